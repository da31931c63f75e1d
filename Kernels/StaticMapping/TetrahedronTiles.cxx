// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronTiles.h"

#include "BarycentricMap.h"
#include "CountedLists.h"
#include "Error.h"
#include "ParallelFor.h"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace deformvolume
{

namespace
{

// In voxels. Nodes farther away would overflow WideInteger, and their weights in single precision
// would be meaningless.
constexpr double LargestIndex = 2147483648.0;

} // namespace

TetrahedronTiles::TetrahedronTiles(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, double margin)
  : Voxels(voxels)
{
  this->ChooseSize();
  std::vector<Rectangle> ranges(tetrahedra.size());
  std::atomic<std::int64_t> flat{ 0 };
  std::atomic<bool> beyondLimit{ false };
  ParallelForParts(tetrahedra.size(), 4096,
    [&](std::size_t begin, std::size_t end)
    {
      std::int64_t flatHere = 0;
      for (std::size_t id = begin; id < end; ++id)
      {
        const Tetrahedron& nodes = tetrahedra[id];
        const Positions positions{ { restPoints[nodes[0]], restPoints[nodes[1]],
          restPoints[nodes[2]], restPoints[nodes[3]] } };
        if (!IsWithinLimit(positions))
        {
          beyondLimit = true;
          continue;
        }
        BarycentricMap map;
        flatHere += map.SetTetrahedron(nodes, restPoints) ? 0 : 1;
        const VoxelBox box = this->FindBox(positions, margin);
        ranges[id] = box.IsEmpty() ? Rectangle() : this->GetTiles(box);
      }
      flat += flatHere;
    });
  if (beyondLimit)
  {
    throw Error(
      "The deformation mesh has nodes more than 2147483648 voxels away from index 0 of the "
      "volume. Check the units of the mesh and the spacing of the volume.");
  }
  this->FlatTetrahedra = flat;
  MakeLists(
    static_cast<std::size_t>(this->GetNumberOfTiles()),
    [&](const auto& take)
    {
      for (std::size_t id = 0; id < ranges.size(); ++id)
      {
        this->ForEachTile(ranges[id],
          [&](std::int64_t tile)
          { take(static_cast<std::size_t>(tile), static_cast<std::int32_t>(id)); });
      }
    },
    this->Offsets, this->Bins);
}

// The default size of tiles fits into the caches of a CPU. Large volumes have larger tiles, since
// each tile needs memory.
void TetrahedronTiles::ChooseSize()
{
  constexpr std::int64_t most = 16384;
  const std::int64_t points[2] = { deformvolume::GetSize(this->Voxels, 1),
    deformvolume::GetSize(this->Voxels, 2) };
  while (true)
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      this->Count[axis] = (points[axis] + this->Size[axis] - 1) / this->Size[axis];
    }
    if (this->GetNumberOfTiles() <= most)
    {
      return;
    }
    this->Size[this->Count[0] > this->Count[1] ? 0 : 1] *= 2;
  }
}

bool TetrahedronTiles::IsWithinLimit(const Positions& nodes)
{
  return std::all_of(nodes.begin(), nodes.end(),
    [](const glm::dvec3& point)
    {
      return std::abs(point.x) <= LargestIndex && std::abs(point.y) <= LargestIndex &&
        std::abs(point.z) <= LargestIndex;
    });
}

VoxelBox TetrahedronTiles::FindBox(const Positions& nodes, double margin) const
{
  const glm::dvec3 min =
    glm::min(glm::min(nodes[0], nodes[1]), glm::min(nodes[2], nodes[3])) - margin;
  const glm::dvec3 max =
    glm::max(glm::max(nodes[0], nodes[1]), glm::max(nodes[2], nodes[3])) + margin;
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double first = static_cast<double>(this->Voxels[2 * axis]);
    const double last = static_cast<double>(this->Voxels[2 * axis + 1]);
    // Relative to the first voxel, so not negative: the conversion to an integer rounds down.
    const double low = std::max(min[axis], first) - first;
    const double high = std::min(max[axis], last) - first;
    if (!(low <= high))
    {
      return VoxelBox();
    }
    const auto begin = static_cast<std::int64_t>(low);
    box.Min[axis] = this->Voxels[2 * axis] + begin + (static_cast<double>(begin) < low ? 1 : 0);
    box.Max[axis] = this->Voxels[2 * axis] + static_cast<std::int64_t>(high);
  }
  return box;
}

VoxelBox TetrahedronTiles::GetVoxels(std::int64_t tile) const
{
  VoxelBox box;
  box.Min[0] = this->Voxels[0];
  box.Max[0] = this->Voxels[1];
  const std::int64_t index[2] = { tile % this->Count[0], tile / this->Count[0] };
  for (int axis = 0; axis < 2; ++axis)
  {
    box.Min[axis + 1] = this->Voxels[2 * axis + 2] + index[axis] * this->Size[axis];
    box.Max[axis + 1] =
      std::min<std::int64_t>(box.Min[axis + 1] + this->Size[axis] - 1, this->Voxels[2 * axis + 3]);
  }
  return box;
}

} // namespace deformvolume
