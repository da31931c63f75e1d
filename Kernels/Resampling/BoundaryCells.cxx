// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryCells.h"

#include "ArrayText.h"
#include "BinningProgram.h"
#include "DeviceVolume.h"
#include "DisplacementSource.h"
#include "HostMemory.h"
#include "IndexBounds.h" // for GetOutputTransform
#include "KernelLauncher.h"
#include "KernelMaking.h"
#include "KernelSources.h"
#include "KernelText.h"
#include "OutputSlab.h"
#include "SamplingMeshText.h"
#include "WorkDevice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <unordered_map>

namespace deformvolume
{
namespace
{

constexpr int TileSize[3] = { 1 << DEFORMVOLUME_TILE_BITS_X, 1 << DEFORMVOLUME_TILE_BITS_Y,
  1 << DEFORMVOLUME_TILE_BITS_Z };

cl_int4 MakeInt4(int x, int y, int z)
{
  return { { x, y, z, 0 } };
}

cl::Program GetCornerProgram(OpenCLContext& context)
{
  return context.GetProgram(ProgramText(GetReal(context)) + GetSamplingMeshText() +
      RasterParameters_h + MultiplyAdd_cl + FieldPoints_cl + BoundaryCorners_cl,
    KernelOptions);
}

cl::Program GetBoundaryProgram(
  OpenCLContext& context, const std::vector<VolumeArray>& arrays, bool coverageBits, bool serial)
{
  return context.GetProgram(GetSamplingMeshText() + RasterParameters_h +
      MakeArrayText(context, arrays) + "#define CUBIC 0\n#define COVERAGE_IS_BITS " +
      (coverageBits ? "1" : "0") + "\n#define ROWS_AT_ONCE " +
      (serial ? "DEFORMVOLUME_TILE_ROWS\n" : "1\n") + MultiplyAdd_cl + GetTileText(false) +
      PointInTetrahedron_cl + SampleStoring_cl + BoundaryCells_cl,
    KernelOptions);
}

} // namespace

BoundaryCells::BoundaryCells(WorkDevice& device, MemoryBudget& budget, DeviceVolume& volume,
  const DisplacementSource& source, KernelLauncher& launcher)
  : Device(device)
  , Budget(budget)
  , Volume(volume)
  , Source(source)
  , Launcher(launcher)
{
}

void BoundaryCells::Clear()
{
  this->Boundary.clear();
  this->NumberOfCorners = 0;
  for (cl::Buffer* buffer : { &this->Corners, &this->Pieces, &this->Positions, &this->Displacements,
         &this->Tiles, &this->PatchCounts })
  {
    *buffer = cl::Buffer();
  }
  this->Lists = TetrahedronLists();
  this->Counts = { 0, 0 };
  this->CoveredInPatches.clear();
  this->Covered = 0;
}

void BoundaryCells::Set(const MeshBoundary& boundary, const Tetrahedron* tetrahedra)
{
  this->Clear();
  this->Boundary = boundary.Pieces;
  this->SetCorners(tetrahedra);
}

void BoundaryCells::SetCorners(const Tetrahedron* tetrahedra)
{
  if (this->IsEmpty())
  {
    return;
  }
  const OutputTransform transform = GetOutputTransform(this->Volume.GetVoxelGrid());
  const bool isMirrored = this->Volume.GetVoxelGrid().ToOutput.GetDeterminant() < 0.0;
  std::vector<BoundaryCorner> corners;
  std::vector<cl_int4> pieces;
  std::unordered_map<std::int32_t, cl_int> found; // corner of each node
  for (const MeshBoundary::Piece& piece : this->Boundary)
  {
    cl_int4 numbers;
    for (std::size_t k = 0; k < 4; ++k)
    {
      const std::array<float, 4>& weights = piece.Weights[k];
      const auto one = std::find(weights.begin(), weights.end(), 1.0F) - weights.begin();
      const bool isNode = tetrahedra && one < 4;
      numbers.s[k] = static_cast<cl_int>(corners.size());
      if (isNode)
      {
        const Tetrahedron& nodes = tetrahedra[static_cast<std::size_t>(piece.Tetrahedron)];
        const std::int32_t node = nodes[static_cast<std::size_t>(one)];
        numbers.s[k] = found.emplace(node, numbers.s[k]).first->second;
      }
      if (numbers.s[k] < static_cast<cl_int>(corners.size()))
      {
        continue;
      }
      BoundaryCorner corner;
      const glm::dvec3 scaled = 256.0 * transform.ToOutput(piece.Rest[k]);
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const double position = scaled[static_cast<glm::length_t>(axis)];
        // Positions beyond the clamping range are outside any output.
        const double whole = std::clamp(std::floor(position), -0x1p30, 0x1p30);
        corner.Whole[axis] = static_cast<cl_int>(whole);
        corner.Fraction[axis] = static_cast<float>(position - whole);
      }
      std::copy(weights.begin(), weights.end(), corner.Weights);
      corner.Tetrahedron = piece.Tetrahedron;
      corner.Node = isNode ? static_cast<cl_int>(one) : -1;
      corners.push_back(corner);
    }
    if (isMirrored)
    {
      std::swap(numbers.s[2], numbers.s[3]); // keeps upright pieces upright
    }
    pieces.push_back(numbers);
  }
  const std::uint64_t bytes =
    std::max(corners.size() * sizeof(BoundaryCorner), pieces.size() * sizeof(cl_int4));
  // The limit of SetAllocationLimit() is for data that can be divided, so use the limit of the
  // device.
  const std::uint64_t most =
    this->Device.GetDevice().Device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  CheckAllocation(bytes, most, "The cells on the boundary of the deformation",
    "Use a coarser mesh or field, a smaller volume");
  this->Device.Send(this->Corners, corners);
  this->Device.Send(this->Pieces, pieces);
  OpenCLContext& context = this->Device.GetContext();
  Reserve(context, this->Positions, corners.size() * sizeof(cl_int4));
  Reserve(context, this->Displacements, corners.size() * sizeof(cl_float4));
  this->NumberOfCorners = corners.size();
}

void BoundaryCells::MoveCorners()
{
  OpenCLContext& context = this->Device.GetContext();
  cl::Kernel kernel(GetCornerProgram(context), "MoveCorners");
  const auto count = static_cast<cl_uint>(this->NumberOfCorners);
  const cl_uint i = this->Source.SetPointArguments(kernel, SetArguments(kernel, 0, this->Corners));
  SetArguments(kernel, i, this->Positions, this->Displacements, count);
  this->Launcher.AddMapping(this->Device.Launch(kernel, count));
}

std::vector<cl_uint> BoundaryCells::ListTiles(
  const RasterParameters& r, const std::vector<std::uint32_t>* patches)
{
  std::vector<cl_uint> tiles;
  const auto count = static_cast<std::size_t>(CountTiles(r));
  if (!patches)
  {
    tiles.resize(count);
    std::iota(tiles.begin(), tiles.end(), 0U);
    return tiles;
  }
  std::vector<unsigned char> wanted(count);
  const std::uint32_t across = DEFORMVOLUME_PATCHES(static_cast<std::uint32_t>(r.OutputSize[0]));
  const std::uint32_t down = DEFORMVOLUME_PATCHES(static_cast<std::uint32_t>(r.OutputSize[1]));
  for (const std::uint32_t patch : *patches)
  {
    const int scaled[3] = { static_cast<int>(patch % across),
      static_cast<int>(patch / across % down), static_cast<int>(patch / across / down) };
    Extent touched;
    for (int axis = 0; axis < 3; ++axis)
    {
      // Patches are numbered from the first voxel, tiles from index 0.
      const int low = r.OutputFirst[axis] + scaled[axis] * DEFORMVOLUME_PATCH -
        r.TileFirst[axis] * TileSize[axis];
      const int size =
        std::min(DEFORMVOLUME_PATCH, r.OutputSize[axis] - scaled[axis] * DEFORMVOLUME_PATCH);
      touched[2 * axis] = low / TileSize[axis];
      touched[2 * axis + 1] = (low + size - 1) / TileSize[axis];
    }
    ForEachPoint(touched,
      [&](int x, int y, int z)
      { wanted[static_cast<std::size_t>((z * r.TileCount[1] + y) * r.TileCount[0] + x)] = 1; });
  }
  for (std::size_t tile = 0; tile < count; ++tile)
  {
    if (wanted[tile])
    {
      tiles.push_back(static_cast<cl_uint>(tile));
    }
  }
  return tiles;
}

void BoundaryCells::Run(
  const DeformRequest& request, const OutputSlab& output, const std::vector<std::uint32_t>* patches)
{
  if (this->IsEmpty())
  {
    return;
  }
  const cl::CommandQueue& queue = this->Device.GetQueue();
  RasterParameters r = MakeTiles(output.GetExtent(), this->Boundary.size());
  SetInverse(this->Volume.GetVoxelGrid(), r);
  r.HasActive = this->Volume.GetMasks().HasGivenActive();
  r.HasBlanked = this->Volume.GetMasks().HasBlanked();
  r.HasDistances = this->Volume.GetMasks().HasDistances();

  std::size_t numberOfPatches = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    numberOfPatches *= static_cast<std::size_t>(DEFORMVOLUME_PATCHES(r.OutputSize[axis]));
  }
  this->CoveredInPatches.resize(numberOfPatches);
  if (patches)
  {
    for (const std::uint32_t patch : *patches)
    {
      this->CoveredInPatches[patch] = 0;
    }
  }
  else
  {
    this->CoveredInPatches.assign(numberOfPatches, 0);
  }
  const QueueGuard guard(queue);
  this->MoveCorners();
  this->Counts = this->Lists.Make(this->Device, this->Budget, this->Pieces, this->Positions, r);
  const std::vector<cl_uint> tiles = ListTiles(r, patches);
  if (!tiles.empty())
  {
    this->Device.Send(this->Tiles, tiles);
    const std::uint64_t bytes = numberOfPatches * sizeof(cl_uint);
    Reserve(this->Device.GetContext(), this->PatchCounts, bytes);
    PendingCopy sent =
      BeginToWrite(queue, this->PatchCounts, 0, bytes, this->CoveredInPatches.data());
    this->RunTiles(request, output, r, tiles.size());
    queue.enqueueReadBuffer(this->PatchCounts, CL_TRUE, 0, bytes, this->CoveredInPatches.data());
    sent.Check();
  }
  this->Covered = std::accumulate(
    this->CoveredInPatches.begin(), this->CoveredInPatches.end(), std::uint64_t{ 0 });
}

void BoundaryCells::RunTiles(const DeformRequest& request, const OutputSlab& output,
  const RasterParameters& r, std::size_t numberOfTiles)
{
  const std::vector<VolumeArray>& arrays = this->Volume.GetArrays().Get();
  cl::Kernel kernel(GetBoundaryProgram(this->Device.GetContext(), arrays, output.HasCoverageBits(),
                      this->Device.HasSerialGroups()),
    "ResampleBoundary");
  const std::size_t group = this->Device.GetHeavyGroupSize(kernel);
  const Extent& whole = GetWholeExtent(this->Volume.GetVoxelGrid());
  const std::vector<VolumeChunk>& chunks = this->Volume.GetChunks();
  const DeviceMasks& masks = this->Volume.GetMasks();
  // With several chunks, all upright pieces must come before any inverted one.
  for (const int orientation : chunks.size() > 1 ? std::vector<int>{ 1, 2 } : std::vector<int>{ 3 })
  {
    for (const VolumeChunk& chunk : chunks)
    {
      KernelParameters p = this->Volume.GetParameters(chunk);
      output.SetParameters(p);
      cl_uint i = SetArguments(kernel, 0, this->Pieces, this->Positions, this->Displacements,
        this->Lists.GetBegins(), this->Lists.GetLists(), this->Tiles, masks.GetActive(chunk),
        chunk.Active, chunk.Blanked, chunk.Distances, output.GetCoverageTarget(), this->PatchCounts,
        MakeInt4(whole[0], whole[2], whole[4]), MakeInt4(whole[1], whole[3], whole[5]),
        cl_int{ orientation }, r, p);
      const std::vector<cl::Buffer>& sources = this->Volume.GetArrays().GetBuffers(chunk);
      for (std::size_t a = 0; a < sources.size(); ++a)
      {
        i = SetArguments(kernel, i, sources[a], output.GetArray(a));
      }
      this->Launcher.LaunchAndReport(
        request, kernel, cl::NDRange(numberOfTiles * group), cl::NDRange(group));
    }
  }
}

std::size_t BoundaryCells::GetNumberOfLaunches() const
{
  const std::size_t chunks = this->Volume.GetChunks().size();
  return this->IsEmpty() ? 0 : chunks > 1 ? 2 * chunks : 1;
}

std::uint64_t BoundaryCells::GetMemory() const
{
  return this->Lists.GetMemory() +
    deformvolume::GetMemory(this->Corners, this->Pieces, this->Positions, this->Displacements,
      this->Tiles, this->PatchCounts);
}

} // namespace deformvolume
