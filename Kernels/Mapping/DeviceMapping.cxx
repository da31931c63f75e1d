// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceMapping.h"

#include "Error.h"
#include "HostMemory.h"
#include "ParallelFor.h"

#include <algorithm>
#include <limits>
#include <map>

namespace deformvolume
{

// Where voxels are inside the mesh and were not, or the other way round: boxes of so many that they
// are tight, and not too many.
class DeviceMapping::Changes
{
public:
  // Voxels of a row, from one x to before another.
  void Add(int begin, int end, int y, int z)
  {
    for (int x = begin; x < end; x = (x / BlockSize[0] + 1) * BlockSize[0])
    {
      const int last = std::min(end, (x / BlockSize[0] + 1) * BlockSize[0]) - 1;
      const auto inserted = this->Boxes.emplace(
        std::array<int, 3>{ { x / BlockSize[0], y / BlockSize[1], z / BlockSize[2] } },
        Extent{ { x, last, y, y, z, z } });
      Extent& box = inserted.first->second;
      box = { { std::min(box[0], x), std::max(box[1], last), std::min(box[2], y),
        std::max(box[3], y), std::min(box[4], z), std::max(box[5], z) } };
    }
  }

  std::vector<Extent> Get() const
  {
    std::vector<Extent> boxes;
    for (const auto& box : this->Boxes)
    {
      boxes.push_back(box.second);
    }
    return boxes;
  }

private:
  static constexpr int BlockSize[3] = { 64, 16, 16 };
  std::map<std::array<int, 3>, Extent> Boxes;
};

namespace
{

// The part of a box that lies in a chunk; false where there is none.
bool ClipToChunk(const VolumeChunk& chunk, Extent& box)
{
  box[4] = std::max(box[4], chunk.PlanesBegin);
  box[5] = std::min(box[5], chunk.PlanesEnd - 1);
  return box[4] <= box[5];
}

// Calls body(begin, end) for the voxels of a row that are in a run inside the mesh in one of two
// lists, and outside in the other one.
template <typename Body>
void CompareRuns(const VertexRun* before, const VertexRun* beforeEnd, const VertexRun* after,
  const VertexRun* afterEnd, int size, Body&& body)
{
  const auto getEnd = [size](const VertexRun* run, const VertexRun* end)
  { return run + 1 < end ? run[1].Begin : size; };
  for (int x = 0; x < size;)
  {
    const int beforeNext = getEnd(before, beforeEnd);
    const int afterNext = getEnd(after, afterEnd);
    const int next = std::min(beforeNext, afterNext);
    if ((before->Tetrahedron < 0) != (after->Tetrahedron < 0))
    {
      body(x, next);
    }
    before += next == beforeNext ? 1 : 0;
    after += next == afterNext ? 1 : 0;
    x = next;
  }
}

} // namespace

DeviceMapping::DeviceMapping(OpenCLContext& context, const cl::CommandQueue& queue,
  const std::array<int, 3>& size, std::uint64_t allocationLimit)
  : Context(context)
  , Queue(queue)
  , Size(size)
  , AllocationLimit(allocationLimit)
  , Records(context, queue, allocationLimit)
{
}

void DeviceMapping::SendLinks(VolumeChunk& chunk, const VertexLink* links, const MeshOrder& order)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->Size[0]) * this->Size[1];
  const auto bytesOf = [&](std::int64_t planes)
  { return static_cast<std::uint64_t>(planes * plane) * sizeof(VertexLink); };
  CheckAllocation(bytesOf(chunk.PlanesEnd - chunk.PlanesBegin), this->AllocationLimit);
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
        std::transform(links + first * plane + begin, links + first * plane + end, sent + begin,
          [&](VertexLink link)
          {
            link.Tetrahedron = order.GetLinked(link.Tetrahedron);
            return link;
          });
      });
    this->Queue.enqueueUnmapMemObject(chunk.Links, sent);
    this->Queue.finish();
  }
}

void DeviceMapping::SetLinks(
  std::vector<VolumeChunk>& chunks, const VertexLink* links, const MeshOrder& order)
{
  for (VolumeChunk& chunk : chunks)
  {
    chunk.Runs = chunk.RowRanges = cl::Buffer();
  }
  this->Runs.clear();
  this->Records.Clear();
  this->RunBytes = 0;
  this->WithLinks = false; // until all of them are there
  const std::int64_t voxels =
    static_cast<std::int64_t>(this->Size[0]) * this->Size[1] * this->Size[2];
  this->AllLinked = std::all_of(
    links, links + voxels, [](const VertexLink& link) { return link.Tetrahedron >= 0; });
  for (VolumeChunk& chunk : chunks)
  {
    this->SendLinks(chunk, links, order);
  }
  this->WithLinks = true;
}

void DeviceMapping::Forget(std::vector<VolumeChunk>& chunks)
{
  for (VolumeChunk& chunk : chunks)
  {
    chunk.Links = chunk.Runs = chunk.RowRanges = cl::Buffer();
  }
  this->Runs.clear();
  this->Records.Clear();
  this->RunBytes = 0;
  this->WithLinks = false;
}

void DeviceMapping::SetRuns(
  std::vector<VolumeChunk>& chunks, const VertexRuns& runs, const MeshOrder& order)
{
  static_assert(
    sizeof(VertexRun) == 8 && sizeof(TetrahedronRecord) == 64, "as the kernels have it");
  this->Forget(chunks);
  this->AllLinked = std::all_of(
    runs.Runs.begin(), runs.Runs.end(), [](const VertexRun& run) { return run.Tetrahedron >= 0; });
  const std::int64_t rows = this->Size[1];
  for (VolumeChunk& chunk : chunks)
  {
    const auto first = runs.RowBegins.begin() + rows * chunk.PlanesBegin;
    const auto last = runs.RowBegins.begin() + rows * chunk.PlanesEnd;
    ChunkRuns has;
    for (auto begin = first; begin != last; ++begin)
    {
      has.Rows.push_back(begin[0] - *first);
      has.Rows.push_back(begin[1] - *first);
    }
    has.End = *last - *first;
    const std::uint64_t bytes[2] = { has.End * sizeof(VertexRun),
      has.Rows.size() * sizeof(std::uint32_t) };
    CheckAllocation(std::max(bytes[0], bytes[1]), this->AllocationLimit);
    Reserve(this->Context, chunk.Runs, bytes[0]);
    Reserve(this->Context, chunk.RowRanges, bytes[1]);
    Write(this->Queue, chunk.Runs, 0, bytes[0], runs.Runs.data() + *first);
    Write(this->Queue, chunk.RowRanges, 0, bytes[1], has.Rows.data());
    this->Runs.push_back(std::move(has));
  }
  this->Records.Set(runs.Tetrahedra, order);
  this->RunBytes = GetBytes(runs);
}

std::vector<Extent> DeviceMapping::Update(std::vector<VolumeChunk>& chunks,
  const MappingUpdate& update, const std::array<int, 3>& first, const MeshOrder& order,
  const std::vector<std::int32_t>& removed)
{
  std::vector<Extent> boxes = update.Boxes;
  for (Extent& box : boxes)
  {
    for (int i = 0; i < 6; ++i)
    {
      box[i] -= first[i / 2];
    }
  }
  Changes changes;
  if (this->HasRuns())
  {
    const std::vector<std::int32_t> records =
      this->Records.Add(update.Runs.Tetrahedra, order, removed);
    for (std::size_t i = 0; i < chunks.size(); ++i)
    {
      this->UpdateRuns(chunks[i], this->Runs[i], boxes, update.Runs, records, changes);
    }
    this->AllLinked = this->AllLinked &&
      std::all_of(update.Runs.Runs.begin(), update.Runs.Runs.end(),
        [](const VertexRun& run) { return run.Tetrahedron >= 0; });
    return changes.Get();
  }
  for (const VolumeChunk& chunk : chunks)
  {
    const VertexLink* links = update.Links.data();
    for (const Extent& box : boxes)
    {
      this->UpdateLinks(chunk, box, links, order, changes);
      links += GetNumberOfPoints(box);
    }
  }
  this->AllLinked = this->AllLinked &&
    std::all_of(update.Links.begin(), update.Links.end(),
      [](const VertexLink& link) { return link.Tetrahedron >= 0; });
  return changes.Get();
}

void DeviceMapping::UpdateLinks(const VolumeChunk& chunk, const Extent& box,
  const VertexLink* links, const MeshOrder& order, Changes& changes) const
{
  Extent part = box;
  if (!ClipToChunk(chunk, part))
  {
    return;
  }
  const auto plane =
    static_cast<std::size_t>(deformvolume::GetSize(box, 0) * deformvolume::GetSize(box, 1));
  const VertexLink* next = links + static_cast<std::size_t>(part[4] - box[4]) * plane;
  const auto count = static_cast<std::size_t>(GetNumberOfPoints(part));
  std::vector<VertexLink> before(count);
  std::vector<VertexLink> after(next, next + count);
  for (VertexLink& link : after)
  {
    link.Tetrahedron = order.GetLinked(link.Tetrahedron);
  }
  const std::size_t row = static_cast<std::size_t>(this->Size[0]) * sizeof(VertexLink);
  const cl::array<cl::size_type, 3> there{ { 0, static_cast<cl::size_type>(part[2]),
    static_cast<cl::size_type>(part[4] - chunk.PlanesBegin) } };
  const cl::array<cl::size_type, 3> here{ { 0, 0, 0 } };
  const cl::array<cl::size_type, 3> region{ { row,
    static_cast<cl::size_type>(deformvolume::GetSize(part, 1)),
    static_cast<cl::size_type>(deformvolume::GetSize(part, 2)) } };
  const std::size_t slice = row * static_cast<std::size_t>(this->Size[1]);
  this->Queue.enqueueReadBufferRect(
    chunk.Links, CL_TRUE, there, here, region, row, slice, row, 0, before.data());
  this->Queue.enqueueWriteBufferRect(
    chunk.Links, CL_TRUE, there, here, region, row, slice, row, 0, after.data());
  std::size_t i = 0;
  for (int z = part[4]; z <= part[5]; ++z)
  {
    for (int y = part[2]; y <= part[3]; ++y)
    {
      for (int x = part[0]; x <= part[1]; ++x, ++i)
      {
        if ((before[i].Tetrahedron < 0) != (after[i].Tetrahedron < 0))
        {
          changes.Add(x, x + 1, y, z);
        }
      }
    }
  }
}

void DeviceMapping::MakeRoom(VolumeChunk& chunk, ChunkRuns& has, std::uint64_t more) const
{
  if ((has.End + more) * sizeof(VertexRun) <= GetMemory(chunk.Runs))
  {
    return;
  }
  std::uint64_t used = 0;
  for (std::size_t row = 0; row < has.Rows.size(); row += 2)
  {
    used += has.Rows[row + 1] - has.Rows[row];
  }
  const std::uint64_t needed = used + more;
  const std::uint64_t most = std::min<std::uint64_t>(
    this->AllocationLimit / sizeof(VertexRun), std::numeric_limits<std::uint32_t>::max());
  if (needed > most)
  {
    throw Error(
      "The volume falls into more runs of voxels in a tetrahedron of the deformation mesh "
      "than the device can hold. Use a smaller volume or a coarser mesh.");
  }
  // More may follow soon.
  const cl::Buffer buffer(this->Context.GetContext(), CL_MEM_READ_WRITE,
    std::min(most, needed + needed / 8) * sizeof(VertexRun));
  {
    const MappedBuffer<const VertexRun> from(this->Queue, chunk.Runs, CL_MAP_READ);
    const MappedBuffer<VertexRun> to(this->Queue, buffer, CL_MAP_WRITE);
    std::uint32_t end = 0;
    for (std::size_t row = 0; row < has.Rows.size(); row += 2)
    {
      const std::uint32_t count = has.Rows[row + 1] - has.Rows[row];
      std::copy_n(from.Get() + has.Rows[row], count, to.Get() + end);
      has.Rows[row] = end;
      end += count;
      has.Rows[row + 1] = end;
    }
    has.End = end;
  }
  chunk.Runs = buffer;
}

void DeviceMapping::UpdateRuns(VolumeChunk& chunk, ChunkRuns& has, const std::vector<Extent>& boxes,
  const VertexRuns& runs, const std::vector<std::int32_t>& records, Changes& changes)
{
  // Of a box each row that the chunk has, and its place in the update.
  const auto forEachRow = [&](auto&& body)
  {
    std::size_t first = 0;
    for (const Extent& box : boxes)
    {
      Extent part = box;
      ClipToChunk(chunk, part);
      const auto rows = static_cast<std::size_t>(deformvolume::GetSize(box, 1));
      for (int z = part[4]; z <= part[5]; ++z)
      {
        for (int y = part[2]; y <= part[3]; ++y)
        {
          body(y, z,
            first + static_cast<std::size_t>(z - box[4]) * rows +
              static_cast<std::size_t>(y - box[2]));
        }
      }
      first += rows * static_cast<std::size_t>(deformvolume::GetSize(box, 2));
    }
  };
  std::uint64_t more = 0;
  forEachRow(
    [&](int, int, std::size_t row) { more += runs.RowBegins[row + 1] - runs.RowBegins[row]; });
  if (more == 0)
  {
    return;
  }
  this->MakeRoom(chunk, has, more);
  std::vector<VertexRun> added;
  added.reserve(more);
  {
    const MappedBuffer<const VertexRun> last(this->Queue, chunk.Runs, CL_MAP_READ);
    forEachRow(
      [&](int y, int z, std::size_t row)
      {
        const std::size_t begin = added.size();
        for (std::uint32_t i = runs.RowBegins[row]; i < runs.RowBegins[row + 1]; ++i)
        {
          VertexRun run = runs.Runs[i];
          run.Tetrahedron = run.Tetrahedron < 0 ? -1 : records[run.Tetrahedron];
          added.push_back(run);
        }
        std::uint32_t* const range = has.Rows.data() +
          2 *
            (static_cast<std::size_t>(z - chunk.PlanesBegin) *
                static_cast<std::size_t>(this->Size[1]) +
              static_cast<std::size_t>(y));
        CompareRuns(last.Get() + range[0], last.Get() + range[1], added.data() + begin,
          added.data() + added.size(), this->Size[0],
          [&](int x, int end) { changes.Add(x, end, y, z); });
        range[0] = static_cast<std::uint32_t>(has.End + begin);
        range[1] = static_cast<std::uint32_t>(has.End + added.size());
      });
  }
  Write(this->Queue, chunk.Runs, has.End * sizeof(VertexRun), added.size() * sizeof(VertexRun),
    added.data());
  Write(this->Queue, chunk.RowRanges, 0, has.Rows.size() * sizeof(std::uint32_t), has.Rows.data());
  has.End += more;
}

BrickPoints DeviceMapping::MakeBrickPoints(const VolumeChunk& chunk, const BrickGrid& grid,
  const cl::Buffer& tetrahedra, std::size_t numberOfNodes,
  const std::vector<std::vector<std::int32_t>>& boundary,
  const std::vector<std::size_t>* wanted) const
{
  const MappedBuffer<const Tetrahedron> places(this->Queue, tetrahedra, CL_MAP_READ);
  const auto numberOfTetrahedra =
    static_cast<std::size_t>(GetMemory(tetrahedra) / sizeof(Tetrahedron));
  if (!this->HasRuns())
  {
    const MappedBuffer<const VertexLink> links(this->Queue, chunk.Links, CL_MAP_READ);
    return BrickPoints::FromLinks(
      grid, links.Get(), { places.Get(), numberOfTetrahedra, numberOfNodes, boundary }, wanted);
  }
  const MappedBuffer<const VertexRun> runs(this->Queue, chunk.Runs, CL_MAP_READ);
  const MappedBuffer<const std::int32_t> owners(
    this->Queue, this->Records.GetOwners(), CL_MAP_READ);
  BrickPoints points;
  this->Records.VisitRest(
    [&](const double* rest)
    {
      points = BrickPoints::FromRuns(grid,
        { runs.Get(), this->Runs.front().Rows.data(), rest, owners.Get() },
        { places.Get(), numberOfTetrahedra, numberOfNodes, boundary }, wanted);
    });
  return points;
}

} // namespace deformvolume
