// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMemoryNeeds_h
#define DeformVolumeMemoryNeeds_h

#include "Extent.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class MemoryBudget;
class WorkDevice;

/// What a deformation needs memory for, as far as that is known before anything is allocated.
/// Winners of the output are counted when it turns out that the volume is folded (ExactResampler).
struct DeformationSize
{
  const VoxelGrid& Grid;
  const std::vector<VolumeArray>& Arrays; // their values are not read
  const Extent& OutputExtent;
  std::size_t NumberOfNodes; // of the mesh, or points of a field
  std::size_t NumberOfTetrahedra;
  std::uint64_t MappingBytes; // see GetMappingBytes; with what the boundary of a mesh takes
  bool IsRasterized;          // by MeshRasterization
  bool HasDistances = false;  // to the boundary
};

/// Bytes of the static mapping: of runs where there are some, else of a link a voxel; a field has
/// none.
std::uint64_t GetMappingBytes(const VoxelGrid& grid, bool field, std::uint64_t runBytes);

/// Throws an Error where the device has too little memory. outputBytesPerVoxel: of the output
/// there. Returns how many bytes are left.
std::uint64_t CheckDeviceMemory(WorkDevice& device, MemoryBudget& budget,
  const DeformationSize& size, std::uint64_t outputBytesPerVoxel);

/// The same for the device and for the system. heldBytes: see VolumeDeformer::CheckMemory.
void CheckMemory(
  WorkDevice& device, MemoryBudget& budget, const DeformationSize& size, std::uint64_t heldBytes);

} // namespace deformvolume

#endif
