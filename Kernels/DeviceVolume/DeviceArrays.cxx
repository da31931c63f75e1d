// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceArrays.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace deformvolume
{

bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array)
{
  return array.Owner && CanWorkInPlace(context, array.Data, GetElementSize(array.Type));
}

DeviceArrays::DeviceArrays(const OpenCLContext& context, const cl::CommandQueue& queue,
  const std::array<int, 3>& size, std::uint64_t allocationLimit, std::vector<VolumeChunk>& chunks)
  : Context(context)
  , Queue(queue)
  , Size(size)
  , AllocationLimit(allocationLimit)
  , Chunks(chunks)
{
}

void DeviceArrays::ReleaseBuffersInPlace()
{
  if (this->ChunkInPlace)
  {
    this->Queue.finish();
    for (std::size_t i = 0; i < this->BuffersInPlace.size(); ++i)
    {
      if (this->IsInPlace(i))
      {
        this->ChunkInPlace->Arrays[i] = cl::Buffer();
        this->BuffersInPlace[i].Buffer = cl::Buffer();
      }
    }
    this->ChunkInPlace = nullptr;
  }
}

BufferInPlace DeviceArrays::FindOverlapping(const void* data, std::uint64_t bytes) const
{
  const auto found = std::find_if(this->BuffersInPlace.begin(), this->BuffersInPlace.end(),
    [&](const BufferInPlace& one) { return one.Overlaps(data, bytes); });
  return found != this->BuffersInPlace.end() ? *found : BufferInPlace();
}

void DeviceArrays::Set(const std::vector<VolumeArray>& arrays, const BufferInPlace& field)
{
  const QueueGuard guard(this->Queue);
  this->ReleaseBuffersInPlace();
  this->BuffersInPlace.assign(arrays.size(), BufferInPlace());
  this->Described.clear(); // no arrays are set after an exception
  const std::int64_t plane = static_cast<std::int64_t>(this->Size[0]) * this->Size[1];
  const bool whole = this->Chunks.size() == 1;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    const VolumeArray& array = arrays[i];
    const std::uint64_t bytes =
      static_cast<std::uint64_t>(plane * this->Size[2]) * GetTupleSize(array);
    const BufferInPlace other = this->FindOverlapping(array.Data, bytes);
    // A buffer can be shared with the field only if the volume is one chunk.
    const bool free = other.Bytes == 0 || other.IsOver(array.Data, bytes);
    const bool freeOfField =
      !field.Overlaps(array.Data, bytes) || (whole && field.IsOver(array.Data, bytes));
    if (IsUsedInPlace(this->Context, array) && free && freeOfField)
    {
      this->BuffersInPlace[i].Data = array.Data;
      this->BuffersInPlace[i].Bytes = bytes;
    }
  }
  for (VolumeChunk& chunk : this->Chunks)
  {
    chunk.Arrays.resize(arrays.size());
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      chunk.Arrays[i] = this->IsInPlace(i)
        ? cl::Buffer()
        : SendLayers(this->Context, this->Queue, this->AllocationLimit,
            { arrays[i].Data, GetTupleSize(arrays[i]), plane, chunk.PlanesBegin, chunk.PlanesEnd },
            chunk.Arrays[i]);
    }
  }
  if (whole)
  {
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      BufferInPlace& inPlace = this->BuffersInPlace[i];
      inPlace.Buffer = field.IsOver(inPlace.Data, inPlace.Bytes) ? field.Buffer : cl::Buffer();
    }
    this->GetBuffers(this->Chunks.front());
  }
  this->Described = arrays;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    if (!this->IsInPlace(i))
    {
      this->Described[i].Owner.reset(); // the data were copied
    }
  }
}

bool DeviceArrays::SetOptions(const std::vector<VolumeArray>& arrays)
{
  const bool alike =
    std::equal(arrays.begin(), arrays.end(), this->Described.begin(), this->Described.end(),
      [](const VolumeArray& a, const VolumeArray& b)
      { return a.Type == b.Type && a.Components == b.Components; });
  if (!alike)
  {
    throw Error("The array options do not match the arrays that are set, in number, type or "
                "components. Call SetArrays() first.");
  }
  bool changed = false;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    VolumeArray& set = this->Described[i];
    const bool areNaN = std::isnan(set.Background) && std::isnan(arrays[i].Background);
    changed = changed || set.Categorical != arrays[i].Categorical ||
      !(set.Background == arrays[i].Background || areNaN);
    set.Categorical = arrays[i].Categorical;
    set.Background = arrays[i].Background;
  }
  return changed;
}

void DeviceArrays::Reread() const
{
  // If there are several chunks, GetBuffers() makes new buffers for each.
  if (this->Chunks.size() == 1)
  {
    for (const BufferInPlace& inPlace : this->BuffersInPlace)
    {
      UpdateFromHost(this->Context, this->Queue, inPlace);
    }
  }
}

const std::vector<cl::Buffer>& DeviceArrays::GetBuffers(const VolumeChunk& chunk)
{
  if (&chunk == this->ChunkInPlace)
  {
    return chunk.Arrays;
  }
  this->ReleaseBuffersInPlace();
  VolumeChunk& placed = this->Chunks[static_cast<std::size_t>(&chunk - this->Chunks.data())];
  this->ChunkInPlace = &placed;
  for (std::size_t i = 0; i < this->BuffersInPlace.size(); ++i)
  {
    BufferInPlace& inPlace = this->BuffersInPlace[i];
    if (inPlace.Bytes == 0)
    {
      continue;
    }
    const auto same = std::find_if(this->BuffersInPlace.begin(), this->BuffersInPlace.end(),
      [&](const BufferInPlace& one) { return one.IsOver(inPlace.Data, inPlace.Bytes); });
    if (!same->Buffer())
    {
      const std::uint64_t bytesPerPlane = inPlace.Bytes / static_cast<std::uint64_t>(this->Size[2]);
      // The kernels only read the array.
      same->Buffer = MakeBufferOver(this->Context, CL_MEM_READ_ONLY,
        static_cast<char*>(const_cast<void*>(inPlace.Data)) +
          bytesPerPlane * static_cast<std::uint64_t>(chunk.PlanesBegin),
        bytesPerPlane * static_cast<std::uint64_t>(chunk.PlanesEnd - chunk.PlanesBegin));
    }
    inPlace.Buffer = same->Buffer;
    placed.Arrays[i] = inPlace.Buffer;
  }
  return chunk.Arrays;
}

} // namespace deformvolume
