// SPDX-License-Identifier: BSD-3-Clause
#include "MeshRasterizer.h"

#include "CompilationWatch.h"
#include "DeviceVolume.h"
#include "Error.h"
#include "OutputSlab.h"
#include "RasterTarget.h"
#include "RasterizationProgram.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

namespace deformvolume
{
namespace
{

using Clock = std::chrono::steady_clock;

/// Seconds since it was made, without those in which kernels were compiled.
class Stopwatch
{
public:
  double GetSeconds() const
  {
    const std::chrono::duration<double> passed = Clock::now() - this->Begin;
    return passed.count() - (CompilationWatch::GetCurrentSeconds() - this->Compiled);
  }

private:
  Clock::time_point Begin = Clock::now();
  double Compiled = CompilationWatch::GetCurrentSeconds();
};

// Positions in 1/256 voxel and their differences then fit into 32 bits.
constexpr double LargestPosition = 1 << 21;

// Launches a rasterisation is split into, for progress and for an abort.
constexpr int LaunchesPerSlab = 32;

constexpr int TileBits[3] = { DEFORMVOLUME_TILE_BITS_X, DEFORMVOLUME_TILE_BITS_Y,
  DEFORMVOLUME_TILE_BITS_Z };

// Six times the signed volume of a tetrahedron at rest.
double GetRestVolume(const Tetrahedron& tetrahedron, const double* nodes)
{
  double sides[3][3];
  for (int side = 0; side < 3; ++side)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      sides[side][axis] =
        nodes[3 * tetrahedron[side + 1] + axis] - nodes[3 * tetrahedron[0] + axis];
    }
  }
  return sides[0][0] * (sides[1][1] * sides[2][2] - sides[1][2] * sides[2][1]) +
    sides[0][1] * (sides[1][2] * sides[2][0] - sides[1][0] * sides[2][2]) +
    sides[0][2] * (sides[1][0] * sides[2][1] - sides[1][1] * sides[2][0]);
}

void Send(
  const MeshRasterizer::Setting& setting, cl::Buffer& buffer, const void* data, std::uint64_t bytes)
{
  if (bytes > setting.AllocationLimit)
  {
    throw Error("The deformation mesh needs " + std::to_string(bytes) +
      " bytes in one piece, and the device gives no more than " +
      std::to_string(setting.AllocationLimit) + ". Use a coarser mesh or another device.");
  }
  if (GetMemory(buffer) != bytes)
  {
    buffer = cl::Buffer(); // free the old one before the new one is made
    buffer = cl::Buffer(setting.Context.GetContext(), CL_MEM_READ_ONLY, bytes);
  }
  setting.Queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
}

void Reserve(const MeshRasterizer::Setting& setting, cl::Buffer& buffer, std::uint64_t bytes)
{
  if (bytes > setting.AllocationLimit)
  {
    throw Error("The lists of the tetrahedra in each part of the output need " +
      std::to_string(bytes) + " bytes in one piece, and the device gives no more than " +
      std::to_string(setting.AllocationLimit) +
      ". Use a coarser deformation mesh, the resampler Exact, or another device.");
  }
  if (GetMemory(buffer) < bytes)
  {
    buffer = cl::Buffer();
    buffer = cl::Buffer(setting.Context.GetContext(), CL_MEM_READ_WRITE, bytes);
  }
}

int FloorDivide(int value, int bits)
{
  return value >= 0 ? value >> bits : -((-(value + 1) >> bits) + 1);
}

RasterParameters MakeParameters(
  const DeviceVolume& volume, const Extent& slab, std::size_t numberOfTetrahedra)
{
  RasterParameters p = {};
  for (int axis = 0; axis < 3; ++axis)
  {
    p.Size[axis] = volume.GetSize(axis);
    p.First[axis] = volume.GetVoxelGrid().VertexExtent[2 * axis];
    p.OutputFirst[axis] = slab[2 * axis];
    p.OutputSize[axis] = static_cast<int>(GetSize(slab, axis));
    p.TileFirst[axis] = FloorDivide(slab[2 * axis], TileBits[axis]);
    p.TileCount[axis] = FloorDivide(slab[2 * axis + 1], TileBits[axis]) - p.TileFirst[axis] + 1;
    // As many as fit into an int beside an index that is one voxel too far, and into a float.
    int bits = 24;
    while ((static_cast<std::int64_t>(p.Size[axis]) + 2) << bits > std::int64_t{ 1 } << 31)
    {
      --bits;
    }
    p.FractionBits[axis] = bits;
    const double inverse = 1.0 / volume.GetVoxelGrid().Scale[axis];
    p.InverseScale[axis] = static_cast<float>(inverse);
    p.InverseScaleRest[axis] = static_cast<float>(inverse - p.InverseScale[axis]);
    // Rounding to 1/256 output voxel moves a surface that is that of the volume by half of it at
    // most on each axis.
    p.Tolerance[axis] =
      static_cast<int>(std::ldexp(std::min(1.0, inverse / 256.0), p.FractionBits[axis]));
  }
  p.Tetrahedra = static_cast<int>(numberOfTetrahedra);
  p.HasActive = volume.HasActive();
  p.HasBlanked = volume.HasBlanked();
  return p;
}

} // namespace

void MeshRasterizer::SetMesh(const Setting& setting, const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, const double* restNodes, std::size_t numberOfNodes)
{
  this->Clear();
  std::vector<Tetrahedron> oriented(tetrahedra, tetrahedra + numberOfTetrahedra);
  for (Tetrahedron& tetrahedron : oriented)
  {
    const double volume = GetRestVolume(tetrahedron, restNodes);
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
  Send(setting, this->Tetrahedra, oriented.data(), numberOfTetrahedra * sizeof(Tetrahedron));
  this->NumberOfTetrahedra = numberOfTetrahedra;
  this->RestNodes.assign(restNodes, restNodes + 3 * numberOfNodes);
}

void MeshRasterizer::SetDisplacements(
  const Setting& setting, const float* displacements, const std::array<double, 3>& scale)
{
  const std::size_t count = this->RestNodes.size() / 3;
  std::vector<std::int32_t> positions(4 * count);
  std::vector<float> padded(4 * count);
  this->FarthestPosition = 0.0;
  for (std::size_t node = 0; node < count; ++node)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const float displacement = displacements[3 * node + axis];
      const double position =
        scale[axis] * this->RestNodes[3 * node + axis] + static_cast<double>(displacement);
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
  Send(setting, this->Positions, positions.data(), positions.size() * sizeof(std::int32_t));
  Send(setting, this->Displacements, padded.data(), padded.size() * sizeof(float));
  this->DisplacementsSet = true;
}

void MeshRasterizer::CheckPositions() const
{
  if (this->FarthestPosition > LargestPosition)
  {
    throw Error("Node " + std::to_string(this->FarthestNode) +
      " of the deformation mesh is more than 2,097,152 output voxels away from the output's index "
      "0, which the resampler MeshRasterization cannot rasterise. Use the resampler Exact, or a "
      "mesh that ends nearer to the volume.");
  }
}

// Lists the tetrahedra of each tile.
void MeshRasterizer::Bin(const Setting& setting, RasterParameters& p, DeformReport& report)
{
  const std::uint64_t tiles =
    static_cast<std::uint64_t>(p.TileCount[0]) * p.TileCount[1] * p.TileCount[2];
  // More ranges keep more work-items busy, and cost two counters a tile each.
  const cl::Device& device = setting.Context.GetDevice().Device;
  const std::uint64_t most = std::max<std::uint64_t>(1, (std::uint64_t{ 64 } << 20) / (8 * tiles));
  p.Ranges = static_cast<int>(std::min<std::uint64_t>(
    { most, 4 * std::uint64_t{ device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>() }, 128,
      std::uint64_t{ this->NumberOfTetrahedra } }));
  const std::uint64_t ranges = static_cast<std::uint64_t>(p.Ranges);
  Reserve(setting, this->Places, 2 * ranges * tiles * sizeof(cl_uint));
  Reserve(setting, this->ListBegins, (tiles + 1) * sizeof(cl_uint));
  const cl::Buffer counters(setting.Context.GetContext(), CL_MEM_WRITE_ONLY,
    ranges * DEFORMVOLUME_BINNED_COUNTERS * sizeof(cl_uint));

  const cl::Program program = GetBinningProgram(setting.Context);
  cl::Kernel count(program, "CountTetrahedra");
  count.setArg(0, this->Tetrahedra);
  count.setArg(1, this->Positions);
  count.setArg(2, this->Places);
  count.setArg(3, counters);
  count.setArg(4, p);
  setting.Context.Launch(
    setting.Queue, count, cl::NDRange(static_cast<std::size_t>(ranges)), cl::NDRange(1));
  std::vector<cl_uint> counts(static_cast<std::size_t>(ranges) * DEFORMVOLUME_BINNED_COUNTERS);
  setting.Queue.enqueueReadBuffer(
    counters, CL_TRUE, 0, counts.size() * sizeof(cl_uint), counts.data());
  report.NumberOfInvertedTetrahedra = 0;
  std::uint64_t overstretched = 0;
  for (std::size_t range = 0; range < ranges; ++range)
  {
    const cl_uint* counter = counts.data() + range * DEFORMVOLUME_BINNED_COUNTERS;
    report.NumberOfInvertedTetrahedra += counter[DEFORMVOLUME_BINNED_INVERTED];
    overstretched += counter[DEFORMVOLUME_BINNED_OVERSTRETCHED];
  }
  if (overstretched > 0)
  {
    throw Error(std::to_string(overstretched) +
      " tetrahedra of the deformation mesh span more than 5,000 output voxels, which the resampler "
      "MeshRasterization cannot rasterise. Use the resampler Exact, a finer mesh or a greater "
      "output spacing.");
  }

  // Places: sums over the ranges, tile by tile.
  std::vector<cl_uint> begins(static_cast<std::size_t>(tiles) + 1);
  const std::size_t bytes = static_cast<std::size_t>(2 * ranges * tiles) * sizeof(cl_uint);
  cl_uint* places = static_cast<cl_uint*>(
    setting.Queue.enqueueMapBuffer(this->Places, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes));
  std::uint64_t place = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile)
  {
    begins[tile] = static_cast<cl_uint>(place);
    for (std::size_t range = 0; range < 2 * ranges; ++range)
    {
      cl_uint& entry = places[range * tiles + tile];
      const cl_uint number = entry;
      entry = static_cast<cl_uint>(place);
      place += number;
    }
  }
  begins[tiles] = static_cast<cl_uint>(place);
  setting.Queue.enqueueUnmapMemObject(this->Places, places);
  if (place > std::numeric_limits<cl_uint>::max())
  {
    throw Error("The deformation mesh and the output are too large for the resampler "
                "MeshRasterization: use the resampler Exact, or a coarser mesh.");
  }
  setting.Queue.enqueueWriteBuffer(
    this->ListBegins, CL_TRUE, 0, begins.size() * sizeof(cl_uint), begins.data());
  Reserve(setting, this->Lists, std::max<std::uint64_t>(place, 1) * sizeof(cl_int));
  cl::Kernel list(program, "ListTetrahedra");
  list.setArg(0, this->Tetrahedra);
  list.setArg(1, this->Positions);
  list.setArg(2, this->Places);
  list.setArg(3, this->Lists);
  list.setArg(4, p);
  setting.Context.Launch(
    setting.Queue, list, cl::NDRange(static_cast<std::size_t>(ranges)), cl::NDRange(1));
  setting.Queue.finish();
}

void MeshRasterizer::RunTiles(const Setting& setting, cl::Kernel& kernel, const VolumeChunk& chunk,
  RasterParameters p, const RasterTarget& target, const std::function<bool(double)>& progress,
  DeformReport& report)
{
  const std::size_t tiles = static_cast<std::size_t>(p.TileCount[0]) *
    static_cast<std::size_t>(p.TileCount[1]) * static_cast<std::size_t>(p.TileCount[2]);
  const std::size_t counterBytes = tiles * DEFORMVOLUME_TILE_COUNTERS * sizeof(cl_uint);
  const cl::Buffer counters(setting.Context.GetContext(), CL_MEM_WRITE_ONLY, counterBytes);
  const QueueGuard guard(setting.Queue);
  cl_uint i = this->SetDeformationArguments(kernel);
  // Any buffer stands in for a missing one: not all drivers take a null pointer.
  kernel.setArg(i++, p.HasActive ? chunk.Active : target.GetCoverage());
  kernel.setArg(i++, p.HasBlanked ? chunk.Blanked : target.GetCoverage());
  kernel.setArg(i++, target.GetBackgrounds());
  kernel.setArg(i++, target.GetCoverage());
  kernel.setArg(i++, counters);
  const cl_uint parameters = i++;
  for (std::size_t a = 0; a < chunk.Arrays.size(); ++a)
  {
    kernel.setArg(i++, chunk.Arrays[a]);
    kernel.setArg(i++, target.GetArray(a));
  }
  const OpenCLDevice& device = setting.Context.GetDevice();
  const auto largest = kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(device.Device);
  const std::size_t wanted =
    setting.WorkGroupSize ? setting.WorkGroupSize : (device.HasVectors ? 1 : 64);
  const std::size_t group = std::min(wanted, largest);
  const std::size_t step = (tiles + LaunchesPerSlab - 1) / LaunchesPerSlab;
  cl::Event previous;
  for (std::size_t tile = 0; tile < tiles; tile += step)
  {
    p.TileBegin = static_cast<int>(tile);
    kernel.setArg(parameters, p);
    setting.Context.Prepare(setting.Queue, kernel, cl::NDRange(group)); // of the first tile
    const cl::Event event = setting.Context.Launch(
      setting.Queue, kernel, cl::NDRange(std::min(step, tiles - tile) * group), cl::NDRange(group));
    setting.Queue.flush();
    // Wait for the launch before this one: the device always has work while we report.
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
  setting.Queue.enqueueReadBuffer(counters, CL_TRUE, 0, counterBytes, counts.data());
  for (std::size_t tile = 0; tile < tiles; ++tile)
  {
    const cl_uint* counter = counts.data() + tile * DEFORMVOLUME_TILE_COUNTERS;
    report.NumberOfCoveredVoxels += counter[DEFORMVOLUME_TILE_COVERED];
    report.Overlapping |= counter[DEFORMVOLUME_TILE_OVERLAPS] != 0;
  }
}

DeformReport MeshRasterizer::Deform(const Setting& setting, const DeviceVolume& volume,
  const std::vector<VolumeArray>& arrays, const DeformRequest& request, std::uint64_t spare)
{
  this->CheckPositions();
  if (volume.GetChunks().size() > 1)
  {
    throw Error("The volume has more bytes than the device gives in one piece, which the resampler "
                "MeshRasterization needs. Use the resampler Exact, or another device.");
  }
  cl::Kernel kernel = this->MakeKernel(setting, volume, arrays, request.Interpolation);
  const std::vector<Extent> slabs =
    OutputSlab::Split(request.OutputExtent, arrays, volume.GetVoxelGrid(), setting.AllocationLimit);
  const std::uint64_t bytes = OutputSlab::GetBytesPerVoxel(setting.Context, arrays, request) *
    static_cast<std::uint64_t>(GetNumberOfPoints(slabs.front()));
  // As much again for lists of tetrahedra that are longer than was foreseen.
  const bool overlapped = bytes > 0 && slabs.size() > 1 && spare >= 2 * bytes;
  // One is made while the other is copied to the caller.
  std::array<std::unique_ptr<RasterTarget>, 2> targets;
  const QueueGuard reads(setting.ReadQueue);
  DeformReport report;
  report.NumberOfFlatTetrahedra = this->NumberOfFlatTetrahedra;
  for (std::size_t s = 0; s < slabs.size(); ++s)
  {
    Stopwatch watch;
    RasterParameters p = MakeParameters(volume, slabs[s], this->NumberOfTetrahedra);
    DeformReport binned; // every slab sees all tetrahedra
    if (!this->HasField())
    {
      this->Bin(setting, p, binned);
    }
    report.NumberOfInvertedTetrahedra = binned.NumberOfInvertedTetrahedra;
    report.MappingTime += watch.GetSeconds();

    watch = Stopwatch();
    std::unique_ptr<RasterTarget>& target = targets[overlapped ? s % 2 : 0];
    if (target)
    {
      target->FinishReading();
      target.reset();
    }
    report.TransferTime += watch.GetSeconds();

    watch = Stopwatch();
    target = std::make_unique<RasterTarget>(setting.Context, arrays, request, slabs[s]);
    this->RunTiles(
      setting, kernel, volume.GetChunks().front(), p, *target,
      [&](double done)
      {
        return !request.Progress ||
          request.Progress((static_cast<double>(s) + done) / static_cast<double>(slabs.size()));
      },
      report);
    report.ResamplingTime += watch.GetSeconds();

    watch = Stopwatch();
    target->Read(setting.ReadQueue);
    if (!overlapped || s + 1 == slabs.size())
    {
      for (const std::unique_ptr<RasterTarget>& read : targets)
      {
        if (read)
        {
          read->FinishReading();
        }
      }
    }
    report.TransferTime += watch.GetSeconds();
  }
  return report;
}

std::uint64_t MeshRasterizer::GetMemory() const
{
  std::uint64_t bytes = 0;
  for (const cl::Buffer* buffer : { &this->Tetrahedra, &this->Positions, &this->Displacements,
         &this->Places, &this->ListBegins, &this->Lists, &this->FieldVectors })
  {
    bytes += deformvolume::GetMemory(*buffer);
  }
  return bytes;
}

std::uint64_t MeshRasterizer::GetMemoryNeeded(std::uint64_t outputVoxels,
  std::uint64_t bytesPerVoxel, std::size_t numberOfNodes, std::size_t numberOfTetrahedra)
{
  // Tetrahedra with four places in lists, nodes with positions and displacements, or points of a
  // field with their vectors; for a tile four numbers and a few counters.
  const std::uint64_t node = numberOfTetrahedra > 0 ? 32 : 3 * sizeof(float);
  return outputVoxels * (bytesPerVoxel + 1) + std::uint64_t{ numberOfTetrahedra } * 32 +
    std::uint64_t{ numberOfNodes } * node + outputVoxels / DEFORMVOLUME_TILE_VOXELS * 128;
}

} // namespace deformvolume
