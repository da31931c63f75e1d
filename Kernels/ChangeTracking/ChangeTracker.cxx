// SPDX-License-Identifier: BSD-3-Clause
#include "ChangeTracker.h"

#include "ParallelFor.h"

#include <algorithm>
#include <atomic>

namespace deformvolume
{

void ChangeTracker::Start(const BrickGrid& bricks, const VoxelGrid& voxelGrid, const Extent& output)
{
  this->Bricks = bricks;
  this->SubBricks = bricks.GetSubBricks();
  const std::size_t subBricks = this->SubBricks.GetNumberOfBricks();
  if (output != this->OutputExtent || this->Known.size() != subBricks)
  {
    this->Known.assign(subBricks, 0); // boxes are relative to the output
    this->PlanBoxesKnown = false;
  }
  if (this->Sections.empty())
  {
    for (std::size_t subBrick = 0; subBrick < subBricks; ++subBrick)
    {
      this->Sections.push_back(bricks.GetBrick(this->SubBricks, subBrick));
    }
  }
  this->Voxels = voxelGrid;
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

void ChangeTracker::Finish()
{
  this->Moved.assign(this->SubBricks.GetNumberOfBricks(), 0);
  this->Masked.assign(this->SubBricks.GetNumberOfBricks(), 0);
}

void ChangeTracker::MoveAll(const std::optional<DisplacementBounds>& after)
{
  this->Tracking = false;
  this->Known.assign(this->Known.size(), 0);
  this->PlanBoxesKnown = false;
  this->AllBounds = after;
}

void ChangeTracker::InvalidateMapping()
{
  this->Tracking = false;
  this->Points = this->PointsOfBricks = BrickPoints();
  this->Known.clear();
  this->PlanBoxesKnown = false;
  this->AllBounds.reset();
}

bool ChangeTracker::AreVerticesInterior(
  std::size_t subBrick, const unsigned char* state, const Extent& box) const
{
  const Extent vertices = this->SubBricks.GetVertices(subBrick, 0);
  const std::array<int, 3>& size = this->SubBricks.Size;
  if (!this->IsCut.empty() && this->IsCut[subBrick])
  {
    return false; // the sides of a cut can separate
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
      const unsigned char* row =
        state + ((z - box[4]) * GetSize(box, 1) + y - box[2]) * GetSize(box, 0);
      if (!std::all_of(row + (vertices[0] - box[0]), row + (vertices[1] + 1 - box[0]),
            [](unsigned char v) { return (v & DEFORMVOLUME_VERTEX_INTERIOR) != 0; }))
      {
        return false;
      }
    }
  }
  return true;
}

Extent ChangeTracker::GetMovedVertices() const
{
  Extent box = EmptyExtent;
  for (std::size_t subBrick = 0; subBrick < this->Moved.size(); ++subBrick)
  {
    if (this->Moved[subBrick])
    {
      Include(box, this->SubBricks.GetVertices(subBrick, 0));
    }
  }
  return box;
}

bool ChangeTracker::IsChangeInterior(const unsigned char* state, const Extent& box) const
{
  std::atomic<bool> inside{ true };
  ParallelForItems(this->SubBricks.GetNumberOfBricks(), StepSize,
    [&](std::size_t subBrick)
    {
      if (inside &&
        (this->Masked[subBrick] ||
          (this->Moved[subBrick] && !this->AreVerticesInterior(subBrick, state, box))))
      {
        inside = false;
      }
    });
  return inside;
}

} // namespace deformvolume
