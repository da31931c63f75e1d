// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTileGrid_h
#define DeformVolumeTileGrid_h

#include "Extent.h"
#include "Tetrahedron.h"
#include "TetrahedronRaster.h" // for VoxelBox

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Splits a volume into tiles, each the rows of voxels in a rectangle of y and z.
class TileGrid
{
public:
  explicit TileGrid(const Extent& voxels);

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

  using Places = std::array<glm::dvec3, 4>;
  static Places GetPlaces(const Tetrahedron& nodes, const std::vector<glm::dvec3>& points)
  {
    return { { points[nodes[0]], points[nodes[1]], points[nodes[2]], points[nodes[3]] } };
  }
  /// Whether the nodes of a tetrahedron are at most 2^31 voxels away.
  static bool IsWithinLimit(const Places& nodes);
  /// The voxels of the volume in the box of a tetrahedron within that limit, widened by a margin in
  /// voxels.
  VoxelBox FindBox(const Places& nodes, double margin) const;

  /// The tiles of a tetrahedron, those with voxels in its box, both ends included; empty where it
  /// has no voxel.
  struct Range
  {
    std::int16_t Min[2] = { 0, 0 };
    std::int16_t Max[2] = { -1, -1 };
  };
  Range FindRange(const Places& nodes, double margin) const;
  template <typename Body>
  void ForEachTile(const Range& range, Body&& body) const
  {
    for (std::int64_t z = range.Min[1]; z <= range.Max[1]; ++z)
    {
      for (std::int64_t y = range.Min[0]; y <= range.Max[0]; ++y)
      {
        body(z * this->Count[0] + y);
      }
    }
  }

private:
  void ChooseSize();

  const Extent Voxels;
  std::int64_t Size[2] = { 16, 16 };
  std::int64_t Count[2] = { 0, 0 };
};

} // namespace deformvolume

#endif
