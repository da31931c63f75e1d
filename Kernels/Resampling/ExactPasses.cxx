// SPDX-License-Identifier: BSD-3-Clause
#include "ExactPasses.h"

#include "BrickGrid.h"
#include "DeviceVolume.h"
#include "DisplacementSource.h"
#include "Error.h"
#include "HostMemory.h"
#include "KernelLauncher.h"
#include "KernelMaking.h"
#include "OutputSlab.h"
#include "WorkDevice.h"

#include <algorithm>
#include <array>
#include <utility>

namespace deformvolume
{

static_assert(DEFORMVOLUME_CUBOID_X % DEFORMVOLUME_SPAN == 0 &&
    DEFORMVOLUME_BRICK_X % DEFORMVOLUME_CUBOID_X == 0 &&
    DEFORMVOLUME_BRICK_Y / 2 % DEFORMVOLUME_CUBOID_Y == 0 &&
    DEFORMVOLUME_BRICK_Z / 2 % DEFORMVOLUME_CUBOID_Z == 0,
  "bricks are made of cuboids, and these of spans in one half of a brick on y and z");

namespace
{

// The approximate number of cells in a launch, on CPUs and on other devices.
constexpr std::int64_t CellsOfProcessors = std::int64_t{ 1 } << 23;
constexpr std::int64_t CellsOfColumns = std::int64_t{ 1 } << 25;

const char* GetKernelName(ResamplingKernel form)
{
  switch (form)
  {
    case ResamplingKernel::Cells:
      return "Resample";
    case ResamplingKernel::Lanes:
      return "ResampleBricks";
    case ResamplingKernel::Columns:
      return "ResampleColumns";
    case ResamplingKernel::DeferredInt32:
      return "ResampleDeferredInt32";
    case ResamplingKernel::DeferredInt64:
      return "ResampleDeferredInt64";
    case ResamplingKernel::LargeCells:
      return "ResampleLargeCells";
  }
  return "";
}

bool IsByColumns(ResamplingKernel form)
{
  return form == ResamplingKernel::Columns || form == ResamplingKernel::DeferredInt32 ||
    form == ResamplingKernel::DeferredInt64;
}

} // namespace

ExactPasses::ExactPasses(WorkDevice& device, DeviceVolume& volume, const DisplacementSource& source,
  KernelLauncher& launcher)
  : Device(device)
  , Volume(volume)
  , Source(source)
  , Launcher(launcher)
  , Deferred(device)
{
}

ResamplingKernel ExactPasses::ChooseKernel(
  const DeformRequest& request, const OutputSlab& output, int pass)
{
  const Resampling method = request.Method;
  const bool isCubic = request.Interpolation == Interpolation::Cubic;
  if (isCubic && (method == Resampling::ExactByLanes || method == Resampling::ExactByColumns))
  {
    throw Error("The resampling by lanes or columns interpolates linearly only. Use the method "
                "Exact, or the interpolation Linear.");
  }
  const bool fits = output.FitsLanes();
  const bool hasVectors = this->Device.GetDevice().HasVectors;
  if ((method == Resampling::ExactByLanes || method == Resampling::ExactByColumns) && !fits)
  {
    throw Error(
      "The resampling by lanes or columns takes only outputs that have at most 32,768 voxels on "
      "each axis and begin within 2^22 voxels of index 0.");
  }
  if (method == Resampling::ExactByLanes && !hasVectors)
  {
    throw Error("The resampling by lanes needs a processor whose work-items have vector registers "
                "of their own. The device \"" +
      this->Device.GetDevice().Name + "\" is not such a processor.");
  }
  const bool hasColumns = HasLocalColumns(this->Device.GetContext());
  if (method == Resampling::ExactByColumns && !hasColumns)
  {
    throw Error("The resampling by columns needs more local memory than the device \"" +
      this->Device.GetDevice().Name + "\" has.");
  }
  if (!fits || isCubic || method == Resampling::ExactByCell || pass == DEFORMVOLUME_PASS_COUNT)
  {
    return ResamplingKernel::Cells;
  }
  if (hasVectors && method != Resampling::ExactByColumns)
  {
    return ResamplingKernel::Lanes;
  }
  return hasColumns ? ResamplingKernel::Columns : ResamplingKernel::Cells;
}

int ExactPasses::GetLayersPerLaunch() const
{
  const std::int64_t cells =
    this->Device.GetDevice().HasVectors ? CellsOfProcessors : CellsOfColumns;
  const std::int64_t layer = std::int64_t{ this->Volume.GetSize(0) } * this->Volume.GetSize(1);
  constexpr std::int64_t turn = BrickGrid::BricksInTurn * DEFORMVOLUME_BRICK_Z;
  const std::int64_t turns = (cells / layer + turn - 1) / turn;
  const std::int64_t mostTurns = this->Volume.GetSize(2) / turn + 1;
  return static_cast<int>(std::clamp<std::int64_t>(turns, 1, mostTurns) * turn);
}

std::size_t ExactPasses::GetNumberOfLaunches() const
{
  const int layers = this->GetLayersPerLaunch();
  return static_cast<std::size_t>((this->Volume.GetSize(2) + layers - 1) / layers);
}

cl::Kernel ExactPasses::MakeKernel(
  const DeformRequest& request, ResamplingKernel form, const OutputSlab& output, int pass)
{
  OpenCLContext& context = this->Device.GetContext();
  const std::vector<VolumeArray>& arrays = this->Volume.GetArrays().Get();
  if (form == ResamplingKernel::Lanes)
  {
    Reserve(context, this->TakenBricks, sizeof(cl_uint));
    if (!HasLocalBricks(context, this->Volume.HasTurnedAxes()))
    {
      Reserve(context, this->BrickRows,
        std::uint64_t{ context.GetNumberOfUnits() } *
          GetBrickMemory(context, this->Volume.HasTurnedAxes(), arrays));
    }
  }
  const bool wideKeys = GetWinnerSize(this->Volume.GetVoxelGrid()) == 8;
  return cl::Kernel(
    GetResamplingProgram(context, this->Source.GetMappingKind(), arrays,
      { form, wideKeys, output.HasCoverageBits(), this->Volume.GetMasks().HasCut(),
        (form == ResamplingKernel::Columns || form == ResamplingKernel::DeferredInt32) &&
          pass == DEFORMVOLUME_PASS_DIRECT,
        request.Interpolation == Interpolation::Cubic, this->Volume.HasTurnedAxes() }),
    GetKernelName(form));
}

void ExactPasses::SetArguments(cl::Kernel& kernel, const VolumeChunk& chunk,
  const OutputSlab& output, ResamplingKernel form, const KernelParameters& p)
{
  const DeviceMasks& masks = this->Volume.GetMasks();
  const OutputWinners& winners = output.GetWinners();
  cl_uint i =
    deformvolume::SetArguments(kernel, this->Source.SetMappingArguments(kernel, chunk), chunk.State,
      masks.GetActive(chunk), chunk.Distances, output.GetCoverageTarget(), winners.GetKeys(),
      winners.GetPatches(), output.GetLargeCells().GetBuffer(), output.GetCounters().GetBuffer());
  if (masks.HasCut())
  {
    i = masks.GetCut().SetArguments(kernel, i);
  }
  if (form != ResamplingKernel::LargeCells)
  {
    kernel.setArg(i++, this->Bricks);
  }
  OpenCLContext& context = this->Device.GetContext();
  const std::vector<VolumeArray>& types = this->Volume.GetArrays().Get();
  const bool turned = this->Volume.HasTurnedAxes();
  if (form == ResamplingKernel::Lanes)
  {
    kernel.setArg(i++, this->TakenBricks);
    if (HasLocalBricks(context, turned))
    {
      kernel.setArg(i++, cl::Local(GetBrickMemory(context, turned, types)));
    }
    else
    {
      kernel.setArg(i++, this->BrickRows);
    }
  }
  else if (IsByColumns(form))
  {
    i = deformvolume::SetArguments(
      kernel, i, this->Deferred.GetBuffer(), cl::Local(GetColumnMemory(context, types, form)));
  }
  else if (form == ResamplingKernel::Cells)
  {
    kernel.setArg(i++, cl::Local(3 * sizeof(cl_int) * DEFORMVOLUME_CUBOID_VERTICES));
  }
  else
  {
    kernel.setArg(i++, this->Pieces);
  }
  kernel.setArg(i++, p);
  const std::vector<cl::Buffer>& arrays = this->Volume.GetArrays().GetBuffers(chunk);
  for (std::size_t a = 0; a < arrays.size(); ++a)
  {
    i = deformvolume::SetArguments(kernel, i, arrays[a], output.GetArray(a));
  }
}

void ExactPasses::PrepareKernel(cl::Kernel& kernel, const VolumeChunk& chunk,
  const OutputSlab& output, ResamplingKernel form, const KernelParameters& parameters)
{
  // An empty list of bricks.
  KernelParameters p = parameters;
  p.ListBegin = p.ListEnd = 0;
  this->SetArguments(kernel, chunk, output, form, p);
  const auto getGroup = [&]
  {
    const std::size_t group = this->Device.GetHeavyGroupSize(kernel);
    switch (form)
    {
      case ResamplingKernel::Cells:
        return cl::NDRange(group, 1, 1);
      case ResamplingKernel::Lanes:
        return cl::NDRange(1);
      case ResamplingKernel::Columns:
        return cl::NDRange(this->GetColumnGroup(kernel), 1, 1);
      case ResamplingKernel::DeferredInt32:
      case ResamplingKernel::DeferredInt64:
        return cl::NDRange(this->Deferred.GetGroup(kernel));
      case ResamplingKernel::LargeCells:
        break;
    }
    return cl::NDRange(group);
  };
  this->Device.GetContext().Prepare(this->Device.GetQueue(), kernel, getGroup());
}

std::size_t ExactPasses::GetColumnGroup(const cl::Kernel& kernel)
{
  return this->Device.GetHeavyGroupSize(kernel, DEFORMVOLUME_SPAN * DEFORMVOLUME_BRICK_Y / 2);
}

std::vector<ExactPasses::PlannedLaunch> ExactPasses::PlanAll(
  const OutputSlab& output, int pass, std::vector<cl_uint>& bricks)
{
  if (this->Volume.GetBricks().GetNumberOfBricks() >> DEFORMVOLUME_BRICK_BITS)
  {
    throw Error("The volume has more than 10^11 voxels. Use a smaller volume.");
  }
  // Take one brick at a time if there are few bricks for each compute unit.
  const int leastForTurns = 32 * static_cast<int>(this->Device.GetContext().GetNumberOfUnits());
  std::vector<PlannedLaunch> launches;
  for (const VolumeChunk& chunk : this->Volume.GetChunks())
  {
    for (int begin = chunk.LayersBegin; begin < chunk.LayersEnd;)
    {
      KernelParameters p = this->Volume.GetParameters(chunk);
      // Launches end at the borders of bricks.
      const int step =
        this->GetLayersPerLaunch() - (begin - p.BrickOrigin[2]) % DEFORMVOLUME_BRICK_Z;
      p.LayersBegin = begin;
      p.LayersEnd = std::min(begin + step, chunk.LayersEnd);
      p.Pass = pass;
      output.SetParameters(p);
      p.ListBegin = static_cast<int>(bricks.size());
      this->Volume.GetBricks().AppendBricks(p.LayersBegin, p.LayersEnd, bricks);
      p.ListEnd = static_cast<int>(bricks.size());
      p.Portion = p.ListEnd - p.ListBegin < leastForTurns ? 1 : BrickGrid::BricksInTurn;
      launches.push_back({ chunk, p });
      begin = p.LayersEnd;
    }
  }
  return launches;
}

std::vector<ExactPasses::PlannedLaunch> ExactPasses::PlanSome(
  const OutputSlab& output, int pass, const std::vector<cl_uint>& bricks)
{
  const VolumeChunk& chunk = this->Volume.GetChunks().front();
  KernelParameters p = this->Volume.GetParameters(chunk);
  p.Pass = pass;
  output.SetParameters(p);
  p.Portion = 1;
  // A launch has as many bricks as a launch of a pass over all bricks.
  const std::size_t step = static_cast<std::size_t>(p.BrickCount[0]) *
    static_cast<std::size_t>(p.BrickCount[1]) *
    static_cast<std::size_t>(this->GetLayersPerLaunch() / DEFORMVOLUME_BRICK_Z);
  std::vector<PlannedLaunch> launches;
  for (std::size_t begin = 0; begin < bricks.size(); begin += step)
  {
    p.ListBegin = static_cast<int>(begin);
    p.ListEnd = static_cast<int>(std::min(begin + step, bricks.size()));
    launches.push_back({ chunk, p });
  }
  this->Launcher.ExpectAtLeast(launches.size());
  return launches;
}

void ExactPasses::Launch(const DeformRequest& request, cl::Kernel& kernel, ResamplingKernel form,
  const KernelParameters& p)
{
  const auto bricks = static_cast<cl_uint>(p.ListEnd - p.ListBegin);
  if (form == ResamplingKernel::Lanes)
  {
    this->Device.GetQueue().enqueueFillBuffer(this->TakenBricks, cl_uint{ 0 }, 0, sizeof(cl_uint));
    this->Launcher.LaunchAndReport(request, kernel,
      cl::NDRange(std::min(this->Device.GetContext().GetNumberOfUnits(), bricks)), cl::NDRange(1));
    return;
  }
  if (form == ResamplingKernel::Columns)
  {
    this->Deferred.Clear();
    const std::size_t group = this->GetColumnGroup(kernel);
    this->Launcher.LaunchAndReport(request, kernel,
      cl::NDRange(group * DEFORMVOLUME_SPANS * bricks, 2, 2), cl::NDRange(group, 1, 1));
    return;
  }
  if (IsByColumns(form))
  {
    const std::size_t group = this->Deferred.GetGroup(kernel);
    this->Launcher.Launch(kernel, cl::NDRange(this->Deferred.GetItems(group)), cl::NDRange(group));
    return;
  }
  const std::size_t group = this->Device.GetHeavyGroupSize(kernel);
  constexpr std::size_t cuboids = DEFORMVOLUME_BRICK_X / DEFORMVOLUME_CUBOID_X;
  this->Launcher.LaunchAndReport(request, kernel,
    cl::NDRange(group * cuboids * bricks, DEFORMVOLUME_BRICK_Y / DEFORMVOLUME_CUBOID_Y,
      DEFORMVOLUME_BRICK_Z / DEFORMVOLUME_CUBOID_Z),
    cl::NDRange(group, 1, 1));
}

const cl::Buffer& ExactPasses::SendBricks(const std::vector<cl_uint>& list)
{
  if (list == this->SentBricks)
  {
    return this->Bricks; // sending them again would wait for the queue
  }
  this->SentBricks.clear(); // if sending fails, the content is unknown
  this->Device.Send(this->Bricks, list);
  this->SentBricks = list;
  return this->Bricks;
}

void ExactPasses::Run(const DeformRequest& request, const OutputSlab& output, int pass,
  const std::vector<cl_uint>* bricks)
{
  output.GetLargeCells().Clear();
  std::vector<cl_uint> all;
  const std::vector<PlannedLaunch> launches =
    bricks ? this->PlanSome(output, pass, *bricks) : this->PlanAll(output, pass, all);
  if (launches.empty())
  {
    return;
  }
  const std::vector<cl_uint>& list = bricks ? *bricks : all;
  const ResamplingKernel form = this->ChooseKernel(request, output, pass);
  cl::Kernel kernel = this->MakeKernel(request, form, output, pass);
  this->SendBricks(list);
  if (form == ResamplingKernel::Columns)
  {
    this->RunColumns(request, output, kernel, launches);
    return;
  }
  this->PrepareKernel(kernel, launches.front().Chunk, output, form, launches.front().Parameters);
  for (const auto& [chunk, p] : launches)
  {
    this->SetArguments(kernel, chunk, output, form, p);
    this->Launch(request, kernel, form, p);
  }
}

void ExactPasses::RunColumns(const DeformRequest& request, const OutputSlab& output,
  cl::Kernel& columns, const std::vector<PlannedLaunch>& launches)
{
  const auto most = static_cast<int>(this->Deferred.GetMostBricks());
  int used = 0;
  for (const PlannedLaunch& launch : launches)
  {
    used = std::max(used, launch.Parameters.ListEnd - launch.Parameters.ListBegin);
  }
  this->Deferred.Reserve(static_cast<std::uint64_t>(used));
  const PlannedLaunch& first = launches.front();
  const int pass = first.Parameters.Pass;
  std::array<std::pair<ResamplingKernel, cl::Kernel>, 3> kernels{ {
    { ResamplingKernel::Columns, columns },
    { ResamplingKernel::DeferredInt32,
      this->MakeKernel(request, ResamplingKernel::DeferredInt32, output, pass) },
    { ResamplingKernel::DeferredInt64,
      this->MakeKernel(request, ResamplingKernel::DeferredInt64, output, pass) },
  } };
  for (auto& [form, kernel] : kernels)
  {
    this->PrepareKernel(kernel, first.Chunk, output, form, first.Parameters);
  }
  for (const auto& [chunk, planned] : launches)
  {
    KernelParameters p = planned;
    for (p.ListEnd = p.ListBegin; p.ListEnd < planned.ListEnd; p.ListBegin = p.ListEnd)
    {
      p.ListEnd = std::min(p.ListBegin + most, planned.ListEnd);
      for (auto& [form, kernel] : kernels)
      {
        this->SetArguments(kernel, chunk, output, form, p);
        this->Launch(request, kernel, form, p);
      }
    }
  }
}

void ExactPasses::RunLargeCells(const DeformRequest& request, const OutputSlab& output, int pass)
{
  const std::vector<LargeCellList::LargeCell> cells = output.GetLargeCells().Read();
  if (cells.empty())
  {
    return;
  }
  using Piece = std::array<cl_int, 4>;
  std::vector<Piece> pieces;
  pieces.reserve(DEFORMVOLUME_PIECES);
  std::uint64_t numberOfPieces = 0;
  for (const LargeCellList::LargeCell& cell : cells)
  {
    numberOfPieces += static_cast<std::uint64_t>(cell.Pieces);
  }
  this->Launcher.Expect(numberOfPieces / DEFORMVOLUME_PIECES + 1);
  cl::Kernel kernel = this->MakeKernel(request, ResamplingKernel::LargeCells, output, pass);
  const std::size_t group = this->Device.GetHeavyGroupSize(kernel);
  Reserve(this->Device.GetContext(), this->Pieces, DEFORMVOLUME_PIECES * sizeof(Piece));
  for (const VolumeChunk& chunk : this->Volume.GetChunks())
  {
    KernelParameters p = this->Volume.GetParameters(chunk);
    p.Pass = pass;
    output.SetParameters(p);
    this->PrepareKernel(kernel, chunk, output, ResamplingKernel::LargeCells, p);
    const auto launch = [&]
    {
      this->Device.GetQueue().enqueueWriteBuffer(
        this->Pieces, CL_TRUE, 0, pieces.size() * sizeof(Piece), pieces.data());
      p.ListEnd = static_cast<int>(pieces.size());
      this->SetArguments(kernel, chunk, output, ResamplingKernel::LargeCells, p);
      this->Launcher.LaunchAndReport(request, kernel,
        cl::NDRange((pieces.size() + group - 1) / group * group), cl::NDRange(group));
      pieces.clear();
    };
    for (const auto& [cell, count] : cells)
    {
      const bool here = cell[2] >= chunk.LayersBegin && cell[2] < chunk.LayersEnd;
      for (cl_int piece = 0; here && piece < count; ++piece)
      {
        pieces.push_back({ { cell[0], cell[1], cell[2], piece } });
        if (pieces.size() == DEFORMVOLUME_PIECES)
        {
          launch();
        }
      }
    }
    if (!pieces.empty())
    {
      launch();
    }
  }
}

std::uint64_t ExactPasses::GetMemory() const
{
  return deformvolume::GetMemory(this->BrickRows, this->Deferred.GetBuffer());
}

} // namespace deformvolume
