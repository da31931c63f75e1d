// SPDX-License-Identifier: BSD-3-Clause
#include "MeshRasterizer.h"

#include "DeviceVolume.h"
#include "Error.h"
#include "HostMemory.h"
#include "IndexBounds.h"
#include "KernelMaking.h"
#include "Stopwatch.h"
#include "WorkDevice.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

namespace deformvolume
{
namespace
{

// The largest position, in output voxels. Positions in 1/256 voxel and their differences fit into
// 32 bits.
constexpr double LargestPosition = 1 << 21;

// The number of launches for a slab, so that progress can be reported and the work aborted.
constexpr int LaunchesPerSlab = 32;

// Six times the signed volume of a tetrahedron at rest.
double GetRestVolume(const Tetrahedron& tetrahedron, const double* nodes)
{
  const auto node = [&](std::size_t k) { return GetVector(nodes, tetrahedron[k]); };
  return glm::dot(node(1) - node(0), glm::cross(node(2) - node(0), node(3) - node(0)));
}

void Send(WorkDevice& device, cl::Buffer& buffer, const void* data, std::uint64_t bytes)
{
  CheckAllocation(bytes, device.GetAllocationLimit(),
    "The nodes and tetrahedra of the deformation mesh", "Use a coarser mesh");
  device.Send(buffer, data, static_cast<std::size_t>(bytes));
}

RasterParameters MakeParameters(
  const DeviceVolume& volume, const Extent& slab, std::size_t numberOfTetrahedra)
{
  RasterParameters p = MakeTiles(slab, numberOfTetrahedra);
  SetInverse(volume.GetVoxelGrid(), p);
  // Rounding to 1/256 output voxel can move the surface of the volume by half of that on each axis.
  const glm::dvec3 tolerance = GetOutputTransform(volume.GetVoxelGrid()).GetTolerance(1.0 / 256.0);
  for (int axis = 0; axis < 3; ++axis)
  {
    p.Size[axis] = volume.GetSize(axis);
    p.First[axis] = volume.GetVoxelGrid().VertexExtent[2 * axis];
    // As many bits as fit into an int, with an index that is one voxel too far, and into a float.
    int bits = 24;
    while ((static_cast<std::int64_t>(p.Size[axis]) + 2) << bits > std::int64_t{ 1 } << 31)
    {
      --bits;
    }
    p.FractionBits[axis] = bits;
    p.Tolerance[axis] = static_cast<int>(std::ldexp(tolerance[axis], p.FractionBits[axis]));
  }
  p.HasActive = volume.GetMasks().HasActive();
  p.HasBlanked = volume.GetMasks().HasBlanked();
  p.HasDistances = volume.GetMasks().HasDistances();
  return p;
}

} // namespace

void MeshRasterizer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  const double* restNodes, std::size_t numberOfNodes)
{
  this->Clear();
  const double sign = std::copysign(1.0, this->Volume->GetVoxelGrid().ToOutput.GetDeterminant());
  std::vector<Tetrahedron> oriented(tetrahedra, tetrahedra + numberOfTetrahedra);
  for (Tetrahedron& tetrahedron : oriented)
  {
    // The orientation of the tetrahedron in the output.
    const double volume = sign * GetRestVolume(tetrahedron, restNodes);
    if (volume < 0.0)
    {
      std::swap(tetrahedron[2], tetrahedron[3]);
    }
    else if (!(volume > 0.0))
    {
      tetrahedron.fill(-1);
      ++this->NumberOfFlatTetrahedra;
    }
  }
  Send(*this->Device, this->Tetrahedra, oriented.data(), numberOfTetrahedra * sizeof(Tetrahedron));
  this->NumberOfTetrahedra = numberOfTetrahedra;
  this->RestNodes.assign(restNodes, restNodes + 3 * numberOfNodes);
}

void MeshRasterizer::SetDisplacements(const float* displacements)
{
  const OutputTransform transform = GetOutputTransform(this->Volume->GetVoxelGrid());
  const std::size_t count = this->RestNodes.size() / 3;
  std::vector<std::int32_t> positions(4 * count);
  std::vector<float> padded(4 * count);
  this->FarthestPosition = 0.0;
  for (std::size_t node = 0; node < count; ++node)
  {
    const glm::dvec3 restPosition =
      transform.ToOutput(GetVector(this->RestNodes.data(), static_cast<std::int64_t>(node)));
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const float displacement = displacements[3 * node + axis];
      const double position =
        restPosition[static_cast<glm::length_t>(axis)] + static_cast<double>(displacement);
      const double distance =
        std::isnan(position) ? std::numeric_limits<double>::infinity() : std::abs(position);
      if (distance > this->FarthestPosition)
      {
        this->FarthestPosition = distance;
        this->FarthestNode = node;
      }
      const bool fits = distance <= LargestPosition;
      positions[4 * node + axis] =
        fits ? static_cast<std::int32_t>(std::lrint(256.0 * position)) : 0;
      padded[4 * node + axis] = displacement;
    }
  }
  Send(*this->Device, this->Positions, positions.data(), positions.size() * sizeof(std::int32_t));
  Send(*this->Device, this->Displacements, padded.data(), padded.size() * sizeof(float));
  this->DisplacementsSet = true;
}

void MeshRasterizer::CheckPositions() const
{
  if (this->FarthestPosition > LargestPosition)
  {
    throw Error("Node " + std::to_string(this->FarthestNode) +
      " of the deformation mesh is more than 2,097,152 output voxels away from the output's index "
      "0, which mesh rasterization cannot take. Use the exact resampler, or a mesh that ends "
      "nearer to the volume.");
  }
}

cl_uint MeshRasterizer::SetArguments(const OutputMemory& target, const cl::Buffer& counters)
{
  const VolumeChunk& chunk = this->Volume->GetChunks().front();
  const cl_uint parameters = deformvolume::SetArguments(this->Kernel,
    this->SetDeformationArguments(this->Kernel), chunk.Active, chunk.Blanked, chunk.Distances,
    this->Backgrounds, target.GetCoverage(), counters);
  cl_uint i = parameters + 1;
  for (std::size_t a = 0; a < chunk.Arrays.size(); ++a)
  {
    i = deformvolume::SetArguments(this->Kernel, i, chunk.Arrays[a], target.GetArray(a));
  }
  return parameters;
}

void MeshRasterizer::RunTiles(RasterParameters p, const OutputMemory& target,
  const std::function<bool(double)>& progress, DeformReport& report)
{
  const std::size_t tiles = static_cast<std::size_t>(p.TileCount[0]) *
    static_cast<std::size_t>(p.TileCount[1]) * static_cast<std::size_t>(p.TileCount[2]);
  const std::size_t counterBytes = tiles * DEFORMVOLUME_TILE_COUNTERS * sizeof(cl_uint);
  OpenCLContext& context = this->Device->GetContext();
  const cl::CommandQueue& queue = this->Device->GetQueue();
  const cl::Buffer counters(context.GetContext(), CL_MEM_WRITE_ONLY, counterBytes);
  const QueueGuard guard(queue);
  const cl_uint parameters = this->SetArguments(target, counters);
  const std::size_t group = this->Device->GetHeavyGroupSize(this->Kernel);
  const std::size_t step = (tiles + LaunchesPerSlab - 1) / LaunchesPerSlab;
  cl::Event previous;
  for (std::size_t tile = 0; tile < tiles; tile += step)
  {
    p.TileBegin = static_cast<int>(tile);
    this->Kernel.setArg(parameters, p);
    context.Prepare(queue, this->Kernel, cl::NDRange(group)); // for the first tile
    const cl::Event event = context.Launch(
      queue, this->Kernel, cl::NDRange(std::min(step, tiles - tile) * group), cl::NDRange(group));
    queue.flush();
    // Wait for the previous launch only, so that the device always has work.
    if (previous())
    {
      previous.wait();
    }
    previous = event;
    if (!progress(static_cast<double>(tile) / static_cast<double>(tiles)))
    {
      throw Aborted();
    }
  }
  std::vector<cl_uint> counts(tiles * DEFORMVOLUME_TILE_COUNTERS);
  queue.enqueueReadBuffer(counters, CL_TRUE, 0, counterBytes, counts.data());
  for (std::size_t tile = 0; tile < tiles; ++tile)
  {
    const cl_uint* counter = counts.data() + tile * DEFORMVOLUME_TILE_COUNTERS;
    report.NumberOfCoveredVoxels += counter[DEFORMVOLUME_TILE_COVERED];
    report.Overlapping |= counter[DEFORMVOLUME_TILE_OVERLAPS] != 0;
  }
}

void MeshRasterizer::Begin(const DeformRequest& request, const SlabPlan&, DeformReport& report)
{
  this->CheckPositions();
  if (this->Volume->GetChunks().size() > 1)
  {
    throw Error("Mesh rasterization needs the volume in one allocation, but the device does not "
                "allow that many bytes. Use the exact resampler or another device.");
  }
  this->Kernel = this->MakeKernel(request.Interpolation);
  std::vector<cl_ulong> backgrounds;
  for (const VolumeArray& array : this->Volume->GetArrays().Get())
  {
    const ElementBytes background = GetBackground(array);
    std::memcpy(&backgrounds.emplace_back(), background.Bytes.data(), background.Size);
  }
  this->Backgrounds =
    cl::Buffer(this->Device->GetContext().GetContext(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
      backgrounds.size() * sizeof(cl_ulong), backgrounds.data());
  report.NumberOfFlatTetrahedra = this->NumberOfFlatTetrahedra;
}

void MeshRasterizer::Make(
  const DeformRequest& request, const SlabPlan& plan, std::size_t slab, DeformReport& report)
{
  Stopwatch watch;
  RasterParameters p = MakeParameters(*this->Volume, plan.Slabs[slab], this->NumberOfTetrahedra);
  if (!this->HasField())
  {
    // The lists of each slab are made from all tetrahedra.
    const TetrahedronLists::Counts counts =
      this->Lists.Make(*this->Device, *this->Budget, this->Tetrahedra, this->Positions, p);
    if (counts.Overstretched > 0)
    {
      throw Error(std::to_string(counts.Overstretched) +
        " tetrahedra of the deformation mesh span more than 5,000 output voxels, which mesh "
        "rasterization cannot take. Use the exact resampler, a finer mesh or a "
        "greater output spacing.");
    }
    report.NumberOfInvertedTetrahedra = counts.Inverted;
  }
  report.MappingTime += watch.GetSeconds();

  watch = Stopwatch();
  OutputMemory& target = this->Targets[plan.GetTarget(slab)];
  target.FinishReading();
  report.TransferTime += watch.GetSeconds();

  watch = Stopwatch();
  target.Bind(
    this->Device->GetContext(), request, this->Volume->GetArrays().Get(), plan.Slabs[slab]);
  const auto slabs = static_cast<double>(plan.Slabs.size());
  this->RunTiles(
    p, target,
    [&](double done)
    { return !request.Progress || request.Progress((static_cast<double>(slab) + done) / slabs); },
    report);
  report.ResamplingTime += watch.GetSeconds();
}

void MeshRasterizer::Finish() noexcept
{
  for (OutputMemory& target : this->Targets)
  {
    target.Release();
    target = OutputMemory();
  }
  this->Backgrounds = cl::Buffer();
  this->Kernel = cl::Kernel();
}

std::uint64_t MeshRasterizer::GetMemory() const
{
  return this->Lists.GetMemory() +
    deformvolume::GetMemory(
      this->Tetrahedra, this->Positions, this->Displacements, this->FieldVectors);
}

std::uint64_t MeshRasterizer::GetMemoryNeeded(WorkDevice& device, std::uint64_t outputVoxels,
  std::uint64_t bytesPerVoxel, std::size_t numberOfNodes, std::size_t numberOfTetrahedra)
{
  // Tetrahedra with their lists; nodes with positions and displacements, or points of a field with
  // their vectors; counters of tiles.
  const std::uint64_t tiles = outputVoxels / DEFORMVOLUME_TILE_VOXELS;
  const bool field = numberOfTetrahedra == 0;
  const std::uint64_t node = field ? 3 * sizeof(float) : 32;
  return outputVoxels * (bytesPerVoxel + 1) +
    std::uint64_t{ numberOfTetrahedra } * sizeof(Tetrahedron) +
    (field ? 0 : TetrahedronLists::GetMemoryNeeded(device, numberOfTetrahedra, tiles)) +
    std::uint64_t{ numberOfNodes } * node + tiles * DEFORMVOLUME_TILE_COUNTERS * sizeof(cl_uint);
}

} // namespace deformvolume
