// SPDX-License-Identifier: BSD-3-Clause
// How displacements reach the device, and what VolumeDeformer does where only a part of them
// changed.
#include "VolumeDeformerInternals.h"

#include "HostThreads.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>

namespace deformvolume
{
namespace
{

// If more points than this part change, all is made anew.
constexpr double LargestPart = 0.6;

// The first of the vectors that is not finite or too large; count where there is none.
std::size_t FindBadVector(const float* vectors, std::size_t count)
{
  std::atomic<std::size_t> bad{ count };
  RunOnParts(count,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = 3 * begin; i < 3 * end; ++i)
      {
        // The negation catches NaN as well.
        if (!(std::abs(vectors[i]) <= LargestDisplacement))
        {
          std::size_t first = bad;
          while (i / 3 < first && !bad.compare_exchange_weak(first, i / 3))
          {
          }
          return;
        }
      }
    });
  return bad;
}

// Marks the vectors that differ from those that the device has, four floats each; returns their
// number.
std::size_t MarkChanges(
  const float* vectors, const float* last, std::vector<unsigned char>& changed)
{
  std::atomic<std::size_t> number{ 0 };
  RunOnParts(changed.size(),
    [&](std::size_t begin, std::size_t end)
    {
      std::size_t found = 0;
      for (std::size_t i = begin; i < end; ++i)
      {
        // Bit by bit: -0 is not 0, and what is not the same may not be taken for it.
        changed[i] = std::memcmp(vectors + 3 * i, last + 4 * i, 3 * sizeof(float)) != 0 ? 1 : 0;
        found += changed[i];
      }
      number += found;
    });
  return number;
}

// The three floats of each vector become the four that the device reads at once.
void PadVectors(const float* vectors, std::size_t count, float* padded)
{
  RunOnParts(count,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        for (std::size_t c = 0; c < 3; ++c)
        {
          padded[4 * i + c] = vectors[3 * i + c];
        }
        padded[4 * i + 3] = 0.0F;
      }
    });
}

void CopyOnThreads(void* to, const void* from, std::uint64_t bytes)
{
  constexpr std::uint64_t step = std::uint64_t{ 1 } << 20;
  RunOnThreads(static_cast<std::size_t>((bytes + step - 1) / step),
    [&](std::size_t part)
    {
      const std::uint64_t begin = part * step;
      std::memcpy(static_cast<char*>(to) + begin, static_cast<const char*>(from) + begin,
        static_cast<std::size_t>(std::min(bytes - begin, step)));
    });
}

} // namespace

void VolumeDeformer::Internals::CheckVectors(
  const float* vectors, std::size_t count, const char* what)
{
  const std::size_t bad = FindBadVector(vectors, count);
  if (bad < count)
  {
    throw Error(std::string("The displacement of ") + what + " " + std::to_string(bad) +
      " is not finite, or over 16,383 output voxels. Check the scale of the displacements and "
      "the output spacing.");
  }
}

void VolumeDeformer::Internals::SendVectors(
  const float* vectors, std::size_t count, cl::Buffer& buffer)
{
  const std::size_t bytes = 4 * count * sizeof(float);
  if (!this->GetContext().GetDevice().IsProcessor)
  {
    std::vector<float> padded(4 * count);
    PadVectors(vectors, count, padded.data());
    buffer = this->SendBuffer(padded.data(), bytes, buffer);
    this->Update.MoveAll();
    return;
  }
  if (GetMemory(buffer) != bytes)
  {
    buffer = cl::Buffer(this->Context->GetContext(), CL_MEM_READ_ONLY, bytes);
    this->Update.MoveAll();
  }
  if (this->Update.IsTracking())
  {
    std::vector<unsigned char> changed(count);
    const MappedBuffer<const float> last(this->Queue, buffer, CL_MAP_READ);
    const std::size_t number = MarkChanges(vectors, last.Get(), changed);
    if (number == 0)
    {
      return;
    }
    if (static_cast<double>(number) <= LargestPart * static_cast<double>(count))
    {
      this->PrepareBrickPoints();
      this->Update.MovePoints(changed, last.Get());
    }
    else
    {
      this->Update.MoveAll();
    }
  }
  else
  {
    this->Update.MoveAll();
  }
  const MappedBuffer<float> padded(this->Queue, buffer, CL_MAP_WRITE);
  PadVectors(vectors, count, padded.Get());
}

void VolumeDeformer::Internals::PrepareBrickPoints()
{
  if (!this->Update.HasPoints())
  {
    this->Update.SetPoints(this->Mesh->HasMesh()
        ? this->Mesh->MakeBrickPoints(
            this->Tetrahedra, this->NumberOfTetrahedra, this->NumberOfNodes)
        : BrickPoints::FromField(this->Mesh->GetBrickGrid().GetParts(), this->Field));
  }
}

void VolumeDeformer::Internals::TellMask(const unsigned char* next, bool ofCells)
{
  if (!this->Update.IsTracking())
  {
    return;
  }
  constexpr unsigned char allActive = 31;
  const unsigned char value = ofCells ? allActive : 0;
  const LatticeChunk& chunk = this->Mesh->GetChunks().front();
  if (ofCells ? this->Mesh->HasActive() : this->Mesh->HasBlanked())
  {
    const MappedBuffer<const unsigned char> last(
      this->Queue, ofCells ? chunk.Active : chunk.Blanked, CL_MAP_READ);
    this->Update.ChangeMask(last.Get(), next, value, ofCells);
  }
  else
  {
    this->Update.ChangeMask(nullptr, next, value, ofCells);
  }
}

bool VolumeDeformer::Internals::CanUpdate(const DeformRequest& request)
{
  return request.Incremental && this->Update.IsTracking() &&
    this->Update.GetOutputExtent() == request.OutputExtent && this->LastMethod == request.Method &&
    request.LastCoverage && request.LastOutputs.size() == request.Outputs.size() &&
    !std::count(request.LastOutputs.begin(), request.LastOutputs.end(), nullptr) &&
    OutputSlab::GetBytesPerVoxel(*this->Context, this->Arrays, request) == 0;
}

void VolumeDeformer::Internals::CopyLastOutput(const DeformRequest& request) const
{
  const auto voxels = static_cast<std::uint64_t>(GetNumberOfPoints(request.OutputExtent));
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    if (request.LastOutputs[i] != request.Outputs[i])
    {
      CopyOnThreads(
        request.Outputs[i], request.LastOutputs[i], voxels * GetTupleSize(this->Arrays[i]));
    }
  }
  if (request.LastCoverage != request.Coverage)
  {
    CopyOnThreads(request.Coverage, request.LastCoverage, voxels);
  }
}

bool VolumeDeformer::Internals::UpdateOutput(
  const DeformRequest& request, OutputSlab& output, DeformReport& report)
{
  if (!this->CanUpdate(request))
  {
    return false;
  }
  const auto begin = std::chrono::steady_clock::now();
  this->PrepareBrickPoints();
  IncrementalUpdate::Plan plan;
  {
    const MappedBuffer<const float> vectors(
      this->Queue, this->Mesh->HasMesh() ? this->Nodes : this->FieldVectors, CL_MAP_READ);
    if (!this->Update.MakePlan(vectors.Get(), plan))
    {
      return false;
    }
  }
  this->CopyLastOutput(request);
  this->PlanningTime =
    std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::uint64_t before = output.PreparePatches(*this->Context, this->Queue,
    request.OutputExtent, request, this->Arrays, plan.Patches, plan.Bricks, this->ResamplingEvents);
  this->Run(request, output, DEFORMVOLUME_PASS_DIRECT, &plan.Bricks);
  const std::uint64_t covered =
    this->LastCovered - before + output.CountPatches(*this->Context, this->ResamplingEvents);
  const OutputSlab::Counts counts = output.ReadCounts();
  if (counts.NeedWinners(covered))
  {
    return false;
  }
  const auto done = std::chrono::steady_clock::now();
  output.Read(this->ReadQueue, request);
  this->ReadQueue.finish();
  report.TransferTime =
    std::chrono::duration<double>(std::chrono::steady_clock::now() - done).count();
  this->LastCovered = covered;
  this->Update.Finish();
  report.NumberOfOverstretchedCells = static_cast<std::int64_t>(counts.Overstretched);
  report.NumberOfCoveredVoxels = static_cast<std::int64_t>(covered);
  report.NumberOfResampledBricks = static_cast<std::int64_t>(plan.Bricks.size());
  return true;
}

} // namespace deformvolume
