// SPDX-License-Identifier: BSD-3-Clause
// ChangeTracker: the boxes of sub-bricks in the output.
#include "ChangeTracker.h"

#include "IndexBounds.h"
#include "ParallelFor.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{
namespace
{

// In output voxels. Positions are rounded to 1/256 voxel. Displacements of at most 2^14 voxels are
// added up in floats, with errors of about 2^-10.
constexpr double Margin = 1.0 / 16.0;

// The kernels clamp displacements to 2^22 - 1 steps of 1/256 voxel.
constexpr double LargestMove = 16384.0;

} // namespace

DisplacementBounds ChangeTracker::ComputeBounds(
  std::size_t subBrick, const Displacements& displacements) const
{
  if (displacements.OfSubBricks)
  {
    return (*displacements.OfSubBricks)[subBrick];
  }
  DisplacementBounds bounds;
  const auto add = [&](const auto& from)
  {
    this->Points.AnyRange(subBrick,
      [&](std::size_t begin, std::size_t end)
      {
        bounds.Add(from, begin, end);
        return false;
      });
  };
  if (displacements.Padded)
  {
    add(displacements.Padded);
  }
  else
  {
    add(displacements);
  }
  return bounds;
}

DisplacementBounds ChangeTracker::ComputeAllBounds(
  const Displacements& displacements, std::size_t numberOfPoints) const
{
  if (displacements.OfSubBricks)
  {
    return Join(*displacements.OfSubBricks);
  }
  constexpr std::size_t step = 65536;
  std::vector<DisplacementBounds> steps((numberOfPoints + step - 1) / step);
  ParallelForParts(numberOfPoints, step,
    [&](std::size_t begin, std::size_t end)
    { steps[begin / step].Add(displacements, begin, end); });
  return Join(steps);
}

ChangeTracker::Box ChangeTracker::MakeBox(
  std::size_t subBrick, const DisplacementBounds& bounds) const
{
  const Extent vertices = this->SubBricks.GetVertices(subBrick, 0);
  const double excess = this->Points.GetNegativeWeightSum(subBrick);
  if (GetNumberOfCells(vertices) == 0)
  {
    return Box();
  }
  IndexBounds voxels = GetBox(vertices);
  const glm::dvec3 first = GetBox(this->Voxels).Min;
  voxels.Min += first;
  voxels.Max += first;
  const IndexBounds rest = GetOutputTransform(this->Voxels).ToOutput(voxels);
  Box box;
  for (int axis = 0; axis < 3; ++axis)
  {
    const float least = bounds.Min[axis];
    const float greatest = bounds.Max[axis];
    if (!(least <= greatest)) // no vertex has a position
    {
      return Box();
    }
    const double widening = excess * (double(greatest) - double(least)) + Margin;
    double low = std::min(least - widening, LargestMove);
    double high = std::max(greatest + widening, -LargestMove);
    if (this->Points.IsFading())
    {
      low = std::min(low, -Margin);
      high = std::max(high, Margin);
    }
    if (!this->IsCut.empty() && this->IsCut[subBrick])
    {
      // A cut adds at most the difference of two other displacements (CutPositions.cl).
      const double difference = high - low;
      low -= difference;
      high += difference;
    }
    box.Min[axis] = rest.Min[axis] + low - this->OutputExtent[2 * axis];
    box.Max[axis] = rest.Max[axis] + high - this->OutputExtent[2 * axis];
    if (!std::isfinite(box.Min[axis]) || !std::isfinite(box.Max[axis]))
    {
      // Overflow, or not-a-number from infinity times 0: the sub-brick may lie anywhere.
      box.Min[axis] = 0.0;
      box.Max[axis] = static_cast<double>(GetSize(this->OutputExtent, axis));
    }
  }
  return box;
}

ChangeTracker::Box ChangeTracker::GetDirtyBox() const
{
  Box dirtyBox;
  this->ForChangedBoxes([&](const Box& box) { dirtyBox.Add(box); });
  if (!dirtyBox.IsEmpty())
  {
    dirtyBox.Min -= double{ DEFORMVOLUME_PATCH };
    dirtyBox.Max += double{ DEFORMVOLUME_PATCH };
  }
  return dirtyBox;
}

template <typename IsWanted>
void ChangeTracker::FindBoxesOf(const IsWanted& isWanted, const Displacements& displacements)
{
  ParallelForItems(this->SubBricks.GetNumberOfBricks(), StepSize,
    [&](std::size_t subBrick)
    {
      if (!this->Known[subBrick] && isWanted(subBrick))
      {
        this->Boxes[subBrick] =
          this->MakeBox(subBrick, this->ComputeBounds(subBrick, displacements));
        this->Known[subBrick] = 1;
      }
    });
}

void ChangeTracker::FindChangedBoxes(const Displacements& displacements)
{
  this->FindBoxesOf([&](std::size_t subBrick) { return this->IsChanged(subBrick); }, displacements);
}

void ChangeTracker::FindAllBoxes(const Displacements& displacements)
{
  this->FindBoxesOf([](std::size_t) { return true; }, displacements);
}

bool ChangeTracker::HasAllBoxes() const
{
  return this->HasPoints() && !this->Known.empty() &&
    std::find(this->Known.begin(), this->Known.end(), 0) == this->Known.end();
}

void ChangeTracker::FindPlanBoxes(const Displacements& displacements, std::size_t numberOfPoints)
{
  if (!this->AllBounds)
  {
    this->AllBounds = this->ComputeAllBounds(displacements, numberOfPoints);
  }
  this->FindChangedBoxes(displacements);
  const Box dirtyBox = this->GetDirtyBox();
  this->FindBoxesOf([&](std::size_t subBrick)
    { return this->MakeBox(subBrick, *this->AllBounds).Overlaps(dirtyBox); },
    displacements);
  this->PlanBoxesKnown = true;
}

} // namespace deformvolume
