// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSessionPositions_h
#define DeformVolumeSessionPositions_h

#include "vtkSmartPointer.h"

#include <glm/vec3.hpp>

class vtkDataSet;
class vtkPolyData;

namespace deformvolume
{

/// Convert positions of the deformed body to positions at rest, and back. deformation: a field on
/// the grid of the volume, or a mesh of tetrahedra, with the displacements as active point vectors.
/// Positions outside are converted by the closest boundary face or point of the field. If a field
/// is folded or torn, FindRestPosition() searches for the nearest voxel.
///@{
glm::dvec3 FindRestPosition(vtkDataSet* deformation, const glm::dvec3& deformed);
glm::dvec3 FindDeformedPosition(vtkDataSet* deformation, const glm::dvec3& rest);
///@}

/// Moves a sheet with the tissue to its position at rest. Triangles are divided, since a plane is
/// curved there.
vtkSmartPointer<vtkPolyData> MoveToRest(vtkPolyData* sheet, vtkDataSet* deformation);

} // namespace deformvolume

#endif
