// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelLinker_h
#define DeformVolumeVoxelLinker_h

#include "BarycentricMap.h"
#include "Extent.h"
#include "Tetrahedron.h"
#include "TetrahedronOrder.h"
#include "TetrahedronRaster.h"
#include "TetrahedronTiles.h"
#include "VertexLink.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

namespace deformvolume
{

/// An array of results for the voxels of a box. Element: VertexLink, or std::int32_t for the number
/// of the tetrahedron only (-1 outside the mesh).
template <typename Element>
struct VoxelTarget
{
  /// The element of the first voxel. x varies fastest.
  Element* Data = nullptr;
  /// Structured index of the first voxel.
  std::int64_t First[3] = { 0, 0, 0 };
  /// Number of voxels on x and y.
  std::int64_t Size[2] = { 0, 0 };

  Element& At(std::int64_t x, std::int64_t y, std::int64_t z) const
  {
    return this
      ->Data[((z - this->First[2]) * this->Size[1] + (y - this->First[1])) * this->Size[0] +
        (x - this->First[0])];
  }
};

/// Converts an extent to a box of voxels.
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

/// Returns the intersection of two boxes.
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

/// Finds the tetrahedra of voxels, tile by tile. Calls for different tiles may run in parallel. The
/// arguments of the constructor must outlive the object.
class VoxelLinker
{
public:
  /// Throws Error if a node is more than 2^31 voxels away from index 0.
  VoxelLinker(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra);
  /// In voxels. The link of a voxel depends only on the tetrahedra whose bounding boxes, enlarged
  /// by this margin, contain the voxel.
  static constexpr double Margin = 1.0 / 128.0;

  const TetrahedronTiles& GetTiles() const { return this->Tiles; }

  /// Links the voxels of a tile that lie in `part`. Before the call they must have no tetrahedron.
  /// Returns the number of linked voxels. The links do not depend on `part` if it has complete
  /// rows. StaticMappingBuilder describes which of several tetrahedra is linked. Element:
  /// VertexLink or std::int32_t.
  template <typename Element>
  std::int64_t LinkTile(
    std::int64_t tile, const VoxelBox& part, const VoxelTarget<Element>& target) const;

  /// Finds a voxel in a tetrahedron. The choice is deterministic. Returns false if no voxel of the
  /// volume lies in the tetrahedron with rounded nodes.
  bool FindVoxel(std::int32_t tetrahedron, glm::i64vec3& voxel) const;

  /// Returns a voxel that lies in two bodies of the mesh (TetrahedronOrder), and in the inside of a
  /// tetrahedron of one of them. It is one of those that were linked until now, and the first of
  /// them by z, then y, then x.
  const std::optional<glm::i64vec3>& GetSharedVoxel() const { return this->SharedVoxel; }

private:
  using Nodes = std::array<RasterPoint, 4>;

  Nodes GetNodes(const Tetrahedron& tetrahedron) const;
  /// Returns the voxels of a part of the volume in the bounding box of a tetrahedron.
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
  /// Whether a tetrahedron takes a voxel from another one that contains it, too. map: of the first.
  bool TakesVoxel(std::int32_t id, const BarycentricMap& map, std::int32_t other,
    const glm::i64vec3& voxel) const;

  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  const VoxelBox Voxels;
  const TetrahedronTiles Tiles;
  const TetrahedronOrder Order;
  mutable std::mutex SharedMutex;
  mutable std::optional<glm::i64vec3> SharedVoxel;
};

} // namespace deformvolume

#endif
