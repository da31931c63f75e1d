// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorArray_h
#define DeformVolumeVectorArray_h

#include <glm/vec3.hpp>

#include <string>

class vtkDataArray;
class vtkDataSet;

namespace deformvolume
{

/// Copies the tuples of an array of three components to vectors, in parallel. Throws an Error that
/// names the first tuple that is not finite: "<kind> 5 of the <owner>".
void ReadVectors(
  vtkDataArray* array, glm::dvec3* vectors, const std::string& kind, const std::string& owner);

/// The vectors of a dataset's points where nobody chose: the active ones, or else the only array of
/// three components; null where there is no such array.
vtkDataArray* FindVectors(vtkDataSet* dataSet);

} // namespace deformvolume

#endif
