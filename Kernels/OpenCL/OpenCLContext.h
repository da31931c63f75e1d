// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOpenCLContext_h
#define DeformVolumeOpenCLContext_h

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>

#include "DeviceRank.h"
#include "ProgramText.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace deformvolume
{

class StagedCopies;

struct OpenCLDevice
{
  cl::Device Device;
  std::string Name; // "device (platform)"
  bool IsProcessor = false;
  /// Whether a work-item can use all vector registers of a CPU thread. Otherwise the driver, also
  /// one for CPUs, spreads work-items over vector lanes, and work-groups of one item leave most
  /// lanes idle.
  bool HasVectors = false;
  DeviceDescription Description;
};

/// Returns the devices of this machine, the best first (IsBetter). Empty if there is no platform.
std::vector<OpenCLDevice> FindDevices();

/// Returns the device that a request selects, by the rules of ResolveDevice(). Throws Error.
OpenCLDevice FindDevice(const std::string& request);

/// The OpenCL context of a device and the programs built for it. All users of a device in a process
/// share one context. Contexts live until the process ends: some platforms crash when static
/// destructors release OpenCL objects.
class OpenCLContext
{
public:
  /// Returns the context of a device, which the first call creates. Throws Error.
  static OpenCLContext& Get(const OpenCLDevice& device);
  /// Returns the OpenCLContext of a queue; null for queues of other contexts.
  static OpenCLContext* Find(const cl::CommandQueue& queue);

  const OpenCLDevice& GetDevice() const { return this->Device; }
  const cl::Context& GetContext() const { return this->Context; }
  bool HasExtension(const std::string& name) const;
  cl_uint GetNumberOfUnits() const { return this->NumberOfUnits; }
  /// Whether the driver never copies a buffer that uses host memory (CL_MEM_USE_HOST_PTR). Other
  /// drivers may keep a copy, which UpdateFromHost() updates.
  bool SharesHostMemory() const;
  /// Returns the staged copies for large transfers to and from a device with memory of its own.
  /// Null if the device uses host memory, or if the driver provides no page-locked memory.
  StagedCopies* GetStagedCopies();

  /// Returns the program of a source text and options. The first call builds it. Throws Error with
  /// the log of the compiler.
  cl::Program GetProgram(const ProgramText& source, const std::string& options);

  /// Enqueues a kernel. The queue must have profiling enabled. Drivers may compile a kernel again
  /// for the size of its work-groups. Therefore the first launch with each size waits for the
  /// kernel, and the time until the kernel starts counts as compilation.
  cl::Event Launch(const cl::CommandQueue& queue, const cl::Kernel& kernel,
    const cl::NDRange& items, const cl::NDRange& group);

  /// Compiles a kernel by launching one work-group of it, unless the kernel has been launched with
  /// this group size. Needed for drivers that compile at the launch but report this time as time of
  /// the kernel. An additional execution of the first work-group must have no effect.
  void Prepare(const cl::CommandQueue& queue, const cl::Kernel& kernel, const cl::NDRange& group);

private:
  struct BuiltProgram
  {
    std::mutex Mutex; // locked during the compilation
    cl::Program Program;
  };

  explicit OpenCLContext(const OpenCLDevice& device);

  /// Returns the entry of a program, whose address does not change.
  BuiltProgram& FindProgram(const ProgramText& source, const std::string& options);
  cl::Program Build(const std::string& source, const std::string& options) const;
  /// The driver compiles a kernel when it is launched first with a key: a program, and a text of
  /// the name of the kernel, the group size, whether there are few work-items and, if OwnLinker is
  /// set, their number.
  using LaunchKey = std::pair<cl_program, std::string>;
  LaunchKey MakeLaunchKey(
    const cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group) const;
  bool WasLaunched(const LaunchKey& key);
  void AddLaunched(const LaunchKey& key);

  OpenCLDevice Device;
  cl::Context Context;
  bool UsesPoCL = false;  // whether commands that may compile need a KernelCacheLock
  bool OwnLinker = false; // whether they need a KernelLinkerScope
  std::string Extensions;
  cl_uint NumberOfUnits;
  std::mutex Mutex;
  std::map<std::pair<std::string, ProgramText>, BuiltProgram*> Requested; // by options and text
  std::map<std::string, BuiltProgram> Programs;
  std::set<LaunchKey> Launched;
  std::mutex StagingMutex;
  std::unique_ptr<StagedCopies> Staging;
};

/// Returns a message that explains an OpenCL error to the user.
std::string GetMessage(const cl::Error& error);

} // namespace deformvolume

#endif
