// SPDX-License-Identifier: BSD-3-Clause
// An OpenCL loader for libraries that must not depend on the loader of the system, which may not be
// installed, such as the Python package. It has only the OpenCL functions that the engine calls.
// Each OpenCL object begins with a pointer to the function table of its driver (cl_khr_icd), and
// each function here calls the function in that table. SystemDrivers finds the drivers.
#include "DriverLibrary.h"
#include "SystemDrivers.h"

#include <CL/cl_icd.h>

#include <mutex>
#include <vector>

namespace
{

/// The function table of the driver that owns an object.
template <typename Object>
const cl_icd_dispatch& Functions(Object object)
{
  return **reinterpret_cast<const cl_icd_dispatch* const*>(object);
}

template <typename Object>
Object Refuse(cl_int error, cl_int* result)
{
  if (result)
  {
    *result = error;
  }
  return nullptr;
}

const std::vector<cl_platform_id>& GetPlatforms()
{
  static std::once_flag isFound;
  static auto* const platforms = new std::vector<cl_platform_id>; // drivers stay loaded
  std::call_once(isFound,
    []
    {
      for (const std::string& library : deformvolume::FindSystemDrivers())
      {
        std::string problem; // ignored: a broken driver must not hide working drivers
        for (cl_platform_id platform : deformvolume::LoadPlatforms(library, problem))
        {
          platforms->push_back(platform);
        }
      }
    });
  return *platforms;
}

} // namespace

extern "C"
{

  cl_int CL_API_CALL clGetPlatformIDs(cl_uint room, cl_platform_id* platforms, cl_uint* found)
  {
    if ((platforms && room == 0) || (!platforms && !found))
    {
      return CL_INVALID_VALUE;
    }
    const std::vector<cl_platform_id>& all = GetPlatforms();
    if (found)
    {
      *found = static_cast<cl_uint>(all.size());
    }
    for (std::size_t i = 0; platforms && i < room && i < all.size(); ++i)
    {
      platforms[i] = all[i];
    }
    return all.empty() ? CL_PLATFORM_NOT_FOUND_KHR : CL_SUCCESS;
  }

  cl_context CL_API_CALL clCreateContext(const cl_context_properties* properties, cl_uint count,
    const cl_device_id* devices, void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*),
    void* data, cl_int* result)
  {
    return count && devices && devices[0]
      ? Functions(devices[0]).clCreateContext(properties, count, devices, notify, data, result)
      : Refuse<cl_context>(CL_INVALID_DEVICE, result);
  }

  cl_int CL_API_CALL clWaitForEvents(cl_uint count, const cl_event* events)
  {
    return count && events && events[0] ? Functions(events[0]).clWaitForEvents(count, events)
                                        : CL_INVALID_VALUE;
  }

  // Functions that take only an object.
#define FORWARD(name, type, error)                                                                 \
  cl_int CL_API_CALL name(type object)                                                             \
  {                                                                                                \
    return object ? Functions(object).name(object) : error;                                        \
  }
  FORWARD(clRetainDevice, cl_device_id, CL_INVALID_DEVICE)
  FORWARD(clReleaseDevice, cl_device_id, CL_INVALID_DEVICE)
  FORWARD(clRetainContext, cl_context, CL_INVALID_CONTEXT)
  FORWARD(clReleaseContext, cl_context, CL_INVALID_CONTEXT)
  FORWARD(clRetainCommandQueue, cl_command_queue, CL_INVALID_COMMAND_QUEUE)
  FORWARD(clReleaseCommandQueue, cl_command_queue, CL_INVALID_COMMAND_QUEUE)
  FORWARD(clFlush, cl_command_queue, CL_INVALID_COMMAND_QUEUE)
  FORWARD(clFinish, cl_command_queue, CL_INVALID_COMMAND_QUEUE)
  FORWARD(clRetainMemObject, cl_mem, CL_INVALID_MEM_OBJECT)
  FORWARD(clReleaseMemObject, cl_mem, CL_INVALID_MEM_OBJECT)
  FORWARD(clRetainProgram, cl_program, CL_INVALID_PROGRAM)
  FORWARD(clReleaseProgram, cl_program, CL_INVALID_PROGRAM)
  FORWARD(clRetainKernel, cl_kernel, CL_INVALID_KERNEL)
  FORWARD(clReleaseKernel, cl_kernel, CL_INVALID_KERNEL)
  FORWARD(clRetainEvent, cl_event, CL_INVALID_EVENT)
  FORWARD(clReleaseEvent, cl_event, CL_INVALID_EVENT)
#undef FORWARD

  // Functions that return information about an object.
#define FORWARD_INFO(name, type, info, error)                                                      \
  cl_int CL_API_CALL name(type object, info key, size_t size, void* value, size_t* needed)         \
  {                                                                                                \
    return object ? Functions(object).name(object, key, size, value, needed) : error;              \
  }
  FORWARD_INFO(clGetPlatformInfo, cl_platform_id, cl_platform_info, CL_INVALID_PLATFORM)
  FORWARD_INFO(clGetDeviceInfo, cl_device_id, cl_device_info, CL_INVALID_DEVICE)
  FORWARD_INFO(
    clGetCommandQueueInfo, cl_command_queue, cl_command_queue_info, CL_INVALID_COMMAND_QUEUE)
  FORWARD_INFO(clGetMemObjectInfo, cl_mem, cl_mem_info, CL_INVALID_MEM_OBJECT)
  FORWARD_INFO(clGetProgramInfo, cl_program, cl_program_info, CL_INVALID_PROGRAM)
  FORWARD_INFO(clGetKernelInfo, cl_kernel, cl_kernel_info, CL_INVALID_KERNEL)
  FORWARD_INFO(clGetEventInfo, cl_event, cl_event_info, CL_INVALID_EVENT)
  FORWARD_INFO(clGetEventProfilingInfo, cl_event, cl_profiling_info, CL_INVALID_EVENT)
#undef FORWARD_INFO

  cl_int CL_API_CALL clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint room,
    cl_device_id* devices, cl_uint* found)
  {
    return platform ? Functions(platform).clGetDeviceIDs(platform, type, room, devices, found)
                    : CL_INVALID_PLATFORM;
  }

  cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
    size_t offset, size_t size, void* pointer, cl_uint waits, const cl_event* wait, cl_event* event)
  {
    return queue ? Functions(queue).clEnqueueReadBuffer(
                     queue, buffer, blocking, offset, size, pointer, waits, wait, event)
                 : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clEnqueueReadBufferRect(cl_command_queue queue, cl_mem buffer,
    cl_bool blocking, const size_t* origin, const size_t* host, const size_t* region, size_t row,
    size_t slice, size_t hostRow, size_t hostSlice, void* pointer, cl_uint waits,
    const cl_event* wait, cl_event* event)
  {
    return queue ? Functions(queue).clEnqueueReadBufferRect(queue, buffer, blocking, origin, host,
                     region, row, slice, hostRow, hostSlice, pointer, waits, wait, event)
                 : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
    size_t offset, size_t size, const void* pointer, cl_uint waits, const cl_event* wait,
    cl_event* event)
  {
    return queue ? Functions(queue).clEnqueueWriteBuffer(
                     queue, buffer, blocking, offset, size, pointer, waits, wait, event)
                 : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clEnqueueWriteBufferRect(cl_command_queue queue, cl_mem buffer,
    cl_bool blocking, const size_t* origin, const size_t* host, const size_t* region, size_t row,
    size_t slice, size_t hostRow, size_t hostSlice, const void* pointer, cl_uint waits,
    const cl_event* wait, cl_event* event)
  {
    return queue ? Functions(queue).clEnqueueWriteBufferRect(queue, buffer, blocking, origin, host,
                     region, row, slice, hostRow, hostSlice, pointer, waits, wait, event)
                 : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clEnqueueCopyBuffer(cl_command_queue queue, cl_mem source, cl_mem target,
    size_t from, size_t to, size_t size, cl_uint waits, const cl_event* wait, cl_event* event)
  {
    return queue ? Functions(queue).clEnqueueCopyBuffer(
                     queue, source, target, from, to, size, waits, wait, event)
                 : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern,
    size_t patternSize, size_t offset, size_t size, cl_uint waits, const cl_event* wait,
    cl_event* event)
  {
    return queue ? Functions(queue).clEnqueueFillBuffer(
                     queue, buffer, pattern, patternSize, offset, size, waits, wait, event)
                 : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem memory, void* pointer,
    cl_uint waits, const cl_event* wait, cl_event* event)
  {
    return queue
      ? Functions(queue).clEnqueueUnmapMemObject(queue, memory, pointer, waits, wait, event)
      : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint axes,
    const size_t* offset, const size_t* items, const size_t* group, cl_uint waits,
    const cl_event* wait, cl_event* event)
  {
    return queue ? Functions(queue).clEnqueueNDRangeKernel(
                     queue, kernel, axes, offset, items, group, waits, wait, event)
                 : CL_INVALID_COMMAND_QUEUE;
  }

  cl_int CL_API_CALL clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices,
    const char* options, void(CL_CALLBACK* notify)(cl_program, void*), void* data)
  {
    return program
      ? Functions(program).clBuildProgram(program, count, devices, options, notify, data)
      : CL_INVALID_PROGRAM;
  }

  cl_int CL_API_CALL clGetProgramBuildInfo(cl_program program, cl_device_id device,
    cl_program_build_info name, size_t size, void* value, size_t* needed)
  {
    return program
      ? Functions(program).clGetProgramBuildInfo(program, device, name, size, value, needed)
      : CL_INVALID_PROGRAM;
  }

  cl_int CL_API_CALL clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device,
    cl_kernel_work_group_info name, size_t size, void* value, size_t* needed)
  {
    return kernel
      ? Functions(kernel).clGetKernelWorkGroupInfo(kernel, device, name, size, value, needed)
      : CL_INVALID_KERNEL;
  }

  cl_int CL_API_CALL clSetKernelArg(cl_kernel kernel, cl_uint index, size_t size, const void* value)
  {
    return kernel ? Functions(kernel).clSetKernelArg(kernel, index, size, value)
                  : CL_INVALID_KERNEL;
  }

  cl_mem CL_API_CALL clCreateBuffer(
    cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* result)
  {
    return context ? Functions(context).clCreateBuffer(context, flags, size, host, result)
                   : Refuse<cl_mem>(CL_INVALID_CONTEXT, result);
  }

  cl_command_queue CL_API_CALL clCreateCommandQueue(
    cl_context context, cl_device_id device, cl_command_queue_properties properties, cl_int* result)
  {
    return context ? Functions(context).clCreateCommandQueue(context, device, properties, result)
                   : Refuse<cl_command_queue>(CL_INVALID_CONTEXT, result);
  }

  cl_kernel CL_API_CALL clCreateKernel(cl_program program, const char* name, cl_int* result)
  {
    return program ? Functions(program).clCreateKernel(program, name, result)
                   : Refuse<cl_kernel>(CL_INVALID_PROGRAM, result);
  }

  cl_program CL_API_CALL clCreateProgramWithSource(
    cl_context context, cl_uint count, const char** strings, const size_t* lengths, cl_int* result)
  {
    return context
      ? Functions(context).clCreateProgramWithSource(context, count, strings, lengths, result)
      : Refuse<cl_program>(CL_INVALID_CONTEXT, result);
  }

  void* CL_API_CALL clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
    cl_map_flags flags, size_t offset, size_t size, cl_uint waits, const cl_event* wait,
    cl_event* event, cl_int* result)
  {
    return queue ? Functions(queue).clEnqueueMapBuffer(
                     queue, buffer, blocking, flags, offset, size, waits, wait, event, result)
                 : Refuse<void*>(CL_INVALID_COMMAND_QUEUE, result);
  }

} // extern "C"
