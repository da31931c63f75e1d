// SPDX-License-Identifier: BSD-3-Clause
// ChangeTracker: chooses the sections to resample and the patches to clear, from the changes
// and the boxes.
#include "ChangeTracker.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numeric>

namespace deformvolume
{
namespace
{

constexpr std::uint32_t AllSpans = (1U << DEFORMVOLUME_SPANS) - 1;

// Returns the section bits of a brick, with all spans between the lowest and the highest one.
std::uint32_t FillSpanGaps(std::uint32_t bits)
{
  const std::uint32_t spans = bits & AllSpans;
  std::uint32_t upToHighest = spans;
  for (int shift = 1; shift < DEFORMVOLUME_SPANS; shift *= 2)
  {
    upToHighest |= upToHighest >> shift;
  }
  const std::uint32_t belowLowest = (spans & (~spans + 1)) - 1;
  return bits | (spans ? upToHighest & ~belowLowest : 0);
}

// Returns the number of sections of a brick that are resampled for these bits.
std::size_t CountSections(std::uint32_t bits)
{
  const auto count = [](std::uint32_t v) { return std::bitset<32>(v).count(); };
  const std::uint32_t halves = bits >> DEFORMVOLUME_SPANS;
  return count(FillSpanGaps(bits) & AllSpans) * count(halves & 3) * count(halves >> 2);
}

// Returns the numbers of the marked patches.
std::vector<std::uint32_t> ListPatches(const std::vector<unsigned char>& dirty)
{
  std::vector<std::uint32_t> patches;
  for (std::size_t patch = 0; patch < dirty.size(); ++patch)
  {
    if (dirty[patch])
    {
      patches.push_back(static_cast<std::uint32_t>(patch));
    }
  }
  return patches;
}

// Returns the largest number of points, sections or patches to update. If more change, a full
// update is faster.
std::size_t GetMost(std::size_t all)
{
  constexpr double largestFraction = 0.6;
  return static_cast<std::size_t>(largestFraction * static_cast<double>(all));
}

} // namespace

std::size_t ChangeTracker::GetMaxMoved(std::size_t numberOfPoints) const
{
  return GetMost(numberOfPoints);
}

bool ChangeTracker::GetVoxels(const Box& box, Extent& voxels) const
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const double size = static_cast<double>(GetSize(this->OutputExtent, axis));
    const double low = std::max(std::ceil(box.Min[axis]), 0.0);
    const double high = std::min(std::floor(box.Max[axis]), size - 1.0);
    if (!(low <= high))
    {
      return false;
    }
    voxels[2 * axis] = static_cast<int>(low);
    voxels[2 * axis + 1] = static_cast<int>(high);
  }
  return true;
}

Extent ChangeTracker::GetChangedExtent() const
{
  Extent changed = EmptyExtent;
  this->ForChangedBoxes(
    [&](const Box& box)
    {
      Extent voxels;
      if (this->GetVoxels(box, voxels))
      {
        for (int end = 0; end < 6; ++end)
        {
          voxels[end] += this->OutputExtent[end / 2 * 2];
        }
        Include(changed, voxels);
      }
    });
  return changed;
}

template <typename Body>
bool ChangeTracker::AnyRowOfPatches(const Box& box, Body&& body) const
{
  Extent voxels;
  if (!this->GetVoxels(box, voxels))
  {
    return false;
  }
  const auto get = [&](int end) { return voxels[end] / DEFORMVOLUME_PATCH; };
  for (int z = get(4); z <= get(5); ++z)
  {
    for (int y = get(2); y <= get(3); ++y)
    {
      const std::ptrdiff_t row =
        (static_cast<std::ptrdiff_t>(z) * this->PatchCount[1] + y) * this->PatchCount[0];
      if (body(row + get(0), row + get(1) + 1))
      {
        return true;
      }
    }
  }
  return false;
}

std::vector<unsigned char> ChangeTracker::FindDirtyPatches() const
{
  std::vector<unsigned char> dirty(static_cast<std::size_t>(this->PatchCount[0]) *
    static_cast<std::size_t>(this->PatchCount[1]) * static_cast<std::size_t>(this->PatchCount[2]));
  this->ForChangedBoxes(
    [&](const Box& box)
    {
      this->AnyRowOfPatches(box,
        [&](std::ptrdiff_t first, std::ptrdiff_t end)
        {
          std::fill(dirty.begin() + first, dirty.begin() + end, 1);
          return false;
        });
    });
  return dirty;
}

std::vector<std::uint32_t> ChangeTracker::GetChangedPatches() const
{
  return ListPatches(this->FindDirtyPatches());
}

void ChangeTracker::AddSections(
  const std::vector<unsigned char>& dirty, std::vector<std::uint32_t>& toResample) const
{
  const auto isDirty = [&](std::ptrdiff_t first, std::ptrdiff_t end)
  { return std::find(dirty.begin() + first, dirty.begin() + end, 1) != dirty.begin() + end; };
  const Box dirtyBox = this->GetDirtyBox();
  for (std::size_t subBrick = 0; subBrick < this->Sections.size(); ++subBrick)
  {
    const auto [brick, bits] = this->Sections[subBrick];
    if (this->Known[subBrick] && this->Boxes[subBrick].Overlaps(dirtyBox) &&
      (toResample[brick] & bits) != bits && this->AnyRowOfPatches(this->Boxes[subBrick], isDirty))
    {
      toResample[brick] |= bits;
    }
  }
}

bool ChangeTracker::PlanUpdate(bool inside, Plan& plan)
{
  std::vector<std::uint32_t> toResample(this->Bricks.GetNumberOfBricks()); // sections of bricks
  bool isChanged = false;
  for (std::size_t subBrick = 0; subBrick < this->Sections.size(); ++subBrick)
  {
    if (this->IsChanged(subBrick))
    {
      isChanged = true;
      toResample[this->Sections[subBrick].first] |= this->Sections[subBrick].second;
    }
  }
  if (!isChanged)
  {
    return true;
  }
  const auto isTooMuch = [&]
  {
    const std::size_t sections =
      std::accumulate(toResample.begin(), toResample.end(), std::size_t{ 0 },
        [](std::size_t sum, std::uint32_t bits) { return sum + CountSections(bits); });
    return sections > GetMost(DEFORMVOLUME_SECTIONS * toResample.size());
  };
  if (isTooMuch())
  {
    return false;
  }
  if (!inside)
  {
    const std::vector<unsigned char> dirty = this->FindDirtyPatches();
    this->AddSections(dirty, toResample);
    plan.Patches = ListPatches(dirty);
    if (plan.Patches.size() > GetMost(dirty.size()) || isTooMuch())
    {
      return false;
    }
  }
  for (std::size_t brick = 0; brick < toResample.size(); ++brick)
  {
    if (toResample[brick])
    {
      plan.Bricks.push_back(static_cast<std::uint32_t>(
        brick | FillSpanGaps(toResample[brick]) << DEFORMVOLUME_BRICK_BITS));
    }
  }
  return true;
}

} // namespace deformvolume
