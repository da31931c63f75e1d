// SPDX-License-Identifier: BSD-3-Clause
// A function on a coarse grid that is positive in the body and its surroundings.
#ifndef DeformVolumeBodyLevelSet_h
#define DeformVolumeBodyLevelSet_h

#include "BodyVoxels.h"

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <array>
#include <vector>

namespace deformvolume
{

using Index = std::array<vtkIdType, 3>;

/// Values at nodes, each of which lies on a voxel or where one beyond the volume's border would.
/// Positions are offsets from the first voxel, along the axes of the volume, in world units.
struct BodyLevelSet
{
  Index Size{ { 0, 0, 0 } };   // nodes on each axis
  Index Border{ { 0, 0, 0 } }; // nodes before the first voxel
  Index Step{ { 1, 1, 1 } };   // voxels from node to node
  glm::dvec3 VoxelSpacing;     // world units, positive
  std::vector<float> Values;   // in units of the smallest distance of nodes, none between +-0.1

  vtkIdType Count() const { return this->Size[0] * this->Size[1] * this->Size[2]; }
  glm::dvec3 Spacing() const;
  glm::dvec3 FirstPosition() const;
};

/// The grid for a body that is to be enlarged by a margin, in world units, with nodes about
/// `resolution` apart, without values. Throws Error where that is too large.
BodyLevelSet MakeGrid(
  const BodyVoxels& body, const glm::dvec3& spacing, double resolution, double margin);

struct LevelSetParameters
{
  double Margin = 0.0;     // world units
  bool Hull = false;       // of the body's convex hull rather than of the body
  bool WholeCells = false; // whether a cell with a voxel of the body is inside as a whole
};

/// Sets the values to about the distance from the surface of the body, enlarged by the margin, its
/// cavities filled. The isosurface at 0 is a manifold. It encloses the body, with WholeCells by
/// construction, and else but for the difference between trilinear and linear interpolation.
void SetDistances(BodyLevelSet& grid, const BodyVoxels& body, const LevelSetParameters& parameters);

} // namespace deformvolume

#endif
