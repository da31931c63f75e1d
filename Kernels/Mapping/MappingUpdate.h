// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMappingUpdate_h
#define DeformVolumeMappingUpdate_h

#include "Extent.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Tetrahedra that are the same as before, with the same nodes in the same places, by their numbers
/// before and now.
struct KeptTetrahedra
{
  std::int32_t Before = 0;
  std::int32_t After = 0;
  std::int32_t Count = 0;
};

/// A tetrahedron that is gone: its nodes, and where they lay at rest, in continuous indices of the
/// volume.
struct RemovedTetrahedron
{
  Tetrahedron Nodes{};
  std::array<glm::dvec3, 4> Places{};
};

/// How the tetrahedra of a mesh follow from those that there were.
struct TetrahedronReplacement
{
  /// In ascending order, before and now. All others are gone, or new.
  std::vector<KeptTetrahedra> Kept;
  std::vector<RemovedTetrahedron> Removed;
};

/// How the static mapping of a volume (StaticMapping.h) changes where tetrahedra are replaced by
/// others: the links or the runs of some rows of voxels. All other voxels stay in the tetrahedra
/// that they lie in, under the numbers of now.
struct MappingUpdate
{
  /// As in TetrahedronReplacement.
  std::vector<KeptTetrahedra> Kept;
  /// Structured indices of all voxels that may lie in another tetrahedron than before.
  std::vector<Extent> Changed;
  /// Those of the voxels that are mapped anew: whole rows, no voxel twice.
  std::vector<Extent> Boxes;
  /// One link for each voxel of the boxes, one box after the other, x varying fastest; or none.
  std::vector<VertexLink> Links;
  /// Or the runs of their rows, one box after the other, y before z.
  VertexRuns Runs;
  /// Voxels of the boxes inside the mesh.
  std::int64_t NumberOfInnerVoxels = 0;
};

/// Calls body(beforeBegin, beforeEnd, afterBegin, afterEnd) for what lies between the tetrahedra
/// that are kept: those that are gone, and those that are new.
template <typename Body>
void ForEachReplaced(const std::vector<KeptTetrahedra>& kept, std::int32_t numberBefore,
  std::int32_t numberAfter, Body&& body)
{
  std::int32_t before = 0;
  std::int32_t after = 0;
  for (const KeptTetrahedra& some : kept)
  {
    body(before, some.Before, after, some.After);
    before = some.Before + some.Count;
    after = some.After + some.Count;
  }
  body(before, numberBefore, after, numberAfter);
}

} // namespace deformvolume

#endif
