// SPDX-License-Identifier: BSD-3-Clause
#include "OpenCLContext.h"

#include "AddedDrivers.h"
#include "CompilationWatch.h"
#include "DeviceRank.h"
#include "DeviceThreads.h"
#include "Error.h"
#include "FloatingPointTrapGuard.h"
#include "KernelCache.h"
#include "KernelLinker.h"
#include "StagedCopies.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>

#include <unistd.h>

namespace deformvolume
{
namespace
{

/// Removes the null characters and blanks with which some platforms pad names.
std::string Trim(const std::string& text)
{
  const char* blank = " \t\n";
  const std::string whole = text.c_str();
  const std::size_t begin = whole.find_first_not_of(blank);
  return begin == std::string::npos
    ? ""
    : whole.substr(begin, whole.find_last_not_of(blank) - begin + 1);
}

bool DeviceHasExtension(const cl::Device& device, const std::string& name)
{
  const std::string extensions = " " + device.getInfo<CL_DEVICE_EXTENSIONS>() + " ";
  return extensions.find(" " + name + " ") != std::string::npos;
}

DeviceDescription GetDescription(const cl::Device& device, const cl::Platform& platform)
{
  using Kind = DeviceDescription::Kind;
  const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
  DeviceDescription description;
  description.Type = type & CL_DEVICE_TYPE_GPU ? Kind::Graphics
    : type & CL_DEVICE_TYPE_CPU                ? Kind::Processor
                                               : Kind::Other;
  description.Name = Trim(device.getInfo<CL_DEVICE_NAME>());
  description.Platform = Trim(platform.getInfo<CL_PLATFORM_NAME>());
  description.SharesMemory = device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>() != CL_FALSE;
  description.HasDouble = DeviceHasExtension(device, "cl_khr_fp64");
  description.ComputeUnits = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  return description;
}

bool IsUsable(const cl::Device& device)
{
  return device.getInfo<CL_DEVICE_AVAILABLE>() && device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>();
}

bool IsPoCL(const OpenCLDevice& device)
{
  return device.Name.find("Portable Computing Language") != std::string::npos;
}

double GetSeconds(const cl::Event& event)
{
  return 1e-9 *
    static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
      event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
}

/// Lists the platforms of added drivers, then those of the system, each platform once. A driver
/// that is both added and installed, or that two .icd files name, returns the same pointer each
/// time.
std::vector<cl::Platform> ListPlatforms()
{
  std::vector<cl::Platform> platforms;
  const auto add = [&](const cl::Platform& platform)
  {
    if (std::none_of(platforms.begin(), platforms.end(),
          [&](const cl::Platform& other) { return other() == platform(); }))
    {
      platforms.push_back(platform);
    }
  };
  for (cl_platform_id platform : AddedDrivers::Get().GetPlatforms())
  {
    add(cl::Platform(platform));
  }
  std::vector<cl::Platform> system;
  try
  {
    cl::Platform::get(&system);
  }
  catch (const cl::Error&)
  {
    system.clear(); // the loader returns an error if there is no platform
  }
  std::for_each(system.begin(), system.end(), add);
  return platforms;
}

std::vector<OpenCLDevice> ListDevices()
{
  const FloatingPointTrapGuard guard;
  std::vector<OpenCLDevice> found;
  const std::vector<cl::Platform> platforms = ListPlatforms();
  for (const cl::Platform& platform : platforms)
  {
    std::vector<cl::Device> devices;
    try
    {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
      for (const cl::Device& device : devices)
      {
        if (IsUsable(device))
        {
          OpenCLDevice one;
          one.Device = device;
          one.Description = GetDescription(device, platform);
          one.Name = one.Description.Name + " (" + one.Description.Platform + ")";
          one.IsProcessor = one.Description.Type == DeviceDescription::Kind::Processor;
          one.HasVectors =
            one.IsProcessor && device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>() > 1;
          found.push_back(one);
        }
      }
    }
    catch (const cl::Error&)
    {
      continue; // a platform without devices must not hide other platforms
    }
  }
  std::stable_sort(found.begin(), found.end(),
    [](const OpenCLDevice& a, const OpenCLDevice& b)
    { return IsBetter(a.Description, b.Description); });
  // Devices of the same model have the same name: number all but the first.
  std::map<std::string, int> seen;
  for (OpenCLDevice& device : found)
  {
    const int count = ++seen[device.Name];
    if (count > 1)
    {
      device.Name += " #" + std::to_string(count);
    }
  }
  return found;
}

std::string ListNames(const std::vector<OpenCLDevice>& devices)
{
  std::string list;
  for (const OpenCLDevice& device : devices)
  {
    list += (list.empty() ? "\"" : ", \"") + device.Name + "\"";
  }
  return list;
}

struct ContextList
{
  std::mutex Mutex;
  std::map<cl_device_id, OpenCLContext*> Contexts;
};

ContextList& GetContexts()
{
  static auto* const list = new ContextList; // lives as long as the process
  return *list;
}

} // namespace

std::vector<OpenCLDevice> FindDevices()
{
  // Drivers start here. Some drivers cannot start from two threads at once: PoCL then reports no
  // device, or crashes. The list is never deleted, since its destructors could call drivers that
  // have already been unloaded.
  static std::mutex mutex;
  static auto* const devices = new std::vector<OpenCLDevice>;
  static std::size_t listed = 0; // number of added drivers in the list
  static std::atomic<pid_t> process{ 0 };
  // Check this before the lock is taken: another thread may have held it during the fork.
  if (process != 0 && process != getpid())
  {
    throw Error("This process was forked from a process that had used OpenCL, and OpenCL does not "
                "work after a fork. Fork before the first use of a device, or start a new program "
                "(in Python: the start method \"spawn\" of multiprocessing).");
  }
  const std::lock_guard<std::mutex> lock(mutex);
  const std::size_t added = AddedDrivers::Get().GetCount();
  if (devices->empty() || added != listed)
  {
    PrepareKernelCache();
    LimitDeviceThreads();
    *devices = ListDevices();
    listed = added;
    process = devices->empty() ? 0 : getpid();
  }
  return *devices;
}

OpenCLDevice FindDevice(const std::string& request)
{
  std::string words = request;
  std::string origin = "device";
  if (words.empty())
  {
    const char* variable = std::getenv("DEFORMVOLUME_DEVICE");
    words = variable ? variable : "";
    origin = "device of the environment variable DEFORMVOLUME_DEVICE";
  }
  const std::vector<OpenCLDevice> devices = FindDevices();
  if (devices.empty())
  {
    CheckKernelCache(); // without a cache directory PoCL has no devices
    throw Error("There is no OpenCL device. Install an OpenCL driver: on Debian the package "
                "pocl-opencl-icd, which runs on every CPU; in Python on Linux, \"pip install "
                "pocl-binary-distribution\". If OCL_ICD_VENDORS is set, check its value.");
  }
  const std::string wanted = ToLower(words);
  for (const OpenCLDevice& device : devices)
  {
    const bool graphics = device.Description.Type == DeviceDescription::Kind::Graphics;
    if (wanted.empty() || (wanted == "cpu" && device.IsProcessor) ||
      (wanted == "gpu" && graphics) ||
      (wanted != "cpu" && wanted != "gpu" &&
        ToLower(device.Name).find(wanted) != std::string::npos))
    {
      return device;
    }
  }
  throw Error("There is no OpenCL " + origin + " \"" + words +
    "\". Ask for \"\" (the best device), \"cpu\", \"gpu\", or a part of one of these names: " +
    ListNames(devices) + ".");
}

OpenCLContext& OpenCLContext::Get(const OpenCLDevice& device)
{
  ContextList& list = GetContexts();
  const std::lock_guard<std::mutex> lock(list.Mutex);
  OpenCLContext*& context = list.Contexts[device.Device()];
  if (!context)
  {
    context = new OpenCLContext(device);
  }
  return *context;
}

OpenCLContext* OpenCLContext::Find(const cl::CommandQueue& queue)
{
  ContextList& list = GetContexts();
  const std::lock_guard<std::mutex> lock(list.Mutex);
  const auto found = list.Contexts.find(queue.getInfo<CL_QUEUE_DEVICE>()());
  return found != list.Contexts.end() && found->second &&
      found->second->Context() == queue.getInfo<CL_QUEUE_CONTEXT>()()
    ? found->second
    : nullptr;
}

OpenCLContext::OpenCLContext(const OpenCLDevice& device)
  : Device(device)
  , NumberOfUnits(device.Device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>())
{
  this->UsesPoCL = IsPoCL(device);
  if (this->UsesPoCL)
  {
    CheckKernelCache();
    if (device.IsProcessor) // PoCL runs no linker for other devices
    {
      const cl::Platform platform(device.Device.getInfo<CL_DEVICE_PLATFORM>());
      this->OwnLinker = CheckKernelLinker(
        platform.getInfo<CL_PLATFORM_VERSION>(), AddedDrivers::Get().Has(platform()));
    }
  }
  if (AddedDrivers::Get().GetProcessor(device.Device()).EndsProcess)
  {
    throw Error("The OpenCL driver of \"" + device.Name +
      "\", PoCL 3.0, would end the process when it compiles a kernel for this CPU. Unset the "
      "environment variable DEFORMVOLUME_KERNEL_PROCESSOR if it is \"driver\". Otherwise install a "
      "later version of the driver, for example the package pocl-opencl-icd on Debian.");
  }
  const FloatingPointTrapGuard guard;
  this->Context = cl::Context(device.Device);
  this->Extensions = " " + device.Device.getInfo<CL_DEVICE_EXTENSIONS>() + " ";
}

bool OpenCLContext::HasExtension(const std::string& name) const
{
  return this->Extensions.find(" " + name + " ") != std::string::npos;
}

bool OpenCLContext::SharesHostMemory() const
{
  return this->UsesPoCL;
}

StagedCopies* OpenCLContext::GetStagedCopies()
{
  if (this->Device.IsProcessor || this->Device.Description.SharesMemory)
  {
    return nullptr; // there is no bus
  }
  const std::lock_guard<std::mutex> lock(this->StagingMutex);
  if (!this->Staging)
  {
    this->Staging = StagedCopies::Make(this->Context, this->Device.Device);
  }
  return this->Staging.get();
}

cl::Program OpenCLContext::GetProgram(const ProgramText& source, const std::string& options)
{
  // Lock only this program: other threads can build or launch other programs meanwhile.
  BuiltProgram& built = this->FindProgram(source, options);
  const std::lock_guard<std::mutex> lock(built.Mutex);
  if (!built.Program())
  {
    const CompilationWatch::Compilation compilation;
    built.Program = this->Build(source.GetText(), options);
  }
  return built.Program;
}

OpenCLContext::BuiltProgram& OpenCLContext::FindProgram(
  const ProgramText& source, const std::string& options)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  BuiltProgram*& requested = this->Requested[{ options, source }];
  if (!requested)
  {
    // References to elements of a map stay valid.
    requested = &this->Programs[options + "\n" + source.GetText()];
  }
  return *requested;
}

cl::Program OpenCLContext::Build(const std::string& source, const std::string& options) const
{
  cl::Program program(this->Context, source);
  // PoCL does not know that SetKernelProcessor() may have changed the processor. The macro makes
  // the source differ, so that PoCL does not take kernels for another processor from its cache.
  std::string processor = AddedDrivers::Get().GetProcessor(this->Device.Device()).Name;
  if (!processor.empty())
  {
    processor = " -DDEFORMVOLUME_PROCESSOR=" + processor;
  }
  try
  {
    const KernelCacheLock cache(this->UsesPoCL);
    program.build({ this->Device.Device }, (options + processor).c_str());
  }
  catch (const cl::BuildError&)
  {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(this->Device.Device);
    if (log.find("unknown target CPU") != std::string::npos)
    {
      throw Error("The OpenCL driver of \"" + this->Device.Name +
        "\" is older than this CPU and cannot compile kernels for it (" + Trim(log) +
        "). Install a later version of the driver, for example the package pocl-opencl-icd on "
        "Debian.");
    }
    throw Error("The OpenCL compiler of \"" + this->Device.Name +
      "\" cannot compile the kernels. Its build log: " + log);
  }
  return program;
}

OpenCLContext::LaunchKey OpenCLContext::MakeLaunchKey(
  const cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group) const
{
  std::string name = kernel.getInfo<CL_KERNEL_FUNCTION_NAME>();
  for (cl::size_type axis = 0; axis < group.dimensions(); ++axis)
  {
    name += " " + std::to_string(group[axis]);
  }
  // PoCL also compiles a kernel again if all axes have fewer than 65,535 work-items and, in some
  // versions, for small numbers of work-groups. This takes little time, but needs the linker.
  bool areFew = this->UsesPoCL;
  for (cl::size_type axis = 0; axis < items.dimensions(); ++axis)
  {
    areFew = areFew && items[axis] < 65535;
    name += this->OwnLinker ? " of " + std::to_string(items[axis]) : "";
  }
  name += areFew ? " few" : "";
  return { kernel.getInfo<CL_KERNEL_PROGRAM>()(), name };
}

bool OpenCLContext::WasLaunched(const LaunchKey& key)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Launched.count(key) > 0;
}

void OpenCLContext::AddLaunched(const LaunchKey& key)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Launched.insert(key);
}

cl::Event OpenCLContext::Launch(const cl::CommandQueue& queue, const cl::Kernel& kernel,
  const cl::NDRange& items, const cl::NDRange& group)
{
  cl::Event event;
  const LaunchKey key = this->MakeLaunchKey(kernel, items, group);
  if (this->WasLaunched(key))
  {
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, items, group, nullptr, &event);
    return event;
  }
  queue.finish(); // so that the measured time is that of this launch alone
  CompilationWatch::Compilation compilation;
  const KernelCacheLock cache(this->UsesPoCL);
  const KernelLinkerScope linker(this->OwnLinker);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, items, group, nullptr, &event);
  event.wait();
  compilation.Exclude(GetSeconds(event));
  this->AddLaunched(key);
  return event;
}

void OpenCLContext::Prepare(
  const cl::CommandQueue& queue, const cl::Kernel& kernel, const cl::NDRange& group)
{
  const LaunchKey key = this->MakeLaunchKey(kernel, group, group);
  if (!this->WasLaunched(key))
  {
    queue.finish();
    const CompilationWatch::Compilation compilation;
    const KernelCacheLock cache(this->UsesPoCL);
    const KernelLinkerScope linker(this->OwnLinker);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, group, group);
    queue.finish();
    this->AddLaunched(key);
  }
}

std::string GetMessage(const cl::Error& error)
{
  const std::string call =
    std::string(" (") + error.what() + ": " + std::to_string(error.err()) + ")";
  switch (error.err())
  {
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
    case CL_OUT_OF_RESOURCES:
    case CL_OUT_OF_HOST_MEMORY:
    case CL_INVALID_BUFFER_SIZE:
      return "The OpenCL device is out of memory" + call +
        ". Use a smaller volume or output, or another device.";
    case CL_INVALID_COMMAND_QUEUE:
    case CL_DEVICE_NOT_AVAILABLE:
      return "The OpenCL device was lost" + call + ". Start the program again.";
    default:
      return std::string("The OpenCL call failed") + call + ".";
  }
}

} // namespace deformvolume
