// SPDX-License-Identifier: BSD-3-Clause
#include "HostMemory.h"

namespace deformvolume
{

std::uint64_t GetMemory(const cl::Buffer& buffer)
{
  return buffer() && !(buffer.getInfo<CL_MEM_FLAGS>() & CL_MEM_USE_HOST_PTR)
    ? buffer.getInfo<CL_MEM_SIZE>()
    : 0;
}

bool CanWorkInPlace(const OpenCLContext& context, const void* data, std::size_t elementSize)
{
  return context.GetDevice().IsProcessor &&
    reinterpret_cast<std::uintptr_t>(data) % elementSize == 0;
}

bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array)
{
  return array.Owner && CanWorkInPlace(context, array.Data, GetElementSize(array.Type));
}

cl::Buffer MakeBufferOver(
  const OpenCLContext& context, cl_mem_flags access, void* data, std::size_t bytes)
{
  return cl::Buffer(context.GetContext(), access | CL_MEM_USE_HOST_PTR, bytes, data);
}

} // namespace deformvolume
