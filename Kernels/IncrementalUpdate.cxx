// SPDX-License-Identifier: BSD-3-Clause
#include "IncrementalUpdate.h"

#include "HostThreads.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace deformvolume
{
namespace
{

// Above these parts of the whole it is faster to make all anew.
constexpr double LargestPart = 0.6;

// In output voxels: positions are rounded to 1/256, and displacements, of at most 2^14 voxels, are
// summed up in floats, with errors of some 2^-10.
constexpr double Margin = 1.0 / 16.0;

// The kernels clamp displacements to 2^22 - 1 steps of 1/256 voxel.
constexpr double LargestMove = 16384.0;

// State of vertices tells of their neighbours, and the fill rule asks the state of neighbours.
constexpr int MaskReach = 3;

bool IsDifferent(const unsigned char* last, const unsigned char* next, unsigned char value,
  std::int64_t begin, std::size_t size)
{
  if (last && next)
  {
    return std::memcmp(last + begin, next + begin, size) != 0;
  }
  const unsigned char* mask = last ? last : next;
  return mask &&
    std::any_of(mask + begin, mask + begin + size, [=](unsigned char v) { return v != value; });
}

constexpr std::uint32_t AllColumns = (1U << DEFORMVOLUME_COLUMNS) - 1;

// The bits of a brick's sections, and those of the columns between the lowest and the highest one.
std::uint32_t JoinColumns(std::uint32_t bits)
{
  const std::uint32_t columns = bits & AllColumns;
  std::uint32_t upToHighest = columns;
  for (int shift = 1; shift < DEFORMVOLUME_COLUMNS; shift *= 2)
  {
    upToHighest |= upToHighest >> shift;
  }
  const std::uint32_t belowLowest = (columns & (~columns + 1)) - 1;
  return bits | (columns ? upToHighest & ~belowLowest : 0);
}

// How many sections of a brick are run with these.
std::size_t CountSections(std::uint32_t bits)
{
  const auto count = [](std::uint32_t v) { return std::bitset<32>(v).count(); };
  const std::uint32_t halves = bits >> DEFORMVOLUME_COLUMNS;
  return count(JoinColumns(bits) & AllColumns) * count(halves & 3) * count(halves >> 2);
}

} // namespace

void IncrementalUpdate::Start(const BrickGrid& bricks, const Lattice& lattice, const Extent& output)
{
  this->Bricks = bricks;
  this->Grid = bricks.GetParts();
  const std::size_t parts = this->Grid.GetNumberOfBricks();
  if (output != this->OutputExtent || this->Known.size() != parts)
  {
    this->Known.assign(parts, 0); // boxes are relative to the output
  }
  this->Shape = lattice;
  this->OutputExtent = output;
  for (int axis = 0; axis < 3; ++axis)
  {
    this->PatchCount[axis] = static_cast<int>(DEFORMVOLUME_PATCHES(GetSize(output, axis)));
  }
  this->Boxes.resize(parts);
  this->LastBoxes.resize(parts);
  this->Finish();
  this->Tracking = true;
}

void IncrementalUpdate::Finish()
{
  this->Moved.assign(this->Grid.GetNumberOfBricks(), 0);
  this->Masked.assign(this->Grid.GetNumberOfBricks(), 0);
}

void IncrementalUpdate::MoveAll()
{
  this->Tracking = false;
  this->Known.assign(this->Known.size(), 0);
}

void IncrementalUpdate::ForgetMapping()
{
  this->Tracking = false;
  this->Points = BrickPoints();
  this->Known.clear();
}

IncrementalUpdate::Box IncrementalUpdate::ComputeBox(
  std::size_t part, const float* displacements) const
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  float least[3] = { infinity, infinity, infinity };
  float greatest[3] = { -infinity, -infinity, -infinity };
  this->Points.AnyOf(part,
    [&](std::size_t point)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        least[axis] = std::min(least[axis], displacements[4 * point + axis]);
        greatest[axis] = std::max(greatest[axis], displacements[4 * point + axis]);
      }
      return false;
    });
  const Extent vertices = this->Grid.GetVertices(part, 0);
  const double excess = this->Points.GetExcess(part);
  Box box;
  for (int axis = 0; axis < 3; ++axis)
  {
    if (!(least[axis] <= greatest[axis]) || vertices[2 * axis] >= vertices[2 * axis + 1])
    {
      // No vertex has a place, or there are no cells.
      return { { { 1.0, 1.0, 1.0 } }, { { 0.0, 0.0, 0.0 } } };
    }
    const double widening = excess * (double(greatest[axis]) - double(least[axis])) + Margin;
    const double low = std::min(least[axis] - widening, LargestMove);
    const double high = std::max(greatest[axis] + widening, -LargestMove);
    const double first = this->Shape.VertexExtent[2 * axis];
    box.Min[axis] =
      this->Shape.Scale[axis] * (first + vertices[2 * axis]) + low - this->OutputExtent[2 * axis];
    box.Max[axis] = this->Shape.Scale[axis] * (first + vertices[2 * axis + 1]) + high -
      this->OutputExtent[2 * axis];
    if (!std::isfinite(box.Min[axis]) || !std::isfinite(box.Max[axis]))
    {
      // Infinite weights times nothing.
      box.Min[axis] = 0.0;
      box.Max[axis] = static_cast<double>(GetSize(this->OutputExtent, axis));
    }
  }
  return box;
}

IncrementalUpdate::Patches IncrementalUpdate::GetPatches(const Box& box) const
{
  Patches patches;
  for (int axis = 0; axis < 3; ++axis)
  {
    // The voxels inside, within the output.
    const double size = static_cast<double>(GetSize(this->OutputExtent, axis));
    const double low = std::max(std::ceil(box.Min[axis]), 0.0);
    const double high = std::min(std::floor(box.Max[axis]), size - 1.0);
    if (!(low <= high))
    {
      return { { 0, -1, 0, -1, 0, -1 } };
    }
    patches[2 * axis] = static_cast<int>(low) / DEFORMVOLUME_PATCH;
    patches[2 * axis + 1] = static_cast<int>(high) / DEFORMVOLUME_PATCH;
  }
  return patches;
}

void IncrementalUpdate::MovePoints(const std::vector<unsigned char>& changed, const float* last)
{
  RunOnThreads(this->Grid.GetNumberOfBricks(),
    [&](std::size_t part)
    {
      if (this->Points.AnyOf(part, [&](std::size_t point) { return changed[point] != 0; }))
      {
        if (!this->Moved[part])
        {
          this->LastBoxes[part] =
            this->Known[part] ? this->Boxes[part] : this->ComputeBox(part, last);
          this->Moved[part] = 1;
        }
        this->Known[part] = 0;
      }
    });
}

void IncrementalUpdate::ChangeMask(
  const unsigned char* last, const unsigned char* next, unsigned char value, bool ofCells)
{
  const int less = ofCells ? 1 : 0;
  const std::int64_t size[2] = { this->Grid.Size[0] - less, this->Grid.Size[1] - less };
  RunOnThreads(this->Grid.GetNumberOfBricks(),
    [&](std::size_t part)
    {
      const Extent region = this->Grid.GetVertices(part, MaskReach);
      const std::int64_t row = region[1] - less - region[0] + 1;
      for (std::int64_t z = region[4]; z <= region[5] - less && !this->Masked[part]; ++z)
      {
        for (std::int64_t y = region[2]; y <= region[3] - less && !this->Masked[part]; ++y)
        {
          const std::int64_t begin = (z * size[1] + y) * size[0] + region[0];
          this->Masked[part] =
            row > 0 && IsDifferent(last, next, value, begin, static_cast<std::size_t>(row)) ? 1 : 0;
        }
      }
    });
}

bool IncrementalUpdate::MakePlan(const float* displacements, Plan& plan)
{
  const std::size_t parts = this->Grid.GetNumberOfBricks();
  std::vector<std::uint32_t> run(this->Bricks.GetNumberOfBricks()); // sections of bricks
  for (std::size_t part = 0; part < parts; ++part)
  {
    if (this->IsChanged(part))
    {
      const auto [brick, bits] = this->Bricks.GetBrick(this->Grid, part);
      run[brick] |= bits;
    }
  }
  const auto isTooMuch = [](std::size_t marked, std::size_t all)
  { return static_cast<double>(marked) > LargestPart * static_cast<double>(all); };
  const auto isRunTooMuch = [&]
  {
    return isTooMuch(
      std::accumulate(run.begin(), run.end(), std::size_t{ 0 },
        [](std::size_t sum, std::uint32_t bits) { return sum + CountSections(bits); }),
      DEFORMVOLUME_SECTIONS * run.size());
  };
  if (isRunTooMuch())
  {
    return false;
  }
  if (std::all_of(run.begin(), run.end(), [](std::uint32_t bits) { return bits == 0; }))
  {
    return true;
  }
  RunOnThreads(parts,
    [&](std::size_t part)
    {
      if (!this->Known[part])
      {
        this->Boxes[part] = this->ComputeBox(part, displacements);
        this->Known[part] = 1;
      }
    });

  std::vector<unsigned char> dirty(static_cast<std::size_t>(this->PatchCount[0]) *
    static_cast<std::size_t>(this->PatchCount[1]) * static_cast<std::size_t>(this->PatchCount[2]));
  // Whether body was true for one of the patches that a box touches.
  const auto anyOf = [&](const Box& box, const auto& body)
  {
    const Patches patches = this->GetPatches(box);
    for (int z = patches[4]; z <= patches[5]; ++z)
    {
      for (int y = patches[2]; y <= patches[3]; ++y)
      {
        const std::size_t row =
          (static_cast<std::size_t>(z) * this->PatchCount[1] + y) * this->PatchCount[0];
        for (int x = patches[0]; x <= patches[1]; ++x)
        {
          if (body(dirty[row + x]))
          {
            return true;
          }
        }
      }
    }
    return false;
  };
  const auto mark = [](unsigned char& patch)
  {
    patch = 1;
    return false;
  };
  for (std::size_t part = 0; part < parts; ++part)
  {
    if (this->IsChanged(part))
    {
      anyOf(this->Boxes[part], mark);
      if (this->Moved[part])
      {
        anyOf(this->LastBoxes[part], mark);
      }
    }
  }
  const auto isDirty = [](unsigned char patch) { return patch != 0; };
  for (std::size_t part = 0; part < parts; ++part)
  {
    const auto [brick, bits] = this->Bricks.GetBrick(this->Grid, part);
    if ((run[brick] & bits) != bits && anyOf(this->Boxes[part], isDirty))
    {
      run[brick] |= bits;
    }
  }
  for (std::size_t patch = 0; patch < dirty.size(); ++patch)
  {
    if (dirty[patch])
    {
      plan.Patches.push_back(static_cast<std::uint32_t>(patch));
    }
  }
  for (std::size_t brick = 0; brick < run.size(); ++brick)
  {
    if (run[brick])
    {
      plan.Bricks.push_back(
        static_cast<std::uint32_t>(brick | JoinColumns(run[brick]) << DEFORMVOLUME_BRICK_BITS));
    }
  }
  return !isTooMuch(plan.Patches.size(), dirty.size()) && !isRunTooMuch();
}

} // namespace deformvolume
