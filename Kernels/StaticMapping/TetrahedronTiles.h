// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronTiles_h
#define DeformVolumeTetrahedronTiles_h

#include "Extent.h"
#include "Tetrahedron.h"
#include "TetrahedronRaster.h" // for VoxelBox

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The division of a volume into tiles, and lists of the tetrahedra in each tile. A tile is a
/// rectangle in y and z with complete rows of voxels along x. One thread links all voxels of a
/// tile, so no locks are needed.
class TetrahedronTiles
{
public:
  /// Sorts tetrahedra into tiles. A tetrahedron belongs to each tile with a voxel in its bounding
  /// box. margin: distance by which bounding boxes are enlarged, in voxels. Throws Error if a node
  /// is more than 2^31 voxels away from index 0.
  TetrahedronTiles(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, double margin);

  std::int64_t GetNumberOfTiles() const { return this->Count[0] * this->Count[1]; }
  /// Number of tiles on y (axis 0) and z (axis 1). Tile (y, z) has the number z * (tiles on y) + y.
  std::int64_t GetNumberOfTiles(int axis) const { return this->Count[axis]; }
  VoxelBox GetVoxels(std::int64_t tile) const;

  /// A range of tiles on y (0) and z (1), from Begin to End - 1. By default empty.
  struct Rectangle
  {
    std::int16_t Begin[2] = { 0, 0 };
    std::int16_t End[2] = { 0, 0 };
  };
  /// Returns the tiles that contain the voxels of a box. The box must lie within the volume.
  Rectangle GetTiles(const VoxelBox& box) const
  {
    Rectangle tiles;
    for (int axis = 0; axis < 2; ++axis)
    {
      const std::int64_t first = this->Voxels[2 * axis + 2];
      tiles.Begin[axis] = static_cast<std::int16_t>((box.Min[axis + 1] - first) / this->Size[axis]);
      tiles.End[axis] =
        static_cast<std::int16_t>((box.Max[axis + 1] - first) / this->Size[axis] + 1);
    }
    return tiles;
  }

  /// The tetrahedra of a tile, in ascending order.
  struct List
  {
    const std::int32_t* First;
    const std::int32_t* Last;
    const std::int32_t* begin() const { return this->First; }
    const std::int32_t* end() const { return this->Last; }
  };
  List GetTetrahedra(std::int64_t tile) const
  {
    return { this->Bins.data() + this->Offsets[tile], this->Bins.data() + this->Offsets[tile + 1] };
  }

  /// Total length of all lists. A tetrahedron in several tiles counts several times.
  std::int64_t GetNumberOfEntries() const { return static_cast<std::int64_t>(this->Bins.size()); }

  /// Number of flat tetrahedra, including tetrahedra outside the volume. The lists contain flat
  /// tetrahedra, too.
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->FlatTetrahedra; }

private:
  using Positions = std::array<glm::dvec3, 4>;
  /// Whether the nodes of a tetrahedron are at most 2^31 voxels away from index 0.
  static bool IsWithinLimit(const Positions& nodes);
  /// Returns the voxels of the volume in the bounding box of a tetrahedron, enlarged by a margin in
  /// voxels. The nodes must be within the limit.
  VoxelBox FindBox(const Positions& nodes, double margin) const;

  /// Calls body(tile) for the tiles of a rectangle.
  template <typename Body>
  void ForEachTile(const Rectangle& tiles, Body&& body) const
  {
    for (std::int64_t z = tiles.Begin[1]; z < tiles.End[1]; ++z)
    {
      for (std::int64_t y = tiles.Begin[0]; y < tiles.End[0]; ++y)
      {
        body(z * this->Count[0] + y);
      }
    }
  }

  void ChooseSize();

  const Extent Voxels;
  std::int64_t Size[2] = { 16, 16 };
  std::int64_t Count[2] = { 0, 0 };
  // The tetrahedra of tile i are Bins[Offsets[i]] to Bins[Offsets[i + 1]].
  std::vector<std::int64_t> Offsets;
  std::vector<std::int32_t> Bins;
  std::int64_t FlatTetrahedra = 0;
};

} // namespace deformvolume

#endif
