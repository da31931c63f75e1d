// SPDX-License-Identifier: BSD-3-Clause
#include "DisplacementBuffer.h"

#include "BrickPoints.h"
#include "ChangeTracker.h"
#include "DisplacementField.h"
#include "Error.h"
#include "HostMemory.h"
#include "ParallelFor.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bitset>
#include <cmath>
#include <cstring>
#include <mutex>
#include <optional>
#include <string>

namespace deformvolume
{
namespace
{

// Number of vectors that are processed together: the points of one word of a PointSet.
constexpr std::size_t WordSize = PointSet::PointsPerWord;
constexpr std::size_t WordStep = 65536 / WordSize; // words that a thread processes at a time

// Calls body(word, begin, end) in parallel for words, with the range of vectors of each word.
// count: number of all vectors.
template <typename Body>
void ForWords(const std::vector<std::size_t>& words, std::size_t count, Body&& body)
{
  ParallelForItems(words.size(), WordStep,
    [&](std::size_t i)
    {
      const std::size_t begin = words[i] * WordSize;
      body(words[i], begin, std::min(begin + WordSize, count));
    });
}

// Lists the words of the points that may have changed, or of all points if `changes` is null.
std::vector<std::size_t> FindWords(const PointRanges* changes, std::size_t count)
{
  PointRanges ranges = changes ? *changes : PointRanges{ { { 0, count } } };
  std::sort(ranges.begin(), ranges.end());
  std::vector<std::size_t> words;
  for (const auto& range : ranges)
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

// Returns the first vector that is too large or not finite; `count` if there is none.
std::size_t FindBadVector(
  const float* vectors, const std::vector<std::size_t>& words, std::size_t count)
{
  std::atomic<std::size_t> bad{ count };
  ForWords(words, count,
    [&](std::size_t, std::size_t begin, std::size_t end)
    {
      const auto isGood = [](float component)
      { return std::abs(component) <= static_cast<float>(LargestDisplacement); };
      // No early exit, so that compilers vectorize the loop.
      int good = 1;
      for (std::size_t i = 3 * begin; i < 3 * end; ++i)
      {
        good &= isGood(vectors[i]) ? 1 : 0;
      }
      if (!good)
      {
        const float* found = std::find_if_not(vectors + 3 * begin, vectors + 3 * end, isGood);
        Lower(bad, static_cast<std::size_t>(found - vectors) / 3);
      }
    });
  return bad;
}

// Marks the vectors that differ from those on the device, and returns their number. Stops when the
// number exceeds `most`. last: the vectors on the device, four floats each.
std::size_t MarkChanges(const float* vectors, const float* last,
  const std::vector<std::size_t>& words, std::size_t count, std::size_t most, PointSet& changed)
{
  std::atomic<std::size_t> number{ 0 };
  ForWords(words, count,
    [&](std::size_t word, std::size_t begin, std::size_t end)
    {
      if (number.load(std::memory_order_relaxed) > most)
      {
        return;
      }
      // A bitwise comparison: -0 differs from 0, and a NaN equals itself.
      std::uint64_t bits = 0;
      for (std::size_t i = begin; i < end; ++i)
      {
        const bool differs = std::memcmp(vectors + 3 * i, last + 4 * i, 3 * sizeof(float)) != 0;
        bits |= std::uint64_t{ differs } << (i - begin);
      }
      changed.AddWord(word, bits);
      number += std::bitset<WordSize>(bits).count();
    });
  return number;
}

// Copies the vectors begin to end - 1, and pads each from three to four floats, which the device
// reads at once. Adds the vectors to bounds.
void PadSome(const float* vectors, std::size_t begin, std::size_t end, float* padded,
  DisplacementBounds& bounds)
{
  // A local copy allows vectorization: bounds may alias padded.
  DisplacementBounds all = bounds;
  for (std::size_t i = begin; i < end; ++i)
  {
    const std::array<float, 4> next{ { vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2],
      0.0F } };
    std::copy(next.begin(), next.end(), padded + 4 * i);
    for (std::size_t c = 0; c < next.size(); ++c)
    {
      all.Min[c] = std::min(all.Min[c], next[c]);
      all.Max[c] = std::max(all.Max[c], next[c]);
    }
  }
  bounds = all;
}

// Pads the vectors of words, in parallel. Returns their bounds.
DisplacementBounds PadVectors(
  const float* vectors, const std::vector<std::size_t>& words, std::size_t count, float* padded)
{
  DisplacementBounds all;
  std::mutex mutex;
  ParallelForParts(words.size(), WordStep,
    [&](std::size_t first, std::size_t past)
    {
      DisplacementBounds bounds;
      for (std::size_t word = first; word < past; ++word)
      {
        const std::size_t begin = words[word] * WordSize;
        const std::size_t end = begin + std::min(WordSize, count - begin);
        PadSome(vectors, begin, end, padded, bounds);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      all.Add(bounds);
    });
  return all;
}

} // namespace

void CheckDisplacements(
  const float* displacements, std::size_t count, const char* what, const PointRanges* changes)
{
  const std::size_t bad = FindBadVector(displacements, FindWords(changes, count), count);
  if (bad < count)
  {
    ThrowBadDisplacement(what, bad);
  }
}

void ThrowBadDisplacement(const char* what, std::size_t point)
{
  throw Error(std::string("The displacement of ") + what + " " + std::to_string(point) +
    " is not finite, or larger than 16383 output voxels. Check the scale of the displacements and "
    "the output spacing.");
}

std::size_t DisplacementBuffer::GetNumberOfPoints() const
{
  return static_cast<std::size_t>(GetMemory(this->Buffer) / (4 * sizeof(float)));
}

void DisplacementBuffer::Clear()
{
  this->Buffer = cl::Buffer();
  std::vector<float>().swap(this->Copy);
}

void DisplacementBuffer::WithDisplacements(const std::function<void(const float*)>& visit) const
{
  if (!this->Device.GetDevice().IsProcessor && !this->Copy.empty())
  {
    visit(this->Copy.data());
    return;
  }
  // On a CPU, or if a kernel has written the buffer.
  const MappedBuffer<const float> mapped(this->Device.GetQueue(), this->Buffer, CL_MAP_READ);
  visit(mapped.Get());
}

const cl::Buffer& DisplacementBuffer::AllocateForKernel(std::size_t count)
{
  const bool isWritable =
    this->Buffer() && this->Buffer.getInfo<CL_MEM_FLAGS>() & CL_MEM_READ_WRITE;
  if (!isWritable || this->GetNumberOfPoints() < count)
  {
    this->Clear();
    deformvolume::Reserve(this->Device.GetContext(), this->Buffer, 4 * count * sizeof(float));
  }
  std::vector<float>().swap(this->Copy);
  this->Tracker.MoveAll({});
  return this->Buffer;
}

void DisplacementBuffer::Grow(std::size_t count)
{
  constexpr std::size_t bytes = 4 * sizeof(float);
  const std::size_t had = this->GetNumberOfPoints();
  if (count <= had)
  {
    return;
  }
  const std::size_t room = count + count / 8; // reserve, since more nodes may follow soon
  const cl::CommandQueue& queue = this->Device.GetQueue();
  const cl::Buffer buffer(this->Device.GetContext().GetContext(), CL_MEM_READ_ONLY, room * bytes);
  queue.enqueueFillBuffer(buffer, cl_uchar{ 0 }, had * bytes, (room - had) * bytes);
  if (had > 0)
  {
    queue.enqueueCopyBuffer(this->Buffer, buffer, 0, 0, had * bytes);
  }
  queue.finish();
  this->Buffer = buffer;
  if (!this->Copy.empty())
  {
    this->Copy.resize(4 * room, 0.0F);
  }
}

void DisplacementBuffer::Set(const float* displacements, std::size_t count, std::size_t room,
  const PointRanges* changes, const std::function<BrickPoints()>& makePoints)
{
  const std::size_t held = this->GetNumberOfPoints();
  const bool isProcessor = this->Device.GetDevice().IsProcessor;
  const bool hasCopy = isProcessor || this->Copy.size() == 4 * held;
  room = std::max(room, count);
  if (!hasCopy || held < room)
  {
    const std::size_t floats = 4 * room;
    this->Clear();
    this->Buffer =
      cl::Buffer(this->Device.GetContext().GetContext(), CL_MEM_READ_ONLY, floats * sizeof(float));
    this->Copy.resize(isProcessor ? 0 : floats, 0.0F);
    this->Tracker.MoveAll({});
    changes = nullptr;
  }
  const SetArguments arguments{ displacements, count, changes, makePoints };
  const cl::CommandQueue& queue = this->Device.GetQueue();
  if (isProcessor)
  {
    const MappedBuffer<float> sent(queue, this->Buffer, CL_MAP_READ | CL_MAP_WRITE);
    this->Write(arguments, sent.Get());
    return;
  }
  const std::array<std::size_t, 2> changed = this->Write(arguments, this->Copy.data());
  if (changed[0] < changed[1])
  {
    constexpr std::size_t bytes = 4 * sizeof(float);
    deformvolume::Write(queue, this->Buffer, changed[0] * bytes, (changed[1] - changed[0]) * bytes,
      this->Copy.data() + 4 * changed[0]);
  }
}

std::array<std::size_t, 2> DisplacementBuffer::Write(const SetArguments& arguments, float* sent)
{
  const auto& [displacements, count, changes, makePoints] = arguments;
  const std::vector<std::size_t> words = FindWords(changes, count);
  bool partly = this->Tracker.IsTracking();
  if (partly)
  {
    const std::size_t most = this->Tracker.GetMaxMoved(count);
    this->Changed.Clear(count);
    const std::size_t number = MarkChanges(displacements, sent, words, count, most, this->Changed);
    if (number == 0)
    {
      return { { 0, 0 } };
    }
    partly = number <= most;
  }
  if (!partly)
  {
    const bool areAll = words.size() * WordSize >= count;
    const DisplacementBounds bounds = PadVectors(displacements, words, count, sent);
    this->Tracker.MoveAll(areAll ? std::optional(bounds) : std::nullopt);
    return { { 0, count } };
  }
  if (!this->Tracker.HasPoints())
  {
    this->Tracker.SetPoints(makePoints());
  }
  this->Tracker.MovePoints(this->Changed, sent);
  this->Tracker.AddMoved(PadVectors(displacements, words, count, sent));
  std::array<std::size_t, 2> changed;
  this->Changed.GetEnds(changed[0], changed[1]);
  return { { changed[0], std::min(changed[1], count) } };
}

} // namespace deformvolume
