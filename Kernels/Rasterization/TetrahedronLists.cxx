// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronLists.h"

#include "Error.h"
#include "HostMemory.h"
#include "WorkDevice.h"

#include <algorithm>
#include <string>

namespace deformvolume
{

std::int64_t TetrahedronLists::Make(WorkDevice& device, const cl::Buffer& tetrahedra,
  const cl::Buffer& positions, const RasterParameters& p)
{
  ListBuffers& buffers = this->Buffers;
  ReserveLists(device, buffers.Boxes, static_cast<std::uint64_t>(p.Tetrahedra) * sizeof(cl_uint2));
  ReserveLists(device, buffers.Counters, DEFORMVOLUME_BINNED_COUNTERS * sizeof(cl_uint));
  const QueueGuard guard(device.GetQueue());
  static const cl_uint zeros[DEFORMVOLUME_BINNED_COUNTERS] = {};
  device.GetQueue().enqueueWriteBuffer(buffers.Counters, CL_FALSE, 0, sizeof(zeros), zeros);
  // Whatever the way, the lists are the same.
  const bool serial = device.HasSerialGroups();
  const std::uint64_t counted = serial
    ? this->Ranges.Count(device, tetrahedra, positions, p, buffers)
    : this->Entries.Count(device, tetrahedra, positions, p, buffers);
  const std::int64_t inverted = this->CheckCounters(device);
  const cl_uint length = CheckLength(counted);
  ReserveLists(device, buffers.Lists, std::max<std::uint64_t>(length, 1) * sizeof(cl_int));
  if (serial)
  {
    this->Ranges.Fill(device, p, buffers);
  }
  else
  {
    this->Entries.Fill(device, p, buffers, length);
  }
  return inverted;
}

std::int64_t TetrahedronLists::CheckCounters(WorkDevice& device) const
{
  cl_uint counts[DEFORMVOLUME_BINNED_COUNTERS];
  device.GetQueue().enqueueReadBuffer(this->Buffers.Counters, CL_TRUE, 0, sizeof(counts), counts);
  if (counts[DEFORMVOLUME_BINNED_OVERSTRETCHED] > 0)
  {
    throw Error(std::to_string(counts[DEFORMVOLUME_BINNED_OVERSTRETCHED]) +
      " tetrahedra of the deformation mesh span more than 5,000 output voxels, which the resampler "
      "MeshRasterization cannot rasterise. Use the resampler Exact, a finer mesh or a greater "
      "output spacing.");
  }
  return counts[DEFORMVOLUME_BINNED_INVERTED];
}

std::uint64_t TetrahedronLists::GetMemory() const
{
  std::uint64_t bytes = this->Ranges.GetMemory() + this->Entries.GetMemory();
  for (const cl::Buffer* buffer :
    { &this->Buffers.Boxes, &this->Buffers.Counters, &this->Buffers.Begins, &this->Buffers.Lists })
  {
    bytes += deformvolume::GetMemory(*buffer);
  }
  return bytes;
}

std::uint64_t TetrahedronLists::GetMemoryNeeded(
  WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles)
{
  // A tetrahedron is in four lists.
  const std::uint64_t length = 4 * std::uint64_t{ numberOfTetrahedra };
  return numberOfTetrahedra * sizeof(cl_uint2) + (tiles + length) * sizeof(cl_uint) +
    (device.HasSerialGroups() ? RangeLists::GetMemoryNeeded(device, numberOfTetrahedra, tiles)
                              : EntryLists::GetMemoryNeeded(numberOfTetrahedra, length));
}

} // namespace deformvolume
