// SPDX-License-Identifier: BSD-3-Clause
// IncrementalUpdate: chooses the sections to resample and the patches to clear, from the changes
// and the boxes.
#include "IncrementalUpdate.h"

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
std::uint32_t JoinSpans(std::uint32_t bits)
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
  return count(JoinSpans(bits) & AllSpans) * count(halves & 3) * count(halves >> 2);
}

// Returns the largest number of points, sections or patches to update. If more change, a full
// update is faster.
std::size_t GetMost(std::size_t all)
{
  constexpr double largestFraction = 0.6;
  return static_cast<std::size_t>(largestFraction * static_cast<double>(all));
}

} // namespace

std::size_t IncrementalUpdate::GetMostMoved(std::size_t numberOfPoints) const
{
  return GetMost(numberOfPoints);
}

bool IncrementalUpdate::GetVoxels(const Box& box, Extent& voxels) const
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

IncrementalUpdate::Patches IncrementalUpdate::GetPatches(const Box& box) const
{
  Extent voxels;
  if (!this->GetVoxels(box, voxels))
  {
    return { { 0, -1, 0, -1, 0, -1 } };
  }
  Patches patches;
  std::transform(voxels.begin(), voxels.end(), patches.begin(),
    [](int voxel) { return voxel / DEFORMVOLUME_PATCH; });
  return patches;
}

Extent IncrementalUpdate::GetChangedExtent() const
{
  Extent changed{ { 0, -1, 0, -1, 0, -1 } };
  const auto add = [&](const Box& box)
  {
    Extent voxels;
    if (!this->GetVoxels(box, voxels))
    {
      return;
    }
    for (int end = 0; end < 6; ++end)
    {
      voxels[end] += this->OutputExtent[end / 2 * 2];
    }
    Include(changed, voxels);
  };
  for (std::size_t subBrick = 0; subBrick < this->Sections.size(); ++subBrick)
  {
    if (this->IsChanged(subBrick))
    {
      add(this->Boxes[subBrick]);
      if (this->Moved[subBrick])
      {
        add(this->LastBoxes[subBrick]);
      }
    }
  }
  return changed;
}

void IncrementalUpdate::MarkPatches(const Box& box, std::vector<unsigned char>& dirty) const
{
  const Patches patches = this->GetPatches(box);
  for (int z = patches[4]; z <= patches[5]; ++z)
  {
    for (int y = patches[2]; y <= patches[3]; ++y)
    {
      const auto row = dirty.begin() +
        (static_cast<std::ptrdiff_t>(z) * this->PatchCount[1] + y) * this->PatchCount[0];
      std::fill(row + patches[0], row + patches[1] + 1, 1);
    }
  }
}

void IncrementalUpdate::MarkChangedPatches(
  std::size_t subBrick, std::vector<unsigned char>& dirty) const
{
  this->MarkPatches(this->Boxes[subBrick], dirty);
  if (this->Moved[subBrick])
  {
    this->MarkPatches(this->LastBoxes[subBrick], dirty);
  }
}

std::vector<unsigned char> IncrementalUpdate::MakeFlagsOfPatches() const
{
  return std::vector<unsigned char>(static_cast<std::size_t>(this->PatchCount[0]) *
    static_cast<std::size_t>(this->PatchCount[1]) * static_cast<std::size_t>(this->PatchCount[2]));
}

std::vector<std::uint32_t> IncrementalUpdate::ListPatches(const std::vector<unsigned char>& dirty)
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

std::vector<std::uint32_t> IncrementalUpdate::GetChangedPatches() const
{
  std::vector<unsigned char> dirty = this->MakeFlagsOfPatches();
  for (std::size_t subBrick = 0; subBrick < this->Sections.size(); ++subBrick)
  {
    if (this->IsChanged(subBrick))
    {
      this->MarkChangedPatches(subBrick, dirty);
    }
  }
  return ListPatches(dirty);
}

void IncrementalUpdate::PlanPatches(const std::vector<std::size_t>& changed,
  std::vector<std::uint32_t>& toResample, std::vector<unsigned char>& dirty) const
{
  for (const std::size_t subBrick : changed)
  {
    this->MarkChangedPatches(subBrick, dirty);
  }
  const Box dirtyBox = this->GetDirtyBox();
  for (std::size_t subBrick = 0; subBrick < this->Sections.size(); ++subBrick)
  {
    const auto [brick, bits] = this->Sections[subBrick];
    if (this->Known[subBrick] && this->Boxes[subBrick].Overlaps(dirtyBox) &&
      (toResample[brick] & bits) != bits && this->TouchesPatches(this->Boxes[subBrick], dirty))
    {
      toResample[brick] |= bits;
    }
  }
}

bool IncrementalUpdate::MakePlan(bool inside, Plan& plan)
{
  std::vector<std::uint32_t> toResample(this->Bricks.GetNumberOfBricks()); // sections of bricks
  std::vector<std::size_t> changed;
  for (std::size_t subBrick = 0; subBrick < this->Sections.size(); ++subBrick)
  {
    if (this->IsChanged(subBrick))
    {
      changed.push_back(subBrick);
      toResample[this->Sections[subBrick].first] |= this->Sections[subBrick].second;
    }
  }
  if (changed.empty())
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
    std::vector<unsigned char> dirty = this->MakeFlagsOfPatches();
    this->PlanPatches(changed, toResample, dirty);
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
        brick | JoinSpans(toResample[brick]) << DEFORMVOLUME_BRICK_BITS));
    }
  }
  return true;
}

} // namespace deformvolume
