// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceVolume.h"

#include "Error.h"
#include "FiveTetrahedra.h"
#include "KernelText.h"
#include "MappingProgram.h"
#include "ParallelFor.h"
#include "VertexRuns.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{

bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array)
{
  return array.Owner && CanWorkInPlace(context, array.Data, GetElementSize(array.Type));
}

std::vector<Tetrahedron> NameNodePlaces(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, const MeshOrder& order)
{
  std::vector<Tetrahedron> places(numberOfTetrahedra);
  ParallelForParts(numberOfTetrahedra, 1 << 16,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t t = begin; t < end; ++t)
      {
        std::transform(tetrahedra[t].begin(), tetrahedra[t].end(),
          places[MeshOrder::Get(order.Tetrahedra, t)].begin(),
          [&](std::int32_t node)
          { return DEFORMVOLUME_NODE_PLACES * MeshOrder::Get(order.Nodes, node); });
      }
    });
  return places;
}

DeviceVolume::DeviceVolume(OpenCLContext& context, const cl::CommandQueue& queue,
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, std::uint64_t allocationLimit,
  bool withLinks)
  : Context(context)
  , Queue(queue)
  , Shape(voxelGrid)
  , Bricks(voxelGrid)
  , AllocationLimit(allocationLimit)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  const std::uint64_t planeBytes =
    static_cast<std::uint64_t>(plane) * std::max(bytesPerVoxel, withLinks ? sizeof(VertexLink) : 0);
  const std::uint64_t planes = allocationLimit / planeBytes;
  const std::uint64_t neighbours = 3; // planes beyond the number of layers
  if (planes <= neighbours)
  {
    throw Error("A slice of the volume needs " + std::to_string(planeBytes) +
      " bytes, and the device gives no more than " + std::to_string(allocationLimit) +
      " bytes at once for several slices. Use a smaller volume or another device.");
  }
  const int layers = this->GetSize(2) - 1;
  const int step = static_cast<int>(
    std::min<std::uint64_t>(planes - neighbours, static_cast<std::uint64_t>(layers)));
  for (int begin = 0; begin < layers; begin += step)
  {
    VolumeChunk chunk;
    chunk.LayersBegin = begin;
    chunk.LayersEnd = std::min(begin + step, layers);
    chunk.PlanesBegin = std::max(begin - 1, 0);
    chunk.PlanesEnd = std::min(chunk.LayersEnd + 2, this->GetSize(2));
    this->Chunks.push_back(chunk);
  }
  this->RestPositions = this->MakeRestPositions();
}

cl::Buffer DeviceVolume::MakeRestPositions() const
{
  std::vector<RestPosition> positions;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = 0; i < this->GetSize(axis); ++i)
    {
      const double position =
        256.0 * this->Shape.Scale[axis] * (this->Shape.VertexExtent[2 * axis] + double(i));
      const double whole = std::floor(position);
      if (std::abs(whole) > 256.0 * (1 << 21))
      {
        throw Error("The output would have indices beyond 2^21. Use a coarser output spacing, or a "
                    "volume whose extent starts nearer to 0.");
      }
      positions.push_back(
        { static_cast<std::int32_t>(whole), static_cast<float>(position - whole) });
    }
  }
  return cl::Buffer(this->Context.GetContext(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
    positions.size() * sizeof(RestPosition), positions.data());
}

void DeviceVolume::CheckAllocation(std::uint64_t bytes) const
{
  if (bytes > this->AllocationLimit)
  {
    throw Error("An array of the volume needs " + std::to_string(bytes) +
      " bytes in one piece, and the device gives no more than " +
      std::to_string(this->AllocationLimit) + ".");
  }
}

cl::Buffer DeviceVolume::Send(const void* data, std::size_t bytesPerElement,
  std::int64_t elementsPerLayer, std::int64_t begin, std::int64_t end, const cl::Buffer& previous)
{
  const std::uint64_t layerBytes = static_cast<std::uint64_t>(elementsPerLayer) * bytesPerElement;
  const std::uint64_t bytes = layerBytes * static_cast<std::uint64_t>(end - begin);
  this->CheckAllocation(bytes);
  // No buffer is of no bytes.
  const std::uint64_t room = std::max<std::uint64_t>(bytes, bytesPerElement);
  cl::Buffer buffer = previous;
  if (deformvolume::GetMemory(buffer) != room)
  {
    buffer = cl::Buffer(this->Context.GetContext(), CL_MEM_READ_ONLY, room);
  }
  if (bytes > 0)
  {
    this->Queue.enqueueWriteBuffer(
      buffer, CL_FALSE, 0, bytes, static_cast<const char*>(data) + layerBytes * begin);
  }
  return buffer;
}

void DeviceVolume::LeaveArrays()
{
  if (this->ChunkInPlace)
  {
    this->Queue.finish();
    for (std::size_t i = 0; i < this->ArraysInPlace.size(); ++i)
    {
      if (this->IsInPlace(i))
      {
        this->ChunkInPlace->Arrays[i] = cl::Buffer();
        this->ArraysInPlace[i].Buffer = cl::Buffer();
      }
    }
    this->ChunkInPlace = nullptr;
  }
}

BufferInPlace DeviceVolume::FindOverlapping(const void* data, std::uint64_t bytes) const
{
  const auto found = std::find_if(this->ArraysInPlace.begin(), this->ArraysInPlace.end(),
    [&](const BufferInPlace& one) { return one.Overlaps(data, bytes); });
  return found != this->ArraysInPlace.end() ? *found : BufferInPlace();
}

void DeviceVolume::SetArrays(const std::vector<VolumeArray>& arrays, const BufferInPlace& field)
{
  const QueueGuard guard(this->Queue);
  this->LeaveArrays();
  this->ArraysInPlace.assign(arrays.size(), BufferInPlace());
  this->Arrays.clear(); // there are none if this fails
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  const bool whole = this->Chunks.size() == 1;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    const VolumeArray& array = arrays[i];
    const std::uint64_t bytes =
      static_cast<std::uint64_t>(plane * this->GetSize(2)) * GetTupleSize(array);
    const BufferInPlace other = this->FindOverlapping(array.Data, bytes);
    // The field lies in one piece.
    const bool free = other.Bytes == 0 || other.IsOver(array.Data, bytes);
    const bool freeOfField =
      !field.Overlaps(array.Data, bytes) || (whole && field.IsOver(array.Data, bytes));
    if (IsUsedInPlace(this->Context, array) && free && freeOfField)
    {
      this->ArraysInPlace[i].Data = array.Data;
      this->ArraysInPlace[i].Bytes = bytes;
    }
  }
  for (VolumeChunk& chunk : this->Chunks)
  {
    chunk.Arrays.resize(arrays.size());
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      chunk.Arrays[i] = this->IsInPlace(i)
        ? cl::Buffer()
        : this->Send(arrays[i].Data, GetTupleSize(arrays[i]), plane, chunk.PlanesBegin,
            chunk.PlanesEnd, chunk.Arrays[i]);
    }
  }
  if (whole)
  {
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      BufferInPlace& place = this->ArraysInPlace[i];
      place.Buffer = field.IsOver(place.Data, place.Bytes) ? field.Buffer : cl::Buffer();
    }
    this->GetArrays(this->Chunks.front());
  }
  this->Arrays = arrays;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    if (!this->IsInPlace(i))
    {
      this->Arrays[i].Owner.reset(); // the data were copied
    }
  }
}

bool DeviceVolume::SetArrayOptions(const std::vector<VolumeArray>& arrays)
{
  const bool alike =
    std::equal(arrays.begin(), arrays.end(), this->Arrays.begin(), this->Arrays.end(),
      [](const VolumeArray& a, const VolumeArray& b)
      { return a.Type == b.Type && a.Components == b.Components; });
  if (!alike)
  {
    throw Error("The options are those of other arrays than are set: call SetArrays first.");
  }
  bool changed = false;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    VolumeArray& set = this->Arrays[i];
    // Not-a-number never counts as the same.
    changed = changed || set.Categorical != arrays[i].Categorical ||
      !(set.Background == arrays[i].Background);
    set.Categorical = arrays[i].Categorical;
    set.Background = arrays[i].Background;
  }
  return changed;
}

void DeviceVolume::ReadArraysAgain() const
{
  // The buffers of several chunks are made whenever it is the chunk's turn.
  if (this->Chunks.size() == 1)
  {
    for (const BufferInPlace& place : this->ArraysInPlace)
    {
      TellOfWrites(this->Context, this->Queue, place);
    }
  }
}

const std::vector<cl::Buffer>& DeviceVolume::GetArrays(const VolumeChunk& chunk)
{
  if (&chunk == this->ChunkInPlace)
  {
    return chunk.Arrays;
  }
  this->LeaveArrays();
  VolumeChunk& placed = this->Chunks[static_cast<std::size_t>(&chunk - this->Chunks.data())];
  this->ChunkInPlace = &placed;
  for (std::size_t i = 0; i < this->ArraysInPlace.size(); ++i)
  {
    BufferInPlace& place = this->ArraysInPlace[i];
    if (place.Bytes == 0)
    {
      continue;
    }
    const auto same = std::find_if(this->ArraysInPlace.begin(), this->ArraysInPlace.end(),
      [&](const BufferInPlace& one) { return one.IsOver(place.Data, place.Bytes); });
    if (!same->Buffer())
    {
      const std::uint64_t bytesPerPlane =
        place.Bytes / static_cast<std::uint64_t>(this->GetSize(2));
      // The kernels only read it.
      same->Buffer = MakeBufferOver(this->Context, CL_MEM_READ_ONLY,
        static_cast<char*>(const_cast<void*>(place.Data)) +
          bytesPerPlane * static_cast<std::uint64_t>(chunk.PlanesBegin),
        bytesPerPlane * static_cast<std::uint64_t>(chunk.PlanesEnd - chunk.PlanesBegin));
    }
    place.Buffer = same->Buffer;
    placed.Arrays[i] = place.Buffer;
  }
  return chunk.Arrays;
}

void DeviceVolume::SendLinks(VolumeChunk& chunk, const VertexLink* links, const MeshOrder& order)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  const auto bytesOf = [&](std::int64_t planes)
  { return static_cast<std::uint64_t>(planes * plane) * sizeof(VertexLink); };
  this->CheckAllocation(bytesOf(chunk.PlanesEnd - chunk.PlanesBegin));
  Reserve(this->Context, chunk.Links, bytesOf(chunk.PlanesEnd - chunk.PlanesBegin));
  // Some planes after the others: a device with its own memory needs room for them on the host.
  constexpr std::int64_t linksAtOnce = 1 << 20;
  const std::int64_t step = std::max<std::int64_t>(1, linksAtOnce / plane);
  for (std::int64_t first = chunk.PlanesBegin; first < chunk.PlanesEnd; first += step)
  {
    const std::int64_t planes = std::min<std::int64_t>(step, chunk.PlanesEnd - first);
    auto* const sent = static_cast<VertexLink*>(this->Queue.enqueueMapBuffer(chunk.Links, CL_TRUE,
      CL_MAP_WRITE_INVALIDATE_REGION, bytesOf(first - chunk.PlanesBegin), bytesOf(planes)));
    ParallelForParts(static_cast<std::size_t>(planes * plane), 1 << 16,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t i = begin; i < end; ++i)
        {
          VertexLink link = links[first * plane + static_cast<std::int64_t>(i)];
          link.Tetrahedron =
            link.Tetrahedron < 0 ? -1 : MeshOrder::Get(order.Tetrahedra, link.Tetrahedron);
          sent[i] = link;
        }
      });
    this->Queue.enqueueUnmapMemObject(chunk.Links, sent);
    this->Queue.finish();
  }
}

void DeviceVolume::SetLinks(const VertexLink* links, const MeshOrder& order)
{
  this->SetNodePlaces({});
  const QueueGuard guard(this->Queue);
  this->ForgetRuns();
  this->WithLinks = false; // until all of them are there
  this->AllLinked = std::all_of(links, links + GetNumberOfPoints(this->Shape.VertexExtent),
    [](const VertexLink& link) { return link.Tetrahedron >= 0; });
  this->States.Forget();
  for (VolumeChunk& chunk : this->Chunks)
  {
    this->SendLinks(chunk, links, order);
  }
  this->WithLinks = true;
}

void DeviceVolume::ForgetRuns()
{
  for (VolumeChunk& chunk : this->Chunks)
  {
    chunk.Runs = cl::Buffer();
    chunk.RowBegins = cl::Buffer();
  }
  this->RestTetrahedra = cl::Buffer();
  this->RecordOwners = cl::Buffer();
  this->Records = cl::Buffer();
  this->RunBytes = 0;
}

void DeviceVolume::ForgetMesh()
{
  this->SetNodePlaces({});
  this->ForgetRuns();
  for (VolumeChunk& chunk : this->Chunks)
  {
    chunk.Links = cl::Buffer();
  }
  this->WithLinks = false;
  this->States.Forget();
}

void DeviceVolume::SetRuns(const VertexRuns& runs, const MeshOrder& order)
{
  static_assert(
    sizeof(VertexRun) == 8 && sizeof(TetrahedronRecord) == 64, "as the kernels have it");
  this->ForgetMesh();
  this->AllLinked = std::all_of(
    runs.Runs.begin(), runs.Runs.end(), [](const VertexRun& run) { return run.Tetrahedron >= 0; });
  const std::int64_t rows = this->GetSize(1);
  for (VolumeChunk& chunk : this->Chunks)
  {
    std::vector<std::uint32_t> begins;
    const QueueGuard guard(this->Queue);
    const auto first = runs.RowBegins.begin() + rows * chunk.PlanesBegin;
    const auto last = runs.RowBegins.begin() + rows * chunk.PlanesEnd;
    chunk.Runs = this->Send(runs.Runs.data(), sizeof(VertexRun), 1, *first, *last, chunk.Runs);
    begins.assign(first, last + 1);
    for (std::uint32_t& begin : begins)
    {
      begin -= *first;
    }
    chunk.RowBegins = this->Send(begins.data(), sizeof(std::uint32_t), 1, 0,
      static_cast<std::int64_t>(begins.size()), chunk.RowBegins);
  }
  this->SendRecords(runs.Tetrahedra, order);
  this->RunBytes = GetBytes(runs);
}

void DeviceVolume::SendRecords(
  const std::vector<RestTetrahedron>& tetrahedra, const MeshOrder& order)
{
  std::vector<double> values;
  std::vector<std::int32_t> owners;
  values.reserve(15 * tetrahedra.size());
  owners.reserve(tetrahedra.size());
  for (const RestTetrahedron& tetrahedron : tetrahedra)
  {
    values.insert(values.end(), tetrahedron.Origin.begin(), tetrahedron.Origin.end());
    values.insert(values.end(), tetrahedron.Weights.begin(), tetrahedron.Weights.end());
    for (const auto& gradient : tetrahedron.Gradients)
    {
      values.insert(values.end(), gradient.begin(), gradient.end());
    }
    owners.push_back(MeshOrder::Get(order.Tetrahedra, tetrahedron.Tetrahedron));
  }
  const auto size = static_cast<std::int64_t>(tetrahedra.size());
  std::vector<float> rounded;
  const QueueGuard guard(this->Queue);
  if (HasDouble(this->Context))
  {
    this->RestTetrahedra =
      this->Send(values.data(), 15 * sizeof(double), 1, 0, size, this->RestTetrahedra);
  }
  else
  {
    rounded.assign(values.begin(), values.end());
    this->RestTetrahedra =
      this->Send(rounded.data(), 15 * sizeof(float), 1, 0, size, this->RestTetrahedra);
  }
  this->RecordOwners =
    this->Send(owners.data(), sizeof(std::int32_t), 1, 0, size, this->RecordOwners);
  this->Records = cl::Buffer(this->Context.GetContext(), CL_MEM_READ_WRITE,
    (tetrahedra.size() + 1) * sizeof(TetrahedronRecord));
  this->NumberOfRecords = static_cast<cl_uint>(size);
  this->RecordsChanged = true;
}

cl::Event DeviceVolume::EvaluateTetrahedra(
  const cl::Program& mapping, const cl::Buffer& tetrahedra, const cl::Buffer& nodes)
{
  cl::Kernel kernel(mapping, "EvaluateTetrahedra");
  kernel.setArg(0, this->RestTetrahedra);
  kernel.setArg(1, this->RecordOwners);
  kernel.setArg(2, tetrahedra);
  kernel.setArg(3, nodes);
  kernel.setArg(4, this->Records);
  kernel.setArg(5, this->NumberOfRecords);
  constexpr std::size_t group = 64;
  const std::size_t items = (this->NumberOfRecords + group) / group * group;
  this->RecordsChanged = false;
  return this->Context.Launch(this->Queue, kernel, cl::NDRange(items), cl::NDRange(group));
}

std::vector<Extent> DeviceVolume::SetBlanked(
  const unsigned char* blanked, unsigned char bits, const PointRanges* written)
{
  std::vector<Extent> changes = this->Blanked.Set(
    this->Context, this->Queue, this->Bricks.Size, this->Chunks, blanked, bits, written);
  this->States.ChangeSources(changes);
  return changes;
}

std::vector<Extent> DeviceVolume::SetActive(const unsigned char* active, const PointRanges* written)
{
  std::vector<Extent> changes = this->Active.Set(this->Context, this->Queue, this->Bricks.Size,
    this->Chunks, active, DEFORMVOLUME_ALL_TETRAHEDRA, written);
  if (this->Bridges.IsOn())
  {
    this->Bridges.ChangeCells(changes);
    return {};
  }
  this->States.ChangeCells(changes);
  return changes;
}

std::vector<Extent> DeviceVolume::SetBoundaryDistances(
  const float* distances, const PointRanges* written)
{
  std::vector<Extent> changes = this->Distances.Set(this->Context, this->Queue, this->Bricks.Size,
    this->Chunks, reinterpret_cast<const unsigned char*>(distances), 255, written);
  this->States.ChangeSources(changes);
  return changes;
}

void DeviceVolume::SetNodePlaces(const std::vector<std::int32_t>& places)
{
  this->Queue.finish(); // nothing uses what is let go
  const bool wasOn = this->Bridges.IsOn();
  this->Bridges.SetPlaces(this->Context, this->Queue, places);
  if (wasOn != this->Bridges.IsOn())
  {
    this->States.Forget();
    for (VolumeChunk& chunk : this->Chunks)
    {
      chunk.Joined = cl::Buffer();
    }
  }
}

std::vector<Extent> DeviceVolume::UpdateBridges(MappingForm mapping, const cl::Buffer& tetrahedra,
  const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set)
{
  std::vector<Extent> changes;
  if (this->Bridges.IsCurrent())
  {
    return changes;
  }
  const cl::Program program = GetBridgeProgram(this->Context, mapping);
  for (VolumeChunk& chunk : this->Chunks)
  {
    // Any buffer stands in for a missing one.
    this->Bridges.Update(this->Context, this->Queue, this->GetParameters(chunk), chunk,
      { program, [&](cl::Kernel& kernel) { return set(kernel, chunk); },
        this->HasRuns() ? this->RecordOwners : this->RestPositions, tetrahedra,
        this->Active.HasBuffers() ? chunk.Active : this->RestPositions, this->Active.HasBuffers() },
      changes);
  }
  this->Bridges.Finish();
  this->States.ChangeCells(changes);
  return changes;
}

KernelParameters DeviceVolume::GetParameters(const VolumeChunk& chunk) const
{
  KernelParameters p = {};
  for (int axis = 0; axis < 3; ++axis)
  {
    p.Size[axis] = this->GetSize(axis);
    p.First[axis] = this->Shape.VertexExtent[2 * axis];
    p.BrickOrigin[axis] = this->Bricks.Origin[axis];
    p.BrickCount[axis] = this->Bricks.Count[axis];
  }
  p.ChunkFirst = chunk.PlanesBegin;
  p.SlabFirst = chunk.PlanesBegin;
  p.PlanesBegin = chunk.PlanesBegin;
  p.PlanesEnd = chunk.PlanesEnd;
  p.LayersBegin = chunk.LayersBegin;
  p.LayersEnd = chunk.LayersEnd;
  p.HasActive = this->HasActive();
  p.HasDistances = this->HasDistances();
  p.HasState = this->WithState;
  return p;
}

BrickPoints DeviceVolume::MakeBrickPoints(
  const cl::Buffer& tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes) const
{
  const VolumeChunk& chunk = this->Chunks.front();
  const MappedBuffer<const Tetrahedron> places(this->Queue, tetrahedra, CL_MAP_READ);
  if (!this->HasRuns())
  {
    const MappedBuffer<const VertexLink> links(this->Queue, chunk.Links, CL_MAP_READ);
    return BrickPoints::FromLinks(
      this->Bricks.GetSubBricks(), links.Get(), places.Get(), numberOfTetrahedra, numberOfNodes);
  }
  const MappedBuffer<const VertexRun> runs(this->Queue, chunk.Runs, CL_MAP_READ);
  const MappedBuffer<const std::uint32_t> begins(this->Queue, chunk.RowBegins, CL_MAP_READ);
  const MappedBuffer<const std::int32_t> owners(this->Queue, this->RecordOwners, CL_MAP_READ);
  std::vector<double> rest(15 * std::size_t{ this->NumberOfRecords });
  if (HasDouble(this->Context))
  {
    const MappedBuffer<const double> records(this->Queue, this->RestTetrahedra, CL_MAP_READ);
    std::copy_n(records.Get(), rest.size(), rest.begin());
  }
  else
  {
    const MappedBuffer<const float> records(this->Queue, this->RestTetrahedra, CL_MAP_READ);
    std::copy_n(records.Get(), rest.size(), rest.begin());
  }
  return BrickPoints::FromRuns(this->Bricks.GetSubBricks(), runs.Get(), begins.Get(), rest.data(),
    owners.Get(), places.Get(), numberOfTetrahedra, numberOfNodes);
}

cl::NDRange DeviceVolume::GetVertexRange(int planes) const
{
  const std::size_t group = this->GetVertexGroup()[0];
  const std::size_t row = static_cast<std::size_t>(this->GetSize(0));
  const std::size_t items = group == 1 ? 1 : (row + group - 1) / group * group;
  return cl::NDRange(
    items, static_cast<std::size_t>(this->GetSize(1)), static_cast<std::size_t>(planes));
}

cl::NDRange DeviceVolume::GetVertexGroup() const
{
  // On a processor one work-item takes a whole row.
  return cl::NDRange(this->Context.GetDevice().HasVectors ? 1 : 64, 1, 1);
}

void DeviceVolume::UpdateState(const cl::Program& mapping, bool movesAll,
  const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set)
{
  if (this->States.AreCurrent())
  {
    return;
  }
  this->WithState = this->HasBlanked() || this->HasActive() || this->HasDistances() ||
    !(this->HasMesh() ? this->AllLinked : movesAll);
  if (!this->WithState)
  {
    this->States.Release(this->Chunks);
    return;
  }
  for (VolumeChunk& chunk : this->Chunks)
  {
    this->States.Update(this->Context, this->Queue, this->GetParameters(chunk), chunk,
      { mapping, [&](cl::Kernel& kernel) { return set(kernel, chunk); },
        // A null pointer is not something that all drivers take: any buffer stands in for a missing
        // one.
        this->HasBlanked() ? chunk.Blanked : this->RestPositions, this->HasBlanked(),
        this->GetActive(chunk), this->GetDistances(chunk) });
  }
  this->States.Finish();
}

std::uint64_t DeviceVolume::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->RestPositions) +
    deformvolume::GetMemory(this->RestTetrahedra) + deformvolume::GetMemory(this->RecordOwners) +
    deformvolume::GetMemory(this->Records);
  for (const VolumeChunk& chunk : this->Chunks)
  {
    bytes += deformvolume::GetMemory(chunk.Joined) + deformvolume::GetMemory(chunk.Links) +
      deformvolume::GetMemory(chunk.Runs) + deformvolume::GetMemory(chunk.RowBegins) +
      deformvolume::GetMemory(chunk.State) + deformvolume::GetMemory(chunk.Blanked) +
      deformvolume::GetMemory(chunk.Active) + deformvolume::GetMemory(chunk.Distances);
    for (const cl::Buffer& array : chunk.Arrays)
    {
      bytes += deformvolume::GetMemory(array);
    }
  }
  return bytes;
}

} // namespace deformvolume
