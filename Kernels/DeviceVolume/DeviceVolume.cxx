// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceVolume.h"

#include "Error.h"
#include "MappingProgram.h"
#include "ParallelFor.h"
#include "RestPositions.h"

#include <algorithm>
#include <string>

namespace deformvolume
{

Tetrahedron GetNodeOffsets(const Tetrahedron& tetrahedron)
{
  Tetrahedron offsets = tetrahedron;
  for (std::int32_t& node : offsets)
  {
    node *= DEFORMVOLUME_NODE_STRIDE;
  }
  return offsets;
}

std::vector<Tetrahedron> GetNodeOffsets(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra)
{
  std::vector<Tetrahedron> offsets(numberOfTetrahedra);
  ParallelForItems(numberOfTetrahedra, 1 << 16,
    [&](std::size_t t) { offsets[t] = GetNodeOffsets(tetrahedra[t]); });
  return offsets;
}

DeviceVolume::DeviceVolume(OpenCLContext& context, const cl::CommandQueue& queue,
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, std::uint64_t allocationLimit,
  bool withLinks)
  : Context(context)
  , Queue(queue)
  , AllocationLimit(allocationLimit)
  , Grid(voxelGrid)
  , Bricks(voxelGrid)
  , Arrays(context, queue, this->Bricks.Size, allocationLimit, this->Chunks)
  , Masks(context, queue, this->Grid, allocationLimit, this->Bricks, this->Chunks, this->States)
  , Mapping(context, queue, this->Bricks.Size, allocationLimit)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  const std::uint64_t planeBytes =
    static_cast<std::uint64_t>(plane) * std::max(bytesPerVoxel, withLinks ? sizeof(VertexLink) : 0);
  const std::uint64_t planes = allocationLimit / planeBytes;
  // A smooth cut needs the vertices up to two voxels away. Smooth cuts are not possible if the
  // planes of these vertices do not fit into an allocation.
  this->HasRoomForCuts = planes > 5;
  const std::uint64_t neighbors = this->HasRoomForCuts ? 5 : 3; // planes in addition to the layers
  if (planes <= neighbors)
  {
    throw Error("A slice of the volume needs " + std::to_string(planeBytes) + " bytes, and " +
      std::to_string(neighbors + 1) +
      " slices must fit into one allocation, but the device allows at most " +
      std::to_string(allocationLimit) + " bytes. Use a smaller volume or another device.");
  }
  const int beyond = this->HasRoomForCuts ? 2 : 1;
  const int layers = this->GetSize(2) - 1;
  const int step = static_cast<int>(
    std::min<std::uint64_t>(planes - neighbors, static_cast<std::uint64_t>(layers)));
  for (int begin = 0; begin < layers; begin += step)
  {
    VolumeChunk chunk;
    chunk.LayersBegin = begin;
    chunk.LayersEnd = std::min(begin + step, layers);
    chunk.PlanesBegin = std::max(begin - beyond, 0);
    chunk.PlanesEnd = std::min(chunk.LayersEnd + 1 + beyond, this->GetSize(2));
    this->Chunks.push_back(chunk);
  }
  this->RestPositions = MakeRestPositions(context, voxelGrid);
}

void DeviceVolume::SetLinks(const VertexLink* links)
{
  this->ForgetMesh();
  this->Mapping.SetLinks(this->Chunks, links);
}

void DeviceVolume::ForgetMesh()
{
  this->Masks.SetCoincidentNodes({});
  this->SetBoundary({}, false);
  this->Mapping.Forget(this->Chunks);
  this->States.Invalidate();
}

void DeviceVolume::SetRuns(const VertexRuns& runs)
{
  this->ForgetMesh();
  this->Mapping.SetRuns(this->Chunks, runs);
}

std::vector<Extent> DeviceVolume::SetCut(const unsigned char* crossed, const float* distances)
{
  if (crossed && !this->HasRoomForCuts && this->Chunks.size() > 1)
  {
    throw Error("A smooth cut needs six slices of the volume in one allocation, but the device "
                "allows at most " +
      std::to_string(this->AllocationLimit) + " bytes. Use a smaller volume or another device.");
  }
  return this->Masks.SetCut(crossed, distances);
}

void DeviceVolume::SetBoundary(const MeshBoundary& boundary, bool isField)
{
  this->Masks.SetBoundary(boundary);
  this->AtBoundary = FindBoundaryDependencies(
    boundary, isField, this->Grid.VertexExtent, this->Bricks.GetSubBricks());
}

std::vector<Extent> DeviceVolume::UpdateResampledMask(
  MappingKind mapping, const cl::Buffer& tetrahedra, const MappingSetter& set)
{
  ResampledMask& mask = this->Masks.GetResampledMask();
  std::vector<Extent> changes;
  if (mask.IsCurrent())
  {
    return changes;
  }
  const DeviceCut& cut = this->Masks.GetCut();
  const cl::Program program =
    GetResampledMaskProgram(this->Context, mapping, cut.IsOn(), this->HasTurnedAxes());
  for (VolumeChunk& chunk : this->Chunks)
  {
    mask.Update(this->Context, this->Queue, this->GetParameters(chunk), chunk,
      { program, set, this->Mapping.GetRecords().GetOwners(), tetrahedra, cut }, changes);
  }
  mask.Finish();
  this->States.ChangeCells(changes);
  return changes;
}

KernelParameters DeviceVolume::GetParameters(const VolumeChunk& chunk) const
{
  KernelParameters p = {};
  for (int axis = 0; axis < 3; ++axis)
  {
    p.Size[axis] = this->GetSize(axis);
    p.First[axis] = this->Grid.VertexExtent[2 * axis];
    p.BrickOrigin[axis] = this->Bricks.Origin[axis];
    p.BrickCount[axis] = this->Bricks.Count[axis];
  }
  p.IsMirrored = this->Grid.ToOutput.GetDeterminant() < 0.0;
  p.ChunkFirst = chunk.PlanesBegin;
  p.PlanesBegin = chunk.PlanesBegin;
  p.PlanesEnd = chunk.PlanesEnd;
  p.LayersBegin = chunk.LayersBegin;
  p.LayersEnd = chunk.LayersEnd;
  p.HasActive = this->Masks.HasActive();
  p.HasDistances = this->Masks.HasDistances();
  p.HasState = this->WithState;
  return p;
}

void DeviceVolume::UpdateState(const cl::Program& mapping, bool movesAll, const MappingSetter& set)
{
  if (this->States.IsCurrent())
  {
    return;
  }
  DeviceCut& cut = this->Masks.GetCut();
  if (cut.IsOn())
  {
    this->States.Report(cut); // before the update, which may fail after some chunks
  }
  this->WithState = this->Masks.HasAny() || cut.IsOn() ||
    !(this->HasMesh() ? this->Mapping.AreAllLinked() : movesAll);
  if (!this->WithState)
  {
    this->States.Release(this->Chunks);
    return;
  }
  for (VolumeChunk& chunk : this->Chunks)
  {
    this->States.Update(this->Context, this->Queue, this->GetParameters(chunk), chunk,
      { mapping, set, this->Masks.GetActive(chunk), cut });
  }
  this->States.Finish();
}

void DeviceVolume::UpdateCut(
  const cl::Program& mapping, const std::vector<cl_uint>* bricks, const MappingSetter& set)
{
  DeviceCut& cut = this->Masks.GetCut();
  if (!cut.IsOn())
  {
    return;
  }
  std::vector<Extent> moved;
  for (std::size_t i = 0; bricks && i < bricks->size(); ++i)
  {
    const cl_uint brick = (*bricks)[i] & ((1U << DEFORMVOLUME_BRICK_BITS) - 1);
    moved.push_back(this->Bricks.GetVertices(brick, 0));
  }
  for (const VolumeChunk& chunk : this->Chunks)
  {
    cut.Update(this->Context, this->Queue, this->GetParameters(chunk), chunk, mapping, set,
      this->Masks.GetActive(chunk), bricks ? &moved : nullptr);
  }
  cut.Finish();
}

std::uint64_t DeviceVolume::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->RestPositions) +
    this->Mapping.GetRecords().GetMemory() + this->Masks.GetCut().GetMemory();
  for (const VolumeChunk& chunk : this->Chunks)
  {
    bytes += deformvolume::GetMemory(chunk.Boundary, chunk.ResampledTetrahedra, chunk.Links,
      chunk.Runs, chunk.RowRanges, chunk.State, chunk.Blanked, chunk.Active, chunk.Distances);
    for (const cl::Buffer& array : chunk.Arrays)
    {
      bytes += deformvolume::GetMemory(array);
    }
  }
  return bytes;
}

} // namespace deformvolume
