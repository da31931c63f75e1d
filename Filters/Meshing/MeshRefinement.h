// SPDX-License-Identifier: BSD-3-Clause
// Local refinement of meshes of tetrahedra.
#ifndef DeformVolumeMeshRefinement_h
#define DeformVolumeMeshRefinement_h

#include <glm/vec3.hpp>

#include <vector>

class vtkPolyData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// Within the radius, edges are at most EdgeLength long. Outside, edges gradually become longer.
/// World units.
struct RefinementSphere
{
  glm::dvec3 Center;
  double Radius = 0.0;
  double EdgeLength = 0.0;
};

/// Estimates the number of tetrahedra that the spheres require within the bounds of a surface.
double EstimateTetrahedra(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres);

/// Splits edges of a triangle surface that are too long for the spheres.
void SplitLongEdges(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres);

/// Splits edges of a mesh of tetrahedra that are still too long within the spheres.
void SplitLongEdges(vtkUnstructuredGrid* mesh, const std::vector<RefinementSphere>& spheres);

/// Makes evenly spaced points in the spheres, as additional nodes for TetGen. They keep some
/// distance from the surface. TetGen ignores points outside the surface.
std::vector<glm::dvec3> MakePoints(
  vtkPolyData* surface, const std::vector<RefinementSphere>& spheres);

} // namespace deformvolume

#endif
