// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSessionPositions_h
#define DeformVolumeSessionPositions_h

#include <glm/vec3.hpp>

class vtkDataSet;
class vtkImageData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// Where a place of the deformed body is at rest, and back. The displacements are the active
/// vectors of the points: of a field, on the lattice of the volume, or of a mesh of tetrahedra.
/// Places outside go with what is nearest. An estimate is the same where a field is neither folded
/// nor torn, and looks no further where it is.
///@{
glm::dvec3 FindRestPosition(vtkDataSet* deformation, const glm::dvec3& deformed);
glm::dvec3 EstimateRestPosition(vtkDataSet* deformation, const glm::dvec3& deformed);
glm::dvec3 FindDeformedPosition(vtkDataSet* deformation, const glm::dvec3& rest);
///@}

} // namespace deformvolume

#endif
