// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceLattice.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{

std::uint64_t GetMemory(const cl::Buffer& buffer)
{
  return buffer() ? buffer.getInfo<CL_MEM_SIZE>() : 0;
}

DeviceLattice::DeviceLattice(OpenCLContext& context, const cl::CommandQueue& queue,
  const Lattice& lattice, std::size_t bytesPerVoxel, std::uint64_t allocationLimit)
  : Context(context)
  , Queue(queue)
  , Shape(lattice)
  , AllocationLimit(allocationLimit)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  const std::uint64_t planeBytes =
    static_cast<std::uint64_t>(plane) * std::max(bytesPerVoxel, sizeof(VertexLink));
  const std::uint64_t planes = allocationLimit / planeBytes;
  const std::uint64_t neighbours = 4; // planes beyond the number of layers, and room to read ahead
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
    LatticeChunk chunk;
    chunk.LayersBegin = begin;
    chunk.LayersEnd = std::min(begin + step, layers);
    chunk.PlanesBegin = std::max(begin - 1, 0);
    chunk.PlanesEnd = std::min(chunk.LayersEnd + 2, this->GetSize(2));
    this->Chunks.push_back(chunk);
  }
  this->RestPositions = this->MakeRestPositions();
}

cl::Buffer DeviceLattice::MakeRestPositions() const
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

cl::Buffer DeviceLattice::Send(const void* data, std::size_t bytesPerElement,
  std::int64_t elementsPerLayer, int begin, int end, const cl::Buffer& previous)
{
  const std::uint64_t layerBytes = static_cast<std::uint64_t>(elementsPerLayer) * bytesPerElement;
  const std::uint64_t bytes = layerBytes * static_cast<std::uint64_t>(end - begin);
  // Kernels may load whole vectors that reach over the end.
  const std::uint64_t room = bytes + DEFORMVOLUME_READ_AHEAD * bytesPerElement;
  if (room > this->AllocationLimit)
  {
    throw Error("An array of the volume needs " + std::to_string(room) +
      " bytes in one piece, and the device gives no more than " +
      std::to_string(this->AllocationLimit) + ".");
  }
  cl::Buffer buffer = previous;
  if (deformvolume::GetMemory(buffer) != room)
  {
    buffer = cl::Buffer(this->Context.GetContext(), CL_MEM_READ_ONLY, room);
  }
  this->Queue.enqueueWriteBuffer(
    buffer, CL_TRUE, 0, bytes, static_cast<const char*>(data) + layerBytes * begin);
  return buffer;
}

void DeviceLattice::SetArrays(const std::vector<VolumeArray>& arrays)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  for (LatticeChunk& chunk : this->Chunks)
  {
    chunk.Arrays.resize(arrays.size());
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      chunk.Arrays[i] = this->Send(arrays[i].Data, GetTupleSize(arrays[i]), plane,
        chunk.PlanesBegin, chunk.PlanesEnd, chunk.Arrays[i]);
    }
  }
}

void DeviceLattice::SetLinks(const VertexLink* links)
{
  this->WithLinks = links != nullptr;
  this->StateChanged = true;
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  for (LatticeChunk& chunk : this->Chunks)
  {
    chunk.Links = links ? this->Send(links, sizeof(VertexLink), plane, chunk.PlanesBegin,
                            chunk.PlanesEnd, chunk.Links)
                        : cl::Buffer();
  }
}

void DeviceLattice::SetBlanked(const unsigned char* blanked)
{
  this->WithBlanked = blanked != nullptr;
  this->StateChanged = true;
  const std::int64_t plane = static_cast<std::int64_t>(this->GetSize(0)) * this->GetSize(1);
  for (LatticeChunk& chunk : this->Chunks)
  {
    chunk.Blanked = blanked
      ? this->Send(blanked, 1, plane, chunk.PlanesBegin, chunk.PlanesEnd, chunk.Blanked)
      : cl::Buffer();
  }
}

void DeviceLattice::SetActive(const unsigned char* active)
{
  this->WithActive = active != nullptr;
  this->StateChanged = true;
  const std::int64_t layer =
    static_cast<std::int64_t>(this->GetSize(0) - 1) * (this->GetSize(1) - 1);
  for (LatticeChunk& chunk : this->Chunks)
  {
    chunk.Active = active
      ? this->Send(active, 1, layer, chunk.PlanesBegin, chunk.PlanesEnd - 1, chunk.Active)
      : cl::Buffer();
  }
}

KernelParameters DeviceLattice::GetParameters(const LatticeChunk& chunk) const
{
  KernelParameters p = {};
  for (int axis = 0; axis < 3; ++axis)
  {
    p.Size[axis] = this->GetSize(axis);
    p.First[axis] = this->Shape.VertexExtent[2 * axis];
  }
  p.ChunkFirst = chunk.PlanesBegin;
  p.SlabFirst = chunk.PlanesBegin;
  p.PlanesBegin = chunk.PlanesBegin;
  p.PlanesEnd = chunk.PlanesEnd;
  p.LayersBegin = chunk.LayersBegin;
  p.LayersEnd = chunk.LayersEnd;
  p.HasActive = this->WithActive;
  return p;
}

cl::NDRange DeviceLattice::GetVertexRange(int planes) const
{
  const std::size_t group = this->GetVertexGroup()[0];
  const std::size_t row = static_cast<std::size_t>(this->GetSize(0));
  const std::size_t items = group == 1 ? 1 : (row + group - 1) / group * group;
  return cl::NDRange(
    items, static_cast<std::size_t>(this->GetSize(1)), static_cast<std::size_t>(planes));
}

cl::NDRange DeviceLattice::GetVertexGroup() const
{
  // On a processor one work-item takes a whole row.
  return cl::NDRange(this->Context.GetDevice().IsProcessor ? 1 : 64, 1, 1);
}

void DeviceLattice::UpdateState(const cl::Program& mapping, const FieldParameters* field)
{
  if (!this->StateChanged)
  {
    return;
  }
  cl::Kernel sources(mapping, field ? "MarkSourcesByField" : "MarkSourcesByMesh");
  cl::Kernel vertices(mapping, "MarkVertices");
  for (LatticeChunk& chunk : this->Chunks)
  {
    KernelParameters p = this->GetParameters(chunk);
    const std::uint64_t bytes = static_cast<std::uint64_t>(p.Size[0]) * p.Size[1] *
        static_cast<std::uint64_t>(p.PlanesEnd - p.PlanesBegin) +
      DEFORMVOLUME_READ_AHEAD;
    if (deformvolume::GetMemory(chunk.State) != bytes)
    {
      chunk.State = cl::Buffer(this->Context.GetContext(), CL_MEM_READ_WRITE, bytes);
    }
    const cl::Buffer marked(this->Context.GetContext(), CL_MEM_READ_WRITE, bytes);
    if (field)
    {
      sources.setArg(0, *field);
    }
    else
    {
      sources.setArg(0, chunk.Links);
    }
    // A null pointer is not something that all drivers take: any buffer stands in for a missing
    // one.
    sources.setArg(1, this->WithBlanked ? chunk.Blanked : this->RestPositions);
    sources.setArg(2, cl_int{ this->WithBlanked });
    sources.setArg(3, marked);
    sources.setArg(4, p);
    vertices.setArg(0, marked);
    vertices.setArg(1, this->WithActive ? chunk.Active : this->RestPositions);
    vertices.setArg(2, chunk.State);
    vertices.setArg(3, p);
    for (const cl::Kernel& kernel : { sources, vertices })
    {
      this->Queue.enqueueNDRangeKernel(kernel, cl::NullRange,
        this->GetVertexRange(p.PlanesEnd - p.PlanesBegin), this->GetVertexGroup());
    }
  }
  this->StateChanged = false;
}

std::uint64_t DeviceLattice::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->RestPositions);
  for (const LatticeChunk& chunk : this->Chunks)
  {
    bytes += deformvolume::GetMemory(chunk.Links) + deformvolume::GetMemory(chunk.State) +
      deformvolume::GetMemory(chunk.Blanked) + deformvolume::GetMemory(chunk.Active);
    for (const cl::Buffer& array : chunk.Arrays)
    {
      bytes += deformvolume::GetMemory(array);
    }
  }
  return bytes;
}

} // namespace deformvolume
