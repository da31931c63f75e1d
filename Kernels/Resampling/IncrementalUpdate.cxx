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

// In voxels from a sub-brick. What a cell does depends on its own vertices, on their states and, on
// the border of the mesh, on the cells that share vertices with it; the state of a vertex depends
// on the vertices and the cells that share a cell with it. So a vertex or a cell that is masked
// matters to cells that have one of their vertices in a cell with it, or in it: it lies at most one
// voxel beyond their vertices.
constexpr int MaskReach = 1;

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

void IncrementalUpdate::SetPoints(BrickPoints&& points)
{
  this->Points = std::move(points);
  std::vector<std::size_t> bricks(this->Places.size());
  std::transform(this->Places.begin(), this->Places.end(), bricks.begin(),
    [](const auto& place) { return place.first; });
  this->PointsOfBricks = this->Points.Join(bricks, this->Bricks.GetNumberOfBricks());
}

void IncrementalUpdate::MovePoints(const PointSet& changed, const float* last)
{
  std::size_t first = 0;
  std::size_t past = 0;
  changed.GetEnds(first, past);
  const auto hasMoved = [&](const BrickPoints& points, std::size_t brick)
  {
    return !points.IsApart(brick, first, past) &&
      points.AnyOf(
        brick, [&](std::size_t begin, std::size_t end) { return changed.HasAnyOf(begin, end); });
  };
  // Most bricks are nowhere near.
  std::vector<unsigned char> near(this->Bricks.GetNumberOfBricks());
  ParallelForParts(near.size(), StepSize,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t brick = begin; brick < end; ++brick)
      {
        near[brick] = hasMoved(this->PointsOfBricks, brick) ? 1 : 0;
      }
    });
  const auto isMoved = [&](std::size_t subBrick)
  { return near[this->Places[subBrick].first] && hasMoved(this->Points, subBrick); };
  ParallelForParts(this->Grid.GetNumberOfBricks(), StepSize,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t subBrick = begin; subBrick < end; ++subBrick)
      {
        if (isMoved(subBrick))
        {
          this->Move(subBrick, last);
        }
      }
    });
  this->BoxesKnown = false;
}

void IncrementalUpdate::Move(std::size_t subBrick, const float* last)
{
  if (!this->HasCells(subBrick))
  {
    return;
  }
  if (!this->Moved[subBrick])
  {
    this->LastBoxes[subBrick] = this->Known[subBrick]
      ? this->Boxes[subBrick]
      : this->MakeBox(subBrick, this->ComputeBounds(subBrick, { last, nullptr }));
    this->Moved[subBrick] = 1;
  }
  this->Known[subBrick] = 0;
}

std::optional<std::vector<Extent>> IncrementalUpdate::ChangeTetrahedra(
  const std::vector<TetrahedronChange>& changes, const float* last)
{
  if (!this->HasPoints() || this->Points.AreOverloaded())
  {
    this->ForgetMapping();
    return {};
  }
  std::vector<unsigned char> near(this->Bricks.GetNumberOfBricks());
  for (const BrickPoints::ChangesOfBrick& brick :
    this->PointsOfBricks.FindBricks(changes, [](std::size_t) { return true; }))
  {
    near[brick.first] = 1;
    this->PointsOfBricks.AddPoints(brick, changes);
  }
  std::vector<Extent> boxes;
  for (const BrickPoints::ChangesOfBrick& subBrick : this->Points.FindBricks(
         changes, [&](std::size_t number) { return near[this->Places[number].first] != 0; }))
  {
    boxes.push_back(this->Grid.GetVertices(subBrick.first, 0));
    if (this->Tracking)
    {
      this->Move(subBrick.first, last); // by the nodes that it has had
    }
    this->Known[subBrick.first] = 0;
    this->Points.AddPoints(subBrick, changes);
  }
  this->BoxesKnown = false;
  return boxes;
}

void IncrementalUpdate::AddMoved(const DisplacementBounds& after)
{
  if (this->AllBounds)
  {
    this->AllBounds->Add(after);
  }
}

bool IncrementalUpdate::HasOnlyInterior(
  std::size_t subBrick, const unsigned char* state, const Extent& box) const
{
  const Extent vertices = this->Grid.GetVertices(subBrick, 0);
  const std::array<int, 3>& size = this->Grid.Size;
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

Extent IncrementalUpdate::GetMovedVertices() const
{
  Extent box{ { 0, -1, 0, -1, 0, -1 } };
  for (std::size_t subBrick = 0; subBrick < this->Moved.size(); ++subBrick)
  {
    if (this->Moved[subBrick])
    {
      Include(box, this->Grid.GetVertices(subBrick, 0));
    }
  }
  return box;
}

bool IncrementalUpdate::IsInside(const unsigned char* state, const Extent& box) const
{
  std::atomic<bool> inside{ true };
  ParallelForParts(this->Grid.GetNumberOfBricks(), StepSize,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t subBrick = begin; subBrick < end && inside; ++subBrick)
      {
        if (this->Masked[subBrick] ||
          (this->Moved[subBrick] && !this->HasOnlyInterior(subBrick, state, box)))
        {
          inside = false;
        }
      }
    });
  return inside;
}

void IncrementalUpdate::ChangeMask(const std::vector<Extent>& changes, bool ofCells)
{
  if (!this->Tracking)
  {
    return;
  }
  const int more = ofCells ? 1 : 0; // a cell reaches to the next vertices
  for (const Extent& box : changes)
  {
    std::array<int, 6> subBricks; // first and last one on each axis that may be near
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto find = [&](int vertex)
      {
        const int place = (vertex - this->Grid.Origin[axis]) / this->Grid.Cells[axis];
        return std::min(std::max(place, 0), this->Grid.Count[axis] - 1);
      };
      subBricks[2 * axis] = find(box[2 * axis] - MaskReach - 1);
      subBricks[2 * axis + 1] = find(box[2 * axis + 1] + more + MaskReach);
    }
    for (int z = subBricks[4]; z <= subBricks[5]; ++z)
    {
      for (int y = subBricks[2]; y <= subBricks[3]; ++y)
      {
        for (int x = subBricks[0]; x <= subBricks[1]; ++x)
        {
          const std::size_t subBrick =
            (static_cast<std::size_t>(z) * static_cast<std::size_t>(this->Grid.Count[1]) +
              static_cast<std::size_t>(y)) *
              static_cast<std::size_t>(this->Grid.Count[0]) +
            static_cast<std::size_t>(x);
          const Extent region = this->Grid.GetVertices(subBrick, MaskReach);
          bool touches = this->HasCells(subBrick);
          for (int axis = 0; axis < 3; ++axis)
          {
            touches &=
              box[2 * axis] <= region[2 * axis + 1] - more && box[2 * axis + 1] >= region[2 * axis];
          }
          this->Masked[subBrick] |= touches ? 1 : 0;
        }
      }
    }
  }
  if (!changes.empty())
  {
    this->BoxesKnown = false; // of sub-bricks that have changed now
  }
}

} // namespace deformvolume
