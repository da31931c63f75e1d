// SPDX-License-Identifier: BSD-3-Clause
#include "OpenCLContext.h"

#include "Error.h"
#include "KernelCache.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <tuple>

namespace deformvolume
{
namespace
{

std::string ToLower(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Some platforms end names with zeros or pad them with blanks.
std::string Trim(const std::string& text)
{
  const char* blank = " \t\n";
  const std::string whole = text.c_str();
  const std::size_t begin = whole.find_first_not_of(blank);
  return begin == std::string::npos
    ? ""
    : whole.substr(begin, whole.find_last_not_of(blank) - begin + 1);
}

int GetRank(const cl::Device& device)
{
  const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
  return type & CL_DEVICE_TYPE_GPU ? 2 : type & CL_DEVICE_TYPE_CPU ? 0 : 1;
}

bool IsUsable(const cl::Device& device)
{
  return device.getInfo<CL_DEVICE_AVAILABLE>() && device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>();
}

bool IsPoCL(const OpenCLDevice& device)
{
  return device.Name.find("Portable Computing Language") != std::string::npos;
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

} // namespace

std::vector<OpenCLDevice> FindDevices()
{
  PrepareKernelCache();
  const FloatingPointTrapGuard guard;
  std::vector<OpenCLDevice> found;
  std::vector<cl::Platform> platforms;
  try
  {
    cl::Platform::get(&platforms);
  }
  catch (const cl::Error&)
  {
    return found; // the loader answers with an error where there is no platform
  }
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
          found.push_back({ device,
            Trim(device.getInfo<CL_DEVICE_NAME>()) + " (" +
              Trim(platform.getInfo<CL_PLATFORM_NAME>()) + ")",
            GetRank(device) == 0 });
        }
      }
    }
    catch (const cl::Error&)
    {
      continue; // a platform without devices must not hide the others
    }
  }
  std::stable_sort(found.begin(), found.end(),
    [](const OpenCLDevice& a, const OpenCLDevice& b)
    {
      return std::make_tuple(GetRank(a.Device), a.Device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()) >
        std::make_tuple(GetRank(b.Device), b.Device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>());
    });
  // Two cards of one kind have one name; the second and later ones get a number.
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
    CheckKernelCompiler(); // the likelier reason, where there is one
    throw Error(
      "There is no OpenCL device. Install an OpenCL driver (on Debian the package "
      "pocl-opencl-icd runs on every processor), and check OCL_ICD_VENDORS if it is set.");
  }
  const std::string wanted = ToLower(words);
  for (const OpenCLDevice& device : devices)
  {
    const int rank = GetRank(device.Device);
    if (wanted.empty() || (wanted == "cpu" && rank == 0) || (wanted == "gpu" && rank == 2) ||
      (wanted != "cpu" && wanted != "gpu" &&
        ToLower(device.Name).find(wanted) != std::string::npos))
    {
      return device;
    }
  }
  throw Error("There is no OpenCL " + origin + " \"" + words +
    "\". Ask for \"\" (the best), \"cpu\", \"gpu\", or a part of one of these names: " +
    ListNames(devices) + ".");
}

OpenCLContext& OpenCLContext::Get(const OpenCLDevice& device)
{
  static std::mutex mutex;
  static auto* contexts = new std::map<cl_device_id, OpenCLContext*>;
  const std::lock_guard<std::mutex> lock(mutex);
  OpenCLContext*& context = (*contexts)[device.Device()];
  if (!context)
  {
    context = new OpenCLContext(device);
  }
  return *context;
}

OpenCLContext::OpenCLContext(const OpenCLDevice& device)
  : Device(device)
  , NumberOfUnits(device.Device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>())
{
  if (IsPoCL(device))
  {
    CheckKernelCompiler();
  }
  const FloatingPointTrapGuard guard;
  this->Context = cl::Context(device.Device);
  this->Extensions = " " + device.Device.getInfo<CL_DEVICE_EXTENSIONS>() + " ";
}

bool OpenCLContext::HasExtension(const std::string& name) const
{
  return this->Extensions.find(" " + name + " ") != std::string::npos;
}

cl::Program OpenCLContext::GetProgram(const std::string& source, const std::string& options)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  cl::Program& program = this->Programs[options + "\n" + source];
  if (!program())
  {
    cl::Program fresh(this->Context, source);
    try
    {
      fresh.build({ this->Device.Device }, options.c_str());
    }
    catch (const cl::BuildError&)
    {
      throw Error("The OpenCL compiler of \"" + this->Device.Name +
        "\" refuses the kernels. Its words: " +
        fresh.getBuildInfo<CL_PROGRAM_BUILD_LOG>(this->Device.Device));
    }
    program = fresh;
  }
  return program;
}

std::uint64_t OpenCLContext::GetAvailableMemory() const
{
  const std::uint64_t device = this->Device.Device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  const std::uint64_t system = this->Device.IsProcessor ? GetSystemMemory() : 0;
  return system ? std::min(device, system) : device;
}

std::uint64_t OpenCLContext::GetSystemMemory()
{
  std::ifstream file("/proc/meminfo");
  std::string key;
  std::uint64_t kibibytes = 0;
  std::string unit;
  while (file >> key >> kibibytes >> unit)
  {
    if (key == "MemAvailable:")
    {
      return kibibytes * 1024;
    }
  }
  return 0;
}

std::string Describe(const cl::Error& error)
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
