// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorArray_h
#define DeformVolumeVectorArray_h

#include <glm/vec3.hpp>

#include <string>

class vtkDataArray;

namespace deformvolume
{

/// Copies the tuples of an array of three components to vectors, in parallel. Throws an Error that
/// names the first tuple that is not finite: "<kind> 5 of the <owner>".
void ReadVectors(
  vtkDataArray* array, glm::dvec3* vectors, const std::string& kind, const std::string& owner);

} // namespace deformvolume

#endif
