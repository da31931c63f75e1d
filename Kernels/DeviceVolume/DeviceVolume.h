// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceVolume_h
#define DeformVolumeDeviceVolume_h

#include "BoundaryDependencies.h"
#include "BrickPoints.h"
#include "DeviceArrays.h"
#include "DeviceMapping.h"
#include "DeviceMasks.h"
#include "Extent.h"
#include "KernelParameters.h"
#include "MappingProgram.h"
#include "OpenCLContext.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"
#include "VertexStates.h"
#include "VolumeChunk.h"
#include "VoxelGrid.h"

#include <functional>
#include <utility>

namespace deformvolume
{

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

  /// Others refer to members of this object.
  DeviceVolume(const DeviceVolume&) = delete;
  DeviceVolume& operator=(const DeviceVolume&) = delete;

  ///@{
  /// The arrays of the volume.
  DeviceArrays& GetArrays() { return this->Arrays; }
  const DeviceArrays& GetArrays() const { return this->Arrays; }
  ///@}
  ///@{
  /// The masks of the volume. Smooth cuts and boundaries are set by this class.
  DeviceMasks& GetMasks() { return this->Masks; }
  const DeviceMasks& GetMasks() const { return this->Masks; }
  ///@}
  /// Sets a smooth cut (DeviceMasks::SetCut). Throws an Error if the device has no room for it.
  std::vector<Extent> SetCut(const unsigned char* crossed, const float* distances);
  /// Leaves out the cells that the boundary of the deformation mesh crosses (DeviceMasks), and
  /// finds what moves them. isField: whether it is the boundary of a displacement field.
  void SetBoundary(const MeshBoundary& boundary, bool isField);
  /// Finds the tetrahedra that BridgeMask leaves out, if anything changed that this depends on.
  /// Returns the boxes of cells whose tetrahedra have changed. set: see UpdateState.
  std::vector<Extent> UpdateBridges(MappingForm mapping, const cl::Buffer& tetrahedra,
    const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set);

  ///@{
  /// The links or runs were checked (CheckLinks, CheckRuns).
  void SetLinks(const VertexLink* links);
  void SetRuns(const VertexRuns& runs);
  ///@}
  /// Frees the links or the runs.
  void ForgetMesh();
  const VoxelGrid& GetVoxelGrid() const { return this->Shape; }
  int GetSize(int axis) const
  {
    return static_cast<int>(deformvolume::GetSize(this->Shape.VertexExtent, axis));
  }
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
      tetrahedra, numberOfNodes, this->AtBoundary.Tetrahedra);
  }
  /// The same of a field.
  BrickPoints MakeBrickPoints(const FieldParameters& field) const
  {
    return BrickPoints::FromField(this->Bricks.GetSubBricks(), field, this->AtBoundary.FieldPoints);
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
  OpenCLContext& Context;
  cl::CommandQueue Queue;
  VoxelGrid Shape;
  BrickGrid Bricks;
  bool HasRoomForCuts = true;
  std::vector<VolumeChunk> Chunks;
  VertexStates States;
  DeviceArrays Arrays;
  DeviceMasks Masks;
  cl::Buffer RestPositions;
  DeviceMapping Mapping;
  BoundaryDependencies AtBoundary;
  bool WithState = true;
};

} // namespace deformvolume

#endif
