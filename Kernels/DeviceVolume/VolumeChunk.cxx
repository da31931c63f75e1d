// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeChunk.h"

#include "HostMemory.h"

#include <algorithm>

namespace deformvolume
{

cl::Buffer SendLayers(const OpenCLContext& context, const cl::CommandQueue& queue,
  std::uint64_t allocationLimit, const HostLayers& layers, const cl::Buffer& previous)
{
  const std::uint64_t layerBytes =
    static_cast<std::uint64_t>(layers.ElementsPerLayer) * layers.BytesPerElement;
  const std::uint64_t bytes = layerBytes * static_cast<std::uint64_t>(layers.End - layers.Begin);
  CheckAllocation(
    bytes, allocationLimit, "The values of an array of the volume", "Use a smaller volume");
  // OpenCL has no buffers of 0 bytes.
  const std::uint64_t room = std::max<std::uint64_t>(bytes, layers.BytesPerElement);
  cl::Buffer buffer = previous;
  if (GetMemory(buffer) != room)
  {
    buffer = cl::Buffer(context.GetContext(), CL_MEM_READ_ONLY, room);
  }
  if (bytes > 0)
  {
    Write(queue, buffer, 0, bytes,
      static_cast<const char*>(layers.Data) +
        layerBytes * static_cast<std::uint64_t>(layers.Begin));
  }
  return buffer;
}

} // namespace deformvolume
