// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceVolume.h"

#include "Error.h"
#include "FiveTetrahedra.h"
#include "IndexBounds.h"
#include "KernelText.h"
#include "MappingProgram.h"
#include "ParallelFor.h"
#include "VertexRuns.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{

namespace
{

template <typename Entry>
cl::Buffer MakeBuffer(const OpenCLContext& context, std::vector<Entry> entries)
{
  return cl::Buffer(context.GetContext(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
    entries.size() * sizeof(Entry), entries.data());
}

/// For each index on x, then y, then z.
std::vector<RestVector> MakeRestVectors(const VoxelGrid& grid, const OutputTransform& transform)
{
  // In 2^-16 voxel, as they are in the whole volume.
  const auto getPart = [&](int axis, int index)
  {
    glm::dvec3 part = transform.GetMatrix()[axis] * static_cast<double>(index);
    part += axis == 0 ? transform.GetShift() : glm::dvec3(0.0);
    return glm::i64vec3(glm::round(65536.0 * part));
  };
  const auto getWhole = [](std::int64_t part) { return (part - (part & 255)) / 256; };
  const Extent& extent = grid.VertexExtent;
  std::vector<RestVector> vectors;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int index = extent[2 * axis]; index <= extent[2 * axis + 1]; ++index)
    {
      RestVector vector;
      for (int row = 0; row < 3; ++row)
      {
        const std::int64_t part = getPart(axis, index)[row];
        std::int64_t whole = getWhole(part);
        if (axis == 0)
        {
          whole += getWhole(getPart(1, extent[2])[row]) + getWhole(getPart(2, extent[4])[row]);
        }
        else
        {
          whole -= getWhole(getPart(axis, extent[2 * axis])[row]);
        }
        vector.Whole[row] = static_cast<std::int32_t>(whole);
        vector.Fraction[row] = static_cast<float>(part & 255) / 256.0F;
      }
      vectors.push_back(vector);
    }
  }
  return vectors;
}

} // namespace

bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array)
{
  return array.Owner && CanWorkInPlace(context, array.Data, GetElementSize(array.Type));
}

Tetrahedron NameNodePlaces(const Tetrahedron& tetrahedron)
{
  Tetrahedron places = tetrahedron;
  for (std::int32_t& node : places)
  {
    node *= DEFORMVOLUME_NODE_PLACES;
  }
  return places;
}

std::vector<Tetrahedron> NameNodePlaces(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra)
{
  std::vector<Tetrahedron> places(numberOfTetrahedra);
  ParallelForParts(numberOfTetrahedra, 1 << 16,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t t = begin; t < end; ++t)
      {
        places[t] = NameNodePlaces(tetrahedra[t]);
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
  , Mapping(context, queue, this->Bricks.Size, allocationLimit)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  const std::uint64_t planeBytes =
    static_cast<std::uint64_t>(plane) * std::max(bytesPerVoxel, withLinks ? sizeof(VertexLink) : 0);
  const std::uint64_t planes = allocationLimit / planeBytes;
  // A smooth cut looks at the vertices up to two voxels away. Devices without room for that have no
  // smooth cuts.
  this->HasRoomForCuts = planes > 5;
  const std::uint64_t neighbours = this->HasRoomForCuts ? 5 : 3; // planes beyond the layers
  if (planes <= neighbours)
  {
    throw Error("A slice of the volume needs " + std::to_string(planeBytes) +
      " bytes, and the device gives no more than " + std::to_string(allocationLimit) +
      " bytes at once for several slices. Use a smaller volume or another device.");
  }
  const int beyond = this->HasRoomForCuts ? 2 : 1;
  const int layers = this->GetSize(2) - 1;
  const int step = static_cast<int>(
    std::min<std::uint64_t>(planes - neighbours, static_cast<std::uint64_t>(layers)));
  for (int begin = 0; begin < layers; begin += step)
  {
    VolumeChunk chunk;
    chunk.LayersBegin = begin;
    chunk.LayersEnd = std::min(begin + step, layers);
    chunk.PlanesBegin = std::max(begin - beyond, 0);
    chunk.PlanesEnd = std::min(chunk.LayersEnd + 1 + beyond, this->GetSize(2));
    this->Chunks.push_back(chunk);
  }
  this->RestPositions = this->MakeRestPositions();
}

cl::Buffer DeviceVolume::MakeRestPositions() const
{
  const OutputTransform transform = GetOutputTransform(this->Shape);
  const IndexBounds bounds = transform.ToOutput(GetBox(this->Shape));
  for (int axis = 0; axis < 3; ++axis)
  {
    if (!(std::abs(bounds.Min[axis]) <= MostOutputIndex &&
          std::abs(bounds.Max[axis]) <= MostOutputIndex))
    {
      throw Error("The output would have indices beyond 2^21. Use a coarser output spacing, or a "
                  "volume whose extent starts nearer to 0.");
    }
  }
  if (this->HasTurnedAxes())
  {
    return MakeBuffer(this->Context, MakeRestVectors(this->Shape, transform));
  }
  std::vector<RestPosition> positions;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = 0; i < this->GetSize(axis); ++i)
    {
      const double position = 256.0 * transform.GetMatrix()[axis][axis] *
          (this->Shape.VertexExtent[2 * axis] + double(i)) +
        256.0 * transform.GetShift()[axis];
      const double whole = std::floor(position);
      positions.push_back(
        { static_cast<std::int32_t>(whole), static_cast<float>(position - whole) });
    }
  }
  return MakeBuffer(this->Context, positions);
}

cl::Buffer DeviceVolume::Send(const void* data, std::size_t bytesPerElement,
  std::int64_t elementsPerLayer, std::int64_t begin, std::int64_t end, const cl::Buffer& previous)
{
  const std::uint64_t layerBytes = static_cast<std::uint64_t>(elementsPerLayer) * bytesPerElement;
  const std::uint64_t bytes = layerBytes * static_cast<std::uint64_t>(end - begin);
  CheckAllocation(bytes, this->AllocationLimit);
  // No buffer is of no bytes.
  const std::uint64_t room = std::max<std::uint64_t>(bytes, bytesPerElement);
  cl::Buffer buffer = previous;
  if (deformvolume::GetMemory(buffer) != room)
  {
    buffer = cl::Buffer(this->Context.GetContext(), CL_MEM_READ_ONLY, room);
  }
  if (bytes > 0)
  {
    Write(this->Queue, buffer, 0, bytes,
      static_cast<const char*>(data) + layerBytes * static_cast<std::uint64_t>(begin));
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

void DeviceVolume::SetLinks(const VertexLink* links)
{
  this->SetNodePlaces({});
  this->SetBoundary({}, false);
  const QueueGuard guard(this->Queue);
  this->States.Forget();
  this->Mapping.SetLinks(this->Chunks, links);
}

void DeviceVolume::ForgetMesh()
{
  this->SetNodePlaces({});
  this->SetBoundary({}, false);
  this->Mapping.Forget(this->Chunks);
  this->States.Forget();
}

void DeviceVolume::SetRuns(const VertexRuns& runs)
{
  this->ForgetMesh();
  this->Mapping.SetRuns(this->Chunks, runs);
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
    // In cells that the boundary crosses the mask is looked at otherwise (BoundaryCells).
    return this->HasBoundary() ? changes : std::vector<Extent>();
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

std::vector<Extent> DeviceVolume::SetCut(const unsigned char* crossed, const float* distances)
{
  if (crossed && this->Chunks.size() > 1 && !this->HasRoomForCuts)
  {
    throw Error("A smooth cut needs room for more than five slices of the volume at once, and the "
                "device gives no more than " +
      std::to_string(this->AllocationLimit) + " bytes. Use a smaller volume or another device.");
  }
  std::vector<Extent> changes =
    this->Cut.Set(this->Context, this->Queue, this->Shape, crossed, distances);
  if (this->HasCut())
  {
    this->Bricks.Halo = BrickGrid::HaloOfCuts; // from now on, as another cut may follow
  }
  this->States.ChangeSources(changes);
  this->Bridges.ChangeVertices(changes);
  return changes;
}

cl_uint DeviceVolume::SetCutArguments(cl::Kernel& kernel, cl_uint argument) const
{
  kernel.setArg(argument++, this->Cut.GetRows());
  kernel.setArg(argument++, this->Cut.GetVertices());
  kernel.setArg(argument++, this->Cut.GetPositions());
  return argument;
}

void DeviceVolume::SetNodePlaces(const std::vector<std::int32_t>& places)
{
  this->Queue.finish(); // nothing uses what is let go
  const bool had = this->Bridges.HasPlaces();
  this->Bridges.SetPlaces(this->Context, this->Queue, places);
  if (had != this->Bridges.HasPlaces())
  {
    this->States.Forget();
    for (VolumeChunk& chunk : this->Chunks)
    {
      chunk.Joined = cl::Buffer();
    }
  }
}

void DeviceVolume::SetBoundary(const MeshBoundary& boundary, bool isField)
{
  if (boundary.IsEmpty() && !this->HasBoundary())
  {
    return;
  }
  this->Queue.finish(); // nothing uses what is let go
  this->States.Forget();
  this->Bridges.SetBoundary(!boundary.IsEmpty());
  const std::int64_t layer =
    static_cast<std::int64_t>(this->GetSize(0) - 1) * (this->GetSize(1) - 1);
  for (VolumeChunk& chunk : this->Chunks)
  {
    chunk.Joined = chunk.Boundary = cl::Buffer();
    if (boundary.IsEmpty())
    {
      continue;
    }
    std::vector<unsigned char> cells(
      static_cast<std::size_t>(layer * (chunk.PlanesEnd - chunk.PlanesBegin - 1)),
      DEFORMVOLUME_ALL_TETRAHEDRA);
    const std::int64_t first = layer * chunk.PlanesBegin;
    const auto mark = [&](const std::vector<std::int64_t>& numbers, unsigned char value)
    {
      const auto begin = std::lower_bound(numbers.begin(), numbers.end(), first);
      const auto end =
        std::lower_bound(begin, numbers.end(), first + static_cast<std::int64_t>(cells.size()));
      std::for_each(begin, end,
        [&](std::int64_t number) { cells[static_cast<std::size_t>(number - first)] = value; });
    };
    mark(boundary.Near, DEFORMVOLUME_ALL_TETRAHEDRA | DEFORMVOLUME_CELL_AT_BOUNDARY);
    mark(boundary.Crossed, DEFORMVOLUME_CELL_AT_BOUNDARY | DEFORMVOLUME_CELL_CROSSED);
    chunk.Boundary =
      this->Send(cells.data(), 1, layer, 0, chunk.PlanesEnd - chunk.PlanesBegin - 1, cl::Buffer());
    this->Queue.finish();
  }
  this->ListBoundary(boundary, isField);
}

void DeviceVolume::ListBoundary(const MeshBoundary& boundary, bool isField)
{
  this->TetrahedraAtBoundary.clear();
  this->FieldPointsAtBoundary.clear();
  if (boundary.IsEmpty())
  {
    return;
  }
  const BrickGrid grid = this->Bricks.GetSubBricks();
  const auto getPlace = [&](int axis, double cell)
  {
    return std::clamp(
      (static_cast<int>(std::clamp(cell, 0.0, this->GetSize(axis) - 2.0)) - grid.Origin[axis]) /
        grid.Cells[axis],
      0, grid.Count[axis] - 1);
  };
  const auto getNumber = [&](int x, int y, int z)
  {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(grid.Count[1]) +
             static_cast<std::size_t>(y)) *
      static_cast<std::size_t>(grid.Count[0]) +
      static_cast<std::size_t>(x);
  };
  std::vector<unsigned char> isNear(grid.GetNumberOfBricks());
  for (const std::int64_t cell : boundary.Near)
  {
    const std::int64_t size[2] = { this->GetSize(0) - 1, this->GetSize(1) - 1 };
    isNear[getNumber(getPlace(0, static_cast<double>(cell % size[0])),
      getPlace(1, static_cast<double>(cell / size[0] % size[1])),
      getPlace(2, static_cast<double>(cell / size[0] / size[1])))] = 1;
  }
  this->TetrahedraAtBoundary.resize(isField ? 0 : isNear.size());
  this->FieldPointsAtBoundary.resize(isField ? isNear.size() : 0, { { 0, -1, 0, -1, 0, -1 } });
  for (const MeshBoundary::Piece& piece : boundary.Pieces)
  {
    int first[3];
    int last[3];
    Extent points;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const auto getEnds = [](const auto& corners, auto k) {
        return std::minmax({ corners[0][k], corners[1][k], corners[2][k], corners[3][k] });
      };
      const auto rest = getEnds(piece.Rest, static_cast<glm::length_t>(axis));
      const int begin = this->Shape.VertexExtent[2 * axis];
      // Nodes are rounded before samples are looked for. And a piece that moves a cell moves the
      // crossed one beside it, too: so no change of pieces is inside (IncrementalUpdate::IsInside).
      first[axis] = getPlace(static_cast<int>(axis), std::floor(rest.first - begin) - 1.0);
      last[axis] = getPlace(static_cast<int>(axis), std::floor(rest.second - begin) + 1.0);
      const auto indices = getEnds(piece.Weights, axis);
      points[2 * axis] = static_cast<int>(std::floor(indices.first));
      points[2 * axis + 1] = static_cast<int>(std::ceil(indices.second));
    }
    for (int z = first[2]; z <= last[2]; ++z)
    {
      for (int y = first[1]; y <= last[1]; ++y)
      {
        for (int x = first[0]; x <= last[0]; ++x)
        {
          const std::size_t subBrick = getNumber(x, y, z);
          if (!isNear[subBrick])
          {
            continue;
          }
          if (isField)
          {
            Include(this->FieldPointsAtBoundary[subBrick], points);
            continue;
          }
          std::vector<std::int32_t>& list = this->TetrahedraAtBoundary[subBrick];
          if (list.empty() || list.back() != piece.Tetrahedron)
          {
            list.push_back(piece.Tetrahedron);
          }
        }
      }
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
  const cl::Program program =
    GetBridgeProgram(this->Context, mapping, this->HasCut(), this->HasTurnedAxes());
  for (VolumeChunk& chunk : this->Chunks)
  {
    // Any buffer stands in for a missing one.
    this->Bridges.Update(this->Context, this->Queue, this->GetParameters(chunk), chunk,
      { program, [&](cl::Kernel& kernel) { return set(kernel, chunk); },
        this->HasRuns() ? this->Mapping.GetRecords().GetOwners() : this->RestPositions, tetrahedra,
        this->Active.HasBuffers() ? chunk.Active : this->RestPositions, this->Active.HasBuffers(),
        this->RestPositions, this->HasCut() ? this->Cut.GetRows() : this->RestPositions,
        this->HasCut() ? this->Cut.GetVertices() : this->RestPositions },
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
  p.IsMirrored = this->Shape.ToOutput.GetDeterminant() < 0.0;
  p.ChunkFirst = chunk.PlanesBegin;
  p.PlanesBegin = chunk.PlanesBegin;
  p.PlanesEnd = chunk.PlanesEnd;
  p.LayersBegin = chunk.LayersBegin;
  p.LayersEnd = chunk.LayersEnd;
  p.HasActive = this->HasActive();
  p.HasDistances = this->HasDistances();
  p.HasState = this->WithState;
  return p;
}

void DeviceVolume::UpdateState(const cl::Program& mapping, bool movesAll,
  const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set)
{
  if (this->States.AreCurrent())
  {
    return;
  }
  this->Cut.ForgetStencils();
  this->WithState = this->HasMasks() || this->HasCut() ||
    !(this->HasMesh() ? this->Mapping.AreAllLinked() : movesAll);
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
        this->GetActive(chunk), this->GetDistances(chunk),
        this->HasCut() ? this->Cut.GetRows() : this->RestPositions,
        this->HasCut() ? this->Cut.GetVertices() : this->RestPositions });
  }
  this->States.Finish();
}

void DeviceVolume::UpdateCut(const cl::Program& mapping, const std::vector<cl_uint>* bricks,
  const std::function<cl_uint(cl::Kernel&, const VolumeChunk&)>& set)
{
  if (!this->HasCut())
  {
    return;
  }
  std::vector<unsigned char> wanted;
  if (bricks)
  {
    wanted.resize(this->Bricks.GetNumberOfBricks());
    for (const cl_uint brick : *bricks)
    {
      wanted[brick & ((1U << DEFORMVOLUME_BRICK_BITS) - 1)] = 1;
    }
  }
  for (const VolumeChunk& chunk : this->Chunks)
  {
    this->Cut.Update(this->Context, this->Queue, this->GetParameters(chunk), chunk,
      { mapping, [&](cl::Kernel& kernel) { return set(kernel, chunk); }, this->GetState(chunk),
        this->GetActive(chunk) },
      wanted);
  }
  this->Cut.Finish();
}

std::uint64_t DeviceVolume::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->RestPositions) +
    this->Mapping.GetRecords().GetMemory() + this->Cut.GetMemory();
  for (const VolumeChunk& chunk : this->Chunks)
  {
    bytes += deformvolume::GetMemory(chunk.Boundary) + deformvolume::GetMemory(chunk.Joined) +
      deformvolume::GetMemory(chunk.Links) + deformvolume::GetMemory(chunk.Runs) +
      deformvolume::GetMemory(chunk.RowRanges) + deformvolume::GetMemory(chunk.State) +
      deformvolume::GetMemory(chunk.Blanked) + deformvolume::GetMemory(chunk.Active) +
      deformvolume::GetMemory(chunk.Distances);
    for (const cl::Buffer& array : chunk.Arrays)
    {
      bytes += deformvolume::GetMemory(array);
    }
  }
  return bytes;
}

} // namespace deformvolume
