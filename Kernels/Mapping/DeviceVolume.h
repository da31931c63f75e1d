// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceVolume_h
#define DeformVolumeDeviceVolume_h

#include "BrickPoints.h"
#include "Extent.h"
#include "HostMemory.h"
#include "KernelParameters.h"
#include "MeshOrder.h"
#include "OpenCLContext.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <functional>
#include <utility>

namespace deformvolume
{

/// Whether an array of the volume is not copied to the device.
bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array);

/// Tetrahedra as the device has them, with the places of their nodes (DEFORMVOLUME_NODE_PLACES).
std::vector<Tetrahedron> NameNodePlaces(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, const MeshOrder& order = {});

/// A range of cell layers of the sampling mesh with the vertex planes that they and their
/// neighbours need: a volume over the device's allocation limit is held in several.
struct VolumeChunk
{
  int LayersBegin = 0; // cells, local z
  int LayersEnd = 0;
  int PlanesBegin = 0; // vertices, local z: one plane more than the cells have on each side
  int PlanesEnd = 0;
  cl::Buffer Links;     // one a voxel, or else runs
  cl::Buffer Runs;      // those of the rows of the planes
  cl::Buffer RowBegins; // 4 bytes a row, counted from the chunk's first run
  cl::Buffer State;
  cl::Buffer Blanked;
  cl::Buffer Active;
  std::vector<cl::Buffer> Arrays; // see DeviceVolume::GetArrays
};

/// What the device holds of the sampling mesh: per voxel the arrays and the state; the static links
/// into the deformation mesh, or runs; per cell the active tetrahedra.
class DeviceVolume
{
public:
  DeviceVolume(OpenCLContext& context, const cl::CommandQueue& queue, const VoxelGrid& voxelGrid,
    std::size_t bytesPerVoxel, std::uint64_t allocationLimit, bool withLinks = true);

  /// Arrays with an owner are used where they lie, if the device can, and their memory does not
  /// overlap that of others. field: where a displacement field lies that is used in place.
  void SetArrays(const std::vector<VolumeArray>& arrays, const BufferInPlace& field = {});
  bool IsInPlace(std::size_t array) const { return this->ArraysInPlace[array].Bytes > 0; }
  /// What lies over memory that overlaps this, with its buffer where there is one chunk only.
  BufferInPlace FindOverlapping(const void* data, std::uint64_t bytes) const;
  /// Has arrays in place be read as they are now.
  void ReadArraysAgain() const;
  /// The arrays of a chunk. Those in place overlap from chunk to chunk, so that one chunk has them
  /// at a time: waits for all that was enqueued where that is another one.
  const std::vector<cl::Buffer>& GetArrays(const VolumeChunk& chunk);
  ///@{
  /// With numbers of the mesh, which become those of the device.
  void SetLinks(const VertexLink* links, const MeshOrder& order = {});
  /// The runs were checked (CheckRuns).
  void SetRuns(const VertexRuns& runs, const MeshOrder& order = {});
  ///@}
  /// Frees the links or the runs.
  void ForgetMesh();
  void SetBlanked(const unsigned char* blanked);
  void SetActive(const unsigned char* active);

  const VoxelGrid& GetVoxelGrid() const { return this->Shape; }
  int GetSize(int axis) const
  {
    return static_cast<int>(deformvolume::GetSize(this->Shape.VertexExtent, axis));
  }
  bool HasActive() const { return this->WithActive; }
  bool HasBlanked() const { return this->WithBlanked; }
  bool HasMesh() const { return this->WithLinks || this->RunBytes > 0; }
  bool HasRuns() const { return this->RunBytes > 0; }
  /// See GetRunBytes in VertexRuns.h; 0 without runs.
  std::uint64_t GetRunBytes() const { return this->RunBytes; }
  const std::vector<VolumeChunk>& GetChunks() const { return this->Chunks; }

  /// For each index on x, then y, then z the undeformed position (RestPosition in
  /// DeformationMapping.cl).
  const cl::Buffer& GetRestPositions() const { return this->RestPositions; }

  /// The record of each tetrahedron that the runs refer to (TetrahedronRecord), after
  /// EvaluateTetrahedra, which is due after the nodes have moved.
  const cl::Buffer& GetRecords() const { return this->Records; }
  bool NeedsRecords() const { return this->RecordsChanged; }
  void ForgetRecords() { this->RecordsChanged = true; }
  cl::Event EvaluateTetrahedra(
    const cl::Program& mapping, const cl::Buffer& tetrahedra, const cl::Buffer& nodes);

  /// Global and work-group size of a launch over the vertices of so many planes.
  cl::NDRange GetVertexRange(int planes) const;
  cl::NDRange GetVertexGroup() const;

  const BrickGrid& GetBricks() const { return this->Bricks; }
  /// Those of the sub-bricks, of a mesh, on a processor, where the voxel grid is one
  /// chunk.
  BrickPoints MakeBrickPoints(
    const cl::Buffer& tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes) const;

  /// Brings the state of the vertices up to date, where anything changed that it depends on.
  /// mapping: the program of the deformation mapping. set: sets a kernel's arguments of the mapping
  /// for a chunk, which come first, and returns how many they are.
  /// Where the deformation moves all voxels and no mask is set there is no state to keep. movesAll:
  /// whether a field moves all voxels; links and runs tell by themselves.
  void UpdateState(const cl::Program& mapping, bool movesAll,
    const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set);
  void ForgetState() { this->StateChanged = true; }
  /// The state, or any buffer that stands in for it.
  const cl::Buffer& GetState(const VolumeChunk& chunk) const
  {
    return chunk.State() ? chunk.State : this->RestPositions;
  }

  /// The parameters of a launch over the whole of a chunk.
  KernelParameters GetParameters(const VolumeChunk& chunk) const;

  std::uint64_t GetMemory() const;

private:
  /// Throws an Error where a device gives no buffer of so many bytes.
  void CheckAllocation(std::uint64_t bytes) const;
  /// Reads the data until the queue has finished.
  cl::Buffer Send(const void* data, std::size_t bytesPerElement, std::int64_t elementsPerLayer,
    std::int64_t begin, std::int64_t end, const cl::Buffer& previous);
  /// Lets go of the buffers over memory of the host.
  void LeaveArrays();
  void ForgetRuns();
  void SendLinks(VolumeChunk& chunk, const VertexLink* links, const MeshOrder& order);
  void SendRecords(const std::vector<RestTetrahedron>& tetrahedra, const MeshOrder& order);
  void MarkChunk(
    cl::Kernel& sources, cl_uint sourcesIndex, cl::Kernel& vertices, const VolumeChunk& chunk);
  cl::Buffer MakeRestPositions() const;

  OpenCLContext& Context;
  cl::CommandQueue Queue;
  VoxelGrid Shape;
  BrickGrid Bricks;
  std::uint64_t AllocationLimit;
  std::vector<VolumeChunk> Chunks;
  std::vector<BufferInPlace> ArraysInPlace; // one for each array, of no bytes where it was sent
  std::vector<std::shared_ptr<const void>> Owners; // of these
  VolumeChunk* ChunkInPlace = nullptr;             // the one that has buffers over them
  cl::Buffer RestPositions;
  cl::Buffer Marked; // sources, while the state is brought up to date
  bool WithLinks = false;
  std::uint64_t RunBytes = 0;
  cl::Buffer RestTetrahedra; // of each record 15 reals, see RunMapping.cl
  cl::Buffer RecordOwners;   // and its tetrahedron, 4 bytes
  cl::Buffer Records;
  cl_uint NumberOfRecords = 0;
  bool RecordsChanged = true;
  bool WithBlanked = false;
  bool WithActive = false;
  bool StateChanged = true;
  bool WithState = true;
  bool AllLinked = false; // no link or run says that a voxel is outside
};

} // namespace deformvolume

#endif
