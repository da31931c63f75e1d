// SPDX-License-Identifier: BSD-3-Clause
#include "ListBuffers.h"

#include "Error.h"
#include "HostMemory.h"
#include "WorkDevice.h"

#include <limits>
#include <string>

namespace deformvolume
{
namespace
{

// Loops advance by the size of a work-group, and must not exceed 32 bits.
constexpr cl_uint LargestLength = std::numeric_limits<cl_uint>::max() - 4096;

} // namespace

std::uint64_t CountTiles(const RasterParameters& p)
{
  return static_cast<std::uint64_t>(p.TileCount[0]) * static_cast<std::uint64_t>(p.TileCount[1]) *
    static_cast<std::uint64_t>(p.TileCount[2]);
}

void ReserveLists(WorkDevice& device, cl::Buffer& buffer, std::uint64_t bytes)
{
  CheckAllocation(bytes, device.GetAllocationLimit(),
    "The lists of the tetrahedra in each part of the output",
    "Use a coarser deformation mesh, the exact resampler,");
  if (GetMemory(buffer) < bytes)
  {
    buffer = cl::Buffer();
    buffer = cl::Buffer(device.GetContext().GetContext(), CL_MEM_READ_WRITE, bytes);
  }
}

cl_uint CheckLength(std::uint64_t length)
{
  if (length > LargestLength)
  {
    throw Error("The deformation mesh and the output are too large for mesh rasterization: "
                "use the exact resampler, or a coarser mesh.");
  }
  return static_cast<cl_uint>(length);
}

} // namespace deformvolume
