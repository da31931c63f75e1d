// SPDX-License-Identifier: BSD-3-Clause
// How displacements reach the device, and what VolumeDeformer does where only a part of them
// changed.
#include "VolumeDeformerInternals.h"

#include "OutputPatches.h"
#include "ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <bitset>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <optional>

namespace deformvolume
{
namespace
{

// Vectors are worked on by words of a PointSet.
constexpr std::size_t WordSize = PointSet::PointsPerWord;
constexpr std::size_t WordStep = 65536 / WordSize; // that a thread takes at a time

// Calls body(word, begin, end) for words and the vectors of each, of which there are count
// altogether, side by side.
template <typename Body>
void ForWords(const std::vector<std::size_t>& words, std::size_t count, Body&& body)
{
  ParallelForParts(words.size(), WordStep,
    [&](std::size_t first, std::size_t past)
    {
      for (std::size_t i = first; i < past; ++i)
      {
        const std::size_t begin = words[i] * WordSize;
        body(words[i], begin, std::min(begin + WordSize, count));
      }
    });
}

// The words of all points, or of those that may have changed.
std::vector<std::size_t> FindWords(const PointRanges* changes, std::size_t count)
{
  const PointRanges all{ { { 0, count } } };
  std::vector<std::size_t> words;
  for (const auto& range : changes ? *changes : all)
  {
    std::size_t word = range[0] / WordSize;
    if (!words.empty())
    {
      word = std::max(word, words.back() + 1);
    }
    for (; word * WordSize < std::min(range[1], count); ++word)
    {
      words.push_back(word);
    }
  }
  return words;
}

// The first of the vectors that is not finite or too large; count where there is none.
std::size_t FindBadVector(
  const float* vectors, const std::vector<std::size_t>& words, std::size_t count)
{
  std::atomic<std::size_t> bad{ count };
  ForWords(words, count,
    [&](std::size_t, std::size_t begin, std::size_t end)
    {
      const auto isGood = [](float component)
      { return std::abs(component) <= static_cast<float>(LargestDisplacement); };
      // All at once, without an early end, is what compilers make vectors of.
      int good = 1;
      for (std::size_t i = 3 * begin; i < 3 * end; ++i)
      {
        good &= isGood(vectors[i]) ? 1 : 0;
      }
      if (!good)
      {
        const float* found = std::find_if_not(vectors + 3 * begin, vectors + 3 * end, isGood);
        const auto vector = static_cast<std::size_t>(found - vectors) / 3;
        std::size_t first = bad;
        while (vector < first && !bad.compare_exchange_weak(first, vector))
        {
        }
      }
    });
  return bad;
}

// What the device calls each vector, empty: as it comes.
using Numbers = std::vector<std::int32_t>;

// Marks, by the numbers of the device, the vectors that differ from those that it has, four floats
// each; returns how many they are. Once they are too many to be worked on one by one, it leaves out
// the rest.
std::size_t MarkChanges(const float* vectors, const float* last, const Numbers& numbers,
  const std::vector<std::size_t>& words, std::size_t count, PointSet& changed)
{
  std::atomic<std::size_t> number{ 0 };
  ForWords(words, count,
    [&](std::size_t word, std::size_t begin, std::size_t end)
    {
      if (IncrementalUpdate::IsTooMuch(number.load(std::memory_order_relaxed), count))
      {
        return;
      }
      // Bit by bit: -0 is not 0, and what is not the same may not be taken for it.
      const auto differs = [&](std::size_t i, std::size_t place)
      { return std::memcmp(vectors + 3 * i, last + 4 * place, 3 * sizeof(float)) != 0; };
      std::size_t found = 0;
      if (numbers.empty())
      {
        std::uint64_t bits = 0;
        for (std::size_t i = begin; i < end; ++i)
        {
          bits |= std::uint64_t{ differs(i, i) } << (i - begin);
        }
        changed.AddWord(word, bits);
        found = std::bitset<WordSize>(bits).count();
      }
      else
      {
        for (std::size_t i = begin; i < end; ++i)
        {
          const auto place = static_cast<std::size_t>(numbers[i]);
          if (differs(i, place))
          {
            changed.Add(place);
            ++found;
          }
        }
      }
      number += found;
    });
  return number;
}

// The three floats of each vector become the four that the device reads at once; returns what they
// lie between.
IncrementalUpdate::Bounds PadVectors(const float* vectors, const Numbers& numbers,
  const std::vector<std::size_t>& words, std::size_t count, float* padded)
{
  IncrementalUpdate::Bounds all;
  std::mutex mutex;
  ParallelForParts(words.size(), WordStep,
    [&](std::size_t first, std::size_t past)
    {
      IncrementalUpdate::Bounds bounds;
      for (std::size_t word = first; word < past; ++word)
      {
        const std::size_t begin = words[word] * WordSize;
        const std::size_t some = std::min(WordSize, count - begin);
        alignas(16) std::array<float, 4 * WordSize> next;
        for (std::size_t i = 0; i < some; ++i)
        {
          for (std::size_t c = 0; c < 3; ++c)
          {
            next[4 * i + c] = vectors[3 * (begin + i) + c];
          }
          next[4 * i + 3] = 0.0F;
        }
        bounds.Add(next.data(), 0, some);
        if (numbers.empty())
        {
          std::copy_n(next.begin(), 4 * some, padded + 4 * begin);
          continue;
        }
        for (std::size_t i = 0; i < some; ++i)
        {
          std::copy_n(
            next.begin() + 4 * i, 4, padded + 4 * static_cast<std::size_t>(numbers[begin + i]));
        }
      }
      const std::lock_guard<std::mutex> lock(mutex);
      all.Add(bounds);
    });
  return all;
}

using Clock = std::chrono::steady_clock;

double GetSecondsSince(const Clock::time_point& begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

void CopyOnThreads(void* to, const void* from, std::uint64_t bytes)
{
  constexpr std::size_t step = std::size_t{ 1 } << 20;
  ParallelForParts(static_cast<std::size_t>(bytes), step,
    [&](std::size_t begin, std::size_t end)
    {
      std::memcpy(
        static_cast<char*>(to) + begin, static_cast<const char*>(from) + begin, end - begin);
    });
}

} // namespace

void VolumeDeformer::Internals::CheckVectors(
  const float* vectors, std::size_t count, const char* what, const PointRanges* changes)
{
  const std::size_t bad = FindBadVector(vectors, FindWords(changes, count), count);
  if (bad < count)
  {
    throw Error(std::string("The displacement of ") + what + " " + std::to_string(bad) +
      " is not finite, or over 16,383 output voxels. Check the scale of the displacements and "
      "the output spacing.");
  }
}

void VolumeDeformer::Internals::SendVectors(const float* vectors, std::size_t count,
  const std::vector<std::int32_t>& numbers, cl::Buffer& buffer, const PointRanges* changes)
{
  const std::size_t bytes = 4 * count * sizeof(float);
  if (!this->GetContext().GetDevice().IsProcessor)
  {
    std::vector<float> padded(4 * count);
    PadVectors(vectors, numbers, FindWords(nullptr, count), count, padded.data());
    buffer = this->SendBuffer(padded.data(), bytes, buffer);
    this->Update.MoveAll();
    return;
  }
  if (GetMemory(buffer) != bytes)
  {
    buffer = cl::Buffer(this->Context->GetContext(), CL_MEM_READ_ONLY, bytes);
    this->Update.MoveAll();
    changes = nullptr;
  }
  const std::vector<std::size_t> words = FindWords(changes, count);
  const MappedBuffer<float> sent(this->Queue, buffer, CL_MAP_READ | CL_MAP_WRITE);
  bool partly = this->Update.IsTracking();
  if (partly)
  {
    this->Changed.Clear(count);
    const std::size_t number =
      MarkChanges(vectors, sent.Get(), numbers, words, count, this->Changed);
    if (number == 0)
    {
      return;
    }
    partly = !IncrementalUpdate::IsTooMuch(number, count);
  }
  if (partly)
  {
    this->PrepareBrickPoints();
    this->Update.MovePoints(this->Changed, sent.Get());
    this->Update.AddMoved(PadVectors(vectors, numbers, words, count, sent.Get()));
  }
  else
  {
    const IncrementalUpdate::Bounds bounds = PadVectors(vectors, numbers, words, count, sent.Get());
    this->Update.MoveAll(words.size() * WordSize >= count ? std::optional(bounds) : std::nullopt);
  }
}

void VolumeDeformer::Internals::PrepareBrickPoints()
{
  if (!this->Update.HasPoints())
  {
    this->Update.SetPoints(this->Mesh->HasMesh()
        ? this->Mesh->MakeBrickPoints(
            this->Tetrahedra, this->NumberOfTetrahedra, this->NumberOfNodes)
        : BrickPoints::FromField(this->Mesh->GetBricks().GetSubBricks(), this->Field));
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
  const VolumeChunk& chunk = this->Mesh->GetChunks().front();
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

bool VolumeDeformer::Internals::IsChangeInside() const
{
  const cl::Buffer& state = this->Mesh->GetChunks().front().State;
  if (!state())
  {
    return this->Update.IsInside(nullptr);
  }
  // As it was for the last output: where a mask has changed, the change is not inside.
  const MappedBuffer<const unsigned char> mapped(this->Queue, state, CL_MAP_READ);
  return this->Update.IsInside(mapped.Get());
}

bool VolumeDeformer::Internals::CanUpdate(const DeformRequest& request)
{
  return request.Incremental && this->Update.IsTracking() &&
    this->Update.GetOutputExtent() == request.OutputExtent &&
    this->LastWholeExtent == request.WholeOutputExtent && this->LastMethod == request.Method &&
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
  const auto begin = Clock::now();
  this->PrepareBrickPoints();
  const bool inside = this->IsChangeInside();
  if (!inside && !this->Update.HasBoxes())
  {
    const cl::Buffer& buffer = this->Mesh->HasMesh() ? this->Nodes : this->FieldVectors;
    const MappedBuffer<const float> vectors(this->Queue, buffer, CL_MAP_READ);
    if (this->GetMappingForm() == MappingForm::FieldInPlace)
    {
      this->Update.FindBoxes({ nullptr, &this->FieldInPlace },
        static_cast<std::size_t>(GetNumberOfPoints(this->FieldInPlace)));
    }
    else
    {
      this->Update.FindBoxes({ vectors.Get(), nullptr }, GetMemory(buffer) / (4 * sizeof(float)));
    }
  }
  IncrementalUpdate::Plan plan;
  if (!this->Update.MakePlan(inside, plan))
  {
    return false;
  }
  this->CopyLastOutput(request);
  // Before the memory becomes that of buffers, and after the device has given it back.
  const std::uint64_t before = ClearPatches(request, this->Arrays, plan.Patches);
  this->PlanningTime = GetSecondsSince(begin);
  output.PrepareAgain(*this->Context, this->Queue, request, this->Arrays, plan.Bricks);
  this->Run(request, output, DEFORMVOLUME_PASS_DIRECT, &plan.Bricks);
  OutputSlab::Counts counts = output.ReadCounts();
  if (counts.Large > 0)
  {
    this->RunLargeCells(request, output, DEFORMVOLUME_PASS_DIRECT);
    counts = output.ReadCounts();
  }
  const auto done = Clock::now();
  output.Read(this->ReadQueue, request);
  output.FinishReading();
  report.TransferTime = GetSecondsSince(done);
  const auto read = Clock::now();
  const std::uint64_t covered =
    this->LastCovered - before + CountCoveredInPatches(request, plan.Patches);
  this->PlanningTime += GetSecondsSince(read);
  if (counts.NeedWinners(covered) || (inside && counts.Writes != covered))
  {
    return false;
  }
  this->LastCovered = covered;
  this->Update.Finish();
  report.NumberOfOverstretchedCells = static_cast<std::int64_t>(counts.Overstretched);
  report.NumberOfCoveredVoxels = static_cast<std::int64_t>(covered);
  report.NumberOfResampledBricks = static_cast<std::int64_t>(plan.Bricks.size());
  return true;
}

} // namespace deformvolume
