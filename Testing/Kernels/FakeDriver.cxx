// SPDX-License-Identifier: BSD-3-Clause
#include "FakeDriver.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <cstring>
#include <dlfcn.h>
#include <string>

FakeDriver& FakeDriver::Get()
{
  static FakeDriver driver;
  return driver;
}

namespace
{

/// The function of the OpenCL library.
template <typename Function>
Function* Find(const char* name)
{
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

cl_int Give(const void* value, std::size_t size, std::size_t room, void* place, std::size_t* needed)
{
  if (needed)
  {
    *needed = size;
  }
  if (place)
  {
    if (room < size)
    {
      return CL_INVALID_VALUE;
    }
    std::memcpy(place, value, size);
  }
  return CL_SUCCESS;
}

} // namespace

extern "C" cl_int CL_API_CALL clGetDeviceInfo(
  cl_device_id device, cl_device_info what, std::size_t room, void* place, std::size_t* needed)
{
  static auto* const real = Find<decltype(clGetDeviceInfo)>("clGetDeviceInfo");
  const FakeDriver& driver = FakeDriver::Get();
  const cl_device_type graphics = CL_DEVICE_TYPE_GPU;
  if (what == CL_DEVICE_TYPE && driver.IsGraphics)
  {
    return Give(&graphics, sizeof(graphics), room, place, needed);
  }
  if (what == CL_DEVICE_GLOBAL_MEM_SIZE && driver.GlobalMemory)
  {
    return Give(&driver.GlobalMemory, sizeof(cl_ulong), room, place, needed);
  }
  if (what == CL_DEVICE_LOCAL_MEM_SIZE && driver.LocalMemory)
  {
    return Give(&driver.LocalMemory, sizeof(cl_ulong), room, place, needed);
  }
  if (what == CL_DEVICE_EXTENSIONS && !driver.HasDouble)
  {
    std::size_t size = 0;
    real(device, what, 0, nullptr, &size);
    std::string names(size, '\0');
    real(device, what, size, &names[0], nullptr);
    const std::string name = "cl_khr_fp64";
    const std::size_t begin = names.find(name);
    if (begin != std::string::npos)
    {
      names.replace(begin, name.size(), name.size(), ' ');
    }
    return Give(names.data(), size, room, place, needed);
  }
  return real(device, what, room, place, needed);
}

extern "C" cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer,
  cl_bool blocking, std::size_t offset, std::size_t size, void* memory, cl_uint number,
  const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer");
  const int error = FakeDriver::Get().ReadError;
  if (!error || blocking || !done)
  {
    return real(queue, buffer, blocking, offset, size, memory, number, events, done);
  }
  cl_context context = nullptr;
  clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof(context), &context, nullptr);
  *done = clCreateUserEvent(context, nullptr);
  return clSetUserEventStatus(*done, error);
}

extern "C" cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel,
  cl_uint dimensions, const std::size_t* offset, const std::size_t* global,
  const std::size_t* local, cl_uint number, const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel");
  FakeDriver::Get().LaunchesWithoutGroup += !local && global[0] > 1;
  return real(queue, kernel, dimensions, offset, global, local, number, events, done);
}
