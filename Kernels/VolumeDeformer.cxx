// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformer.h"

#include "Device.h"
#include "DeviceLattice.h"
#include "KernelProgram.h"
#include "OpenCLContext.h"
#include "OutputSlab.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace deformvolume
{
namespace
{

/// Cell layers in a launch: few enough that positions stay in the caches and that progress is
/// reported, and enough that the planes mapped twice cost little.
const int LayersPerLaunch = 32;

/// Displacements over so many voxels leave the range in which the kernels round them.
const float LargestDisplacement = 16383.0F;

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

std::size_t GetTupleSize(const VolumeArray& array)
{
  return GetElementSize(array.Type) * static_cast<std::size_t>(array.Components);
}

void CheckExtent(const Extent& extent, const char* what)
{
  if (GetNumberOfPoints(extent) == 0)
  {
    throw Error(std::string("The extent of the ") + what + " is empty.");
  }
}

// The kernels trust these indices: a wrong one would read beyond a buffer.
void CheckIndices(const Tetrahedron* tetrahedra, std::size_t count, std::size_t numberOfNodes)
{
  for (std::size_t t = 0; t < count; ++t)
  {
    for (const std::int32_t node : tetrahedra[t])
    {
      if (node < 0 || static_cast<std::size_t>(node) >= numberOfNodes)
      {
        throw Error("Tetrahedron " + std::to_string(t) + " of the deformation mesh has the node " +
          std::to_string(node) + ", but there are " + std::to_string(numberOfNodes) + ".");
      }
    }
  }
}

void CheckLinks(const VertexLink* links, std::int64_t count, std::size_t numberOfTetrahedra)
{
  for (std::int64_t i = 0; i < count; ++i)
  {
    if (links[i].Tetrahedron >= 0 &&
      static_cast<std::size_t>(links[i].Tetrahedron) >= numberOfTetrahedra)
    {
      throw Error("Voxel " + std::to_string(i) + " is linked to the tetrahedron " +
        std::to_string(links[i].Tetrahedron) + ", but there are " +
        std::to_string(numberOfTetrahedra) + ".");
    }
  }
}

/// The three floats of each point padded to the four that the device reads at once.
std::vector<float> MakeVectors(const float* vectors, std::size_t count, const char* what)
{
  std::vector<float> padded(4 * count);
  for (std::size_t i = 0; i < count; ++i)
  {
    for (std::size_t c = 0; c < 3; ++c)
    {
      const float value = vectors[3 * i + c];
      if (!(std::abs(value) <= LargestDisplacement))
      {
        throw Error(std::string("The displacement of ") + what + " " + std::to_string(i) +
          " is not finite, or over 16,383 output voxels.");
      }
      padded[4 * i + c] = value;
    }
  }
  return padded;
}

} // namespace

class VolumeDeformer::Internals
{
public:
  /// Runs a function, with floating-point traps off and OpenCL's errors put into words.
  template <typename Function>
  auto Guard(Function&& function)
  {
    const FloatingPointTrapGuard guard;
    try
    {
      return function();
    }
    catch (const cl::Error& error)
    {
      this->Forget(); // what is on the device may be half done
      throw Error(Describe(error));
    }
  }

  /// Like Guard, for functions that send data: their time belongs to the next execution.
  template <typename Function>
  void Send(Function&& function)
  {
    const Clock::time_point begin = Clock::now();
    this->Guard(function);
    this->SendingTime += std::chrono::duration<double>(Clock::now() - begin).count();
  }

  void Forget()
  {
    this->Mesh.reset();
    this->Arrays.clear();
    this->Tetrahedra = cl::Buffer();
    this->Nodes = cl::Buffer();
    this->FieldVectors = cl::Buffer();
    this->Positions = cl::Buffer();
    this->Target = OutputSlab();
    this->NumberOfNodes = 0;
    this->NodesSet = false;
  }

  OpenCLContext& GetContext()
  {
    if (!this->Context)
    {
      this->SelectDevice("");
    }
    return *this->Context;
  }

  void SelectDevice(const std::string& request)
  {
    const OpenCLDevice device = FindDevice(request);
    OpenCLContext& context = OpenCLContext::Get(device);
    if (&context != this->Context)
    {
      this->Forget();
      this->Context = &context;
      this->Queue = cl::CommandQueue(
        context.GetContext(), context.GetDevice().Device, CL_QUEUE_PROFILING_ENABLE);
    }
  }

  DeviceLattice& GetMesh()
  {
    if (!this->Mesh)
    {
      throw Error("No volume is set: call SetLattice first.");
    }
    return *this->Mesh;
  }

  std::uint64_t GetAllocationLimit()
  {
    const std::uint64_t device =
      this->GetContext().GetDevice().Device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    return this->AllocationLimit ? std::min(device, this->AllocationLimit) : device;
  }

  cl::Buffer SendBuffer(const void* data, std::size_t bytes, const cl::Buffer& previous)
  {
    cl::Buffer buffer = previous;
    if (GetMemory(buffer) != bytes)
    {
      buffer = cl::Buffer(this->GetContext().GetContext(), CL_MEM_READ_ONLY, bytes);
    }
    this->Queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
    return buffer;
  }

  bool UseLanes(Resampling method, const OutputSlab& output) const;
  void CheckRequest(const DeformRequest& request);
  void Map(const cl::Program& program, const LatticeChunk& chunk, const KernelParameters& p);
  void Launch(cl::Kernel& kernel, const KernelParameters& p, bool exact);
  void Run(const DeformRequest& request, OutputSlab& output, int pass);
  DeformReport Deform(const DeformRequest& request);

  OpenCLContext* Context = nullptr;
  cl::CommandQueue Queue;
  std::uint64_t MemoryLimit = 0;
  std::uint64_t AllocationLimit = 0;
  std::size_t WorkGroupSize = 0;

  std::unique_ptr<DeviceLattice> Mesh;
  std::vector<VolumeArray> Arrays; // their Data is not used after it was sent
  cl::Buffer Tetrahedra;
  cl::Buffer Nodes;
  std::size_t NumberOfNodes = 0;
  std::size_t NumberOfTetrahedra = 0;
  bool NodesSet = false;
  FieldParameters Field = {};
  cl::Buffer FieldVectors;
  cl::Buffer Positions;
  OutputSlab Target;

  double SendingTime = 0.0;
  std::vector<cl::Event> MappingEvents;
  std::vector<cl::Event> ResamplingEvents;
  // Progress: launches done, and to do as far as is known.
  std::size_t LaunchesDone = 0;
  std::size_t LaunchesExpected = 1;
};

VolumeDeformer::VolumeDeformer()
  : Impl(new Internals)
{
}

VolumeDeformer::~VolumeDeformer() = default;

std::string VolumeDeformer::SetDevice(const std::string& request)
{
  return this->Impl->Guard(
    [&]
    {
      this->Impl->SelectDevice(request);
      return this->Impl->Context->GetDevice().Name;
    });
}

void VolumeDeformer::SetMemoryLimit(std::uint64_t bytes)
{
  this->Impl->MemoryLimit = bytes;
}

void VolumeDeformer::SetAllocationLimit(std::uint64_t bytes)
{
  this->Impl->AllocationLimit = bytes;
}

void VolumeDeformer::SetWorkGroupSize(std::size_t size)
{
  this->Impl->WorkGroupSize = size;
}

void VolumeDeformer::CheckMemory(const Lattice& lattice, const std::vector<VolumeArray>& arrays,
  const Extent& outputExtent, std::size_t numberOfNodes, std::size_t numberOfTetrahedra,
  bool field) const
{
  std::uint64_t tuple = 0;
  for (const VolumeArray& array : arrays)
  {
    tuple += GetTupleSize(array);
  }
  const auto voxels = static_cast<std::uint64_t>(GetNumberOfPoints(lattice.VertexExtent));
  const auto outputVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(outputExtent));
  const auto plane =
    static_cast<std::uint64_t>(GetSize(lattice.VertexExtent, 0) * GetSize(lattice.VertexExtent, 1));
  // Arrays, state, active tetrahedra and blanking; links where there is a mesh; arrays, coverage
  // and winners of the output; positions of one launch; the deformation itself.
  const std::uint64_t needed = voxels * (tuple + 3 + (field ? 0 : sizeof(VertexLink))) +
    outputVoxels * (tuple + 1 + GetWinnerSize(lattice)) +
    plane * 12 *
      std::min<std::uint64_t>(
        LayersPerLaunch + 3, static_cast<std::uint64_t>(GetSize(lattice.VertexExtent, 2))) +
    (numberOfNodes + numberOfTetrahedra) * 16;
  const std::uint64_t held = this->GetDeviceMemory(); // will be freed or used again
  const std::uint64_t available = this->Impl->Guard(
    [&]
    {
      const std::uint64_t device = this->Impl->GetContext().GetAvailableMemory();
      return this->Impl->MemoryLimit ? this->Impl->MemoryLimit : device + held;
    });
  if (needed > available)
  {
    throw Error("Not enough memory on the device: " + std::to_string(needed) +
      " bytes are needed and " + std::to_string(available) +
      " are available. Use a smaller volume, fewer arrays or smaller output bounds, raise the "
      "memory limit if one is set, or choose another device.");
  }
}

void VolumeDeformer::SetLattice(const Lattice& lattice, std::size_t bytesPerVoxel)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (GetSize(lattice.VertexExtent, axis) < 2)
    {
      throw Error("A volume needs at least two voxels on each axis.");
    }
    if (!(lattice.Scale[axis] > 0.0) || !std::isfinite(lattice.Scale[axis]))
    {
      throw Error("The ratio of the spacings must be greater than 0.");
    }
  }
  this->Impl->Guard(
    [&]
    {
      OpenCLContext& context = this->Impl->GetContext();
      this->Impl->Forget();
      this->Impl->Mesh = std::make_unique<DeviceLattice>(
        context, this->Impl->Queue, lattice, bytesPerVoxel, this->Impl->GetAllocationLimit());
    });
}

void VolumeDeformer::SetArrays(const std::vector<VolumeArray>& arrays)
{
  if (arrays.empty())
  {
    throw Error("The volume has no array to deform.");
  }
  for (const VolumeArray& array : arrays)
  {
    if (!array.Data || array.Components < 1)
    {
      throw Error("An array of the volume has no data.");
    }
  }
  this->Impl->Send(
    [&]
    {
      this->Impl->GetMesh().SetArrays(arrays);
      this->Impl->Arrays = arrays;
    });
}

void VolumeDeformer::SetBlanked(const unsigned char* blanked)
{
  this->Impl->Send([&] { this->Impl->GetMesh().SetBlanked(blanked); });
}

void VolumeDeformer::SetActiveTetrahedra(const unsigned char* active)
{
  this->Impl->Send([&] { this->Impl->GetMesh().SetActive(active); });
}

void VolumeDeformer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexLink* links)
{
  static_assert(sizeof(Tetrahedron) == 16 && sizeof(VertexLink) == 16, "as the kernels read them");
  if (!numberOfTetrahedra || !numberOfNodes || !tetrahedra || !links)
  {
    throw Error("The deformation mesh is empty.");
  }
  CheckIndices(tetrahedra, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send(
    [&]
    {
      CheckLinks(links, GetNumberOfPoints(this->Impl->GetMesh().GetLattice().VertexExtent),
        numberOfTetrahedra);
      this->Impl->GetMesh().SetLinks(links);
      this->Impl->NumberOfTetrahedra = numberOfTetrahedra;
      this->Impl->Tetrahedra = this->Impl->SendBuffer(
        tetrahedra, numberOfTetrahedra * sizeof(Tetrahedron), this->Impl->Tetrahedra);
      this->Impl->NumberOfNodes = numberOfNodes;
      this->Impl->NodesSet = false;
      this->Impl->FieldVectors = cl::Buffer();
    });
}

void VolumeDeformer::SetNodeDisplacements(const float* displacements)
{
  this->Impl->Send(
    [&]
    {
      if (!this->Impl->GetMesh().HasLinks())
      {
        throw Error("No deformation mesh is set: call SetMesh first.");
      }
      const std::vector<float> nodes =
        MakeVectors(displacements, this->Impl->NumberOfNodes, "node");
      this->Impl->Nodes =
        this->Impl->SendBuffer(nodes.data(), nodes.size() * sizeof(float), this->Impl->Nodes);
      this->Impl->NodesSet = true;
    });
}

void VolumeDeformer::SetDisplacementField(const DisplacementField& field)
{
  const std::size_t points = static_cast<std::size_t>(std::max(field.Dimensions[0], 0)) *
    static_cast<std::size_t>(std::max(field.Dimensions[1], 0)) *
    static_cast<std::size_t>(std::max(field.Dimensions[2], 0));
  if (points == 0 || !field.Vectors)
  {
    throw Error("The displacement field is empty.");
  }
  this->Impl->Send(
    [&]
    {
      FieldParameters parameters = {};
      for (int i = 0; i < 12; ++i)
      {
        parameters.IndexToField[i] = static_cast<float>(field.IndexToField[i]);
      }
      std::copy_n(field.Dimensions.begin(), 3, parameters.Dimensions);
      parameters.Extrapolate = field.Extrapolate;
      DeviceLattice& mesh = this->Impl->GetMesh();
      if (mesh.HasLinks())
      {
        mesh.SetLinks(nullptr);
      }
      const bool same = this->Impl->FieldVectors() &&
        std::equal(
          parameters.IndexToField, parameters.IndexToField + 12, this->Impl->Field.IndexToField) &&
        std::equal(
          parameters.Dimensions, parameters.Dimensions + 3, this->Impl->Field.Dimensions) &&
        parameters.Extrapolate == this->Impl->Field.Extrapolate;
      if (!same)
      {
        mesh.ForgetState();
      }
      this->Impl->Field = parameters;
      const std::vector<float> vectors = MakeVectors(field.Vectors, points, "point");
      if (vectors.size() * sizeof(float) > this->Impl->GetAllocationLimit())
      {
        throw Error("The displacement field is larger than the device can hold in one piece. Use a "
                    "coarser field or another device.");
      }
      this->Impl->FieldVectors = this->Impl->SendBuffer(
        vectors.data(), vectors.size() * sizeof(float), this->Impl->FieldVectors);
    });
}

DeformReport VolumeDeformer::Deform(const DeformRequest& request)
{
  this->Impl->CheckRequest(request);
  const DeviceLattice& mesh = this->Impl->GetMesh();
  this->CheckMemory(mesh.GetLattice(), this->Impl->Arrays, request.OutputExtent,
    this->Impl->NumberOfNodes, this->Impl->NumberOfTetrahedra, !mesh.HasLinks());
  return this->Impl->Guard([&] { return this->Impl->Deform(request); });
}

void VolumeDeformer::Internals::CheckRequest(const DeformRequest& request)
{
  CheckExtent(request.OutputExtent, "output");
  const DeviceLattice& mesh = this->GetMesh();
  if (this->Arrays.empty())
  {
    throw Error("No arrays are set: call SetArrays first.");
  }
  if (!(mesh.HasLinks() && this->NodesSet) && !this->FieldVectors())
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
  const bool fits = FitsLanes(this->Arrays) && output.FitsLanes();
  if (method == Resampling::ExactByLanes && !fits)
  {
    throw Error("The resampling by lanes takes only arrays of one component that are float or "
                "integers of 8 or 16 bits and not categorical, and outputs under 2^31 voxels.");
  }
  return fits &&
    (method == Resampling::ExactByLanes ||
      (method == Resampling::Exact && this->Context->GetDevice().IsProcessor));
}

void VolumeDeformer::Internals::Map(
  const cl::Program& program, const LatticeChunk& chunk, const KernelParameters& p)
{
  const bool byMesh = this->Mesh->HasLinks();
  cl::Kernel kernel(program, byMesh ? "MapByMesh" : "MapByField");
  cl_uint i = 0;
  if (byMesh)
  {
    kernel.setArg(i++, chunk.Links);
    kernel.setArg(i++, chunk.State);
    kernel.setArg(i++, this->Tetrahedra);
    kernel.setArg(i++, this->Nodes);
  }
  else
  {
    kernel.setArg(i++, chunk.State);
    kernel.setArg(i++, this->FieldVectors);
  }
  kernel.setArg(i++, this->Mesh->GetRestPositions());
  kernel.setArg(i++, this->Positions);
  if (!byMesh)
  {
    kernel.setArg(i++, this->Field);
  }
  kernel.setArg(i++, p);
  this->MappingEvents.emplace_back();
  this->Queue.enqueueNDRangeKernel(kernel, cl::NullRange,
    this->Mesh->GetVertexRange(p.PlanesEnd - p.PlanesBegin), this->Mesh->GetVertexGroup(), nullptr,
    &this->MappingEvents.back());
}

void VolumeDeformer::Internals::Launch(cl::Kernel& kernel, const KernelParameters& p, bool exact)
{
  const OpenCLDevice& device = this->Context->GetDevice();
  const std::size_t cells = static_cast<std::size_t>(p.Size[0] - 1);
  const auto largest = kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(device.Device);
  std::size_t group = this->WorkGroupSize ? std::min(this->WorkGroupSize, largest)
                                          : std::min<std::size_t>(64, largest);
  // On a processor one work-item takes a whole row of cells.
  std::size_t items = (cells + group - 1) / group * group;
  if (exact && device.IsProcessor)
  {
    group = this->WorkGroupSize ? group : 1;
    items = group;
  }
  this->ResamplingEvents.emplace_back();
  this->Queue.enqueueNDRangeKernel(kernel, cl::NullRange,
    cl::NDRange(items, static_cast<std::size_t>(p.Size[1] - 1),
      static_cast<std::size_t>(p.LayersEnd - p.LayersBegin)),
    cl::NDRange(group, 1, 1), nullptr, &this->ResamplingEvents.back());
}

void VolumeDeformer::Internals::Run(const DeformRequest& request, OutputSlab& output, int pass)
{
  const bool exact = request.Method != Resampling::Published;
  const bool lanes = this->UseLanes(request.Method, output) && pass == DEFORMVOLUME_PASS_DIRECT;
  const cl::Program mapping = GetMappingProgram(*this->Context);
  cl::Kernel kernel = exact
    ? cl::Kernel(GetResamplingProgram(
                   *this->Context, this->Arrays, GetWinnerSize(this->Mesh->GetLattice()) == 8),
        lanes ? "ResampleByLanes" : "Resample")
    : cl::Kernel(GetPublishedProgram(*this->Context, this->Arrays), "ResamplePublished");
  this->Mesh->UpdateState(mapping, this->Mesh->HasLinks() ? nullptr : &this->Field);
  cl::Event previous;
  for (const LatticeChunk& chunk : this->Mesh->GetChunks())
  {
    // The published method maps all vertices, and then resamples all cells.
    const int step = exact ? LayersPerLaunch : chunk.LayersEnd - chunk.LayersBegin;
    for (int begin = chunk.LayersBegin; begin < chunk.LayersEnd; begin += step)
    {
      KernelParameters p = this->Mesh->GetParameters(chunk);
      p.LayersBegin = begin;
      p.LayersEnd = std::min(begin + step, chunk.LayersEnd);
      p.PlanesBegin = std::max(p.LayersBegin - 1, 0);
      p.PlanesEnd = std::min(p.LayersEnd + 2, p.Size[2]);
      p.SlabFirst = p.PlanesBegin;
      p.Pass = pass;
      output.SetParameters(p);
      const std::uint64_t bytes = static_cast<std::uint64_t>(p.Size[0]) * p.Size[1] * 12 *
          static_cast<std::uint64_t>(p.PlanesEnd - p.PlanesBegin) +
        DEFORMVOLUME_READ_AHEAD * sizeof(cl_int);
      if (GetMemory(this->Positions) < bytes)
      {
        this->Positions = cl::Buffer(this->Context->GetContext(), CL_MEM_READ_WRITE, bytes);
      }
      this->Map(mapping, chunk, p);
      cl_uint i = 0;
      kernel.setArg(i++, this->Positions);
      if (exact)
      {
        kernel.setArg(i++, chunk.State);
      }
      kernel.setArg(i++, p.HasActive ? chunk.Active : chunk.State);
      kernel.setArg(i++, output.GetCoverage());
      if (exact)
      {
        kernel.setArg(i++, output.GetWinners());
        kernel.setArg(i++, output.GetCounters());
      }
      kernel.setArg(i++, p);
      for (std::size_t a = 0; a < this->Arrays.size(); ++a)
      {
        kernel.setArg(i++, chunk.Arrays[a]);
        kernel.setArg(i++, output.GetArray(a));
      }
      this->Launch(kernel, p, exact);
      this->Queue.flush();
      // Wait for the launch before this one: the device always has work while we report.
      if (previous())
      {
        previous.wait();
      }
      previous = this->ResamplingEvents.back();
      ++this->LaunchesDone;
      if (request.Progress &&
        !request.Progress(std::min(1.0, double(this->LaunchesDone) / this->LaunchesExpected)))
      {
        this->Queue.finish();
        throw Aborted();
      }
    }
  }
}

DeformReport VolumeDeformer::Internals::Deform(const DeformRequest& request)
{
  this->MappingEvents.clear();
  this->ResamplingEvents.clear();
  this->LaunchesDone = 0;
  DeformReport report;
  const std::vector<Extent> slabs = OutputSlab::Split(
    request.OutputExtent, this->Arrays, this->Mesh->GetLattice(), this->GetAllocationLimit());
  const std::size_t launches =
    static_cast<std::size_t>((this->Mesh->GetSize(2) + LayersPerLaunch - 1) / LayersPerLaunch);
  double transferTime = 0.0;
  for (std::size_t s = 0; s < slabs.size(); ++s)
  {
    this->LaunchesExpected = (slabs.size() - s) * launches + this->LaunchesDone;
    this->Target.Prepare(*this->Context, this->Queue, slabs[s], this->Arrays,
      this->Mesh->GetLattice(), this->ResamplingEvents);
    this->Run(request, this->Target, DEFORMVOLUME_PASS_DIRECT);
    std::uint64_t covered =
      this->Target.CountCovered(*this->Context, this->Arrays, this->ResamplingEvents);
    const OutputSlab::Counts counts = this->Target.ReadCounts();
    if (s == 0) // every slab sees all tetrahedra
    {
      report.NumberOfInvertedTetrahedra = static_cast<std::int64_t>(counts.Inverted);
      report.NumberOfOverstretchedCells = static_cast<std::int64_t>(counts.Overstretched);
    }
    // Every covered voxel was written once, unless tetrahedra overlap; where the mesh is folded,
    // voxels on the crease may also be missing.
    if (request.Method != Resampling::Published && (counts.Writes > covered || counts.Inverted > 0))
    {
      report.Overlapping |= counts.Writes > covered;
      this->LaunchesExpected += 2 * launches;
      this->Target.PrepareWinners(*this->Context, this->ResamplingEvents);
      this->Run(request, this->Target, DEFORMVOLUME_PASS_MARK);
      this->Run(request, this->Target, DEFORMVOLUME_PASS_WINNER);
      covered = this->Target.CountCovered(*this->Context, this->Arrays, this->ResamplingEvents);
    }
    report.NumberOfCoveredVoxels += static_cast<std::int64_t>(covered);
    this->Queue.finish();
    const Clock::time_point begin = Clock::now();
    this->Target.Read(request);
    transferTime += std::chrono::duration<double>(Clock::now() - begin).count();
  }
  report.MappingTime = GetSeconds(this->MappingEvents);
  report.ResamplingTime = GetSeconds(this->ResamplingEvents);
  report.TransferTime = transferTime + this->SendingTime;
  this->SendingTime = 0.0;
  this->MappingEvents.clear();
  this->ResamplingEvents.clear();
  return report;
}

std::uint64_t VolumeDeformer::GetDeviceMemory() const
{
  const Internals& impl = *this->Impl;
  return (impl.Mesh ? impl.Mesh->GetMemory() : 0) + GetMemory(impl.Tetrahedra) +
    GetMemory(impl.Nodes) + GetMemory(impl.FieldVectors) + GetMemory(impl.Positions) +
    impl.Target.GetMemory();
}

void VolumeDeformer::ReleaseMemory()
{
  this->Impl->Forget();
}

} // namespace deformvolume
