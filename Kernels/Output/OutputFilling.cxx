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
cl::Kernel MakeKernel(OpenCLContext& context, const std::string& name, const ElementBytes& value)
{
  cl::Kernel kernel(GetOutputProgram(context), (name + std::to_string(value.Size)).c_str());
  kernel.setArg(2, value.Size, value.Bytes.data());
  return kernel;
}

} // namespace

void LaunchPatches(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Kernel& kernel,
  std::size_t count, std::vector<cl::Event>& events)
{
  constexpr std::size_t group = DEFORMVOLUME_PATCH * DEFORMVOLUME_PATCH;
  events.push_back(context.Launch(queue, kernel, cl::NDRange(group * count), cl::NDRange(group)));
}

void LaunchSteps(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Kernel& kernel,
  std::uint64_t size, std::uint64_t step, std::vector<cl::Event>& events)
{
  constexpr std::uint64_t itemsOfUnit = 2048;
  const std::uint64_t steps = (size + step - 1) / step;
  LaunchBusyItems(context, queue, kernel,
    static_cast<std::size_t>(std::min(steps, context.GetNumberOfUnits() * itemsOfUnit)), events);
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

void LaunchBusyItems(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Kernel& kernel, std::size_t items, std::vector<cl::Event>& events)
{
  const std::size_t group = context.GetDevice().HasVectors ? 1 : 64;
  events.push_back(context.Launch(
    queue, kernel, cl::NDRange((items + group - 1) / group * group), cl::NDRange(group)));
}

void LaunchSmallItems(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Kernel& kernel, std::uint64_t items, std::vector<cl::Event>& events)
{
  constexpr std::uint64_t group = 64;
  const auto launched = static_cast<std::size_t>((items + group - 1) / group * group);
  events.push_back(
    context.Launch(queue, kernel, cl::NDRange(launched), cl::NDRange(std::size_t{ group })));
}

void Fill(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::uint64_t size, std::vector<cl::Event>& events)
{
  const unsigned char first = value.Bytes.front();
  if (value.Size > 1 &&
    std::all_of(value.Bytes.begin(), value.Bytes.begin() + static_cast<std::ptrdiff_t>(value.Size),
      [&](unsigned char byte) { return byte == first; }))
  {
    Fill(context, queue, buffer, ElementBytes::Of(first), size * value.Size, events);
    return;
  }
  if (!context.GetDevice().IsProcessor)
  {
    cl_uint4 pattern;
    auto* const bytes = reinterpret_cast<unsigned char*>(&pattern);
    for (std::size_t i = 0; i < sizeof(pattern); ++i)
    {
      bytes[i] = value.Bytes[i % value.Size];
    }
    LaunchSteps(context, queue,
      MakeKernel(
        GetOutputProgram(context), "FillWide", buffer, cl_ulong{ size * value.Size }, pattern),
      size * value.Size, sizeof(pattern), events);
    return;
  }
  cl::Kernel kernel = MakeKernel(context, "Fill", value);
  SetArguments(kernel, 0, buffer, cl_ulong{ size });
  const std::uint64_t step = DEFORMVOLUME_FILLED_BYTES / value.Size;
  LaunchBusyItems(
    context, queue, kernel, static_cast<std::size_t>((size + step - 1) / step), events);
}

void FillPatches(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::size_t elements, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters, std::vector<cl::Event>& events)
{
  cl::Kernel kernel = MakeKernel(context, "FillPatches", value);
  SetArguments(kernel, 0, buffer, static_cast<cl_uint>(elements));
  SetArguments(kernel, 3, patches, parameters);
  LaunchPatches(context, queue, kernel, count, events);
}

void FillUncovered(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::uint64_t voxels, std::size_t elements, const cl::Buffer& bits,
  std::vector<cl::Event>& events)
{
  cl::Kernel kernel = MakeKernel(context, "FillUncovered", value);
  SetArguments(kernel, 0, buffer, cl_ulong{ voxels });
  SetArguments(kernel, 3, bits, static_cast<cl_uint>(elements));
  LaunchSteps(context, queue, kernel, voxels, 1, events);
}

} // namespace deformvolume
