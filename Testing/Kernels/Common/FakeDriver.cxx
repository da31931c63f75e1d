// SPDX-License-Identifier: BSD-3-Clause
#include "FakeDriver.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <algorithm>
#include <cstring>
#include <dlfcn.h>
#include <map>
#include <mutex>
#include <string>
#include <vector>

FakeDriver& FakeDriver::Get()
{
  static FakeDriver driver;
  return driver;
}

void FakeDriver::Reset()
{
  FakeDriver fresh;
  fresh.IsGraphics = Get().IsGraphics;
  fresh.HasDouble = Get().HasDouble;
  fresh.FirstName = Get().FirstName;
  Get() = fresh;
}

namespace
{

/// Returns a function of the OpenCL library.
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

/// A range of host memory with a buffer over it.
struct Range
{
  const char* Begin;
  const char* End;
  int References;
};

std::mutex Mutex;
std::map<cl_mem, Range> Ranges;

bool IsPinned(cl_mem buffer)
{
  cl_mem_flags flags = 0;
  clGetMemObjectInfo(buffer, CL_MEM_FLAGS, sizeof(flags), &flags, nullptr);
  return flags & CL_MEM_ALLOC_HOST_PTR;
}

/// Whether a non-blocking copy must fail. The call then returns error.
bool Fails(int asked, Counter<int>& before, cl_command_queue queue, cl_event* done, cl_int& error)
{
  if (!asked || !done || before-- > 0)
  {
    return false;
  }
  if (FakeDriver::Get().FailsAtOnce)
  {
    error = asked;
    return true;
  }
  cl_context context = nullptr;
  clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof(context), &context, nullptr);
  *done = clCreateUserEvent(context, nullptr);
  error = clSetUserEventStatus(*done, asked);
  return true;
}

/// Counts a copy, and returns whether it must fail.
bool FailsToRead(
  std::size_t bytes, cl_bool blocking, cl_command_queue queue, cl_event* done, cl_int& error)
{
  FakeDriver& driver = FakeDriver::Get();
  driver.BytesRead += bytes;
  ++driver.Reads;
  return !blocking && Fails(driver.ReadError, driver.ReadsBeforeError, queue, done, error);
}

bool FailsToWrite(
  std::size_t bytes, cl_bool blocking, cl_command_queue queue, cl_event* done, cl_int& error)
{
  FakeDriver& driver = FakeDriver::Get();
  driver.BytesWritten += bytes;
  ++driver.Writes;
  return !blocking && Fails(driver.WriteError, driver.WritesBeforeError, queue, done, error);
}

/// The number of bytes of local memory that arguments of kernels request.
std::map<cl_kernel, std::map<cl_uint, std::size_t>> LocalMemory;

template <typename Query>
std::string GetText(Query&& query)
{
  std::size_t size = 0;
  query(0, nullptr, &size);
  std::string text(size, '\0');
  query(size, size ? &text[0] : nullptr, nullptr);
  return text.c_str(); // up to the first zero
}

std::string GetText(cl_program program, cl_program_info what)
{
  return GetText([&](std::size_t size, void* place, std::size_t* needed)
    { clGetProgramInfo(program, what, size, place, needed); });
}

FakeDriver::Launch DescribeLaunch(cl_kernel kernel, cl_uint dimensions, const std::size_t* local)
{
  FakeDriver::Launch launch;
  cl_program program = nullptr;
  clGetKernelInfo(kernel, CL_KERNEL_PROGRAM, sizeof(program), &program, nullptr);
  launch.Text = GetText(program, CL_PROGRAM_SOURCE);
  launch.Kernel = GetText([&](std::size_t size, void* place, std::size_t* needed)
    { clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, size, place, needed); });
  for (cl_uint axis = 0; local && axis < dimensions; ++axis)
  {
    launch.Items *= local[axis];
  }
  const std::lock_guard<std::mutex> lock(Mutex);
  for (const auto& argument : LocalMemory[kernel])
  {
    launch.LocalMemory += argument.second;
  }
  return launch;
}

} // namespace

extern "C" cl_mem CL_API_CALL clCreateBuffer(
  cl_context context, cl_mem_flags flags, std::size_t size, void* memory, cl_int* error)
{
  static auto* const real = Find<decltype(clCreateBuffer)>("clCreateBuffer");
  FakeDriver::Get().BytesWritten += flags & CL_MEM_COPY_HOST_PTR ? size : 0;
  if (flags & CL_MEM_ALLOC_HOST_PTR && FakeDriver::Get().RefusesPinned)
  {
    if (error)
    {
      *error = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    }
    return nullptr;
  }
  if (FakeDriver::Get().SkipsLaunches && !memory)
  {
    const std::vector<char> zeros(size);
    return real(
      context, flags | CL_MEM_COPY_HOST_PTR, size, const_cast<char*>(zeros.data()), error);
  }
  if (!(flags & CL_MEM_USE_HOST_PTR))
  {
    return real(context, flags, size, memory, error);
  }
  const char* const begin = static_cast<const char*>(memory);
  const std::lock_guard<std::mutex> lock(Mutex);
  const bool overlaps = std::any_of(Ranges.begin(), Ranges.end(),
    [&](const auto& one) { return one.second.Begin < begin + size && begin < one.second.End; });
  if (overlaps && FakeDriver::Get().RefusesOverlaps)
  {
    if (error)
    {
      *error = CL_INVALID_HOST_PTR;
    }
    return nullptr;
  }
  cl_mem buffer = real(context, flags, size, memory, error);
  if (buffer)
  {
    Ranges[buffer] = { begin, begin + size, 1 };
  }
  return buffer;
}

extern "C" cl_program CL_API_CALL clCreateProgramWithSource(
  cl_context context, cl_uint number, const char** texts, const std::size_t* lengths, cl_int* error)
{
  static auto* const real = Find<decltype(clCreateProgramWithSource)>("clCreateProgramWithSource");
  if (!FakeDriver::Get().FusesProducts)
  {
    return real(context, number, texts, lengths, error);
  }
  const std::string fuse =
    "\n#ifdef __clang__\n#pragma clang fp contract(fast)\n#else\n#pragma OPENCL FP_CONTRACT ON\n"
    "#endif\n";
  const std::string separate = "#pragma OPENCL FP_CONTRACT OFF";
  std::string text = fuse;
  for (cl_uint i = 0; i < number; ++i)
  {
    text += lengths && lengths[i] ? std::string(texts[i], lengths[i]) : std::string(texts[i]);
  }
  for (std::size_t place = 0; (place = text.find(separate, place)) != std::string::npos;)
  {
    text.replace(place, separate.size(), fuse);
  }
  const char* whole = text.c_str();
  return real(context, 1, &whole, nullptr, error);
}

extern "C" cl_int CL_API_CALL clBuildProgram(cl_program program, cl_uint number,
  const cl_device_id* devices, const char* options, void(CL_CALLBACK* done)(cl_program, void*),
  void* data)
{
  static auto* const real = Find<decltype(clBuildProgram)>("clBuildProgram");
  std::string known = options ? options : "";
  if (FakeDriver::Get().HasNVIDIAOptions)
  {
    known.erase(std::min(known.find(" -cl-nv-"), known.size()));
  }
  known += FakeDriver::Get().SkipsOptimization ? " -cl-opt-disable" : "";
  const cl_int error = real(program, number, devices, known.c_str(), done, data);
  if (error == CL_SUCCESS && !done && FakeDriver::Get().OnBuild)
  {
    FakeDriver::Get().OnBuild(GetText(program, CL_PROGRAM_SOURCE), options ? options : "",
      GetText(program, CL_PROGRAM_KERNEL_NAMES));
  }
  return error;
}

extern "C" cl_int CL_API_CALL clSetKernelArg(
  cl_kernel kernel, cl_uint index, std::size_t size, const void* value)
{
  static auto* const real = Find<decltype(clSetKernelArg)>("clSetKernelArg");
  if (!value && FakeDriver::Get().OnLaunch)
  {
    const std::lock_guard<std::mutex> lock(Mutex);
    LocalMemory[kernel][index] = size;
  }
  return real(kernel, index, size, value);
}

extern "C" cl_kernel CL_API_CALL clCreateKernel(cl_program program, const char* name, cl_int* error)
{
  static auto* const real = Find<decltype(clCreateKernel)>("clCreateKernel");
  cl_kernel kernel = real(program, name, error);
  const std::lock_guard<std::mutex> lock(Mutex);
  LocalMemory.erase(kernel); // a released kernel may have had this address
  return kernel;
}

extern "C" cl_int CL_API_CALL clRetainMemObject(cl_mem buffer)
{
  static auto* const real = Find<decltype(clRetainMemObject)>("clRetainMemObject");
  const std::lock_guard<std::mutex> lock(Mutex);
  const auto found = Ranges.find(buffer);
  if (found != Ranges.end())
  {
    ++found->second.References;
  }
  return real(buffer);
}

extern "C" cl_int CL_API_CALL clReleaseMemObject(cl_mem buffer)
{
  static auto* const real = Find<decltype(clReleaseMemObject)>("clReleaseMemObject");
  const std::lock_guard<std::mutex> lock(Mutex);
  const auto found = Ranges.find(buffer);
  if (found != Ranges.end() && --found->second.References == 0)
  {
    Ranges.erase(found);
  }
  return real(buffer);
}

extern "C" cl_int CL_API_CALL clGetDeviceInfo(
  cl_device_id device, cl_device_info what, std::size_t room, void* place, std::size_t* needed)
{
  static auto* const real = Find<decltype(clGetDeviceInfo)>("clGetDeviceInfo");
  static const cl_device_id first = device;
  const FakeDriver& driver = FakeDriver::Get();
  const cl_device_type graphics = CL_DEVICE_TYPE_GPU;
  const cl_bool isUnified = CL_FALSE;
  if (what == CL_DEVICE_TYPE && driver.IsGraphics)
  {
    return Give(&graphics, sizeof(graphics), room, place, needed);
  }
  if (what == CL_DEVICE_HOST_UNIFIED_MEMORY && driver.IsGraphics)
  {
    return Give(&isUnified, sizeof(isUnified), room, place, needed);
  }
  if (what == CL_DEVICE_NAME && device == first && !driver.FirstName.empty())
  {
    return Give(driver.FirstName.c_str(), driver.FirstName.size() + 1, room, place, needed);
  }
  if (what == CL_DEVICE_GLOBAL_MEM_SIZE && driver.GlobalMemory)
  {
    return Give(&driver.GlobalMemory, sizeof(cl_ulong), room, place, needed);
  }
  if (what == CL_DEVICE_LOCAL_MEM_SIZE && driver.LocalMemory)
  {
    return Give(&driver.LocalMemory, sizeof(cl_ulong), room, place, needed);
  }
  if (what == CL_DEVICE_EXTENSIONS && (!driver.HasDouble || driver.HasNVIDIAOptions))
  {
    std::string names = GetText([&](std::size_t size, void* text, std::size_t* length)
      { real(device, what, size, text, length); });
    const std::string name = "cl_khr_fp64";
    const std::size_t begin = driver.HasDouble ? std::string::npos : names.find(name);
    if (begin != std::string::npos)
    {
      names.replace(begin, name.size(), name.size(), ' ');
    }
    names += driver.HasNVIDIAOptions ? " cl_nv_compiler_options" : "";
    return Give(names.c_str(), names.size() + 1, room, place, needed);
  }
  return real(device, what, room, place, needed);
}

extern "C" cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer,
  cl_bool blocking, std::size_t offset, std::size_t size, void* memory, cl_uint number,
  const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer");
  cl_int error = CL_SUCCESS;
  return FailsToRead(size, blocking, queue, done, error)
    ? error
    : real(queue, buffer, blocking, offset, size, memory, number, events, done);
}

extern "C" cl_int CL_API_CALL clEnqueueReadBufferRect(cl_command_queue queue, cl_mem buffer,
  cl_bool blocking, const std::size_t* origin, const std::size_t* hostOrigin,
  const std::size_t* region, std::size_t row, std::size_t slice, std::size_t hostRow,
  std::size_t hostSlice, void* memory, cl_uint number, const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueReadBufferRect)>("clEnqueueReadBufferRect");
  cl_int error = CL_SUCCESS;
  return FailsToRead(region[0] * region[1] * region[2], blocking, queue, done, error)
    ? error
    : real(queue, buffer, blocking, origin, hostOrigin, region, row, slice, hostRow, hostSlice,
        memory, number, events, done);
}

extern "C" cl_int CL_API_CALL clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer,
  cl_bool blocking, std::size_t offset, std::size_t size, const void* memory, cl_uint number,
  const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueWriteBuffer)>("clEnqueueWriteBuffer");
  cl_int error = CL_SUCCESS;
  return FailsToWrite(size, blocking, queue, done, error)
    ? error
    : real(queue, buffer, blocking, offset, size, memory, number, events, done);
}

extern "C" cl_int CL_API_CALL clEnqueueWriteBufferRect(cl_command_queue queue, cl_mem buffer,
  cl_bool blocking, const std::size_t* origin, const std::size_t* hostOrigin,
  const std::size_t* region, std::size_t row, std::size_t slice, std::size_t hostRow,
  std::size_t hostSlice, const void* memory, cl_uint number, const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueWriteBufferRect)>("clEnqueueWriteBufferRect");
  cl_int error = CL_SUCCESS;
  return FailsToWrite(region[0] * region[1] * region[2], blocking, queue, done, error)
    ? error
    : real(queue, buffer, blocking, origin, hostOrigin, region, row, slice, hostRow, hostSlice,
        memory, number, events, done);
}

extern "C" void* CL_API_CALL clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer,
  cl_bool blocking, cl_map_flags access, std::size_t offset, std::size_t size, cl_uint number,
  const cl_event* events, cl_event* done, cl_int* error)
{
  static auto* const real = Find<decltype(clEnqueueMapBuffer)>("clEnqueueMapBuffer");
  if (!IsPinned(buffer))
  {
    FakeDriver::Get().BytesRead += access & CL_MAP_READ ? size : 0;
    FakeDriver::Get().BytesWritten += access & ~cl_map_flags{ CL_MAP_READ } ? size : 0;
  }
  return real(queue, buffer, blocking, access, offset, size, number, events, done, error);
}

extern "C" cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel,
  cl_uint dimensions, const std::size_t* offset, const std::size_t* global,
  const std::size_t* local, cl_uint number, const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel");
  FakeDriver::Get().LaunchesWithoutGroup += !local && global[0] > 1;
  if (FakeDriver::Get().OnLaunch)
  {
    FakeDriver::Get().OnLaunch(DescribeLaunch(kernel, dimensions, local));
  }
  if (FakeDriver::Get().SkipsLaunches)
  {
    return clEnqueueMarkerWithWaitList(queue, number, events, done);
  }
  return real(queue, kernel, dimensions, offset, global, local, number, events, done);
}
