// SPDX-License-Identifier: BSD-3-Clause
#include "IncrementalUpdate.h"

#include "ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

namespace deformvolume
{
namespace
{

// In output voxels: positions are rounded to 1/256, and displacements, of at most 2^14 voxels, are
// summed up in floats, with errors of some 2^-10.
constexpr double Margin = 1.0 / 16.0;

// The kernels clamp displacements to 2^22 - 1 steps of 1/256 voxel.
constexpr double LargestMove = 16384.0;

// Whether there are cells between some vertices.
bool HasCells(const Extent& vertices)
{
  return vertices[0] < vertices[1] && vertices[2] < vertices[3] && vertices[4] < vertices[5];
}

// Sub-bricks that a thread takes at a time.
constexpr std::size_t StepSize = 256;

} // namespace

void IncrementalUpdate::Start(
  const BrickGrid& bricks, const VoxelGrid& voxelGrid, const Extent& output)
{
  this->Bricks = bricks;
  this->Grid = bricks.GetSubBricks();
  const std::size_t subBricks = this->Grid.GetNumberOfBricks();
  if (output != this->OutputExtent || this->Known.size() != subBricks)
  {
    this->Known.assign(subBricks, 0); // boxes are relative to the output
    this->BoxesKnown = false;
  }
  if (this->Places.empty())
  {
    for (std::size_t subBrick = 0; subBrick < subBricks; ++subBrick)
    {
      this->Places.push_back(bricks.GetBrick(this->Grid, subBrick));
    }
  }
  this->Shape = voxelGrid;
  this->OutputExtent = output;
  for (int axis = 0; axis < 3; ++axis)
  {
    this->PatchCount[axis] = static_cast<int>(DEFORMVOLUME_PATCHES(GetSize(output, axis)));
  }
  this->Boxes.resize(subBricks);
  this->LastBoxes.resize(subBricks);
  this->Finish();
  this->Tracking = true;
}

void IncrementalUpdate::Finish()
{
  this->Moved.assign(this->Grid.GetNumberOfBricks(), 0);
  this->Masked.assign(this->Grid.GetNumberOfBricks(), 0);
}

void IncrementalUpdate::MoveAll(const std::optional<DisplacementBounds>& after)
{
  this->Tracking = false;
  this->Known.assign(this->Known.size(), 0);
  this->BoxesKnown = false;
  this->AllBounds = after;
}

void IncrementalUpdate::ForgetMapping()
{
  this->Tracking = false;
  this->Points = this->PointsOfBricks = BrickPoints();
  this->Known.clear();
  this->BoxesKnown = false;
  this->AllBounds.reset();
}

DisplacementBounds IncrementalUpdate::ComputeBounds(
  std::size_t subBrick, const Displacements& displacements) const
{
  DisplacementBounds bounds;
  this->Points.AnyOf(subBrick,
    [&](std::size_t begin, std::size_t end)
    {
      bounds.Add(displacements, begin, end);
      return false;
    });
  return bounds;
}

DisplacementBounds IncrementalUpdate::ComputeAllBounds(
  const Displacements& displacements, std::size_t numberOfPoints) const
{
  constexpr std::size_t step = 65536;
  std::vector<DisplacementBounds> steps((numberOfPoints + step - 1) / step);
  ParallelForParts(numberOfPoints, step,
    [&](std::size_t begin, std::size_t end)
    { steps[begin / step].Add(displacements, begin, end); });
  DisplacementBounds all;
  for (const DisplacementBounds& bounds : steps)
  {
    all.Add(bounds);
  }
  return all;
}

IncrementalUpdate::Box IncrementalUpdate::MakeBox(
  std::size_t subBrick, const DisplacementBounds& bounds) const
{
  const Extent vertices = this->Grid.GetVertices(subBrick, 0);
  const double excess = this->Points.GetExcess(subBrick);
  constexpr Box nothing = { { { 1.0, 1.0, 1.0 } }, { { 0.0, 0.0, 0.0 } } };
  if (!HasCells(vertices))
  {
    return nothing;
  }
  Box box;
  for (int axis = 0; axis < 3; ++axis)
  {
    const float least = bounds.Least[axis];
    const float greatest = bounds.Greatest[axis];
    if (!(least <= greatest)) // no vertex has a place
    {
      return nothing;
    }
    const double widening = excess * (double(greatest) - double(least)) + Margin;
    const double low = std::min(least - widening, LargestMove);
    const double high = std::max(greatest + widening, -LargestMove);
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

IncrementalUpdate::Box IncrementalUpdate::GetReach() const
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box reach{ { { infinity, infinity, infinity } }, { { -infinity, -infinity, -infinity } } };
  const auto add = [&](const Box& box)
  {
    for (int axis = 0; axis < 3 && box.Min[0] <= box.Max[0]; ++axis)
    {
      reach.Min[axis] = std::min(reach.Min[axis], box.Min[axis] - DEFORMVOLUME_PATCH);
      reach.Max[axis] = std::max(reach.Max[axis], box.Max[axis] + DEFORMVOLUME_PATCH);
    }
  };
  for (std::size_t subBrick = 0; subBrick < this->Moved.size(); ++subBrick)
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
  return reach;
}

bool IncrementalUpdate::TouchesPatches(
  const Box& box, const std::vector<unsigned char>& dirty) const
{
  const Patches patches = this->GetPatches(box);
  for (int z = patches[4]; z <= patches[5]; ++z)
  {
    for (int y = patches[2]; y <= patches[3]; ++y)
    {
      const auto row = dirty.begin() +
        (static_cast<std::ptrdiff_t>(z) * this->PatchCount[1] + y) * this->PatchCount[0];
      if (std::find(row + patches[0], row + patches[1] + 1, 1) != row + patches[1] + 1)
      {
        return true;
      }
    }
  }
  return false;
}

bool IncrementalUpdate::HasOnlyInterior(std::size_t subBrick, const unsigned char* state) const
{
  const Extent vertices = this->Grid.GetVertices(subBrick, 0);
  const std::array<int, 3>& size = this->Grid.Size;
  if (!HasCells(vertices))
  {
    return true;
  }
  if (!state)
  {
    bool interior = true;
    for (int axis = 0; axis < 3; ++axis)
    {
      interior &= vertices[2 * axis] > 0 && vertices[2 * axis + 1] < size[axis] - 1;
    }
    return interior;
  }
  for (std::int64_t z = vertices[4]; z <= vertices[5]; ++z)
  {
    for (std::int64_t y = vertices[2]; y <= vertices[3]; ++y)
    {
      const unsigned char* row = state + (z * size[1] + y) * size[0];
      if (!std::all_of(row + vertices[0], row + vertices[1] + 1,
            [](unsigned char v) { return (v & DEFORMVOLUME_VERTEX_INTERIOR) != 0; }))
      {
        return false;
      }
    }
  }
  return true;
}

bool IncrementalUpdate::IsInside(const unsigned char* state) const
{
  std::atomic<bool> inside{ true };
  ParallelForParts(this->Grid.GetNumberOfBricks(), StepSize,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t subBrick = begin; subBrick < end && inside; ++subBrick)
      {
        if (this->Masked[subBrick] ||
          (this->Moved[subBrick] && !this->HasOnlyInterior(subBrick, state)))
        {
          inside = false;
        }
      }
    });
  return inside;
}

template <typename IsWanted>
void IncrementalUpdate::FindBoxesOf(const IsWanted& isWanted, const Displacements& displacements)
{
  ParallelForParts(this->Grid.GetNumberOfBricks(), StepSize,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t subBrick = begin; subBrick < end; ++subBrick)
      {
        if (!this->Known[subBrick] && isWanted(subBrick))
        {
          this->Boxes[subBrick] =
            this->MakeBox(subBrick, this->ComputeBounds(subBrick, displacements));
          this->Known[subBrick] = 1;
        }
      }
    });
}

void IncrementalUpdate::FindChangedBoxes(const Displacements& displacements)
{
  this->FindBoxesOf([&](std::size_t subBrick) { return this->IsChanged(subBrick); }, displacements);
}

void IncrementalUpdate::FindAllBoxes(const Displacements& displacements)
{
  this->FindBoxesOf([](std::size_t) { return true; }, displacements);
}

bool IncrementalUpdate::KnowsAllBoxes() const
{
  return this->HasPoints() && !this->Known.empty() &&
    std::find(this->Known.begin(), this->Known.end(), 0) == this->Known.end();
}

void IncrementalUpdate::FindBoxes(const Displacements& displacements, std::size_t numberOfPoints)
{
  if (!this->AllBounds)
  {
    this->AllBounds = this->ComputeAllBounds(displacements, numberOfPoints);
  }
  this->FindChangedBoxes(displacements);
  const Box reach = this->GetReach();
  this->FindBoxesOf([&](std::size_t subBrick)
    { return !IsApart(this->MakeBox(subBrick, *this->AllBounds), reach); },
    displacements);
  this->BoxesKnown = true;
}

bool IncrementalUpdate::IsApart(const Box& a, const Box& b)
{
  bool apart = false;
  for (int axis = 0; axis < 3; ++axis)
  {
    apart |= a.Min[axis] > b.Max[axis] || a.Max[axis] < b.Min[axis];
  }
  return apart;
}

} // namespace deformvolume
