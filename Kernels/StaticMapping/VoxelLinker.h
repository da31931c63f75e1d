// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelLinker_h
#define DeformVolumeVoxelLinker_h

#include "BarycentricMap.h"
#include "Extent.h"
#include "Tetrahedron.h"
#include "TetrahedronRaster.h"
#include "TetrahedronTiles.h"
#include "VertexLink.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// What is to be known of each voxel of a box: a VertexLink, or the tetrahedron alone, an
/// std::int32_t that is -1 outside the mesh.
template <typename Element>
struct VoxelTarget
{
  /// The first voxel's element; x varies fastest.
  Element* Data = nullptr;
  /// Structured index of the first voxel, and voxels on x and y.
  std::int64_t First[3] = { 0, 0, 0 };
  std::int64_t Size[2] = { 0, 0 };

  Element& At(std::int64_t x, std::int64_t y, std::int64_t z) const
  {
    return this
      ->Data[((z - this->First[2]) * this->Size[1] + (y - this->First[1])) * this->Size[0] +
        (x - this->First[0])];
  }
};

/// The voxels of an extent.
inline VoxelBox MakeVoxelBox(const Extent& extent)
{
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis)
  {
    box.Min[axis] = extent[2 * axis];
    box.Max[axis] = extent[2 * axis + 1];
  }
  return box;
}

/// The voxels that two boxes share.
inline VoxelBox Intersect(const VoxelBox& a, const VoxelBox& b)
{
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis)
  {
    box.Min[axis] = std::max(a.Min[axis], b.Min[axis]);
    box.Max[axis] = std::min(a.Max[axis], b.Max[axis]);
  }
  return box;
}

/// Finds the tetrahedra of voxels, tile by tile. Calls for several tiles may run at a time. What
/// it is made of must outlive it.
class VoxelLinker
{
public:
  /// Throws Error where a tetrahedron has a node more than 2^31 voxels away from index 0.
  VoxelLinker(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra);
  /// What a voxel gets depends only on the tetrahedra whose boxes, widened by so much, hold it.
  static constexpr double Margin = 1.0 / 128.0;

  const TetrahedronTiles& GetTiles() const { return this->Tiles; }

  /// Fills the elements of the voxels of a tile that lie in a part of it, and which are outside the
  /// mesh so far; returns how many have a tetrahedron. What a voxel gets does not depend on the
  /// part, if that has whole rows. Of tetrahedra that hold a voxel the first one by the positions
  /// of its nodes gets it (see StaticMappingBuilder). Element: VertexLink or std::int32_t.
  template <typename Element>
  std::int64_t LinkTile(
    std::int64_t tile, const VoxelBox& part, const VoxelTarget<Element>& target) const;

  /// A voxel in a tetrahedron, always the same one; false where no voxel of the volume lies in the
  /// tetrahedron after its nodes are rounded.
  bool FindVoxel(std::int32_t tetrahedron, glm::i64vec3& voxel) const;

private:
  using Nodes = std::array<RasterPoint, 4>;

  Nodes GetNodes(const Tetrahedron& tetrahedron) const;
  /// The voxels of a part of the volume in the box of a tetrahedron.
  static VoxelBox GetBox(const Nodes& nodes, const VoxelBox& part);
  static bool FitsInt64(const Nodes& nodes);
  template <typename Integer>
  static bool FindVoxel(const Nodes& nodes, const VoxelBox& box, glm::i64vec3& voxel);
  template <typename Integer, typename Element>
  std::int64_t LinkTetrahedron(std::int32_t id, const Nodes& nodes, const VoxelBox& box,
    const VoxelTarget<Element>& target, std::vector<glm::i64vec3>& heldByRounding) const;
  template <typename Element>
  bool LinkHeldByRounding(std::int64_t tile, const glm::i64vec3& voxel, Element& element) const;
  std::int64_t LinkRow(std::int32_t id, const BarycentricMap& map, const glm::i64vec3& first,
    std::int64_t count, VertexLink* links) const;
  std::int64_t LinkRow(std::int32_t id, const BarycentricMap& map, const glm::i64vec3& first,
    std::int64_t count, std::int32_t* tetrahedra) const;
  /// Whether a tetrahedron gets the voxels that another one holds, too.
  bool ComesBefore(std::int32_t id, std::int32_t other) const;

  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  const VoxelBox Voxels;
  const TetrahedronTiles Tiles;
};

} // namespace deformvolume

#endif
