// SPDX-License-Identifier: BSD-3-Clause
#include "VectorBounds.h"

#include "DeviceVectorsInternals.h"
#include "FieldChecker.h"
#include "FieldParameters.h"
#include "GuardedCall.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "KernelText.h"
#include "MappingProgram.h"

#include <algorithm>
#include <array>
#include <vector>

namespace deformvolume
{
namespace
{

using Bounds = std::array<double, 6>;

constexpr std::size_t Groups = 256;

// Returns the argument `rest` of the kernel FindBounds, with the arithmetic of the host
// (FieldChecker).
std::vector<double> FindRestPositions(const VoxelGrid& voxelGrid)
{
  const Extent& extent = voxelGrid.VertexExtent;
  const OutputTransform transform = GetOutputTransform(voxelGrid);
  std::vector<double> rest;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = extent[2 * axis]; i <= extent[2 * axis + 1]; ++i)
    {
      const glm::dvec3 part = transform.GetMatrix()[axis] * static_cast<double>(i) +
        (axis == 0 ? transform.GetShift() : glm::dvec3(0.0));
      rest.insert(rest.end(), { part.x, part.y, part.z });
    }
  }
  return rest;
}

std::optional<IndexBounds> FindDeformedExtent(
  const VoxelGrid& voxelGrid, const DisplacementField& field, DeviceVectors::Internals& vectors)
{
  WorkDevice& device = vectors.GetWorkDevice();
  OpenCLContext& context = device.GetContext();
  const cl::CommandQueue& queue = device.GetQueue();
  KernelParameters parameters = {};
  for (int axis = 0; axis < 3; ++axis)
  {
    parameters.Size[axis] = static_cast<int>(GetSize(voxelGrid.VertexExtent, axis));
  }
  const std::vector<double> rest = FindRestPositions(voxelGrid);
  std::vector<Bounds> found(Groups);
  cl_uint bad = 0;
  const cl::Buffer sent(context.GetContext(), CL_MEM_READ_ONLY, rest.size() * sizeof(double));
  const cl::Buffer bounds(context.GetContext(), CL_MEM_READ_WRITE, Groups * sizeof(Bounds));
  const cl::Buffer number(context.GetContext(), CL_MEM_READ_WRITE, sizeof(bad));
  const QueueGuard guard(queue);
  PendingCopies copies;
  copies.Add(BeginToWrite(queue, sent, 0, rest.size() * sizeof(double), rest.data()));
  queue.enqueueFillBuffer(number, bad, 0, sizeof(bad));
  cl::Kernel kernel(GetConversionProgram(context), "FindBounds");
  const std::size_t group = device.GetGroupSize(kernel);
  SetArguments(kernel, 0, vectors.GetBuffer(), MakeFieldParameters(field, voxelGrid), parameters,
    sent, static_cast<cl_float>(LargestDisplacement), cl::Local(group * sizeof(Bounds)), bounds,
    number);
  context.Launch(queue, kernel, cl::NDRange(Groups * group), cl::NDRange(group));
  copies.Add(BeginToReadRange(queue, bounds, 0, Groups * sizeof(Bounds), found.data()));
  queue.enqueueReadBuffer(number, CL_TRUE, 0, sizeof(bad), &bad);
  copies.Check();
  if (bad > 0)
  {
    return {};
  }
  IndexBounds all;
  for (const Bounds& one : found)
  {
    if (one[0] <= one[3]) // otherwise the work-group had no row
    {
      all.Add(glm::dvec3(one[0], one[1], one[2]));
      all.Add(glm::dvec3(one[3], one[4], one[5]));
    }
  }
  return all;
}

} // namespace

std::optional<IndexBounds> FindDeformedBounds(
  const VoxelGrid& voxelGrid, const DisplacementField& field, DeviceVectors& vectors)
{
  DeviceVectors::Internals& internals = vectors.GetInternals();
  WorkDevice& device = internals.GetWorkDevice();
  CheckVectors(&vectors, device, static_cast<std::size_t>(GetNumberOfPoints(field)));
  if (internals.AreInHostMemory() || !HasDouble(device.GetContext()) ||
    !AreVoxelsPoints(voxelGrid, field))
  {
    return {};
  }
  return CallGuarded([&] { return FindDeformedExtent(voxelGrid, field, internals); });
}

} // namespace deformvolume
