// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceVolume_h
#define DeformVolumeDeviceVolume_h

#include "BrickPoints.h"
#include "BridgeMask.h"
#include "DeviceCut.h"
#include "DeviceMapping.h"
#include "DeviceMask.h"
#include "Extent.h"
#include "HostMemory.h"
#include "KernelParameters.h"
#include "MappingProgram.h"
#include "MeshBoundary.h"
#include "OpenCLContext.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"
#include "VertexStates.h"
#include "VolumeArray.h"
#include "VolumeChunk.h"
#include "VoxelGrid.h"

#include <functional>
#include <utility>

namespace deformvolume
{

/// Whether an array of the volume is not copied to the device.
bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array);

///@{
/// Tetrahedra as the device has them, with the places of their nodes (DEFORMVOLUME_NODE_PLACES).
Tetrahedron NameNodePlaces(const Tetrahedron& tetrahedron);
std::vector<Tetrahedron> NameNodePlaces(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra);
///@}

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
  /// Those that were set; their Data is read only where they are used where they lie, and they have
  /// an owner only there. None where SetArrays has failed.
  const std::vector<VolumeArray>& GetVolumeArrays() const { return this->Arrays; }
  /// Changes which are categorical, and their background: of arrays of the types and components
  /// that were set. Returns whether any of that is another than it was.
  bool SetArrayOptions(const std::vector<VolumeArray>& arrays);
  bool IsInPlace(std::size_t array) const { return this->ArraysInPlace[array].Bytes > 0; }
  /// What lies over memory that overlaps this, with its buffer where there is one chunk only.
  BufferInPlace FindOverlapping(const void* data, std::uint64_t bytes) const;
  /// Has arrays in place be read as they are now.
  void ReadArraysAgain() const;
  /// The arrays of a chunk. Those in place overlap from chunk to chunk, so that one chunk has them
  /// at a time: waits for all that was enqueued where that is another one.
  const std::vector<cl::Buffer>& GetArrays(const VolumeChunk& chunk);
  ///@{
  /// The links or runs were checked (CheckLinks, CheckRuns).
  void SetLinks(const VertexLink* links);
  void SetRuns(const VertexRuns& runs);
  ///@}
  /// Frees the links or the runs.
  void ForgetMesh();
  ///@{
  /// Masks of the vertices and of the cells: what these had before is compared with, and what has
  /// changed is sent, and returned (DeviceMask::Set). bits: those of a byte that blank a voxel.
  /// Where tetrahedra that bridge gaps are left out, UpdateBridges() tells which cells have
  /// changed.
  std::vector<Extent> SetBlanked(
    const unsigned char* blanked, unsigned char bits, const PointRanges* written);
  std::vector<Extent> SetActive(const unsigned char* active, const PointRanges* written);
  std::vector<Extent> SetBoundaryDistances(const float* distances, const PointRanges* written);
  ///@}
  /// A smooth cut (DeviceCut::Set); returns boxes of the vertices that it lists otherwise than
  /// before.
  std::vector<Extent> SetCut(const unsigned char* crossed, const float* distances);

  ///@{
  /// Tetrahedra that would bridge the gap where the mesh is split are left out. places: see
  /// BridgeMask; empty: none are. vertices: those that lie in tetrahedra which have got other
  /// nodes.
  void SetNodePlaces(const std::vector<std::int32_t>& places);
  bool LeavesOutBridges() const { return this->Bridges.HasPlaces(); }
  /// The cells that the boundary of the deformation mesh, or of the field, crosses are left out.
  void SetBoundary(const MeshBoundary& boundary, bool isField);
  bool HasBoundary() const { return this->Bridges.HasBoundary(); }
  void ForgetBridges() { this->Bridges.Forget(); }
  void ChangeOwners(const std::vector<Extent>& vertices) { this->Bridges.ChangeVertices(vertices); }
  /// Finds them, where anything changed that this depends on; returns the boxes of cells that have
  /// other tetrahedra then. set: see UpdateState.
  std::vector<Extent> UpdateBridges(MappingForm mapping, const cl::Buffer& tetrahedra,
    const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set);
  ///@}

  const VoxelGrid& GetVoxelGrid() const { return this->Shape; }
  int GetSize(int axis) const
  {
    return static_cast<int>(deformvolume::GetSize(this->Shape.VertexExtent, axis));
  }
  /// Whether there is a mask of active tetrahedra, or one of those that bridge no gap.
  bool HasActive() const { return this->Active.HasBuffers() || this->Bridges.IsOn(); }
  bool HasOwnActive() const { return this->Active.HasBuffers(); }
  /// That of a chunk, or any buffer that stands in for it.
  const cl::Buffer& GetActive(const VolumeChunk& chunk) const
  {
    return this->Bridges.IsOn()   ? chunk.Joined
      : this->Active.HasBuffers() ? chunk.Active
                                  : this->RestPositions;
  }
  bool HasBlanked() const { return this->Blanked.HasBuffers(); }
  bool HasDistances() const { return this->Distances.HasBuffers(); }
  /// Whether there is any of these.
  bool HasMasks() const { return this->HasActive() || this->HasBlanked() || this->HasDistances(); }
  /// The boundary distances of a chunk, or any buffer that stands in for them.
  const cl::Buffer& GetDistances(const VolumeChunk& chunk) const
  {
    return this->HasDistances() ? chunk.Distances : this->RestPositions;
  }
  bool HasCut() const { return this->Cut.IsOn(); }
  const std::vector<CutVertex>& GetCutVertices() const { return this->Cut.GetList(); }
  /// Sets what kernels are given of the cut (CUT_PARAMETERS), from an argument on; returns the
  /// number of the next one.
  cl_uint SetCutArguments(cl::Kernel& kernel, cl_uint argument) const;
  bool HasMesh() const { return this->Mapping.HasLinks() || this->Mapping.HasRuns(); }
  bool HasRuns() const { return this->Mapping.HasRuns(); }
  /// See GetRunBytes in VertexRuns.h; 0 without runs.
  std::uint64_t GetRunBytes() const { return this->Mapping.GetRunBytes(); }
  const std::vector<VolumeChunk>& GetChunks() const { return this->Chunks; }

  /// Whether axes of the volume are not those of the output: HAS_TURNED_AXES in the programs that
  /// read undeformed positions.
  bool HasTurnedAxes() const { return !this->Shape.ToOutput.IsDiagonal(); }
  /// For each index on x, then y, then z the undeformed position (RestPosition or RestVector in
  /// KernelParameters.h).
  const cl::Buffer& GetRestPositions() const { return this->RestPositions; }

  /// Those that the runs refer to.
  TetrahedronRecords& GetRecords() { return this->Mapping.GetRecords(); }

  const BrickGrid& GetBricks() const { return this->Bricks; }
  /// Those of the sub-bricks, of a mesh, where the voxel grid is one chunk. Devices with memory of
  /// their own copy the static mapping to the host for that. See DeviceMapping.
  BrickPoints MakeBrickPoints(const cl::Buffer& tetrahedra, std::size_t numberOfNodes) const
  {
    return this->Mapping.MakeBrickPoints(this->Chunks.front(), this->Bricks.GetSubBricks(),
      tetrahedra, numberOfNodes, this->TetrahedraAtBoundary);
  }
  /// The same of a field.
  BrickPoints MakeBrickPoints(const FieldParameters& field) const
  {
    return BrickPoints::FromField(this->Bricks.GetSubBricks(), field, this->FieldPointsAtBoundary);
  }

  /// Brings the state of the vertices up to date, where anything changed that it depends on.
  /// mapping: the program of the deformation mapping. set: sets a kernel's arguments of the mapping
  /// for a chunk, which come first, and returns how many they are.
  /// Where the deformation moves all voxels and no mask is set there is no state to keep. movesAll:
  /// whether a field moves all voxels; links and runs tell by themselves.
  void UpdateState(const cl::Program& mapping, bool movesAll,
    const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set);
  /// Finds where the vertices of a smooth cut would be on its other side: after UpdateState, each
  /// time that the mapping has changed. bricks: as DEFORMVOLUME_BRICK_BITS says, if only those of
  /// some bricks have changed; else null.
  void UpdateCut(const cl::Program& mapping, const std::vector<cl_uint>* bricks,
    const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set);
  void ForgetState() { this->States.Forget(); }
  /// The state, or any buffer that stands in for it.
  const cl::Buffer& GetState(const VolumeChunk& chunk) const
  {
    return chunk.State() ? chunk.State : this->RestPositions;
  }

  /// The parameters of a launch over the whole of a chunk.
  KernelParameters GetParameters(const VolumeChunk& chunk) const;

  std::uint64_t GetMemory() const;

private:
  /// Reads the data until the queue has finished.
  cl::Buffer Send(const void* data, std::size_t bytesPerElement, std::int64_t elementsPerLayer,
    std::int64_t begin, std::int64_t end, const cl::Buffer& previous);
  void ListBoundary(const MeshBoundary& boundary, bool isField);
  /// Lets go of the buffers over memory of the host.
  void LeaveArrays();
  cl::Buffer MakeRestPositions() const;

  OpenCLContext& Context;
  cl::CommandQueue Queue;
  VoxelGrid Shape;
  BrickGrid Bricks;
  std::uint64_t AllocationLimit;
  bool HasRoomForCuts = true;
  std::vector<VolumeChunk> Chunks;
  std::vector<VolumeArray> Arrays;
  std::vector<BufferInPlace> ArraysInPlace; // one for each array, of no bytes where it was sent
  VolumeChunk* ChunkInPlace = nullptr;      // the one that has buffers over them
  cl::Buffer RestPositions;
  DeviceMapping Mapping;
  DeviceMask Blanked{ DeviceMask::Kind::BlankedVertices };
  DeviceMask Active{ DeviceMask::Kind::ActiveTetrahedra };
  DeviceMask Distances{ DeviceMask::Kind::BoundaryDistances };
  DeviceCut Cut;
  BridgeMask Bridges;
  /// For each sub-brick what moves its cells at the boundary: tetrahedra, or a box of points of the
  /// field. Empty without a mesh, or a field, that has a boundary.
  std::vector<std::vector<std::int32_t>> TetrahedraAtBoundary;
  std::vector<Extent> FieldPointsAtBoundary;
  VertexStates States;
  bool WithState = true;
};

} // namespace deformvolume

#endif
