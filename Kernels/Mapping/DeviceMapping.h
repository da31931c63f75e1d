// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceMapping_h
#define DeformVolumeDeviceMapping_h

#include "BrickPoints.h"
#include "Extent.h"
#include "MappingUpdate.h"
#include "MeshOrder.h"
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
  /// With numbers of the mesh, which become those of the device. A call that fails leaves none.
  void SetLinks(std::vector<VolumeChunk>& chunks, const VertexLink* links, const MeshOrder& order);
  /// The runs were checked (CheckRuns).
  void SetRuns(std::vector<VolumeChunk>& chunks, const VertexRuns& runs, const MeshOrder& order);
  ///@}
  void Forget(std::vector<VolumeChunk>& chunks);

  /// Some rows get other links or runs: those of an update that was checked (CheckMappingUpdate).
  /// first: structured index of the volume's first voxel. order: the numbers of now. removed: those
  /// on the device that no tetrahedron has any more. Returns boxes that hold all voxels which are
  /// inside the mesh now and were not, or the other way round, in local indices.
  std::vector<Extent> Update(std::vector<VolumeChunk>& chunks, const MappingUpdate& update,
    const std::array<int, 3>& first, const MeshOrder& order,
    const std::vector<std::int32_t>& removed);

  bool HasLinks() const { return this->WithLinks; }
  bool HasRuns() const { return this->RunBytes > 0; }
  /// See GetRunBytes in VertexRuns.h; 0 without runs.
  std::uint64_t GetRunBytes() const { return this->RunBytes; }
  /// Whether no link or run says that a voxel is outside, as far as that is known.
  bool AreAllLinked() const { return this->AllLinked; }

  TetrahedronRecords& GetRecords() { return this->Records; }
  const TetrahedronRecords& GetRecords() const { return this->Records; }

  /// Of a mapping in one chunk, on a processor. tetrahedra: as on the device. wanted: see
  /// BrickPoints::FromLinks. boundary: see BrickPoints::Mesh.
  BrickPoints MakeBrickPoints(const VolumeChunk& chunk, const BrickGrid& grid,
    const cl::Buffer& tetrahedra, std::size_t numberOfNodes,
    const std::vector<std::vector<std::int32_t>>& boundary,
    const std::vector<std::size_t>* wanted) const;

private:
  /// The runs of a chunk: where those of each row lie, and where room is left behind all of them.
  struct ChunkRuns
  {
    std::vector<std::uint32_t> Rows; // as on the device (RowRanges in VolumeChunk)
    std::uint64_t End = 0;
  };
  class Changes;

  void SendLinks(VolumeChunk& chunk, const VertexLink* links, const MeshOrder& order);
  void UpdateLinks(const VolumeChunk& chunk, const Extent& box, const VertexLink* links,
    const MeshOrder& order, Changes& changes) const;
  /// boxes: those of the runs, in local indices. records: the numbers on the device of theirs.
  void UpdateRuns(VolumeChunk& chunk, ChunkRuns& has, const std::vector<Extent>& boxes,
    const VertexRuns& runs, const std::vector<std::int32_t>& records, Changes& changes);
  /// Makes room for so many runs behind the others, of which it leaves out those of no row.
  void MakeRoom(VolumeChunk& chunk, ChunkRuns& has, std::uint64_t more) const;

  OpenCLContext& Context;
  cl::CommandQueue Queue;
  std::array<int, 3> Size;
  std::uint64_t AllocationLimit;
  bool WithLinks = false;
  std::uint64_t RunBytes = 0;
  bool AllLinked = false;
  std::vector<ChunkRuns> Runs; // of each chunk
  TetrahedronRecords Records;
};

} // namespace deformvolume

#endif
