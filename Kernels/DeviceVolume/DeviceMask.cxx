// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceMask.h"

#include "FiveTetrahedra.h"
#include "HostMemory.h"
#include "ParallelFor.h"

#include <algorithm>
#include <cstring>

namespace deformvolume
{

cl::Buffer& DeviceMask::GetBuffer(VolumeChunk& chunk) const
{
  switch (this->MaskKind)
  {
    case Kind::BlankedVertices:
      return chunk.Blanked;
    case Kind::BoundaryDistances:
      return chunk.Distances;
    default:
      return chunk.Active;
  }
}

int DeviceMask::GetWidth() const
{
  return this->MaskKind == Kind::BoundaryDistances ? static_cast<int>(sizeof(float)) : 1;
}

MaskValues DeviceMask::MakeValues(const unsigned char* bytes, unsigned char bits) const
{
  constexpr unsigned char none = 0;
  constexpr unsigned char all = DEFORMVOLUME_ALL_TETRAHEDRA;
  return { bytes, bits, this->MaskKind == Kind::ActiveTetrahedra ? all : none };
}

std::array<int, 2> DeviceMask::GetPlanes(const VolumeChunk& chunk) const
{
  const int cells = this->MaskKind == Kind::ActiveTetrahedra ? 1 : 0;
  return { { chunk.PlanesBegin, chunk.PlanesEnd - 1 - cells } };
}

void DeviceMask::Allocate(
  const OpenCLContext& context, const cl::CommandQueue& queue, std::vector<VolumeChunk>& chunks)
{
  const std::size_t plane =
    static_cast<std::size_t>(this->Size[0]) * static_cast<std::size_t>(this->Size[1]);
  const unsigned char usual = this->MakeValues(nullptr, 0).Usual;
  for (VolumeChunk& chunk : chunks)
  {
    const std::array<int, 2> planes = this->GetPlanes(chunk);
    const std::size_t bytes = plane * static_cast<std::size_t>(planes[1] - planes[0] + 1);
    this->GetBuffer(chunk) = cl::Buffer(context.GetContext(), CL_MEM_READ_ONLY, bytes);
    if (this->MaskKind == Kind::BoundaryDistances)
    {
      queue.enqueueFillBuffer(this->GetBuffer(chunk), this->Farthest, 0, bytes);
    }
    else
    {
      queue.enqueueFillBuffer(this->GetBuffer(chunk), usual, 0, bytes);
    }
  }
  queue.finish();
  if (!context.GetDevice().IsProcessor || chunks.size() > 1)
  {
    this->Last.assign(this->CountBytes(), usual);
    if (this->MaskKind == Kind::BoundaryDistances)
    {
      std::fill_n(reinterpret_cast<float*>(this->Last.data()), this->Last.size() / sizeof(float),
        this->Farthest);
    }
  }
  this->WithBuffers = true;
}

void DeviceMask::Release(std::vector<VolumeChunk>& chunks)
{
  this->WithBuffers = false;
  for (VolumeChunk& chunk : chunks)
  {
    this->GetBuffer(chunk) = cl::Buffer();
  }
  std::vector<unsigned char>().swap(this->Last);
}

void DeviceMask::Write(
  const cl::CommandQueue& queue, VolumeChunk& chunk, const std::vector<Extent>& changes) const
{
  const std::array<int, 2> planes = this->GetPlanes(chunk);
  Extent box = EmptyExtent;
  for (const Extent& change : changes)
  {
    if (change[4] <= planes[1] && change[5] >= planes[0])
    {
      Include(box, change);
    }
  }
  if (GetNumberOfPoints(box) == 0)
  {
    return;
  }
  box[4] = std::max(box[4], planes[0]);
  box[5] = std::min(box[5], planes[1]);
  const int x = this->Size[0] - 1;
  const int y = this->Size[1] - 1;
  WriteBox(queue, this->GetBuffer(chunk), { { 0, x, 0, y, planes[0], planes[1] } }, box, 1,
    this->Last.data(), { { 0, x, 0, y, 0, this->Size[2] - 1 } });
}

bool DeviceMask::IsAny(const MaskValues& values)
{
  if (this->MaskKind != Kind::BoundaryDistances)
  {
    return !FindMaskChanges(this->Size, this->MakeValues(nullptr, 0), values).empty();
  }
  bool isAny = false;
  this->Farthest = 0.0F;
  const auto* distances = reinterpret_cast<const float*>(values.Bytes);
  const std::size_t count = distances ? this->CountBytes() / sizeof(float) : 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    isAny |= distances[i] < 0.0F;
    this->Farthest = std::max(this->Farthest, distances[i]);
  }
  return isAny;
}

std::vector<Extent> DeviceMask::Set(const OpenCLContext& context, const cl::CommandQueue& queue,
  const std::array<int, 3>& vertices, std::vector<VolumeChunk>& chunks, const unsigned char* next,
  unsigned char bits, const PointRanges* written)
{
  const QueueGuard guard(queue);
  const int less = this->MaskKind == Kind::ActiveTetrahedra ? 1 : 0;
  const int width = this->GetWidth();
  this->Size = { { width * (vertices[0] - less), vertices[1] - less, vertices[2] - less } };
  std::vector<float> none;
  if (this->MaskKind == Kind::BoundaryDistances && this->WithBuffers && !next)
  {
    none.assign(this->CountBytes() / sizeof(float), this->Farthest);
  }
  const MaskValues wanted = this->MakeValues(
    none.empty() ? next : reinterpret_cast<const unsigned char*>(none.data()), bits);
  std::vector<Extent> changes;
  const auto copy = [&](unsigned char* last)
  {
    constexpr std::size_t step = 64;
    ParallelForItems(
      changes.size(), step, [&](std::size_t i) { CopyMask(this->Size, changes[i], wanted, last); });
  };
  PointRanges bytes;
  if (written)
  {
    bytes = *written;
    for (auto& range : bytes)
    {
      range = { { range[0] * static_cast<std::size_t>(width),
        range[1] * static_cast<std::size_t>(width) } };
    }
  }
  const PointRanges* validChanges = this->WithBuffers && next && written ? &bytes : nullptr;
  if (!this->WithBuffers)
  {
    if (!this->IsAny(wanted))
    {
      return changes;
    }
    this->Allocate(context, queue, chunks);
  }
  if (!this->Last.empty())
  {
    changes =
      FindMaskChanges(this->Size, this->MakeValues(this->Last.data(), 255), wanted, validChanges);
    copy(this->Last.data());
    for (VolumeChunk& chunk : chunks)
    {
      this->Write(queue, chunk, changes);
    }
  }
  else
  {
    const MappedBuffer<unsigned char> last(
      queue, this->GetBuffer(chunks.front()), CL_MAP_READ | CL_MAP_WRITE);
    changes = FindMaskChanges(this->Size, this->MakeValues(last.Get(), 255), wanted, validChanges);
    copy(last.Get());
  }
  if (!next)
  {
    this->Release(chunks);
  }
  for (Extent& box : changes)
  {
    box[0] /= width;
    box[1] /= width;
  }
  return changes;
}

} // namespace deformvolume
