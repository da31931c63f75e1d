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
cl::Kernel MakeKernel(KernelLauncher& launcher, const std::string& name, const ElementBytes& value)
{
  cl::Kernel kernel(
    GetOutputProgram(launcher.GetContext()), (name + std::to_string(value.Size)).c_str());
  kernel.setArg(2, value.Size, value.Bytes.data());
  return kernel;
}

} // namespace

void LaunchPatches(KernelLauncher& launcher, const cl::Kernel& kernel, std::size_t count)
{
  constexpr std::size_t group = DEFORMVOLUME_PATCH * DEFORMVOLUME_PATCH;
  launcher.Launch(kernel, cl::NDRange(group * count), cl::NDRange(group));
}

void LaunchSteps(
  KernelLauncher& launcher, const cl::Kernel& kernel, std::uint64_t size, std::uint64_t step)
{
  constexpr std::uint64_t itemsOfUnit = 2048;
  const std::uint64_t steps = (size + step - 1) / step;
  LaunchHeavyItems(launcher, kernel,
    static_cast<std::size_t>(
      std::min(steps, launcher.GetContext().GetNumberOfUnits() * itemsOfUnit)));
}

ElementBytes GetBackground(const VolumeArray& array)
{
  ElementBytes background;
  DispatchElementType(array.Type,
    [&](auto zero) { background = ElementBytes::Of(ClampTo<decltype(zero)>(array.Background)); });
  return background;
}

void LaunchHeavyItems(KernelLauncher& launcher, const cl::Kernel& kernel, std::size_t items)
{
  const std::size_t group = launcher.GetContext().GetDevice().HasVectors ? 1 : 64;
  launcher.Launch(kernel, cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));
}

void LaunchLightItems(KernelLauncher& launcher, const cl::Kernel& kernel, std::uint64_t items)
{
  constexpr std::uint64_t group = 64;
  const auto launched = static_cast<std::size_t>((items + group - 1) / group * group);
  launcher.Launch(kernel, cl::NDRange(launched), cl::NDRange(std::size_t{ group }));
}

void Fill(
  KernelLauncher& launcher, const cl::Buffer& buffer, const ElementBytes& value, std::uint64_t size)
{
  const unsigned char first = value.Bytes.front();
  if (value.Size > 1 &&
    std::all_of(value.Bytes.begin(), value.Bytes.begin() + static_cast<std::ptrdiff_t>(value.Size),
      [&](unsigned char byte) { return byte == first; }))
  {
    Fill(launcher, buffer, ElementBytes::Of(first), size * value.Size);
    return;
  }
  if (!launcher.GetContext().GetDevice().IsProcessor)
  {
    cl_uint4 pattern;
    auto* const bytes = reinterpret_cast<unsigned char*>(&pattern);
    for (std::size_t i = 0; i < sizeof(pattern); ++i)
    {
      bytes[i] = value.Bytes[i % value.Size];
    }
    LaunchSteps(launcher,
      MakeKernel(GetOutputProgram(launcher.GetContext()), "FillWide", buffer,
        cl_ulong{ size * value.Size }, pattern),
      size * value.Size, sizeof(pattern));
    return;
  }
  cl::Kernel kernel = MakeKernel(launcher, "Fill", value);
  SetArguments(kernel, 0, buffer, cl_ulong{ size });
  const std::uint64_t step = DEFORMVOLUME_FILLED_BYTES / value.Size;
  LaunchHeavyItems(launcher, kernel, static_cast<std::size_t>((size + step - 1) / step));
}

void FillPatches(KernelLauncher& launcher, const cl::Buffer& buffer, const ElementBytes& value,
  std::size_t elements, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters)
{
  cl::Kernel kernel = MakeKernel(launcher, "FillPatches", value);
  SetArguments(kernel, 0, buffer, static_cast<cl_uint>(elements));
  SetArguments(kernel, 3, patches, parameters);
  LaunchPatches(launcher, kernel, count);
}

void FillUncovered(KernelLauncher& launcher, const cl::Buffer& buffer, const ElementBytes& value,
  std::uint64_t voxels, std::size_t elements, const cl::Buffer& bits)
{
  cl::Kernel kernel = MakeKernel(launcher, "FillUncovered", value);
  SetArguments(kernel, 0, buffer, cl_ulong{ voxels });
  SetArguments(kernel, 3, bits, static_cast<cl_uint>(elements));
  LaunchSteps(launcher, kernel, voxels, 1);
}

} // namespace deformvolume
