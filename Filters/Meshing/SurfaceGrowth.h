// SPDX-License-Identifier: BSD-3-Clause
// Moves the vertices of a surface outwards until it encloses a body.
#ifndef DeformVolumeSurfaceGrowth_h
#define DeformVolumeSurfaceGrowth_h

#include "BodyVoxels.h"

#include <glm/vec3.hpp>

#include <functional>

class vtkPolyData;

namespace deformvolume
{

/// A voxel of a body that a surface does not enclose.
using VoxelIndex = std::array<int, 3>;

struct OutsideVoxels
{
  vtkIdType Count = 0;
  std::vector<VoxelIndex> Some; // all, or where there are very many, some all over the body
};

/// The voxels of a body outside a closed surface of triangles that are oriented alike. Positions
/// are offsets from the first voxel in world units, along the axes of the volume.
OutsideVoxels FindOutside(vtkPolyData* surface, const BodyVoxels& body, const glm::dvec3& spacing);

/// Moves vertices outwards, in place, so that all of the body is inside. `reach` is the longest way
/// that a surface may move. Returns whether at most `allowed` voxels of the body are left outside;
/// the surface may intersect itself then, though that is rare. `target` is what is aimed at, a
/// little larger than the body. `check` is called between the steps and throws to give up.
bool GrowAroundBody(vtkPolyData* surface, const BodyVoxels& body, const BodyVoxels& target,
  const glm::dvec3& spacing, double reach, vtkIdType allowed, const std::function<void()>& check);

} // namespace deformvolume

#endif
