// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceMasks_h
#define DeformVolumeDeviceMasks_h

#include "BrickGrid.h"
#include "DeviceCut.h"
#include "DeviceMask.h"
#include "Extent.h"
#include "MeshBoundary.h"
#include "OpenCLContext.h"
#include "ResampledMask.h"
#include "VertexStates.h"
#include "VolumeChunk.h"
#include "VoxelGrid.h"

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The masks of a volume on the device: blanked voxels, active tetrahedra, boundary distances, a
/// smooth cut, and ResampledMask.
class DeviceMasks
{
public:
  /// chunks, states, bricks: of the volume. This object sets the buffers of masks in the chunks,
  /// reports changes to the states, and sets the Halo of the bricks for smooth cuts.
  DeviceMasks(OpenCLContext& context, const cl::CommandQueue& queue, const VoxelGrid& grid,
    std::uint64_t allocationLimit, BrickGrid& bricks, std::vector<VolumeChunk>& chunks,
    VertexStates& states);

  ///@{
  /// Set a mask of vertices or cells; null: no mask. Uploads only bytes that differ from the mask
  /// on the device, and returns the boxes that contain them (DeviceMask::Set()). bits: the bits of
  /// a byte that blank a voxel. If ResampledMask is on, DeviceVolume::UpdateResampledMask() returns
  /// the changes of cells.
  std::vector<Extent> SetBlanked(
    const unsigned char* blanked, unsigned char bits, const PointRanges* written);
  std::vector<Extent> SetActive(const unsigned char* active, const PointRanges* written);
  std::vector<Extent> SetBoundaryDistances(const float* distances, const PointRanges* written);
  ///@}
  /// Set a smooth cut (DeviceCut::Set()). Returns the boxes of vertices whose entries have changed.
  std::vector<Extent> SetCut(const unsigned char* crossed, const float* distances);
  /// Excludes bridges over a split of the mesh. numbers: see ResampledMask::SetCoincidentNodes().
  void SetCoincidentNodes(const std::vector<std::int32_t>& numbers);
  /// Excludes the cells that the boundary of the deformation mesh, or of the field, crosses.
  void SetBoundary(const MeshBoundary& boundary);

  /// Whether there is any mask, apart from a smooth cut.
  bool HasAny() const { return this->HasActive() || this->HasBlanked() || this->HasDistances(); }
  /// Whether kernels need a mask of active tetrahedra: one that is set, or ResampledMask.
  bool HasActive() const { return this->HasGivenActive() || this->Resampled.IsOn(); }
  bool HasGivenActive() const { return this->Active.HasBuffers(); }
  bool HasBlanked() const { return this->Blanked.HasBuffers(); }
  bool HasDistances() const { return this->Distances.HasBuffers(); }
  bool HasCut() const { return this->Cut.IsOn(); }
  bool HasBoundary() const { return this->Resampled.HasBoundary(); }
  /// Returns the active tetrahedra of a chunk that are resampled by their vertices. Null: all.
  const cl::Buffer& GetActive(const VolumeChunk& chunk) const
  {
    return this->Resampled.IsOn() ? chunk.ResampledTetrahedra : chunk.Active;
  }

  DeviceCut& GetCut() { return this->Cut; }
  const DeviceCut& GetCut() const { return this->Cut; }
  ResampledMask& GetResampledMask() { return this->Resampled; }
  const ResampledMask& GetResampledMask() const { return this->Resampled; }

private:
  OpenCLContext& Context;
  cl::CommandQueue Queue;
  const VoxelGrid& Grid;
  std::array<int, 3> Size; // vertices on each axis
  std::uint64_t AllocationLimit;
  BrickGrid& Bricks;
  std::vector<VolumeChunk>& Chunks;
  VertexStates& States;
  DeviceMask Blanked{ DeviceMask::Kind::BlankedVertices };
  DeviceMask Active{ DeviceMask::Kind::ActiveTetrahedra };
  DeviceMask Distances{ DeviceMask::Kind::BoundaryDistances };
  DeviceCut Cut;
  ResampledMask Resampled;
};

} // namespace deformvolume

#endif
