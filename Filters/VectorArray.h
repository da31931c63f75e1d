// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorArray_h
#define DeformVolumeVectorArray_h

#include <glm/vec3.hpp>

#include <string>

class vtkDataArray;

namespace deformvolume
{

/// Copies the tuples of an array of three components to vectors, in parallel. Throws an Error that
/// speaks of a tuple as `what` where one is not finite; the first such tuple is named.
void ReadVectors(vtkDataArray* array, glm::dvec3* vectors, const std::string& what);

} // namespace deformvolume

#endif
