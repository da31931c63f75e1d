// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMemoryNeeds_h
#define DeformVolumeMemoryNeeds_h

#include "DeformVolumeExport.h"
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

/// The input for memory estimates before anything is allocated. Winners of overlaps are not
/// included: ExactResampler counts them when a folded volume needs them.
struct DeformationSize
{
  /// The voxels of the volume.
  const VoxelGrid& Grid;
  /// The arrays of the volume. Their values are not read.
  const std::vector<VolumeArray>& Arrays;
  /// The extent of the output.
  const Extent& OutputExtent;
  /// The number of nodes of the mesh, or of points of a field.
  std::size_t NumberOfNodes;
  /// The number of tetrahedra of the mesh; 0 for a field.
  std::size_t NumberOfTetrahedra;
  /// GetMappingBytes() and the boundary of a mesh; 0 if rasterized.
  std::uint64_t MappingBytes;
  /// Whether the method is Resampling::MeshRasterization.
  bool IsRasterized;
  /// Whether there are boundary distances.
  bool HasDistances = false;
};

/// Returns the bytes of the static mapping: runBytes (GetRunBytes() of VertexRuns.h) if it is not
/// 0, else those of one link per voxel. A field has no static mapping.
DEFORMVOLUME_EXPORT std::uint64_t GetMappingBytes(
  const VoxelGrid& grid, bool field, std::uint64_t runBytes);

/// Throws an Error if the device has too little memory; otherwise returns the remaining bytes.
/// outputBytesPerVoxel: of the output on the device.
std::uint64_t CheckDeviceMemory(WorkDevice& device, MemoryBudget& budget,
  const DeformationSize& size, std::uint64_t outputBytesPerVoxel);

/// Checks both the memory of the device and the memory of the system. heldBytes: see
/// VolumeDeformer::CheckMemory.
void CheckMemory(
  WorkDevice& device, MemoryBudget& budget, const DeformationSize& size, std::uint64_t heldBytes);

} // namespace deformvolume

#endif
