// SPDX-License-Identifier: BSD-3-Clause
#include "FakeSharing.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_gl.h>

#include <chrono>
#include <cstring>
#include <dlfcn.h>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

FakeSharing& FakeSharing::Get()
{
  static FakeSharing sharing;
  return sharing;
}

bool FakeSharing::WaitForBuffers(int number) const
{
  for (int i = 0; i < 500 && this->Buffers != number; ++i)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return this->Buffers == number;
}

namespace
{

/// The function of the OpenCL library.
template <typename Function>
Function* Find(const char* name)
{
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// The function of OpenGL, by the library that the process has loaded.
template <typename Function>
Function* FindOpenGL(const char* name)
{
  using Finder = void* (*)(const char*);
  for (const auto& [library, finder] : { std::make_pair("libGLX.so.0", "glXGetProcAddressARB"),
         std::make_pair("libEGL.so.1", "eglGetProcAddress") })
  {
    void* const loaded = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
    auto* const find = reinterpret_cast<Finder>(loaded ? dlsym(loaded, finder) : nullptr);
    if (void* const function = find ? find(name) : nullptr)
    {
      return reinterpret_cast<Function*>(function);
    }
  }
  return nullptr;
}

constexpr unsigned int CopyWriteBuffer = 0x8F37; // GL_COPY_WRITE_BUFFER, which nothing else uses
constexpr unsigned int BufferSize = 0x8764;      // GL_BUFFER_SIZE

/// Binds a buffer of OpenGL, and returns its size.
std::size_t Bind(unsigned int name)
{
  FindOpenGL<void(unsigned int, unsigned int)>("glBindBuffer")(CopyWriteBuffer, name);
  int size = 0;
  if (name)
  {
    FindOpenGL<void(unsigned int, unsigned int, int*)>("glGetBufferParameteriv")(
      CopyWriteBuffer, BufferSize, &size);
  }
  return static_cast<std::size_t>(size);
}

std::mutex Mutex;
std::map<cl_mem, unsigned int> Names; // of the buffers that are shared
std::set<cl_mem> Acquired;

cl_int CL_API_CALL FindDevices(const cl_context_properties* properties, cl_gl_context_info what,
  std::size_t room, void* place, std::size_t* needed)
{
  cl_device_id device = nullptr;
  for (; *properties; properties += 2)
  {
    if (*properties == CL_CONTEXT_PLATFORM)
    {
      clGetDeviceIDs(
        reinterpret_cast<cl_platform_id>(properties[1]), CL_DEVICE_TYPE_ALL, 1, &device, nullptr);
    }
  }
  const bool draws = !FakeSharing::Get().DrawsElsewhere;
  if (what != CL_DEVICES_FOR_GL_CONTEXT_KHR || !device || room < sizeof(device))
  {
    return CL_INVALID_VALUE;
  }
  *needed = draws ? sizeof(device) : 0;
  std::memcpy(place, &device, *needed);
  return CL_SUCCESS;
}

} // namespace

extern "C" void* CL_API_CALL clGetExtensionFunctionAddressForPlatform(
  cl_platform_id platform, const char* name)
{
  static auto* const real = Find<decltype(clGetExtensionFunctionAddressForPlatform)>(
    "clGetExtensionFunctionAddressForPlatform");
  return std::strcmp(name, "clGetGLContextInfoKHR") == 0 ? reinterpret_cast<void*>(&FindDevices)
                                                         : real(platform, name);
}

extern "C" cl_context CL_API_CALL clCreateContext(const cl_context_properties* properties,
  cl_uint number, const cl_device_id* devices,
  void(CL_CALLBACK* notify)(const char*, const void*, std::size_t, void*), void* data,
  cl_int* error)
{
  static auto* const real = Find<decltype(clCreateContext)>("clCreateContext");
  std::vector<cl_context_properties> known;
  bool hasContext = false;
  bool hasDisplay = false;
  for (; properties && *properties; properties += 2)
  {
    hasContext = hasContext || (*properties == CL_GL_CONTEXT_KHR && properties[1]);
    hasDisplay = hasDisplay ||
      ((*properties == CL_GLX_DISPLAY_KHR || *properties == CL_EGL_DISPLAY_KHR) && properties[1]);
    if (*properties == CL_CONTEXT_PLATFORM)
    {
      known.insert(known.end(), properties, properties + 2);
    }
  }
  known.push_back(0);
  FakeSharing::Get().Contexts += hasContext && hasDisplay;
  return real(known.data(), number, devices, notify, data, error);
}

extern "C" cl_mem CL_API_CALL clCreateFromGLBuffer(
  cl_context context, cl_mem_flags flags, cl_GLuint name, cl_int* error)
{
  cl_mem buffer = clCreateBuffer(context, flags, Bind(name), nullptr, error);
  Bind(0);
  if (buffer)
  {
    const std::lock_guard<std::mutex> lock(Mutex);
    Names[buffer] = name;
    ++FakeSharing::Get().Buffers;
    clSetMemObjectDestructorCallback(
      buffer,
      [](cl_mem gone, void*)
      {
        const std::lock_guard<std::mutex> lock(Mutex);
        Names.erase(gone);
        --FakeSharing::Get().Buffers;
      },
      nullptr);
  }
  return buffer;
}

extern "C" cl_int CL_API_CALL clEnqueueAcquireGLObjects(cl_command_queue /*queue*/, cl_uint number,
  const cl_mem* objects, cl_uint /*events*/, const cl_event* /*list*/, cl_event* /*done*/)
{
  if (FakeSharing::Get().AcquireError)
  {
    return FakeSharing::Get().AcquireError;
  }
  const std::lock_guard<std::mutex> lock(Mutex);
  Acquired.insert(objects, objects + number);
  FakeSharing::Get().Held = static_cast<int>(Acquired.size());
  return CL_SUCCESS;
}

extern "C" cl_int CL_API_CALL clEnqueueCopyBuffer(cl_command_queue queue, cl_mem source,
  cl_mem target, std::size_t from, std::size_t to, std::size_t size, cl_uint number,
  const cl_event* events, cl_event* done)
{
  static auto* const real = Find<decltype(clEnqueueCopyBuffer)>("clEnqueueCopyBuffer");
  const std::lock_guard<std::mutex> lock(Mutex);
  if (Names.count(target))
  {
    ++FakeSharing::Get().Copies;
    FakeSharing::Get().WrongCopies += Acquired.count(target) == 0;
    if (FakeSharing::Get().CopyError)
    {
      return FakeSharing::Get().CopyError;
    }
  }
  return real(queue, source, target, from, to, size, number, events, done);
}

extern "C" cl_int CL_API_CALL clEnqueueReleaseGLObjects(cl_command_queue queue, cl_uint number,
  const cl_mem* objects, cl_uint /*events*/, const cl_event* /*list*/, cl_event* /*done*/)
{
  // Not that of FakeDriver.h, which counts what the library reads.
  static auto* const read = Find<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer");
  for (cl_uint i = 0; i < number; ++i)
  {
    std::size_t size = 0;
    {
      const std::lock_guard<std::mutex> lock(Mutex);
      size = Bind(Names.at(objects[i]));
    }
    std::vector<char> values(size);
    const cl_int error =
      read(queue, objects[i], CL_TRUE, 0, size, values.data(), 0, nullptr, nullptr);
    if (error != CL_SUCCESS)
    {
      return error;
    }
    FindOpenGL<void(unsigned int, std::ptrdiff_t, std::ptrdiff_t, const void*)>("glBufferSubData")(
      CopyWriteBuffer, 0, static_cast<std::ptrdiff_t>(size), values.data());
    Bind(0);
    const std::lock_guard<std::mutex> lock(Mutex);
    Acquired.erase(objects[i]);
    FakeSharing::Get().Held = static_cast<int>(Acquired.size());
  }
  return CL_SUCCESS;
}
