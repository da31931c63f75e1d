// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronLists.h"

#include "HostMemory.h"
#include "IndexBounds.h" // for GetOutputTransform
#include "MemoryBudget.h"
#include "WorkDevice.h"

#include <algorithm>

namespace deformvolume
{

namespace
{

constexpr int TileBits[3] = { DEFORMVOLUME_TILE_BITS_X, DEFORMVOLUME_TILE_BITS_Y,
  DEFORMVOLUME_TILE_BITS_Z };

int FloorDivide(int value, int bits)
{
  return value >= 0 ? value >> bits : -((-(value + 1) >> bits) + 1);
}

} // namespace

RasterParameters MakeTiles(const Extent& slab, std::size_t numberOfTetrahedra)
{
  RasterParameters p = {};
  for (int axis = 0; axis < 3; ++axis)
  {
    p.OutputFirst[axis] = slab[2 * axis];
    p.OutputSize[axis] = static_cast<int>(GetSize(slab, axis));
    p.TileFirst[axis] = FloorDivide(slab[2 * axis], TileBits[axis]);
    p.TileCount[axis] = FloorDivide(slab[2 * axis + 1], TileBits[axis]) - p.TileFirst[axis] + 1;
  }
  p.Tetrahedra = static_cast<int>(numberOfTetrahedra);
  return p;
}

void SetInverse(const VoxelGrid& grid, RasterParameters& parameters)
{
  const OutputTransform transform = GetOutputTransform(grid);
  const auto split = [](double value, float& sum, float& rest)
  {
    // Volatile: GCC 12 omits the rounding when it vectorizes the loop, and the rest is then 0.
    const volatile float rounded = static_cast<float>(value);
    sum = rounded;
    rest = static_cast<float>(value - rounded);
  };
  const glm::dvec3 offset = -transform.ToIndex(glm::dvec3(0.0));
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      split(transform.GetInverse()[column][row], parameters.Inverse[3 * row + column],
        parameters.InverseRest[3 * row + column]);
    }
    split(offset[row], parameters.Offset[row], parameters.OffsetRest[row]);
  }
  parameters.HasTurnedAxes = !grid.ToOutput.IsDiagonal();
}

TetrahedronLists::Counts TetrahedronLists::Make(WorkDevice& device, MemoryBudget& budget,
  const cl::Buffer& tetrahedra, const cl::Buffer& positions, const RasterParameters& p)
{
  ListBuffers& buffers = this->Buffers;
  ReserveLists(device, buffers.Boxes, static_cast<std::uint64_t>(p.Tetrahedra) * sizeof(cl_uint2));
  ReserveLists(device, buffers.Counters, DEFORMVOLUME_BINNED_COUNTERS * sizeof(cl_uint));
  const QueueGuard guard(device.GetQueue());
  static const cl_uint zeros[DEFORMVOLUME_BINNED_COUNTERS] = {};
  PendingCopy cleared = BeginToWrite(device.GetQueue(), buffers.Counters, 0, sizeof(zeros), zeros);
  // Both methods give the same lists.
  const bool serial = device.HasSerialGroups();
  const std::uint64_t counted = serial
    ? this->Ranges.Count(device, tetrahedra, positions, p, buffers)
    : this->Entries.Count(device, tetrahedra, positions, p, buffers);
  cl_uint counts[DEFORMVOLUME_BINNED_COUNTERS];
  device.GetQueue().enqueueReadBuffer(buffers.Counters, CL_TRUE, 0, sizeof(counts), counts);
  cleared.Check();
  const cl_uint length = CheckLength(counted);
  const std::uint64_t needed = std::uint64_t{ length } * sizeof(cl_int) +
    (serial ? 0 : EntryLists::GetMemoryNeeded(static_cast<std::uint64_t>(p.Tetrahedra), length));
  const std::uint64_t held = deformvolume::GetMemory(buffers.Lists) + this->Entries.GetMemory();
  if (needed > held)
  {
    budget.CheckRoomFor(needed - held, "on the device for the lists of tetrahedra");
  }
  ReserveLists(device, buffers.Lists, std::max<std::uint64_t>(length, 1) * sizeof(cl_int));
  if (serial)
  {
    this->Ranges.Fill(device, p, buffers);
  }
  else
  {
    this->Entries.Fill(device, p, buffers, length);
  }
  return { counts[DEFORMVOLUME_BINNED_INVERTED], counts[DEFORMVOLUME_BINNED_OVERSTRETCHED] };
}

std::uint64_t TetrahedronLists::GetMemory() const
{
  const ListBuffers& buffers = this->Buffers;
  return this->Ranges.GetMemory() + this->Entries.GetMemory() +
    deformvolume::GetMemory(buffers.Boxes, buffers.Counters, buffers.Begins, buffers.Lists);
}

std::uint64_t TetrahedronLists::GetMemoryNeeded(
  WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles)
{
  // The estimate: a tetrahedron is in four lists.
  const std::uint64_t length = 4 * std::uint64_t{ numberOfTetrahedra };
  return numberOfTetrahedra * sizeof(cl_uint2) + (tiles + length) * sizeof(cl_uint) +
    (device.HasSerialGroups() ? RangeLists::GetMemoryNeeded(device, numberOfTetrahedra, tiles)
                              : EntryLists::GetMemoryNeeded(numberOfTetrahedra, length));
}

} // namespace deformvolume
