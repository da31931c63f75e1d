// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSessionPositions_h
#define DeformVolumeSessionPositions_h

#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <glm/vec3.hpp>

class vtkDataSet;
class vtkDeformGeometryFilter;
class vtkPolyData;

namespace deformvolume
{

/// Converts positions of the deformed body to positions at rest, and back. deformation: a field on
/// the grid of the volume, or a mesh of tetrahedra, with the displacements as active point vectors.
/// Positions outside are converted by the closest boundary face or point of the field. While a mesh
/// does not change, its search structures are kept.
class PositionSearch
{
public:
  PositionSearch();
  ~PositionSearch();
  PositionSearch(const PositionSearch&) = delete;
  void operator=(const PositionSearch&) = delete;

  /// If a field is folded or torn, searches for the nearest voxel.
  glm::dvec3 FindRestPosition(vtkDataSet* deformation, const glm::dvec3& deformed);
  glm::dvec3 FindDeformedPosition(vtkDataSet* deformation, const glm::dvec3& rest);

  /// Moves a sheet with the tissue to its position at rest. Triangles are divided, since a plane is
  /// curved there.
  vtkSmartPointer<vtkPolyData> MoveToRest(vtkPolyData* sheet, vtkDataSet* deformation);

private:
  // Moves the points of a sheet, to rest or from rest.
  void MoveWithMesh(vtkPolyData* sheet, vtkDataSet* mesh, bool isToRest);
  glm::dvec3 MoveWithMesh(const glm::dvec3& position, vtkDataSet* mesh, bool isToRest);

  vtkNew<vtkDeformGeometryFilter> Filters[2]; // from rest, and to rest
};

} // namespace deformvolume

#endif
