// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronTiles_h
#define DeformVolumeTetrahedronTiles_h

#include "Extent.h"
#include "Tetrahedron.h"
#include "TetrahedronRaster.h" // for VoxelBox

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Splits a volume into tiles, each the rows of voxels in a rectangle of y and z, and lists the
/// tetrahedra of each tile. One thread links all voxels of a tile, so that nothing has to be locked
/// and the order of the tetrahedra decides.
class TetrahedronTiles
{
public:
  /// A tetrahedron belongs to the tiles with voxels in its box, widened by a margin in voxels.
  /// Throws Error where a node is more than 2^31 voxels away.
  TetrahedronTiles(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, double margin);

  std::int64_t GetNumberOfTiles() const { return this->Count[0] * this->Count[1]; }
  /// Tiles on y (0) and z (1); tile = z * (tiles on y) + y.
  std::int64_t GetNumberOfTiles(int axis) const { return this->Count[axis]; }
  VoxelBox GetVoxels(std::int64_t tile) const;

  /// The tiles that hold voxels of a box within the volume, on y (0) and z (1).
  struct Rectangle
  {
    std::int64_t Begin[2];
    std::int64_t End[2];
  };
  Rectangle GetTiles(const VoxelBox& box) const
  {
    Rectangle tiles;
    for (int axis = 0; axis < 2; ++axis)
    {
      const std::int64_t first = this->Voxels[2 * axis + 2];
      tiles.Begin[axis] = (box.Min[axis + 1] - first) / this->Size[axis];
      tiles.End[axis] = (box.Max[axis + 1] - first) / this->Size[axis] + 1;
    }
    return tiles;
  }

  /// The tetrahedra of a tile in ascending order.
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

  /// Tetrahedra of all tiles; those in several are counted several times.
  std::int64_t GetNumberOfEntries() const { return static_cast<std::int64_t>(this->Bins.size()); }

  /// Tetrahedra without volume, wherever they are. They are listed too.
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->FlatTetrahedra; }

private:
  // The tiles of a tetrahedron, both ends included; empty where it has no voxel.
  struct Range
  {
    std::int16_t Min[2] = { 0, 0 };
    std::int16_t Max[2] = { -1, -1 };
  };

  void ChooseSize();
  Range FindRange(
    const Tetrahedron& tetrahedron, const std::vector<glm::dvec3>& restPoints, double margin) const;
  template <typename Body>
  void ForEachTile(const Range& range, Body&& body) const;

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
