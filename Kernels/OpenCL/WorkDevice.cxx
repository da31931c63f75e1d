// SPDX-License-Identifier: BSD-3-Clause
#include "WorkDevice.h"

#include "HostMemory.h"

#include <algorithm>

namespace deformvolume
{

void WorkDevice::Use(OpenCLContext& context)
{
  this->Context = &context;
  this->Queue =
    cl::CommandQueue(context.GetContext(), context.GetDevice().Device, CL_QUEUE_PROFILING_ENABLE);
  this->ReadQueue = cl::CommandQueue(context.GetContext(), context.GetDevice().Device);
}

const std::string& WorkDevice::Choose(
  const std::string& request, const std::function<void()>& release)
{
  OpenCLContext& context = OpenCLContext::Get(FindDevice(request));
  if (!this->Uses(context))
  {
    release();
    this->Use(context);
  }
  return this->GetDevice().Name;
}

OpenCLContext& WorkDevice::GetContext()
{
  if (!this->Context)
  {
    this->Use(OpenCLContext::Get(FindDevice("")));
  }
  return *this->Context;
}

const cl::CommandQueue& WorkDevice::GetQueue()
{
  this->GetContext();
  return this->Queue;
}

const cl::CommandQueue& WorkDevice::GetReadQueue()
{
  this->GetContext();
  return this->ReadQueue;
}

std::uint64_t WorkDevice::GetAllocationLimit()
{
  const std::uint64_t device = this->GetDevice().Device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  return this->AllocationLimit ? std::min(device, this->AllocationLimit) : device;
}

bool WorkDevice::HasSerialGroups()
{
  return this->GetDevice().HasVectors && this->WorkGroupSize == 0;
}

std::size_t WorkDevice::GetGroupSize(const cl::Kernel& kernel, std::size_t wanted)
{
  const auto largest = kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(this->GetDevice().Device);
  return std::min<std::size_t>(this->WorkGroupSize ? this->WorkGroupSize : wanted, largest);
}

std::size_t WorkDevice::GetHeavyGroupSize(const cl::Kernel& kernel, std::size_t wanted)
{
  return this->HasSerialGroups() ? 1 : this->GetGroupSize(kernel, wanted);
}

cl::Event WorkDevice::Launch(const cl::Kernel& kernel, std::size_t items)
{
  const std::size_t group = this->GetGroupSize(kernel);
  return this->GetContext().Launch(
    this->GetQueue(), kernel, cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));
}

void WorkDevice::Send(cl::Buffer& buffer, const void* data, std::size_t bytes)
{
  Reserve(this->GetContext(), buffer, bytes);
  Write(this->GetQueue(), buffer, 0, bytes, data);
}

} // namespace deformvolume
