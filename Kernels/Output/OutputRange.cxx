// SPDX-License-Identifier: BSD-3-Clause
#include "OutputRange.h"

#include "ArrayText.h"
#include "KernelLinker.h"
#include "KernelSources.h"
#include "KernelText.h"

#include <algorithm>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace deformvolume
{

namespace
{

/// Defines the macros of OutputRange.cl.
template <typename T>
std::string MakePreamble(ElementType type)
{
  const std::string name = GetTypeName(type);
  const bool isReal = std::is_floating_point<T>::value;
  std::string least = isReal ? "-INFINITY" : std::to_string(std::numeric_limits<T>::lowest());
  std::string most = isReal ? "INFINITY" : std::to_string(std::numeric_limits<T>::max());
  if (std::is_same<T, std::int64_t>::value)
  {
    least = "LONG_MIN"; // the digits alone are not a valid literal
  }
  if (std::is_same<T, std::uint64_t>::value)
  {
    most = "ULONG_MAX";
  }
  return "#define TYPE " + name + "\n#define TYPE_LEAST ((" + name + ")(" + least +
    "))\n#define TYPE_MOST ((" + name + ")(" + most + "))\n#define IS_FINITE(value) " +
    (isReal ? "isfinite(value)" : "1") + "\n";
}

template <typename T>
DeviceOutput::Range Find(const cl::CommandQueue& queue, const cl::Buffer& buffer, ElementType type,
  std::uint64_t tuples, std::size_t components, std::size_t component)
{
  OpenCLContext* const context = OpenCLContext::Find(queue);
  if (!context)
  {
    throw Error("The output is in a queue of another context.");
  }
  cl::Kernel kernel(context->GetProgram(ProgramText(GetReal(*context) + MakePreamble<T>(type)) +
                        GroupReduction_cl + OutputRange_cl,
                      KernelOptions),
    "FindRange");
  // If a work-item has a thread of its own, it processes consecutive tuples; otherwise neighboring
  // work-items process neighboring tuples.
  const bool hasThread = context->GetDevice().HasVectors;
  const cl_uint portion = hasThread ? 65536 : 1;
  const std::size_t group = hasThread ? 1 : 64;
  const std::size_t most = context->GetNumberOfUnits() * (hasThread ? 4 : 32);
  const std::uint64_t wanted = (tuples + portion * group - 1) / (portion * group);
  const std::size_t groups =
    static_cast<std::size_t>(std::min<std::uint64_t>(most, std::max<std::uint64_t>(wanted, 1)));
  std::vector<T> ranges(2 * groups);
  const cl::Buffer found(context->GetContext(), CL_MEM_WRITE_ONLY, ranges.size() * sizeof(T));
  cl_uint others = 0;
  const cl::Buffer counter(
    context->GetContext(), CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof(others), &others);
  kernel.setArg(0, buffer);
  kernel.setArg(1, cl_ulong{ tuples });
  kernel.setArg(2, static_cast<cl_uint>(components));
  kernel.setArg(3, static_cast<cl_uint>(component));
  kernel.setArg(4, portion);
  kernel.setArg(5, found);
  kernel.setArg(6, counter);
  kernel.setArg(7, cl::Local(2 * group * sizeof(T)));
  const KernelLinkerScope linker(context->UsesOwnLinker());
  // OpenCLContext::Launch would measure times, but this queue has no profiling.
  queue.enqueueNDRangeKernel(
    kernel, cl::NullRange, cl::NDRange(groups * group), cl::NDRange(group));
  queue.enqueueReadBuffer(found, CL_TRUE, 0, ranges.size() * sizeof(T), ranges.data());
  queue.enqueueReadBuffer(counter, CL_TRUE, 0, sizeof(others), &others);
  T least = ranges[0];
  T largest = ranges[1];
  for (std::size_t i = 0; i < groups; ++i)
  {
    least = std::min(least, ranges[2 * i]);
    largest = std::max(largest, ranges[2 * i + 1]);
  }
  return { static_cast<double>(least), static_cast<double>(largest), others == 0 };
}

} // namespace

DeviceOutput::Range FindRange(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  ElementType type, std::uint64_t tuples, std::size_t components, std::size_t component)
{
  switch (type)
  {
#define DEFORMVOLUME_CASE(name, ctype, cl)                                                         \
  case ElementType::name:                                                                          \
    return Find<ctype>(queue, buffer, type, tuples, components, component);
    DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
  }
  return {};
}

} // namespace deformvolume
