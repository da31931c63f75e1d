// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceMasks.h"

#include "Error.h"
#include "FiveTetrahedra.h"

#include <algorithm>
#include <string>

namespace deformvolume
{

DeviceMasks::DeviceMasks(OpenCLContext& context, const cl::CommandQueue& queue,
  const VoxelGrid& grid, std::uint64_t allocationLimit, BrickGrid& bricks,
  std::vector<VolumeChunk>& chunks, VertexStates& states)
  : Context(context)
  , Queue(queue)
  , Grid(grid)
  , Size(bricks.Size)
  , AllocationLimit(allocationLimit)
  , Bricks(bricks)
  , Chunks(chunks)
  , States(states)
{
}

std::vector<Extent> DeviceMasks::SetBlanked(
  const unsigned char* blanked, unsigned char bits, const PointRanges* written)
{
  std::vector<Extent> changes =
    this->Blanked.Set(this->Context, this->Queue, this->Size, this->Chunks, blanked, bits, written);
  this->States.ChangeVertices(changes);
  return changes;
}

std::vector<Extent> DeviceMasks::SetActive(const unsigned char* active, const PointRanges* written)
{
  std::vector<Extent> changes = this->Active.Set(this->Context, this->Queue, this->Size,
    this->Chunks, active, DEFORMVOLUME_ALL_TETRAHEDRA, written);
  if (this->Resampled.IsOn())
  {
    this->Resampled.ChangeCells(changes);
    // BoundaryCells uses the mask of crossed cells directly.
    return this->HasBoundary() ? changes : std::vector<Extent>();
  }
  this->States.ChangeCells(changes);
  return changes;
}

std::vector<Extent> DeviceMasks::SetBoundaryDistances(
  const float* distances, const PointRanges* written)
{
  std::vector<Extent> changes = this->Distances.Set(this->Context, this->Queue, this->Size,
    this->Chunks, reinterpret_cast<const unsigned char*>(distances), 255, written);
  this->States.ChangeVertices(changes);
  return changes;
}

std::vector<Extent> DeviceMasks::SetCut(const unsigned char* crossed, const float* distances)
{
  std::vector<Extent> changes =
    this->Cut.Set(this->Context, this->Queue, this->Grid, crossed, distances);
  if (this->HasCut())
  {
    this->Bricks.Halo = BrickGrid::HaloOfCuts; // never reset, since another cut may follow
  }
  this->States.ChangeVertices(changes);
  this->Resampled.ChangeVertices(changes);
  return changes;
}

void DeviceMasks::SetCoincidentNodes(const std::vector<std::int32_t>& numbers)
{
  this->Queue.finish(); // no command may use the buffers that are released
  const bool had = this->Resampled.HasCoincidentNodes();
  this->Resampled.SetCoincidentNodes(this->Context, this->Queue, numbers);
  if (had != this->Resampled.HasCoincidentNodes())
  {
    this->States.Invalidate();
    for (VolumeChunk& chunk : this->Chunks)
    {
      chunk.ResampledTetrahedra = cl::Buffer();
    }
  }
}

void DeviceMasks::SetBoundary(const MeshBoundary& boundary)
{
  if (boundary.IsEmpty() && !this->HasBoundary())
  {
    return;
  }
  this->Queue.finish(); // no command may use the buffers that are released
  this->States.Invalidate();
  this->Resampled.SetBoundary(!boundary.IsEmpty());
  const std::int64_t layer = static_cast<std::int64_t>(this->Size[0] - 1) * (this->Size[1] - 1);
  for (VolumeChunk& chunk : this->Chunks)
  {
    chunk.ResampledTetrahedra = chunk.Boundary = cl::Buffer();
    if (boundary.IsEmpty())
    {
      continue;
    }
    std::vector<unsigned char> cells(
      static_cast<std::size_t>(layer * (chunk.PlanesEnd - chunk.PlanesBegin - 1)),
      DEFORMVOLUME_ALL_TETRAHEDRA);
    const std::int64_t first = layer * chunk.PlanesBegin;
    const auto mark = [&](const std::vector<std::int64_t>& numbers, unsigned char value)
    {
      const auto begin = std::lower_bound(numbers.begin(), numbers.end(), first);
      const auto end =
        std::lower_bound(begin, numbers.end(), first + static_cast<std::int64_t>(cells.size()));
      std::for_each(begin, end,
        [&](std::int64_t number) { cells[static_cast<std::size_t>(number - first)] = value; });
    };
    mark(boundary.Near, DEFORMVOLUME_ALL_TETRAHEDRA | DEFORMVOLUME_CELL_AT_BOUNDARY);
    mark(boundary.Crossed, DEFORMVOLUME_CELL_AT_BOUNDARY | DEFORMVOLUME_CELL_CROSSED);
    chunk.Boundary = SendLayers(this->Context, this->Queue, this->AllocationLimit,
      { cells.data(), 1, layer, 0, chunk.PlanesEnd - chunk.PlanesBegin - 1 }, cl::Buffer());
    this->Queue.finish();
  }
}

} // namespace deformvolume
