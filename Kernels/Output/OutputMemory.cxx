// SPDX-License-Identifier: BSD-3-Clause
#include "OutputMemory.h"

#include "DeviceOutputInternals.h"

namespace deformvolume
{
namespace
{

// Returns the memory of an array of the request or, after the arrays, of its coverage.
char* GetHost(const DeformRequest& request, std::size_t element)
{
  return static_cast<char*>(
    element < request.Outputs.size() ? request.Outputs[element] : request.Coverage);
}

} // namespace

void OutputMemory::Bind(const OpenCLContext& context, const DeformRequest& request,
  const std::vector<VolumeArray>& arrays, const Extent& slab)
{
  this->Slab = slab;
  this->NumberOfVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(slab));
  const std::uint64_t plane = static_cast<std::uint64_t>(GetSize(slab, 0) * GetSize(slab, 1));
  const std::uint64_t first =
    plane * static_cast<std::uint64_t>(std::int64_t{ slab[4] } - request.OutputExtent[4]);
  this->Elements.resize(arrays.size() + 1);
  for (std::size_t i = 0; i < this->Elements.size(); ++i)
  {
    Element& element = this->Elements[i];
    const bool isArray = i < arrays.size();
    element.Background = isArray ? GetBackground(arrays[i]) : ElementBytes::Of(cl_uchar{ 0 });
    element.TupleSize = isArray ? GetTupleSize(arrays[i]) : 1;
    element.Host = GetHost(request, i) + first * element.TupleSize;
    deformvolume::Bind(context, element.Buffer, element.Host, element.Background.Size,
      this->NumberOfVoxels * element.TupleSize);
  }
}

bool OutputMemory::HoldsLastOutput(const OpenCLContext& context, const DeformRequest& request) const
{
  const auto voxels = static_cast<std::uint64_t>(GetNumberOfPoints(request.OutputExtent));
  bool all =
    this->Slab == request.OutputExtent && this->Elements.size() == request.Outputs.size() + 1;
  for (std::size_t i = 0; all && i < this->Elements.size(); ++i)
  {
    // Arrays in host memory are always available.
    const Element& element = this->Elements[i];
    all = CanWorkInPlace(context, GetHost(request, i), element.Background.Size) ||
      deformvolume::GetMemory(element.Buffer) == voxels * element.TupleSize;
  }
  return all;
}

void OutputMemory::Read(const cl::CommandQueue& queue, const Extent& part)
{
  for (const Element& element : this->Elements)
  {
    if (part == this->Slab || IsInPlace(element.Buffer))
    {
      this->Reads.Add(
        BeginToRead(queue, element.Buffer, this->NumberOfVoxels * element.TupleSize, element.Host));
    }
    else if (GetNumberOfPoints(part) > 0)
    {
      this->Reads.Add(BeginToReadBox(
        queue, element.Buffer, this->Slab, part, element.TupleSize, element.Host, this->Slab));
    }
  }
  queue.flush();
}

std::vector<std::shared_ptr<DeviceOutput>> OutputMemory::KeepOnDevice(
  const cl::CommandQueue& queue, const std::vector<Extent>& parts) const
{
  std::vector<std::shared_ptr<DeviceOutput>> outputs;
  for (const Element& element : this->Elements)
  {
    const DeviceOutput::Internals::Voxels voxels{ this->Slab, parts[outputs.size()],
      element.TupleSize };
    outputs.push_back(std::make_shared<DeviceOutput>(std::make_shared<DeviceOutput::Internals>(
      queue, element.Buffer, voxels, element.Host, element.Background)));
  }
  return outputs;
}

void OutputMemory::Release()
{
  this->Reads.Drop();
  for (Element& element : this->Elements)
  {
    if (IsInPlace(element.Buffer))
    {
      element.Buffer = cl::Buffer();
    }
  }
}

std::uint64_t OutputMemory::GetMemory() const
{
  std::uint64_t bytes = 0;
  for (const Element& element : this->Elements)
  {
    bytes += deformvolume::GetMemory(element.Buffer);
  }
  return bytes;
}

} // namespace deformvolume
