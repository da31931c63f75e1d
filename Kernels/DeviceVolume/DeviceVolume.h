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

#include <utility>

namespace deformvolume
{

///@{
/// Converts tetrahedra to those on the device: multiplies node numbers by DEFORMVOLUME_NODE_STRIDE.
Tetrahedron GetNodeOffsets(const Tetrahedron& tetrahedron);
std::vector<Tetrahedron> GetNodeOffsets(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra);
///@}

/// The sampling mesh on the device: the arrays of the volume, the states of vertices, the static
/// mapping (links or runs), and the masks of vertices and cells.
class DeviceVolume
{
public:
  DeviceVolume(OpenCLContext& context, const cl::CommandQueue& queue, const VoxelGrid& voxelGrid,
    std::size_t bytesPerVoxel, std::uint64_t allocationLimit, bool withLinks = true);

  /// Not copyable: Masks and Arrays refer to other members.
  DeviceVolume(const DeviceVolume&) = delete;
  DeviceVolume& operator=(const DeviceVolume&) = delete;

  ///@{
  /// The arrays of the volume.
  DeviceArrays& GetArrays() { return this->Arrays; }
  const DeviceArrays& GetArrays() const { return this->Arrays; }
  ///@}
  ///@{
  /// The masks of the volume. Set smooth cuts and boundaries by SetCut() and SetBoundary() below.
  DeviceMasks& GetMasks() { return this->Masks; }
  const DeviceMasks& GetMasks() const { return this->Masks; }
  ///@}
  /// Set a smooth cut (DeviceMasks::SetCut()). Throws Error if the device has no room for it.
  std::vector<Extent> SetCut(const unsigned char* crossed, const float* distances);
  /// Excludes the cells that the boundary of the deformation mesh crosses (DeviceMasks), and finds
  /// the tetrahedra or points of the field that move them. isField: whether it is the boundary of a
  /// displacement field.
  void SetBoundary(const MeshBoundary& boundary, bool isField);
  /// Updates ResampledMask, if anything on which it depends has changed. Returns the boxes of cells
  /// whose mask has changed.
  std::vector<Extent> UpdateResampledMask(
    MappingKind mapping, const cl::Buffer& tetrahedra, const MappingSetter& set);

  ///@{
  /// Set the static mapping. The links or runs must have been checked (CheckLinks(), CheckRuns()).
  void SetLinks(const VertexLink* links);
  void SetRuns(const VertexRuns& runs);
  ///@}
  /// Frees the links or the runs.
  void ForgetMesh();
  const VoxelGrid& GetVoxelGrid() const { return this->Grid; }
  int GetSize(int axis) const
  {
    return static_cast<int>(deformvolume::GetSize(this->Grid.VertexExtent, axis));
  }
  bool HasMesh() const { return this->Mapping.HasLinks() || this->Mapping.HasRuns(); }
  bool HasRuns() const { return this->Mapping.HasRuns(); }
  /// Bytes of the runs (GetRunBytes() in VertexRuns.h). 0 without runs.
  std::uint64_t GetRunBytes() const { return this->Mapping.GetRunBytes(); }
  const std::vector<VolumeChunk>& GetChunks() const { return this->Chunks; }

  /// Whether the axes of the volume are not those of the output (HAS_TURNED_AXES in programs).
  bool HasTurnedAxes() const { return !this->Grid.ToOutput.IsDiagonal(); }
  /// The undeformed position for each index on x, then y, then z (RestPosition or RestVector in
  /// KernelParameters.h).
  const cl::Buffer& GetRestPositions() const { return this->RestPositions; }

  /// The records of runs.
  TetrahedronRecords& GetRecords() { return this->Mapping.GetRecords(); }

  const BrickGrid& GetBricks() const { return this->Bricks; }
  /// Finds the points that move each sub-brick, for a mesh. The volume must be one chunk. A device
  /// with memory of its own copies the static mapping to the host. See DeviceMapping.
  BrickPoints MakeBrickPoints(const cl::Buffer& tetrahedra, std::size_t numberOfNodes) const
  {
    return this->Mapping.MakeBrickPoints(this->Chunks.front(), this->Bricks.GetSubBricks(),
      tetrahedra, numberOfNodes, this->AtBoundary.Tetrahedra);
  }
  /// Finds the points that move each sub-brick, for a field.
  BrickPoints MakeBrickPoints(const FieldParameters& field) const
  {
    return BrickPoints::FromField(this->Bricks.GetSubBricks(), field, this->AtBoundary.FieldPoints);
  }

  /// Updates the states of the vertices, if anything on which they depend has changed. If the
  /// deformation moves all voxels and there is no mask and no cut, no states are stored. mapping:
  /// the program of the deformation mapping. movesAll: whether a field moves all voxels; not used
  /// for meshes.
  void UpdateState(const cl::Program& mapping, bool movesAll, const MappingSetter& set);
  /// Computes the positions of the copies of vertices at a smooth cut. Call it after UpdateState(),
  /// each time that the mapping has changed. bricks: the bricks in which positions have changed
  /// (DEFORMVOLUME_BRICK_BITS); null: all.
  void UpdateCut(
    const cl::Program& mapping, const std::vector<cl_uint>* bricks, const MappingSetter& set);
  void InvalidateState() { this->States.Invalidate(); }
  /// Returns the parameters of a launch over a whole chunk.
  KernelParameters GetParameters(const VolumeChunk& chunk) const;

  std::uint64_t GetMemory() const;

private:
  OpenCLContext& Context;
  cl::CommandQueue Queue;
  std::uint64_t AllocationLimit;
  VoxelGrid Grid;
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
