// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFilling.h"

#include "Background.h"
#include "KernelMaking.h"
#include "ResamplingProgram.h"

#include <algorithm>
#include <string>

namespace deformvolume
{
namespace
{

// Makes a kernel for elements of the size of a value, which is its third argument.
cl::Kernel MakeKernel(Launches& launches, const std::string& name, const ElementBytes& value)
{
  cl::Kernel kernel(
    GetOutputProgram(launches.GetContext()), (name + std::to_string(value.Size)).c_str());
  kernel.setArg(2, value.Size, value.Bytes.data());
  return kernel;
}

} // namespace

void LaunchPatches(Launches& launches, const cl::Kernel& kernel, std::size_t count)
{
  constexpr std::size_t group = DEFORMVOLUME_PATCH * DEFORMVOLUME_PATCH;
  launches.Launch(kernel, cl::NDRange(group * count), cl::NDRange(group));
}

void LaunchSteps(
  Launches& launches, const cl::Kernel& kernel, std::uint64_t size, std::uint64_t step)
{
  constexpr std::uint64_t itemsOfUnit = 2048;
  const std::uint64_t steps = (size + step - 1) / step;
  LaunchBusyItems(launches, kernel,
    static_cast<std::size_t>(
      std::min(steps, launches.GetContext().GetNumberOfUnits() * itemsOfUnit)));
}

ElementBytes GetBackground(const VolumeArray& array)
{
  switch (array.Type)
  {
#define DEFORMVOLUME_CASE(name, ctype, cl)                                                         \
  case ElementType::name:                                                                          \
    return ElementBytes::Of(ClampTo<ctype>(array.Background));
    DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
  }
  return {};
}

void LaunchBusyItems(Launches& launches, const cl::Kernel& kernel, std::size_t items)
{
  const std::size_t group = launches.GetContext().GetDevice().HasVectors ? 1 : 64;
  launches.Launch(kernel, cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));
}

void LaunchSmallItems(Launches& launches, const cl::Kernel& kernel, std::uint64_t items)
{
  constexpr std::uint64_t group = 64;
  const auto launched = static_cast<std::size_t>((items + group - 1) / group * group);
  launches.Launch(kernel, cl::NDRange(launched), cl::NDRange(std::size_t{ group }));
}

void Fill(
  Launches& launches, const cl::Buffer& buffer, const ElementBytes& value, std::uint64_t size)
{
  const unsigned char first = value.Bytes.front();
  if (value.Size > 1 &&
    std::all_of(value.Bytes.begin(), value.Bytes.begin() + static_cast<std::ptrdiff_t>(value.Size),
      [&](unsigned char byte) { return byte == first; }))
  {
    Fill(launches, buffer, ElementBytes::Of(first), size * value.Size);
    return;
  }
  if (!launches.GetContext().GetDevice().IsProcessor)
  {
    cl_uint4 pattern;
    auto* const bytes = reinterpret_cast<unsigned char*>(&pattern);
    for (std::size_t i = 0; i < sizeof(pattern); ++i)
    {
      bytes[i] = value.Bytes[i % value.Size];
    }
    LaunchSteps(launches,
      MakeKernel(GetOutputProgram(launches.GetContext()), "FillWide", buffer,
        cl_ulong{ size * value.Size }, pattern),
      size * value.Size, sizeof(pattern));
    return;
  }
  cl::Kernel kernel = MakeKernel(launches, "Fill", value);
  SetArguments(kernel, 0, buffer, cl_ulong{ size });
  const std::uint64_t step = DEFORMVOLUME_FILLED_BYTES / value.Size;
  LaunchBusyItems(launches, kernel, static_cast<std::size_t>((size + step - 1) / step));
}

void FillPatches(Launches& launches, const cl::Buffer& buffer, const ElementBytes& value,
  std::size_t elements, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters)
{
  cl::Kernel kernel = MakeKernel(launches, "FillPatches", value);
  SetArguments(kernel, 0, buffer, static_cast<cl_uint>(elements));
  SetArguments(kernel, 3, patches, parameters);
  LaunchPatches(launches, kernel, count);
}

void FillUncovered(Launches& launches, const cl::Buffer& buffer, const ElementBytes& value,
  std::uint64_t voxels, std::size_t elements, const cl::Buffer& bits)
{
  cl::Kernel kernel = MakeKernel(launches, "FillUncovered", value);
  SetArguments(kernel, 0, buffer, cl_ulong{ voxels });
  SetArguments(kernel, 3, bits, static_cast<cl_uint>(elements));
  LaunchSteps(launches, kernel, voxels, 1);
}

} // namespace deformvolume
