// SPDX-License-Identifier: BSD-3-Clause
// How a slab of the output is made: the passes over the cells of the sampling mesh, and their
// launches.
#include "VolumeDeformerInternals.h"

#include "ResamplingProgram.h"

#include <algorithm>

namespace deformvolume
{

void VolumeDeformer::Internals::Map(const VolumeChunk& chunk, const KernelParameters& p)
{
  const std::uint64_t bytes = static_cast<std::uint64_t>(p.Size[0]) * p.Size[1] * 3 *
    sizeof(cl_int) * static_cast<std::uint64_t>(p.PlanesEnd - p.PlanesBegin);
  if (GetMemory(this->Positions) < bytes)
  {
    this->Positions = cl::Buffer(this->Context->GetContext(), CL_MEM_READ_WRITE, bytes);
  }
  cl::Kernel kernel(GetMappingProgram(*this->Context, this->GetMappingForm()), "MapPositions");
  cl_uint i = this->SetMappingArguments(kernel, chunk);
  kernel.setArg(i++, this->Mesh->GetState(chunk));
  kernel.setArg(i++, this->Positions);
  kernel.setArg(i++, p);
  this->MappingEvents.push_back(this->Context->Launch(this->Queue, kernel,
    this->Mesh->GetVertexRange(p.PlanesEnd - p.PlanesBegin), this->Mesh->GetVertexGroup()));
}

std::size_t VolumeDeformer::Internals::GetGroupSize(const cl::Kernel& kernel) const
{
  const auto largest =
    kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(this->Context->GetDevice().Device);
  return std::min<std::size_t>(this->WorkGroupSize ? this->WorkGroupSize : 64, largest);
}

void VolumeDeformer::Internals::Launch(
  cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group)
{
  this->ResamplingEvents.push_back(this->Context->Launch(this->Queue, kernel, items, group));
  this->Queue.flush();
}

void VolumeDeformer::Internals::ReportLaunch(const DeformRequest& request, cl::Event& previous)
{
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

void VolumeDeformer::Internals::RunPublished(const DeformRequest& request, OutputSlab& output)
{
  cl::Kernel kernel(GetPublishedProgram(*this->Context, this->Arrays), "ResamplePublished");
  const std::size_t group = this->GetGroupSize(kernel);
  cl::Event previous;
  for (const VolumeChunk& chunk : this->Mesh->GetChunks())
  {
    // The published method maps all vertices, and then resamples all cells.
    KernelParameters p = this->Mesh->GetParameters(chunk);
    p.PlanesBegin = p.LayersBegin;
    p.PlanesEnd = p.LayersEnd + 1;
    p.SlabFirst = p.PlanesBegin;
    output.SetParameters(p);
    this->Map(chunk, p);
    cl_uint i = 0;
    kernel.setArg(i++, this->Positions);
    kernel.setArg(i++, p.HasActive ? chunk.Active : this->Mesh->GetState(chunk));
    kernel.setArg(i++, output.GetCoverage());
    kernel.setArg(i++, p);
    const std::vector<cl::Buffer>& arrays = this->Mesh->GetArrays(chunk);
    for (std::size_t a = 0; a < arrays.size(); ++a)
    {
      kernel.setArg(i++, arrays[a]);
      kernel.setArg(i++, output.GetArray(a));
    }
    const std::size_t cells = static_cast<std::size_t>(p.Size[0] - 1);
    this->Launch(kernel,
      cl::NDRange((cells + group - 1) / group * group, static_cast<std::size_t>(p.Size[1] - 1),
        static_cast<std::size_t>(p.LayersEnd - p.LayersBegin)),
      cl::NDRange(group, 1, 1));
    this->ReportLaunch(request, previous);
  }
}

cl::Kernel VolumeDeformer::Internals::MakeResamplingKernel(ResamplingForm form)
{
  const bool lanes = form == ResamplingForm::Lanes;
  if (lanes && !HasLocalBricks(*this->Context))
  {
    Reserve(*this->Context, this->BrickRows,
      std::uint64_t{ this->Context->GetNumberOfUnits() } *
        GetBrickMemory(*this->Context, this->Arrays));
  }
  return cl::Kernel(GetResamplingProgram(*this->Context, this->GetMappingForm(), this->Arrays,
                      GetWinnerSize(this->Mesh->GetVoxelGrid()) == 8, form),
    lanes                             ? "ResampleBricks"
      : form == ResamplingForm::Cells ? "Resample"
                                      : "ResampleLargeCells");
}

void VolumeDeformer::Internals::SetResamplingArguments(cl::Kernel& kernel, const VolumeChunk& chunk,
  const OutputSlab& output, ResamplingForm form, const KernelParameters& p) const
{
  cl_uint i = this->SetMappingArguments(kernel, chunk);
  kernel.setArg(i++, this->Mesh->GetState(chunk));
  kernel.setArg(i++, p.HasActive ? chunk.Active : this->Mesh->GetState(chunk));
  kernel.setArg(i++, output.GetCoverage());
  kernel.setArg(i++, output.GetWinners());
  kernel.setArg(i++, output.GetPatches());
  kernel.setArg(i++, output.GetLargeCells());
  kernel.setArg(i++, output.GetCounters());
  if (form == ResamplingForm::Lanes)
  {
    kernel.setArg(i++, this->Bricks);
    kernel.setArg(i++, this->TakenBricks);
    if (HasLocalBricks(*this->Context))
    {
      kernel.setArg(i++, cl::Local(GetBrickMemory(*this->Context, this->Arrays)));
    }
    else
    {
      kernel.setArg(i++, this->BrickRows);
    }
  }
  else if (form == ResamplingForm::Cells)
  {
    kernel.setArg(i++, cl::Local(3 * sizeof(cl_int) * DEFORMVOLUME_CUBOID_VERTICES));
  }
  else
  {
    kernel.setArg(i++, this->Pieces);
  }
  kernel.setArg(i++, p);
  const std::vector<cl::Buffer>& arrays = this->Mesh->GetArrays(chunk);
  for (std::size_t a = 0; a < arrays.size(); ++a)
  {
    kernel.setArg(i++, arrays[a]);
    kernel.setArg(i++, output.GetArray(a));
  }
}

void VolumeDeformer::Internals::PrepareKernel(cl::Kernel& kernel, const VolumeChunk& chunk,
  const OutputSlab& output, ResamplingForm form, const KernelParameters& parameters)
{
  // One that has no brick and no layer of cells to work on.
  KernelParameters p = parameters;
  p.ListBegin = p.ListEnd = 0;
  p.LayersEnd = p.LayersBegin;
  this->SetResamplingArguments(kernel, chunk, output, form, p);
  const std::size_t group = this->GetCellGroup(kernel);
  this->Context->Prepare(this->Queue, kernel,
    form == ResamplingForm::Cells     ? cl::NDRange(group, 1, 1)
      : form == ResamplingForm::Lanes ? cl::NDRange(1)
                                      : cl::NDRange(group));
}

std::size_t VolumeDeformer::Internals::GetCellGroup(const cl::Kernel& kernel) const
{
  // A work-group takes a cuboid; on a processor its only item does.
  const bool processor = this->Context->GetDevice().HasVectors;
  return processor && !this->WorkGroupSize ? 1 : this->GetGroupSize(kernel);
}

void VolumeDeformer::Internals::LaunchBricks(cl::Kernel& kernel, const KernelParameters& p)
{
  this->Queue.enqueueFillBuffer(this->TakenBricks, cl_uint{ 0 }, 0, sizeof(cl_uint));
  this->Launch(kernel,
    cl::NDRange(
      std::min(this->Context->GetNumberOfUnits(), static_cast<cl_uint>(p.ListEnd - p.ListBegin))),
    cl::NDRange(1));
}

void VolumeDeformer::Internals::RunBricks(
  const DeformRequest& request, OutputSlab& output, int pass, const std::vector<cl_uint>& bricks)
{
  if (bricks.empty())
  {
    return;
  }
  cl::Kernel kernel = this->MakeResamplingKernel(ResamplingForm::Lanes);
  this->Bricks = this->SendBuffer(bricks.data(), bricks.size() * sizeof(cl_uint), this->Bricks);
  const VolumeChunk& chunk = this->Mesh->GetChunks().front();
  KernelParameters p = this->Mesh->GetParameters(chunk);
  p.Pass = pass;
  output.SetParameters(p);
  this->PrepareKernel(kernel, chunk, output, ResamplingForm::Lanes, p);
  // As many in a launch as there are when all are run.
  const std::size_t step = static_cast<std::size_t>(p.BrickCount[0]) *
    static_cast<std::size_t>(p.BrickCount[1]) *
    static_cast<std::size_t>(this->GetLayersPerLaunch() / DEFORMVOLUME_BRICK_Z);
  this->LaunchesExpected =
    std::max(this->LaunchesExpected, this->LaunchesDone + (bricks.size() + step - 1) / step);
  cl::Event previous;
  for (std::size_t begin = 0; begin < bricks.size(); begin += step)
  {
    p.ListBegin = static_cast<int>(begin);
    p.ListEnd = static_cast<int>(std::min(begin + step, bricks.size()));
    p.Portion = 1;
    this->SetResamplingArguments(kernel, chunk, output, ResamplingForm::Lanes, p);
    this->LaunchBricks(kernel, p);
    this->ReportLaunch(request, previous);
  }
}

std::vector<VolumeDeformer::Internals::PlannedLaunch> VolumeDeformer::Internals::PlanLaunches(
  const OutputSlab& output, int pass, std::vector<cl_uint>* bricks) const
{
  // Several are too much at once where there are few bricks for each unit.
  const int leastForTurns = 32 * static_cast<int>(this->Context->GetNumberOfUnits());
  std::vector<PlannedLaunch> launches;
  for (const VolumeChunk& chunk : this->Mesh->GetChunks())
  {
    for (int begin = chunk.LayersBegin; begin < chunk.LayersEnd;)
    {
      KernelParameters p = this->Mesh->GetParameters(chunk);
      // Launches end where bricks do.
      const int step =
        this->GetLayersPerLaunch() - (begin - p.BrickOrigin[2]) % DEFORMVOLUME_BRICK_Z;
      p.LayersBegin = begin;
      p.LayersEnd = std::min(begin + step, chunk.LayersEnd);
      p.Pass = pass;
      output.SetParameters(p);
      if (bricks)
      {
        p.ListBegin = static_cast<int>(bricks->size());
        this->Mesh->GetBricks().AppendBricks(p.LayersBegin, p.LayersEnd, *bricks);
        p.ListEnd = static_cast<int>(bricks->size());
        p.Portion = p.ListEnd - p.ListBegin < leastForTurns ? 1 : BrickGrid::BricksInTurn;
      }
      launches.push_back({ chunk, p });
      begin = p.LayersEnd;
    }
  }
  return launches;
}

void VolumeDeformer::Internals::LaunchCells(cl::Kernel& kernel, const KernelParameters& p)
{
  const std::size_t group = this->GetCellGroup(kernel);
  const auto count = [](int cells, int size)
  { return static_cast<std::size_t>((cells + size - 1) / size); };
  this->Launch(kernel,
    cl::NDRange(group * count(p.Size[0] - 1, DEFORMVOLUME_CUBOID_X),
      count(p.Size[1] - 1, DEFORMVOLUME_CUBOID_Y),
      count(p.LayersEnd - p.LayersBegin, DEFORMVOLUME_CUBOID_Z)),
    cl::NDRange(group, 1, 1));
}

void VolumeDeformer::Internals::RunExact(const DeformRequest& request, OutputSlab& output, int pass)
{
  const bool lanes = this->UseLanes(request.Method, output);
  const ResamplingForm form = lanes ? ResamplingForm::Lanes : ResamplingForm::Cells;
  cl::Kernel kernel = this->MakeResamplingKernel(form);
  if (lanes && this->Mesh->GetBricks().GetNumberOfBricks() >> DEFORMVOLUME_BRICK_BITS)
  {
    throw Error("The volume has more than 10^11 voxels. Use a smaller volume.");
  }
  std::vector<cl_uint> bricks;
  const std::vector<PlannedLaunch> launches =
    this->PlanLaunches(output, pass, lanes ? &bricks : nullptr);
  if (lanes)
  {
    this->Bricks = this->SendBuffer(bricks.data(), bricks.size() * sizeof(cl_uint), this->Bricks);
  }
  this->PrepareKernel(kernel, launches.front().Chunk, output, form, launches.front().Parameters);
  cl::Event previous;
  for (const auto& [chunk, p] : launches)
  {
    this->SetResamplingArguments(kernel, chunk, output, form, p);
    if (lanes)
    {
      this->LaunchBricks(kernel, p);
    }
    else
    {
      this->LaunchCells(kernel, p);
    }
    this->ReportLaunch(request, previous);
  }
}

void VolumeDeformer::Internals::RunLargeCells(
  const DeformRequest& request, OutputSlab& output, int pass)
{
  const std::vector<OutputSlab::LargeCell> cells = output.ReadLargeCells();
  if (cells.empty())
  {
    return;
  }
  using Piece = std::array<cl_int, 4>;
  std::vector<Piece> pieces;
  pieces.reserve(DEFORMVOLUME_PIECES);
  std::uint64_t left = 0;
  for (const OutputSlab::LargeCell& cell : cells)
  {
    left += static_cast<std::uint64_t>(cell.Pieces);
  }
  this->LaunchesExpected = this->LaunchesDone + left / DEFORMVOLUME_PIECES + 1;
  cl::Kernel kernel = this->MakeResamplingKernel(ResamplingForm::LargeCells);
  const std::size_t group = this->GetCellGroup(kernel);
  Reserve(*this->Context, this->Pieces, DEFORMVOLUME_PIECES * sizeof(Piece));
  cl::Event previous;
  for (const VolumeChunk& chunk : this->Mesh->GetChunks())
  {
    KernelParameters p = this->Mesh->GetParameters(chunk);
    p.Pass = pass;
    output.SetParameters(p);
    this->PrepareKernel(kernel, chunk, output, ResamplingForm::LargeCells, p);
    const auto launch = [&]
    {
      this->Queue.enqueueWriteBuffer(
        this->Pieces, CL_TRUE, 0, pieces.size() * sizeof(Piece), pieces.data());
      p.ListEnd = static_cast<int>(pieces.size());
      this->SetResamplingArguments(kernel, chunk, output, ResamplingForm::LargeCells, p);
      this->Launch(
        kernel, cl::NDRange((pieces.size() + group - 1) / group * group), cl::NDRange(group));
      this->ReportLaunch(request, previous);
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

void VolumeDeformer::Internals::Run(
  const DeformRequest& request, OutputSlab& output, int pass, const std::vector<cl_uint>* bricks)
{
  const cl::Program mapping = GetMappingProgram(*this->Context, this->GetMappingForm());
  if (this->Mesh->HasRuns() && this->Mesh->NeedsRecords())
  {
    this->MappingEvents.push_back(
      this->Mesh->EvaluateTetrahedra(mapping, this->Tetrahedra, this->Nodes));
  }
  this->Mesh->UpdateState(mapping, this->Field.Extrapolate || this->Field.SameGrid,
    [this](cl::Kernel& kernel, const VolumeChunk& chunk)
    { return this->SetMappingArguments(kernel, chunk); });
  if (request.Method == Resampling::Published)
  {
    this->RunPublished(request, output);
  }
  else
  {
    output.ClearLargeCells();
    if (bricks)
    {
      this->RunBricks(request, output, pass, *bricks);
    }
    else
    {
      this->RunExact(request, output, pass);
    }
  }
}

bool VolumeDeformer::Internals::RunSlab(
  const DeformRequest& request, OutputSlab& output, bool first, DeformReport& report)
{
  // What was folded last time probably still is: then one pass does for two.
  const bool expected = this->WasContested && request.Method != Resampling::Published &&
    this->HasRoomForWinners(output);
  if (expected)
  {
    output.PrepareWinners(*this->Context, this->ResamplingEvents);
  }
  const int firstPass = expected ? DEFORMVOLUME_PASS_OWNERS : DEFORMVOLUME_PASS_DIRECT;
  this->Run(request, output, firstPass);
  std::uint64_t covered = output.CountCovered(*this->Context, this->ResamplingEvents);
  OutputSlab::Counts counts = output.ReadCounts();
  const bool hasLarge = counts.Large > 0;
  if (hasLarge)
  {
    this->RunLargeCells(request, output, firstPass);
    covered = output.CountCovered(*this->Context, this->ResamplingEvents);
    counts = output.ReadCounts();
  }
  if (first) // every slab sees all tetrahedra
  {
    report.NumberOfInvertedTetrahedra = static_cast<std::int64_t>(counts.Inverted);
    report.NumberOfOverstretchedCells = static_cast<std::int64_t>(counts.Overstretched);
  }
  const bool folded = request.Method != Resampling::Published && counts.NeedWinners(covered);
  if (folded)
  {
    const bool contested = counts.Writes > covered;
    report.Overlapping |= contested;
    this->LaunchesExpected += (contested && !expected ? 3 : 2) * this->GetNumberOfLaunches();
    const auto runPass = [&](int pass, const std::vector<cl_uint>* bricks)
    {
      this->Run(request, output, pass, bricks);
      if (hasLarge)
      {
        this->RunLargeCells(request, output, pass);
      }
    };
    if (!expected)
    {
      this->CheckWinners(output);
      output.PrepareWinners(*this->Context, this->ResamplingEvents);
      if (contested)
      {
        runPass(DEFORMVOLUME_PASS_OWNERS, nullptr);
      }
    }
    const bool claimed = expected || contested;
    output.Settle(*this->Context, claimed,
      this->Mesh->GetParameters(this->Mesh->GetChunks().front()), this->ResamplingEvents);
    const bool someBricks =
      this->UseLanes(request.Method, output) && this->Mesh->GetChunks().size() == 1;
    const auto run = [&](int pass, bool all, int counter)
    {
      std::vector<cl_uint> bricks;
      if (!all)
      {
        bricks = output.FindBricks(counter);
      }
      runPass(pass, all ? nullptr : &bricks);
    };
    run(DEFORMVOLUME_PASS_MARK, !someBricks || !claimed, DEFORMVOLUME_COUNT_TOUCHED);
    run(DEFORMVOLUME_PASS_WINNER, !someBricks, DEFORMVOLUME_COUNT_CANDIDATES);
    covered = output.CountCovered(*this->Context, this->ResamplingEvents);
  }
  report.NumberOfCoveredVoxels += static_cast<std::int64_t>(covered);
  return !folded;
}

int VolumeDeformer::Internals::GetLayersPerLaunch() const
{
  constexpr std::int64_t cells = 1 << 23;
  const std::int64_t layer = std::int64_t{ this->Mesh->GetSize(0) } * this->Mesh->GetSize(1);
  constexpr std::int64_t turn = BrickGrid::BricksInTurn * DEFORMVOLUME_BRICK_Z;
  const std::int64_t turns = (cells / layer + turn - 1) / turn;
  const std::int64_t mostTurns = this->Mesh->GetSize(2) / turn + 1;
  return static_cast<int>(std::clamp<std::int64_t>(turns, 1, mostTurns) * turn);
}

std::size_t VolumeDeformer::Internals::GetNumberOfLaunches() const
{
  const int layers = this->GetLayersPerLaunch();
  return static_cast<std::size_t>((this->Mesh->GetSize(2) + layers - 1) / layers);
}

} // namespace deformvolume
