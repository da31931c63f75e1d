// SPDX-License-Identifier: BSD-3-Clause
// ChangeTracker: the sub-bricks that a change of the deformation or of masks affects.
#include "ChangeTracker.h"

#include "ParallelFor.h"

#include <algorithm>
#include <array>

namespace deformvolume
{
namespace
{

// In voxels around a sub-brick. A cell depends on its own vertices, on their states and, at the
// border of the sampling mesh, on cells that share vertices with it. The state of a vertex depends
// on the vertices and cells that share a cell with it. So a change of a mask affects cells up to
// one voxel away.
constexpr int MaskHalo = 1;

} // namespace

void ChangeTracker::SetHalo(int halo)
{
  if (this->SubBricks.Halo != halo)
  {
    this->Bricks.Halo = this->SubBricks.Halo = halo;
    this->Points = this->PointsOfBricks = BrickPoints(); // a wider halo has more points
  }
}

std::vector<unsigned char> ChangeTracker::AddCut(const std::vector<CutVertex>& vertices)
{
  std::vector<unsigned char> found(vertices.empty() ? 0 : this->SubBricks.GetNumberOfBricks());
  for (const CutVertex& v : vertices)
  {
    this->ForSubBricks({ { v.X, v.X, v.Y, v.Y, v.Z, v.Z } }, false, 0,
      [&](std::size_t subBrick) { found[subBrick] = 1; });
  }
  this->IsCut.resize(this->SubBricks.GetNumberOfBricks());
  for (std::size_t subBrick = 0; subBrick < found.size(); ++subBrick)
  {
    if (found[subBrick] && !this->IsCut[subBrick])
    {
      this->IsCut[subBrick] = 1;
      this->Known[subBrick] = 0; // the box becomes wider
    }
  }
  this->PlanBoxesKnown = false;
  return found;
}

void ChangeTracker::SetCut(const std::vector<CutVertex>& vertices)
{
  this->IsCut = this->AddCut(vertices); // boxes that were cut before may stay wider than needed
}

void ChangeTracker::SetPoints(BrickPoints&& points)
{
  this->Points = std::move(points);
  std::vector<std::vector<std::size_t>> bricks(this->Bricks.GetNumberOfBricks());
  for (std::size_t subBrick = 0; subBrick < this->Sections.size(); ++subBrick)
  {
    bricks[this->Sections[subBrick].first].push_back(subBrick);
  }
  this->PointsOfBricks = this->Points.Join(bricks);
}

void ChangeTracker::MovePoints(const PointSet& changed, const float* last)
{
  std::size_t first = 0;
  std::size_t past = 0;
  changed.GetEnds(first, past);
  const auto hasMoved = [&](const BrickPoints& points, std::size_t brick)
  {
    return !points.IsOutside(brick, first, past) &&
      points.AnyRange(
        brick, [&](std::size_t begin, std::size_t end) { return changed.HasAnyOf(begin, end); });
  };
  // Test bricks first: most of them have no changed points.
  std::vector<unsigned char> near(this->Bricks.GetNumberOfBricks());
  ParallelForItems(near.size(), StepSize,
    [&](std::size_t brick) { near[brick] = hasMoved(this->PointsOfBricks, brick) ? 1 : 0; });
  const auto isMoved = [&](std::size_t subBrick)
  { return near[this->Sections[subBrick].first] && hasMoved(this->Points, subBrick); };
  ParallelForItems(this->SubBricks.GetNumberOfBricks(), StepSize,
    [&](std::size_t subBrick)
    {
      if (isMoved(subBrick))
      {
        this->Move(subBrick, last);
      }
    });
  this->PlanBoxesKnown = false;
}

void ChangeTracker::Move(std::size_t subBrick, const float* last)
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

std::optional<std::vector<Extent>> ChangeTracker::ChangeTetrahedra(
  const std::vector<TetrahedronChange>& changes, const float* last)
{
  if (!this->HasPoints() || this->Points.ShouldRebuild())
  {
    this->InvalidateMapping();
    return {};
  }
  const BrickPoints::PreviousNodes nodes(changes);
  std::vector<unsigned char> near(this->Bricks.GetNumberOfBricks());
  const std::vector<BrickPoints::ChangesOfBrick> bricks =
    this->PointsOfBricks.FindBricks(nodes, [](std::size_t) { return true; });
  for (const BrickPoints::ChangesOfBrick& brick : bricks)
  {
    near[brick.first] = 1;
  }
  this->PointsOfBricks.AddPoints(bricks, changes);
  const std::vector<BrickPoints::ChangesOfBrick> subBricks = this->Points.FindBricks(
    nodes, [&](std::size_t number) { return near[this->Sections[number].first] != 0; });
  std::vector<Extent> boxes;
  for (const BrickPoints::ChangesOfBrick& subBrick : subBricks)
  {
    boxes.push_back(this->SubBricks.GetVertices(subBrick.first, 0));
    if (this->Tracking)
    {
      this->Move(subBrick.first, last); // the last box is that of the old nodes
    }
    this->Known[subBrick.first] = 0;
  }
  this->Points.AddPoints(subBricks, changes);
  this->PlanBoxesKnown = false;
  return boxes;
}

void ChangeTracker::AddMoved(const DisplacementBounds& after)
{
  if (this->AllBounds)
  {
    this->AllBounds->Add(after);
  }
}

template <typename Body>
void ChangeTracker::ForSubBricks(const Extent& box, bool ofCells, int halo, Body&& body) const
{
  const int more = ofCells ? 1 : 0;
  Extent subBricks; // first and last on each axis that may touch the box
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto find = [&](int vertex)
    {
      const int index = (vertex - this->SubBricks.Origin[axis]) / this->SubBricks.Cells[axis];
      return std::min(std::max(index, 0), this->SubBricks.Count[axis] - 1);
    };
    subBricks[2 * axis] = find(box[2 * axis] - halo - 1);
    subBricks[2 * axis + 1] = find(box[2 * axis + 1] + more + halo);
  }
  ForEachPoint(subBricks,
    [&](int x, int y, int z)
    {
      const std::size_t subBrick = this->SubBricks.GetNumber(x, y, z);
      const Extent region = this->SubBricks.GetVertices(subBrick, halo);
      bool touches = true;
      for (int axis = 0; axis < 3; ++axis)
      {
        touches &=
          box[2 * axis] <= region[2 * axis + 1] - more && box[2 * axis + 1] >= region[2 * axis];
      }
      if (touches)
      {
        body(subBrick);
      }
    });
}

void ChangeTracker::ChangeMask(const std::vector<Extent>& changes, bool ofCells)
{
  if (!this->Tracking)
  {
    return;
  }
  // A smooth cut also depends on the states of the vertices whose displacements it continues.
  const bool hasCuts = this->SubBricks.Halo != BrickGrid::LeastHalo;
  const int halo = MaskHalo + (hasCuts ? BrickGrid::HaloOfCuts : 0);
  for (const Extent& box : changes)
  {
    this->ForSubBricks(box, ofCells, halo,
      [&](std::size_t subBrick) { this->Masked[subBrick] |= this->HasCells(subBrick) ? 1 : 0; });
  }
  if (!changes.empty())
  {
    this->PlanBoxesKnown = false; // more sub-bricks have changed
  }
}

} // namespace deformvolume
