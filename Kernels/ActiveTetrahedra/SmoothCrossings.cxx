// SPDX-License-Identifier: BSD-3-Clause
#include "SmoothCrossings.h"

#include "BrickBlocks.h"
#include "FiveTetrahedra.h"
#include "TetrahedronSet.h"

#include <algorithm>
#include <bitset>
#include <limits>

namespace deformvolume
{
namespace
{

// Returns the edges that are crossed if some vertices are on the negative side.
unsigned int GetEdges(const std::array<bool, 4>& isNegative)
{
  unsigned int edges = 0;
  for (unsigned int k = 0; k < 6; ++k)
  {
    const int* ends = CrossingSet::Ends[k];
    edges |= (isNegative[static_cast<std::size_t>(ends[0])] !=
                   isNegative[static_cast<std::size_t>(ends[1])]
                 ? 1U
                 : 0U)
      << k;
  }
  return edges;
}

int CountTetrahedra(unsigned int bits)
{
  return static_cast<int>(std::bitset<5>(bits).count());
}

// Whether crossed edges separate the vertices of a tetrahedron into two sides.
bool IsDivision(unsigned int edges)
{
  bool found = false;
  for (unsigned int sides = 1; sides < 8; ++sides)
  {
    found = found ||
      edges == GetEdges({ { false, (sides & 1U) != 0, (sides & 2U) != 0, (sides & 4U) != 0 } });
  }
  return found;
}

void AppendBrick(DistanceSet& set, std::size_t brick)
{
  if (set.IsEmpty() || set.Bricks.back() != brick)
  {
    set.Bricks.push_back(brick);
    set.Blocks.emplace_back();
    set.Blocks.back().fill(FarFromSheets);
  }
}

} // namespace

SmoothCrossings::SmoothCrossings(const Extent& vertices)
  : Bricks(vertices)
  , VertexBricks(deformvolume::GetVertexBricks(vertices))
  , Cells({}, [](CrossedEdges& cell, const CrossedEdges& other) { cell.Join(other); })
  , VertexDistances(FarFromSheets,
      [](float& distance, const float& other)
      { distance = CombineSheetDistances(distance, other); })
  , Changed(this->Bricks.GetNumberOfBricks(), true)
  , ChangedVertices(this->VertexBricks.GetNumberOfBricks(), true)
{
}

void SmoothCrossings::Allocate()
{
  if (this->Crossed.empty())
  {
    this->Crossed.assign(this->Bricks.GetNumberOfCells(), 0);
    this->SwitchedOff.assign(this->Bricks.GetNumberOfCells(), 0);
    this->Distances.assign(this->VertexBricks.GetNumberOfCells(), 0.0F);
  }
}

std::size_t SmoothCrossings::GetVertex(const std::array<int, 3>& cell, int offset) const
{
  const std::array<int, 3>& size = this->VertexBricks.GetSize();
  return (static_cast<std::size_t>(cell[2] + (offset >> 1 & 1)) *
             static_cast<std::size_t>(size[1]) +
           static_cast<std::size_t>(cell[1] + (offset >> 2 & 1))) *
    static_cast<std::size_t>(size[0]) +
    static_cast<std::size_t>(cell[0] + (offset & 1));
}

void SmoothCrossings::SetBase(
  const unsigned char* crossed, const float* distances, const std::vector<const CrossingSet*>& sets)
{
  this->Base = CrossingSet();
  if (!crossed && sets.empty() && this->Crossed.empty())
  {
    return;
  }
  this->Allocate();
  // The count was relative to the old cut.
  std::fill(this->Crossed.begin(), this->Crossed.end(), static_cast<unsigned char>(0));
  this->NumberOfDivided = 0;
  std::vector<bool> isCorner(this->Distances.size());
  for (std::size_t brick = 0; crossed && brick < this->Bricks.GetNumberOfBricks(); ++brick)
  {
    CrossingSet::Block block{};
    bool isHit = false;
    ForEachCell(this->Bricks, brick,
      [&](const std::array<int, 3>& cell, std::size_t index, std::size_t number)
      {
        const unsigned int hit = crossed[number] & DEFORMVOLUME_ALL_TETRAHEDRA;
        const int mirror = this->Bricks.GetMirror(cell);
        for (unsigned int t = 0; hit != 0 && t < 5; ++t)
        {
          std::array<bool, 4> isNegative;
          for (std::size_t k = 0; k < 4; ++k)
          {
            const std::size_t vertex = this->GetVertex(cell, FiveTetrahedra[t][k] ^ mirror);
            isNegative[k] = distances[vertex] < 0.0F;
            isCorner[vertex] = isCorner[vertex] || (hit >> t & 1U) != 0;
          }
          block[index].Edges |= (hit >> t & 1U) != 0 ? GetEdges(isNegative) << 6 * t : 0U;
        }
        isHit = isHit || block[index].Edges != 0;
      });
    if (isHit)
    {
      this->Base.Bricks.push_back(brick);
      this->Base.Blocks.push_back(block);
    }
  }
  for (std::size_t brick = 0; crossed && brick < this->VertexBricks.GetNumberOfBricks(); ++brick)
  {
    ForEachCell(this->VertexBricks, brick,
      [&](const std::array<int, 3>&, std::size_t index, std::size_t vertex)
      {
        if (isCorner[vertex])
        {
          AppendBrick(this->Base.Distances, brick);
          // In the base, a distance of 0 counts as positive.
          const float distance = distances[vertex];
          this->Base.Distances.Blocks.back()[index] =
            distance < 0.0F || distance > 0.0F ? distance : std::numeric_limits<float>::min();
        }
      });
  }
  this->Cells.Clear();
  this->VertexDistances.Clear();
  const auto join = [this](const CrossingSet& set)
  {
    this->Cells.Add(set);
    this->VertexDistances.Add(set.Distances);
  };
  join(this->Base);
  std::for_each(sets.begin(), sets.end(), [&](const CrossingSet* set) { join(*set); });
  for (std::size_t brick = 0; brick < this->VertexBricks.GetNumberOfBricks(); ++brick)
  {
    this->UpdateDistances(brick);
  }
  for (std::size_t brick = 0; brick < this->Bricks.GetNumberOfBricks(); ++brick)
  {
    this->UpdateCells(brick);
  }
  this->Changed.assign(this->Changed.size(), true);
  this->ChangedVertices.assign(this->ChangedVertices.size(), true);
}

std::vector<std::size_t> SmoothCrossings::FindNeighbors(
  const std::vector<std::size_t>& bricks) const
{
  std::vector<std::size_t> found;
  for (const std::size_t brick : bricks)
  {
    const Extent cells = this->Bricks.GetCells(brick);
    Extent near; // the bricks on each axis
    for (int axis = 0; axis < 3; ++axis)
    {
      const int last = this->Bricks.GetSize()[axis] - 1;
      near[2 * axis] = std::max(cells[2 * axis] - 1, 0) / CellBricks::Length;
      near[2 * axis + 1] = std::min(cells[2 * axis + 1] + 1, last) / CellBricks::Length;
    }
    ForEachPoint(near,
      [&](int x, int y, int z)
      {
        constexpr int length = CellBricks::Length;
        found.push_back(this->Bricks.FindBrick({ { x * length, y * length, z * length } }));
      });
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::vector<std::size_t> SmoothCrossings::Add(const CrossingSet& edit)
{
  this->Cells.Add(edit);
  this->VertexDistances.Add(edit.Distances);
  return this->Update(edit);
}

std::vector<std::size_t> SmoothCrossings::Remove(
  const CrossingSet& edit, const std::vector<const CrossingSet*>& sets)
{
  this->Cells.Forget(edit.Bricks);
  this->VertexDistances.Forget(edit.Distances.Bricks);
  const auto rejoin = [&](const CrossingSet& set)
  {
    this->Cells.Rejoin(edit.Bricks, set);
    this->VertexDistances.Rejoin(edit.Distances.Bricks, set.Distances);
  };
  rejoin(this->Base);
  std::for_each(sets.begin(), sets.end(), [&](const CrossingSet* set) { rejoin(*set); });
  return this->Update(edit);
}

// Updates the distances of the vertices and the tetrahedra of the cells that an edit hits.
std::vector<std::size_t> SmoothCrossings::Update(const CrossingSet& edit)
{
  if (edit.IsEmpty())
  {
    return {};
  }
  this->Allocate();
  for (const std::size_t brick : edit.Distances.Bricks)
  {
    this->UpdateDistances(brick);
    this->ChangedVertices[brick] = true;
  }
  // Vertices on the faces of bricks belong to cells of several bricks.
  std::vector<std::size_t> bricks = this->FindNeighbors(edit.Bricks);
  for (const std::size_t brick : bricks)
  {
    this->UpdateCells(brick);
    this->Changed[brick] = true;
  }
  return bricks;
}

void SmoothCrossings::UpdateDistances(std::size_t brick)
{
  const DistanceSet::Block* const block = this->VertexDistances.Find(brick);
  ForEachCell(this->VertexBricks, brick,
    [&](const std::array<int, 3>&, std::size_t index, std::size_t vertex)
    {
      const float distance = block ? (*block)[index] : FarFromSheets;
      this->Distances[vertex] = distance == FarFromSheets ? 0.0F : distance;
    });
}

void SmoothCrossings::UpdateCells(std::size_t brick)
{
  const CrossingSet::Block* const block = this->Cells.Find(brick);
  const CrossingSet::Block* const base = FindBlock(this->Base, brick);
  ForEachCell(this->Bricks, brick,
    [&](const std::array<int, 3>& cell, std::size_t index, std::size_t number)
    {
      const CrossedEdges joined = block ? (*block)[index] : CrossedEdges();
      const int mirror = this->Bricks.GetMirror(cell);
      unsigned int crossed = 0;
      unsigned int off = 0;
      unsigned int before = 0; // bits of the tetrahedra that the cut before all edits divides
      for (unsigned int t = 0; joined.Edges != 0 && t < 5; ++t)
      {
        const unsigned int edges = joined.Edges >> 6 * t & 63U;
        if (edges == 0)
        {
          continue;
        }
        before |= (base && ((*base)[index].Edges >> 6 * t & 63U) != 0 ? 1U : 0U) << t;
        std::array<bool, 4> isNegative;
        bool isClear = true;
        for (std::size_t k = 0; k < 4; ++k)
        {
          const float distance =
            this->Distances[this->GetVertex(cell, FiveTetrahedra[t][k] ^ mirror)];
          isNegative[k] = distance < 0.0F;
          isClear = isClear && distance != 0.0F;
        }
        const bool isMultiple = (joined.MultiplyCrossed >> t & 1U) != 0;
        const bool isDivision = IsDivision(edges);
        const bool isDivided =
          !isMultiple && isDivision && isClear && GetEdges(isNegative) == edges;
        crossed |= (isDivided ? 1U : 0U) << t;
        off |= (!isDivided && (isMultiple || isDivision) ? 1U : 0U) << t;
      }
      this->NumberOfDivided +=
        CountTetrahedra(crossed & ~before) - CountTetrahedra(this->Crossed[number] & ~before);
      this->Crossed[number] = static_cast<unsigned char>(crossed);
      this->SwitchedOff[number] = static_cast<unsigned char>(off);
    });
}

std::vector<std::size_t> SmoothCrossings::TakeChangedBricks()
{
  return this->Crossed.empty() ? std::vector<std::size_t>() : TakeMarked(this->Changed);
}

std::vector<std::size_t> SmoothCrossings::TakeChangedVertexBricks()
{
  return this->Crossed.empty() ? std::vector<std::size_t>() : TakeMarked(this->ChangedVertices);
}

} // namespace deformvolume
