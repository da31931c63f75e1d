// SPDX-License-Identifier: BSD-3-Clause
#include "MemoryNeeds.h"

#include "BrickGrid.h"
#include "DeferredCells.h"
#include "DeviceVolume.h"
#include "MemoryBudget.h"
#include "MeshRasterizer.h"
#include "SlabSizes.h"
#include "VectorConverter.h"
#include "VertexLink.h"
#include "WorkDevice.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

// Returns the number of voxels of the first slab. All slabs of the output use the same buffers.
std::uint64_t CountVoxelsOfSlab(WorkDevice& device, const DeformationSize& size)
{
  if (GetNumberOfPoints(size.OutputExtent) == 0)
  {
    return 0;
  }
  const std::vector<Extent> slabs =
    SplitIntoSlabs(size.OutputExtent, size.Arrays, size.Grid, device.GetAllocationLimit());
  return static_cast<std::uint64_t>(GetNumberOfPoints(slabs.front()));
}

// Whether a kernel converts the vectors of a field.
bool IsConvertedByKernel(WorkDevice& device, const DeformationSize& size)
{
  return !device.GetDevice().IsProcessor && size.NumberOfTetrahedra == 0 &&
    size.NumberOfNodes >= VectorConverter::MinPoints;
}

std::uint64_t CountDeviceMemory(
  WorkDevice& device, const DeformationSize& size, std::uint64_t outputBytesPerVoxel)
{
  std::uint64_t sent = 0;
  for (const VolumeArray& array : size.Arrays)
  {
    sent += IsUsedInPlace(device.GetContext(), array) ? 0 : GetTupleSize(array);
  }
  sent += size.HasDistances ? sizeof(float) : 0;
  const auto voxels = static_cast<std::uint64_t>(GetNumberOfPoints(size.Grid.VertexExtent));
  const std::uint64_t outputVoxels = CountVoxelsOfSlab(device, size);
  if (size.IsRasterized)
  {
    // Arrays, and both masks.
    return voxels * (sent + 2) +
      MeshRasterizer::GetMemoryNeeded(
        device, outputVoxels, outputBytesPerVoxel, size.NumberOfNodes, size.NumberOfTetrahedra);
  }
  // The list of deferred cells (GPUs), and coverage as bits.
  const std::uint64_t deferred =
    DeferredCells::GetMemory(device, BrickGrid(size.Grid).GetNumberOfBricks());
  const std::uint64_t bits = deferred > 0 ? CountWords(outputVoxels) * 4 : 0;
  const std::uint64_t vectors = IsConvertedByKernel(device, size)
    ? std::min(size.NumberOfNodes, VectorConverter::PointsOfPortion) * 3 * sizeof(float)
    : 0;
  // Arrays, states, active tetrahedra and blanking; links or runs of a mesh; arrays and coverage of
  // the output; displacements and tetrahedra.
  return voxels * (sent + 3) + size.MappingBytes + outputVoxels * outputBytesPerVoxel + deferred +
    bits + vectors + (size.NumberOfNodes + size.NumberOfTetrahedra) * 16;
}

} // namespace

std::uint64_t GetMappingBytes(const VoxelGrid& grid, bool field, std::uint64_t runBytes)
{
  return field ? 0
    : runBytes
    ? runBytes
    : static_cast<std::uint64_t>(GetNumberOfPoints(grid.VertexExtent)) * sizeof(VertexLink);
}

std::uint64_t CheckDeviceMemory(WorkDevice& device, MemoryBudget& budget,
  const DeformationSize& size, std::uint64_t outputBytesPerVoxel)
{
  const std::uint64_t needed = CountDeviceMemory(device, size, outputBytesPerVoxel);
  const std::uint64_t available = budget.GetUsable();
  MemoryBudget::CheckBytes(needed, available, "on the device");
  return available - needed;
}

void CheckMemory(
  WorkDevice& device, MemoryBudget& budget, const DeformationSize& size, std::uint64_t heldBytes)
{
  std::uint64_t tuple = 0;
  for (const VolumeArray& array : size.Arrays)
  {
    tuple += GetTupleSize(array);
  }
  // A CPU device works in the memory of the output.
  const bool shared = device.GetDevice().IsProcessor;
  const std::uint64_t outputBytesPerVoxel = shared ? 0 : tuple + 1;
  CheckDeviceMemory(device, budget, size, outputBytesPerVoxel);
  // Host memory that the caller holds; a CPU device shares it. For other devices, there is a copy
  // of the displacements (DisplacementBuffer).
  const std::uint64_t copied =
    shared || size.IsRasterized || IsConvertedByKernel(device, size) ? 0 : size.NumberOfNodes * 16;
  const std::uint64_t host = size.MappingBytes + copied +
    static_cast<std::uint64_t>(GetNumberOfPoints(size.OutputExtent)) * (tuple + 1);
  const std::uint64_t onDevice = shared ? CountDeviceMemory(device, size, outputBytesPerVoxel) : 0;
  const std::uint64_t system = budget.GetSystemMemory();
  if (system > 0)
  {
    MemoryBudget::CheckBytes(host + onDevice, system + heldBytes, "in the system");
  }
}

} // namespace deformvolume
