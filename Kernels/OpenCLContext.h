// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOpenCLContext_h
#define DeformVolumeOpenCLContext_h

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>

#include <cfenv>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace deformvolume
{

struct OpenCLDevice
{
  cl::Device Device;
  std::string Name; // "device (platform)"
  bool IsProcessor = false;
};

/// The devices of this machine, the best first: graphics processors, accelerators, then
/// processors, each by its number of compute units. Empty where there is no platform.
std::vector<OpenCLDevice> FindDevices();

/// The device for a request in the words of ResolveDevice; throws Error.
OpenCLDevice FindDevice(const std::string& request);

/// What the process shares of a device: its context and the programs built for it. Contexts live as
/// long as the process: releasing OpenCL objects from static destructors crashes some platforms.
class OpenCLContext
{
public:
  /// The context of a device; made at the first request. Throws Error.
  static OpenCLContext& Get(const OpenCLDevice& device);

  const OpenCLDevice& GetDevice() const { return this->Device; }
  const cl::Context& GetContext() const { return this->Context; }
  bool HasExtension(const std::string& name) const;
  cl_uint GetNumberOfUnits() const { return this->NumberOfUnits; }

  /// The program of this text and these options; built at the first request. Throws Error with the
  /// compiler's log.
  cl::Program GetProgram(const std::string& source, const std::string& options);

  /// Bytes that the device has for us: its memory, and for a processor no more than what the system
  /// has left.
  std::uint64_t GetAvailableMemory() const;

  /// Bytes of memory that the system can still give; 0 where it does not tell.
  static std::uint64_t GetSystemMemory();

private:
  explicit OpenCLContext(const OpenCLDevice& device);

  OpenCLDevice Device;
  cl::Context Context;
  std::string Extensions;
  cl_uint NumberOfUnits;
  std::mutex Mutex;
  std::map<std::string, cl::Program> Programs;
};

/// What an error of the OpenCL layer means to the user.
std::string Describe(const cl::Error& error);

/// Some hosts trap floating-point exceptions, which OpenCL compilers and kernels may raise
/// harmlessly: traps are off during the life of this object.
class FloatingPointTrapGuard
{
public:
  FloatingPointTrapGuard() { std::feholdexcept(&this->Environment); }
  ~FloatingPointTrapGuard() { std::fesetenv(&this->Environment); }
  FloatingPointTrapGuard(const FloatingPointTrapGuard&) = delete;
  FloatingPointTrapGuard& operator=(const FloatingPointTrapGuard&) = delete;

private:
  std::fenv_t Environment;
};

} // namespace deformvolume

#endif
