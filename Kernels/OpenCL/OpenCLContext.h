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
  /// Whether a work-item has a thread of a processor, with its vector registers, for itself. Else
  /// work-items share them, be it on a processor, and groups of one leave most of it idle.
  bool HasVectors = false;
  DeviceDescription Description;
};

/// The devices of this machine, the best first (IsBetter). Empty where there is no platform.
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
  /// The one that a queue belongs to; null for queues of other contexts.
  static OpenCLContext* Find(const cl::CommandQueue& queue);

  const OpenCLDevice& GetDevice() const { return this->Device; }
  const cl::Context& GetContext() const { return this->Context; }
  /// Whether what may compile kernels has to be done, and to end, within a KernelLinkerScope.
  bool UsesOwnLinker() const { return this->OwnLinker; }
  bool HasExtension(const std::string& name) const;
  cl_uint GetNumberOfUnits() const { return this->NumberOfUnits; }
  /// Whether a buffer over memory of the host (CL_MEM_USE_HOST_PTR) is that memory, wherever it
  /// lies. Other drivers may keep a copy, which has to be told of what the host writes there.
  bool SharesHostMemory() const;
  /// How large copies reach a device with memory of its own, which is behind a bus; null where it
  /// shares that of the host, or the driver gives no page-locked memory.
  StagedCopies* GetStagedCopies();

  /// The program of this text and these options, built at the first request. Throws Error with the
  /// compiler's log.
  cl::Program GetProgram(const ProgramText& source, const std::string& options);

  /// Enqueues a kernel, in a queue that takes the times. Drivers may compile a kernel once more for
  /// the size of its work-groups: the first launch of a kind is waited for, and what it takes
  /// before the kernel runs counts as compilation.
  cl::Event Launch(const cl::CommandQueue& queue, const cl::Kernel& kernel,
    const cl::NDRange& items, const cl::NDRange& group);

  /// Runs one work-group of a kernel where no kernel of this kind has been launched: some drivers
  /// compile when the kernel already counts as running. For kernels that do no harm then.
  void Prepare(const cl::CommandQueue& queue, const cl::Kernel& kernel, const cl::NDRange& group);

private:
  struct BuiltProgram
  {
    std::mutex Mutex; // held while it is compiled
    cl::Program Program;
  };

  explicit OpenCLContext(const OpenCLDevice& device);

  /// The place of a program, which stays where it is.
  BuiltProgram& FindProgram(const ProgramText& source, const std::string& options);
  cl::Program Build(const std::string& source, const std::string& options) const;
  /// Whether it is the first time that this is asked for such launches.
  bool IsNew(const cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group);

  OpenCLDevice Device;
  cl::Context Context;
  bool OwnLinker = false;
  std::string Extensions;
  cl_uint NumberOfUnits;
  std::mutex Mutex;
  std::map<std::pair<std::string, ProgramText>, BuiltProgram*> Requested; // by options and text
  std::map<std::string, BuiltProgram> Programs;
  std::set<std::pair<cl_program, std::string>> Launched;
  std::mutex StagingMutex;
  std::unique_ptr<StagedCopies> Staging;
};

/// What an error of the OpenCL layer means to the user.
std::string GetMessage(const cl::Error& error);

} // namespace deformvolume

#endif
