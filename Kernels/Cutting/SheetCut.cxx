// SPDX-License-Identifier: BSD-3-Clause
#include "SheetCut.h"

#include "BoxTree.h"
#include "BrickEdit.h"
#include "DistanceGatherer.h"
#include "Error.h"
#include "TriangleCrossing.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace deformvolume
{
namespace
{

// The position of a vertex relative to a triangle, as bits. If all vertices of a tetrahedron have a
// bit in common, the triangle does not cross the tetrahedron.
enum Outcodes : unsigned char
{
  Above = 1,
  Below = 2,
  First = 4 // first of three pairs of bits: below and above the box of the triangle on each axis
};

// The triangles of a sheet near a volume.
class SheetTriangles
{
public:
  SheetTriangles(const VertexPositions& positions, const Sheet& sheet)
    : Triangles(sheet.Divide(positions.GetBox()))
    , Tree(this->Triangles, [](const SnappedTriangle& triangle) { return GetBox(triangle); })
  {
    this->Crossings.reserve(this->Triangles.size());
    for (const SnappedTriangle& triangle : this->Triangles)
    {
      this->Crossings.emplace_back(triangle);
    }
  }

  // Finds the triangles whose boxes overlap a box.
  void Find(const SnappedBox& box, std::vector<std::size_t>& numbers) const
  {
    this->Tree.Find(box, numbers);
  }
  bool MayIntersect(std::size_t triangle, const SnappedBox& box) const
  {
    return this->Crossings[triangle].MayIntersect(box);
  }
  // Calls function(index, t, vertices, isAbove) for the tetrahedra of a brick that a triangle may
  // cross: tetrahedron t of the cell with this index, its four vertices, and whether each of these
  // is above the plane of the triangle.
  template <typename Function>
  void ForEachNear(std::size_t triangle, const BrickEdit& edit, Function&& function) const;
  const TriangleCrossing& GetCrossing(std::size_t triangle) const
  {
    return this->Crossings[triangle];
  }

private:
  unsigned char GetOutcode(
    const TriangleCrossing& crossing, const SnappedBox& box, const SnappedPoint& p) const;

  std::vector<SnappedTriangle> Triangles;
  std::vector<TriangleCrossing> Crossings;
  BoxTree<SnappedBox> Tree;
};

// A vertex at the upper end of the box counts as outside, because vertices are shifted symbolically
// (TriangleCrossing).
unsigned char SheetTriangles::GetOutcode(
  const TriangleCrossing& crossing, const SnappedBox& box, const SnappedPoint& p) const
{
  unsigned int outcodes = crossing.IsAbove(p) ? Above : Below;
  for (int axis = 0; axis < 3; ++axis)
  {
    const unsigned int low = p[axis] < box.Min[axis] ? 1U : 0U;
    const unsigned int high = p[axis] >= box.Max[axis] ? 2U : 0U;
    outcodes |=
      (low | high) * (static_cast<unsigned int>(First) << 2U * static_cast<unsigned>(axis));
  }
  return static_cast<unsigned char>(outcodes);
}

template <typename Function>
void SheetTriangles::ForEachNear(
  std::size_t triangle, const BrickEdit& edit, Function&& function) const
{
  const TriangleCrossing& crossing = this->Crossings[triangle];
  const SnappedBox& box = this->Tree.GetBox(triangle);
  std::array<unsigned char, BrickEdit::MaxVertices> outcodes;
  unsigned int common = 255;
  for (std::size_t i = 0; i < edit.GetNumberOfVertices(); ++i)
  {
    outcodes[i] = this->GetOutcode(crossing, box, edit.GetPosition(i));
    common &= outcodes[i];
  }
  if (common != 0)
  {
    return;
  }
  const std::size_t up = edit.GetSteps()[1];
  const std::size_t over = edit.GetSteps()[2];
  edit.ForEachCell(
    [&](int x, int y, int z, std::size_t index)
    {
      const unsigned char* first = outcodes.data() + edit.GetVertex(x, y, z);
      if ((first[0] & first[1] & first[up] & first[up + 1] & first[over] & first[over + 1] &
            first[over + up] & first[over + up + 1]) != 0)
      {
        return;
      }
      const BrickEdit::CellTetrahedra tetrahedra = edit.GetTetrahedra(x, y, z);
      for (int t = 0; t < 5; ++t)
      {
        const std::array<std::size_t, 4>& v = tetrahedra[static_cast<std::size_t>(t)];
        if ((outcodes[v[0]] & outcodes[v[1]] & outcodes[v[2]] & outcodes[v[3]]) == 0 &&
          edit.HasPosition(v))
        {
          function(index, t, v,
            std::array<bool, 4>{ { (outcodes[v[0]] & Above) != 0, (outcodes[v[1]] & Above) != 0,
              (outcodes[v[2]] & Above) != 0, (outcodes[v[3]] & Above) != 0 } });
        }
      }
    });
}

// Sets up a brick, and returns the triangles that may cross it.
std::vector<std::size_t> FindNear(const SheetTriangles& triangles, const VertexPositions& positions,
  std::size_t brick, BrickEdit& edit)
{
  const SnappedBox box = positions.GetBox(brick);
  std::vector<std::size_t> near;
  triangles.Find(box, near);
  if (near.empty())
  {
    return near;
  }
  if (box.GetLength() > TriangleCrossing::LargestBox)
  {
    throw Error(
      "The deformation stretches a brick of 8 x 8 x 8 cells, which the sheet may cross, to "
      "more than 2,048 voxels. Cut the volume before it is deformed so far.");
  }
  near.erase(std::remove_if(near.begin(), near.end(),
               [&](std::size_t triangle) { return !triangles.MayIntersect(triangle, box); }),
    near.end());
  if (!near.empty())
  {
    edit.Set(positions, brick);
  }
  return near;
}

using Vertices = std::array<std::size_t, 4>;

void HitCrossedTetrahedra(const SheetTriangles& triangles, std::size_t triangle, BrickEdit& edit)
{
  triangles.ForEachNear(triangle, edit,
    [&](std::size_t index, int t, const Vertices& v, const std::array<bool, 4>& isAbove)
    {
      if ((edit.GetHits(index) >> t & 1) == 0 &&
        triangles.GetCrossing(triangle).Crosses(
          { { edit.GetPosition(v[0]), edit.GetPosition(v[1]), edit.GetPosition(v[2]),
            edit.GetPosition(v[3]) } },
          isAbove))
      {
        edit.Hit(index, t);
      }
    });
}

// The crossings of a brick.
struct BrickCrossings
{
  std::size_t Brick = 0;
  CrossingSet::Block Cells{};
  std::array<float, BrickEdit::MaxVertices> Distances; // as in CrossingSet
  Extent Vertices;                                     // in structured indices
};

// The least absolute distance, in voxels, of the end of a crossed edge. No distance is 0: a vertex
// in the plane of a triangle is on one side of it, because vertices are shifted symbolically.
constexpr double LeastDistance = 1e-6;

void AddCrossedEdges(
  const SheetTriangles& triangles, std::size_t triangle, BrickEdit& edit, BrickCrossings& crossings)
{
  const TriangleCrossing& crossing = triangles.GetCrossing(triangle);
  const auto join = [&](std::size_t vertex, bool isAbove)
  {
    const auto far =
      static_cast<float>(std::max(crossing.GetDistance(edit.GetPosition(vertex)), LeastDistance));
    crossings.Distances[vertex] =
      CombineSheetDistances(crossings.Distances[vertex], isAbove ? far : -far);
  };
  triangles.ForEachNear(triangle, edit,
    [&](std::size_t index, int t, const Vertices& v, const std::array<bool, 4>& isAbove)
    {
      CrossedEdges crossed;
      for (unsigned int k = 0; k < 6; ++k)
      {
        const auto a = static_cast<std::size_t>(CrossingSet::Ends[k][0]);
        const auto b = static_cast<std::size_t>(CrossingSet::Ends[k][1]);
        if (isAbove[a] != isAbove[b] &&
          crossing.CrossesEdge(edit.GetPosition(v[a]), edit.GetPosition(v[b])))
        {
          crossed.Edges |= 1U << (6U * static_cast<unsigned int>(t) + k);
          join(v[a], isAbove[a]);
          join(v[b], isAbove[b]);
        }
      }
      if (crossed.Edges != 0)
      {
        crossings.Cells[index].Join(crossed);
        edit.Hit(index, t);
      }
    });
}

} // namespace

TetrahedronSet FindCrossedTetrahedra(
  const VertexPositions& positions, const Sheet& sheet, const EditProgress& progress)
{
  const SheetTriangles triangles(positions, sheet);
  return BrickEdit::ForEachBrick(
    positions.GetBricks().GetNumberOfBricks(),
    [&](std::size_t brick, BrickEdit& edit)
    {
      for (const std::size_t triangle : FindNear(triangles, positions, brick, edit))
      {
        HitCrossedTetrahedra(triangles, triangle, edit);
      }
    },
    progress);
}

CrossingSet FindSheetCrossings(
  const VertexPositions& positions, const Sheet& sheet, const EditProgress& progress)
{
  const SheetTriangles triangles(positions, sheet.Orient());
  std::mutex mutex;
  std::vector<std::unique_ptr<BrickCrossings>> parts;
  BrickEdit::ForEachBrick(
    positions.GetBricks().GetNumberOfBricks(),
    [&](std::size_t brick, BrickEdit& edit)
    {
      const std::vector<std::size_t> near = FindNear(triangles, positions, brick, edit);
      if (near.empty())
      {
        return;
      }
      auto part = std::make_unique<BrickCrossings>();
      part->Brick = brick;
      part->Vertices = edit.GetVertices();
      part->Distances.fill(FarFromSheets);
      for (const std::size_t triangle : near)
      {
        AddCrossedEdges(triangles, triangle, edit, *part);
      }
      if (edit.IsHit())
      {
        const std::lock_guard<std::mutex> lock(mutex);
        parts.push_back(std::move(part));
      }
    },
    progress);
  std::sort(
    parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a->Brick < b->Brick; });
  CrossingSet set;
  DistanceGatherer gatherer(
    positions.GetBricks().GetVertices(), FarFromSheets, CombineSheetDistances);
  for (const auto& part : parts)
  {
    set.Bricks.push_back(part->Brick);
    set.Blocks.push_back(part->Cells);
    gatherer.Add(part->Vertices, part->Distances.data());
  }
  set.Distances = gatherer.Take();
  return set;
}

} // namespace deformvolume
