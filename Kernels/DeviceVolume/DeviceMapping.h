// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceMapping_h
#define DeformVolumeDeviceMapping_h

#include "BrickPoints.h"
#include "OpenCLContext.h"
#include "Tetrahedron.h"
#include "TetrahedronRecords.h"
#include "VertexLink.h"
#include "VertexRuns.h"
#include "VolumeChunk.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The static mapping of a volume on the device: links, or runs with their records. The links or
/// runs are stored in the chunks of the volume.
class DeviceMapping
{
public:
  /// size: voxels of the volume on each axis.
  DeviceMapping(OpenCLContext& context, const cl::CommandQueue& queue,
    const std::array<int, 3>& size, std::uint64_t allocationLimit);

  ///@{
  /// Set the links or runs. After a call that throws, there is no mapping.
  void SetLinks(std::vector<VolumeChunk>& chunks, const VertexLink* links);
  /// The runs must have been checked (CheckRuns()).
  void SetRuns(std::vector<VolumeChunk>& chunks, const VertexRuns& runs);
  ///@}
  void Forget(std::vector<VolumeChunk>& chunks);

  bool HasLinks() const { return this->WithLinks; }
  bool HasRuns() const { return this->RunBytes > 0; }
  /// Bytes of the runs (GetRunBytes() in VertexRuns.h). 0 without runs.
  std::uint64_t GetRunBytes() const { return this->RunBytes; }
  /// Whether all voxels have a tetrahedron.
  bool AreAllLinked() const { return this->AllLinked; }

  TetrahedronRecords& GetRecords() { return this->Records; }
  const TetrahedronRecords& GetRecords() const { return this->Records; }

  /// Finds the points that move each brick of a grid, for a mapping in one chunk. tetrahedra: as on
  /// the device. boundary: see BrickPoints::Mesh.
  BrickPoints MakeBrickPoints(const VolumeChunk& chunk, const BrickGrid& grid,
    const cl::Buffer& tetrahedra, std::size_t numberOfNodes,
    const std::vector<std::vector<std::int32_t>>& boundary) const;

private:
  void SendLinks(VolumeChunk& chunk, const VertexLink* links);

  OpenCLContext& Context;
  cl::CommandQueue Queue;
  std::array<int, 3> Size;
  std::uint64_t AllocationLimit;
  bool WithLinks = false;
  std::uint64_t RunBytes = 0;
  bool AllLinked = false;
  /// For each chunk a copy of VolumeChunk::RowRanges.
  std::vector<std::vector<std::uint32_t>> Rows;
  TetrahedronRecords Records;
};

} // namespace deformvolume

#endif
