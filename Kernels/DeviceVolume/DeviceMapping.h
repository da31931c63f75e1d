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

/// The static mapping of a volume on the device: links, or runs with their records. Its parts lie
/// in the chunks of the volume.
class DeviceMapping
{
public:
  /// size: voxels of the volume on each axis.
  DeviceMapping(OpenCLContext& context, const cl::CommandQueue& queue,
    const std::array<int, 3>& size, std::uint64_t allocationLimit);

  ///@{
  /// A call that fails leaves none.
  void SetLinks(std::vector<VolumeChunk>& chunks, const VertexLink* links);
  /// The runs were checked (CheckRuns).
  void SetRuns(std::vector<VolumeChunk>& chunks, const VertexRuns& runs);
  ///@}
  void Forget(std::vector<VolumeChunk>& chunks);

  bool HasLinks() const { return this->WithLinks; }
  bool HasRuns() const { return this->RunBytes > 0; }
  /// See GetRunBytes in VertexRuns.h; 0 without runs.
  std::uint64_t GetRunBytes() const { return this->RunBytes; }
  /// Whether no link or run says that a voxel is outside.
  bool AreAllLinked() const { return this->AllLinked; }

  TetrahedronRecords& GetRecords() { return this->Records; }
  const TetrahedronRecords& GetRecords() const { return this->Records; }

  /// Of a mapping in one chunk, on a processor. tetrahedra: as on the device. boundary: see
  /// BrickPoints::Mesh.
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
  /// Where the runs of each row lie in each chunk, as on the device (RowRanges in VolumeChunk).
  std::vector<std::vector<std::uint32_t>> Rows;
  TetrahedronRecords Records;
};

} // namespace deformvolume

#endif
