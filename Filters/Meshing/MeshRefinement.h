// SPDX-License-Identifier: BSD-3-Clause
// Shorter edges of tetrahedra where they are asked for.
#ifndef DeformVolumeMeshRefinement_h
#define DeformVolumeMeshRefinement_h

#include <glm/vec3.hpp>

#include <vector>

class vtkPolyData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// Within the radius, edges are at most so long; beyond it, they become longer gradually. World
/// units.
struct RefinementSphere
{
  glm::dvec3 Center;
  double Radius = 0.0;
  double EdgeLength = 0.0;
};

/// About how many tetrahedra the spheres ask for within the bounds of a surface.
double EstimateTetrahedra(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres);

/// Halves edges of a surface of triangles that are too long where the spheres are.
void SplitLongEdges(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres);

/// Halves the few edges of a mesh of tetrahedra that are too long within the spheres all the same.
void SplitLongEdges(vtkUnstructuredGrid* mesh, const std::vector<RefinementSphere>& spheres);

/// Points in the spheres for TetGen to use, evenly spaced, at some distance from the surface and
/// from each other. Those outside the surface do no harm.
std::vector<glm::dvec3> MakePoints(
  vtkPolyData* surface, const std::vector<RefinementSphere>& spheres);

} // namespace deformvolume

#endif
