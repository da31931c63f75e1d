// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformerInternals.h"

#include "SystemMemory.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

using Clock = std::chrono::steady_clock;

double GetSeconds(const std::vector<cl::Event>& events)
{
  double nanoseconds = 0.0;
  for (const cl::Event& event : events)
  {
    nanoseconds += static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
      event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
  }
  return nanoseconds * 1e-9;
}

void CheckExtent(const Extent& extent, const char* what)
{
  if (GetNumberOfPoints(extent) == 0)
  {
    throw Error(std::string("The extent of the ") + what + " is empty.");
  }
}

} // namespace

void CheckBytes(std::uint64_t needed, std::uint64_t available, const char* where)
{
  if (needed > available)
  {
    throw Error(std::string("Not enough memory ") + where + ": " + std::to_string(needed) +
      " bytes are needed and " + std::to_string(available) +
      " are available. Use a smaller volume, fewer arrays or smaller output bounds, raise the "
      "memory limit if one is set, or choose another device.");
  }
}

void VolumeDeformer::Internals::Forget()
{
  this->Mesh.reset();
  this->Arrays.clear();
  this->ForgetNodes();
  this->ForgetField();
  this->Positions = cl::Buffer();
  this->BrickRows = cl::Buffer();
  this->Targets = {};
  this->Update = IncrementalUpdate();
  this->Rasterizer.Clear();
  this->LastVectorsSent = false;
  this->WasContested = false;
}

void VolumeDeformer::Internals::ForgetNodes()
{
  this->Tetrahedra = cl::Buffer();
  this->Nodes = cl::Buffer();
  this->NodeNumbers.clear();
  this->NumberOfTetrahedra = 0;
  this->NumberOfNodes = 0;
  this->NodesSet = false;
}

OpenCLContext& VolumeDeformer::Internals::GetContext()
{
  if (!this->Context)
  {
    this->SelectDevice("");
  }
  return *this->Context;
}

void VolumeDeformer::Internals::SelectDevice(const std::string& request)
{
  const OpenCLDevice device = FindDevice(request);
  OpenCLContext& context = OpenCLContext::Get(device);
  if (&context != this->Context)
  {
    this->Forget();
    this->Context = &context;
    this->Queue =
      cl::CommandQueue(context.GetContext(), context.GetDevice().Device, CL_QUEUE_PROFILING_ENABLE);
    this->ReadQueue = cl::CommandQueue(context.GetContext(), context.GetDevice().Device);
    this->TakenBricks = cl::Buffer(context.GetContext(), CL_MEM_READ_WRITE, sizeof(cl_uint));
  }
}

DeviceVolume& VolumeDeformer::Internals::GetMesh()
{
  if (!this->Mesh)
  {
    throw Error("No volume is set: call SetVoxelGrid first.");
  }
  return *this->Mesh;
}

std::uint64_t VolumeDeformer::Internals::GetAllocationLimit()
{
  const std::uint64_t device =
    this->GetContext().GetDevice().Device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  return this->AllocationLimit ? std::min(device, this->AllocationLimit) : device;
}

std::uint64_t VolumeDeformer::Internals::GetHeldMemory() const
{
  return (this->Mesh ? this->Mesh->GetMemory() : 0) + GetMemory(this->Tetrahedra) +
    GetMemory(this->Nodes) + this->Rasterizer.GetMemory() + GetMemory(this->FieldVectors) +
    GetMemory(this->Positions) + GetMemory(this->BrickRows) + this->Targets[0].GetMemory() +
    this->Targets[1].GetMemory();
}

std::uint64_t VolumeDeformer::Internals::GetUsableMemory()
{
  return this->Guard(
    [&]
    {
      if (this->MemoryLimit)
      {
        return this->MemoryLimit;
      }
      const OpenCLDevice& device = this->GetContext().GetDevice();
      const std::uint64_t all = device.Device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
      const std::uint64_t system = device.IsProcessor ? this->GetSystemMemory() : 0;
      return system ? std::min(all, system) : all;
    });
}

std::uint64_t VolumeDeformer::Internals::GetSystemMemory()
{
  if (!this->SystemMemory)
  {
    const std::uint64_t left = deformvolume::GetSystemMemory();
    const bool shared = this->GetContext().GetDevice().IsProcessor;
    this->SystemMemory = left + (left && shared ? this->GetHeldMemory() : 0);
  }
  return *this->SystemMemory;
}

bool VolumeDeformer::Internals::HasRoomForWinners(const OutputSlab& slab)
{
  this->ForgetSystemMemory(); // the output takes some of it by now
  // Also where none is missing: the limit may be lower now.
  return this->GetHeldMemory() + slab.GetMissingWinnerMemory() <= this->GetUsableMemory();
}

void VolumeDeformer::Internals::CheckWinners(const OutputSlab& slab)
{
  this->ForgetSystemMemory();
  CheckBytes(this->GetHeldMemory() + slab.GetMissingWinnerMemory(), this->GetUsableMemory(),
    "on the device for a deformation that folds the volume over");
}

cl::Buffer VolumeDeformer::Internals::SendBuffer(
  const void* data, std::size_t bytes, const cl::Buffer& previous)
{
  cl::Buffer buffer = previous;
  if (GetMemory(buffer) != bytes)
  {
    buffer = cl::Buffer(this->GetContext().GetContext(), CL_MEM_READ_ONLY, bytes);
  }
  this->Queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
  return buffer;
}

void VolumeDeformer::Internals::SendTetrahedra(const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes, MeshOrder&& order)
{
  static_assert(DEFORMVOLUME_NODE_PLACES == 2, "as the message says");
  if (numberOfNodes > std::size_t{ 1 } << 30)
  {
    throw Error("The deformation mesh has more than 2^30 nodes. Use a coarser mesh.");
  }
  this->NumberOfTetrahedra = numberOfTetrahedra;
  const std::vector<Tetrahedron> places = NameNodePlaces(tetrahedra, numberOfTetrahedra, order);
  this->Tetrahedra =
    this->SendBuffer(places.data(), numberOfTetrahedra * sizeof(Tetrahedron), this->Tetrahedra);
  this->NumberOfNodes = numberOfNodes;
  this->NodeNumbers = std::move(order.Nodes);
  this->NodesSet = false;
  this->LastVectorsSent = false;
  this->ForgetField();
  this->Update.ForgetMapping();
  this->Rasterizer.Clear();
}

void VolumeDeformer::Internals::CheckRequest(const DeformRequest& request)
{
  CheckExtent(request.OutputExtent, "output");
  const DeviceVolume& mesh = this->GetMesh();
  if (this->Arrays.empty())
  {
    throw Error("No arrays are set: call SetArrays first.");
  }
  if (request.Method == Resampling::MeshRasterization ||
    request.Interpolation != Interpolation::Linear)
  {
    this->CheckRasterization(request);
  }
  else if (!(mesh.HasMesh() && this->NodesSet) && !this->FieldVectors())
  {
    throw Error("No deformation is set: call SetMesh and SetNodeDisplacements, or "
                "SetDisplacementField, first.");
  }
  if (request.Outputs.size() != this->Arrays.size() || !request.Coverage ||
    std::count(request.Outputs.begin(), request.Outputs.end(), nullptr))
  {
    throw Error("The request must have room for each array of the volume and for the coverage.");
  }
}

bool VolumeDeformer::Internals::UseLanes(Resampling method, const OutputSlab& output) const
{
  const bool fits = output.FitsLanes();
  if (method == Resampling::ExactByLanes && !fits)
  {
    throw Error(
      "The resampling by lanes takes only outputs under 2^31 voxels, and of at most 32,768 "
      "on an axis, that begin within 2^22 voxels of index 0.");
  }
  const bool hasVectors = this->Context->GetDevice().HasVectors;
  if (method == Resampling::ExactByLanes && !hasVectors)
  {
    throw Error("The resampling by lanes is for processors whose vector registers a work-item has "
                "for itself, and the device \"" +
      this->Context->GetDevice().Name + "\" is none.");
  }
  return fits && hasVectors && (method == Resampling::ExactByLanes || method == Resampling::Exact);
}

MappingForm VolumeDeformer::Internals::GetMappingForm() const
{
  return this->Mesh->HasRuns() ? MappingForm::Runs
    : this->Mesh->HasMesh()    ? MappingForm::Links
    : this->FieldInPlace.Owner ? MappingForm::FieldInPlace
                               : MappingForm::Field;
}

cl_uint VolumeDeformer::Internals::SetMappingArguments(
  cl::Kernel& kernel, const VolumeChunk& chunk) const
{
  cl_uint i = 0;
  if (this->GetMappingForm() == MappingForm::Runs)
  {
    kernel.setArg(i++, chunk.Runs);
    kernel.setArg(i++, chunk.RowBegins);
    kernel.setArg(i++, this->Mesh->GetRecords());
  }
  else if (this->GetMappingForm() == MappingForm::Links)
  {
    kernel.setArg(i++, chunk.Links);
    kernel.setArg(i++, this->Tetrahedra);
    kernel.setArg(i++, this->Nodes);
  }
  else
  {
    kernel.setArg(i++, this->FieldVectors);
    kernel.setArg(i++, this->Field);
  }
  kernel.setArg(i++, this->Mesh->GetRestPositions());
  return i;
}

void VolumeDeformer::Internals::DeformSlabs(
  const DeformRequest& request, std::uint64_t spare, DeformReport& report)
{
  const std::vector<Extent> slabs = OutputSlab::Split(
    request.OutputExtent, this->Arrays, this->Mesh->GetVoxelGrid(), this->GetAllocationLimit());
  const std::uint64_t bytes = OutputSlab::GetBytesPerVoxel(*this->Context, this->Arrays, request) *
    static_cast<std::uint64_t>(GetNumberOfPoints(slabs.front()));
  const bool overlapped = bytes > 0 && slabs.size() > 1 && spare >= bytes;
  if (!overlapped)
  {
    this->Targets[1] = OutputSlab();
  }
  bool plain = slabs.size() == 1 && this->Mesh->GetChunks().size() == 1;
  for (std::size_t s = 0; s < slabs.size(); ++s)
  {
    OutputSlab& target = this->Targets[overlapped ? s % 2 : 0];
    this->LaunchesExpected = (slabs.size() - s) * this->GetNumberOfLaunches() + this->LaunchesDone;
    target.Prepare(*this->Context, this->Queue, slabs[s], request, this->Arrays,
      this->Mesh->GetVoxelGrid(), this->Mesh->GetBricks().GetNumberOfBricks(),
      this->ResamplingEvents);
    plain = this->RunSlab(request, target, s == 0, report) && plain;
    const Clock::time_point begin = Clock::now();
    target.Read(this->ReadQueue, request);
    if (!overlapped || s + 1 == slabs.size())
    {
      for (OutputSlab& read : this->Targets)
      {
        read.FinishReading();
      }
    }
    report.TransferTime += std::chrono::duration<double>(Clock::now() - begin).count();
  }
  this->WasContested = report.Overlapping;
  report.NumberOfResampledBricks = report.NumberOfBricks;
  // Only the kernel for processors works on bricks one by one.
  if (request.Incremental && plain && this->Context->GetDevice().HasVectors &&
    request.Method != Resampling::Published && this->UseLanes(request.Method, this->Targets[0]))
  {
    this->Update.Start(this->Mesh->GetBricks(), this->Mesh->GetVoxelGrid(), request.OutputExtent);
    this->LastMethod = request.Method;
    this->LastWholeExtent = request.WholeOutputExtent;
    this->LastCovered = static_cast<std::uint64_t>(report.NumberOfCoveredVoxels);
  }
}

DeformReport VolumeDeformer::Internals::Deform(const DeformRequest& request, std::uint64_t spare)
{
  // However this ends, the memory of the request is left alone afterwards.
  struct Finish
  {
    ~Finish()
    {
      for (OutputSlab& target : this->Targets)
      {
        target.Finish();
      }
    }
    std::array<OutputSlab, 2>& Targets;
  };
  const Finish finish{ this->Targets };
  const QueueGuard reads(this->ReadQueue);
  this->MappingEvents.clear();
  this->ResamplingEvents.clear();
  this->LaunchesDone = 0;
  this->LaunchesExpected = 1;
  this->PlanningTime = 0.0;
  DeformReport report;
  report.NumberOfBricks = static_cast<std::int64_t>(this->Mesh->GetBricks().GetNumberOfBricks());
  bool updated = false;
  try
  {
    updated = this->UpdateOutput(request, this->Targets[0], report);
  }
  catch (...)
  {
    this->Update.Forget();
    throw;
  }
  if (!updated)
  {
    this->Update.Forget();
    this->DeformSlabs(request, spare, report);
  }
  report.MappingTime = GetSeconds(this->MappingEvents);
  report.ResamplingTime = GetSeconds(this->ResamplingEvents) + this->PlanningTime;
  report.TransferTime += this->SendingTime;
  this->SendingTime = 0.0;
  this->MappingEvents.clear();
  this->ResamplingEvents.clear();
  return report;
}

} // namespace deformvolume
