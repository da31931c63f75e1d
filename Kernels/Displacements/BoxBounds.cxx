// SPDX-License-Identifier: BSD-3-Clause
#include "BoxBounds.h"

#include "HostMemory.h"
#include "KernelMaking.h"
#include "MappingProgram.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

using BoundsOfAxes = std::array<cl_float, 6>;

} // namespace

std::vector<DisplacementBounds> FindBoxBounds(WorkDevice& device, const cl::Buffer& displacements,
  const std::array<int, 3>& size, const std::vector<Extent>& boxes)
{
  static_assert(sizeof(Extent) == 6 * sizeof(cl_int), "The kernel reads an Extent as six ints.");
  if (boxes.empty())
  {
    return {};
  }
  cl::Buffer boxesThere;
  device.Send(boxesThere, boxes);
  OpenCLContext& context = device.GetContext();
  const cl::CommandQueue& queue = device.GetQueue();
  const std::size_t bytes = boxes.size() * sizeof(BoundsOfAxes);
  std::vector<BoundsOfAxes> found(boxes.size());
  const cl::Buffer bounds(context.GetContext(), CL_MEM_READ_WRITE, bytes);
  const QueueGuard guard(queue);
  cl::Kernel kernel(GetConversionProgram(context), "FindBoxBounds");
  const std::size_t group = device.GetGroupSize(kernel);
  SetArguments(kernel, 0, displacements, cl_int{ size[0] }, cl_int{ size[1] }, boxesThere,
    cl::Local(group * sizeof(BoundsOfAxes)), bounds);
  context.Launch(queue, kernel, cl::NDRange(boxes.size() * group), cl::NDRange(group));
  queue.enqueueReadBuffer(bounds, CL_TRUE, 0, bytes, found.data());
  std::vector<DisplacementBounds> made(boxes.size());
  for (std::size_t box = 0; box < boxes.size(); ++box)
  {
    std::copy_n(found[box].begin(), 3, made[box].Min.begin());
    std::copy_n(found[box].begin() + 3, 3, made[box].Max.begin());
  }
  return made;
}

} // namespace deformvolume
