// SPDX-License-Identifier: BSD-3-Clause
#include "SheetCut.h"

#include "BoxTree.h"
#include "BrickEdit.h"
#include "Error.h"
#include "TriangleCrossing.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace deformvolume
{
namespace
{

// Where a vertex is as seen from a triangle: bits of places where it does not reach. What has one
// of them in common for all vertices is not crossed.
enum Places : unsigned char
{
  Above = 1,
  Below = 2,
  First = 4 // of three pairs: too low and too high on each axis
};

// The triangles of a sheet that are near a volume.
class SheetTriangles
{
public:
  SheetTriangles(const VertexPositions& positions, const Sheet& sheet)
    : Triangles(sheet.Divide(positions.GetBox()))
    , Tree(GetBoxes(this->Triangles))
  {
    this->Crossings.reserve(this->Triangles.size());
    for (const SnappedTriangle& triangle : this->Triangles)
    {
      this->Crossings.emplace_back(triangle);
    }
  }

  // The triangles whose boxes overlap another one.
  void Find(const SnappedBox& box, std::vector<std::size_t>& numbers) const
  {
    this->Tree.Find(box, numbers);
  }
  bool MayReach(std::size_t triangle, const SnappedBox& box) const
  {
    return this->Crossings[triangle].MayReach(box);
  }
  void Hit(std::size_t triangle, BrickEdit& edit) const;

private:
  static std::vector<SnappedBox> GetBoxes(const std::vector<SnappedTriangle>& triangles)
  {
    std::vector<SnappedBox> boxes(triangles.size());
    std::transform(triangles.begin(), triangles.end(), boxes.begin(),
      [](const SnappedTriangle& triangle) { return GetBox(triangle); });
    return boxes;
  }

  unsigned char GetPlaces(
    const TriangleCrossing& crossing, const SnappedBox& box, const SnappedPoint& p) const;

  std::vector<SnappedTriangle> Triangles;
  std::vector<TriangleCrossing> Crossings;
  BoxTree Tree;
};

// A vertex at the upper end of the box is moved out of it.
unsigned char SheetTriangles::GetPlaces(
  const TriangleCrossing& crossing, const SnappedBox& box, const SnappedPoint& p) const
{
  unsigned int places = crossing.IsAbove(p) ? Above : Below;
  for (int axis = 0; axis < 3; ++axis)
  {
    const unsigned int low = p[axis] < box.Min[axis] ? 1U : 0U;
    const unsigned int high = p[axis] >= box.Max[axis] ? 2U : 0U;
    places |= (low | high) * (static_cast<unsigned int>(First) << 2U * static_cast<unsigned>(axis));
  }
  return static_cast<unsigned char>(places);
}

void SheetTriangles::Hit(std::size_t triangle, BrickEdit& edit) const
{
  const TriangleCrossing& crossing = this->Crossings[triangle];
  const SnappedBox& box = this->Tree.GetBox(triangle);
  std::array<unsigned char, BrickEdit::MaxVertices> places;
  unsigned int common = 255;
  for (std::size_t i = 0; i < edit.GetNumberOfVertices(); ++i)
  {
    places[i] = this->GetPlaces(crossing, box, edit.GetPosition(i));
    common &= places[i];
  }
  if (common != 0)
  {
    return;
  }
  const std::size_t up = edit.GetSteps()[1];
  const std::size_t over = edit.GetSteps()[2];
  edit.ForEachCell(
    [&](int x, int y, int z, std::size_t place)
    {
      const unsigned char* first = places.data() + edit.GetVertex(x, y, z);
      if ((first[0] & first[1] & first[up] & first[up + 1] & first[over] & first[over + 1] &
            first[over + up] & first[over + up + 1]) != 0)
      {
        return;
      }
      const BrickEdit::CellTetrahedra tetrahedra = edit.GetTetrahedra(x, y, z);
      for (int t = 0; t < 5; ++t)
      {
        const std::array<std::size_t, 4>& v = tetrahedra[static_cast<std::size_t>(t)];
        if ((edit.GetHits(place) >> t & 1) != 0 ||
          (places[v[0]] & places[v[1]] & places[v[2]] & places[v[3]]) != 0 || !edit.IsPlaced(v))
        {
          continue;
        }
        TriangleCrossing::Tetrahedron vertices;
        std::array<bool, 4> isAbove;
        for (std::size_t k = 0; k < 4; ++k)
        {
          vertices[k] = edit.GetPosition(v[k]);
          isAbove[k] = (places[v[k]] & Above) != 0;
        }
        if (crossing.Crosses(vertices, isAbove))
        {
          edit.Hit(place, t);
        }
      }
    });
}

} // namespace

TetrahedronSet FindCrossedTetrahedra(const VertexPositions& positions, const Sheet& sheet)
{
  const SheetTriangles triangles(positions, sheet);
  return BrickEdit::ForEachBrick(positions.GetBricks().GetNumberOfBricks(),
    [&](std::size_t brick, BrickEdit& edit)
    {
      const SnappedBox box = positions.GetBox(brick);
      std::vector<std::size_t> near;
      triangles.Find(box, near);
      if (near.empty())
      {
        return;
      }
      if (box.GetLength() > TriangleCrossing::LargestBox)
      {
        throw Error("The deformation draws a part of 8 cells of the volume that the sheet may "
                    "cross out to more than 2,048 voxels. Cut before it is deformed so far.");
      }
      near.erase(std::remove_if(near.begin(), near.end(),
                   [&](std::size_t triangle) { return !triangles.MayReach(triangle, box); }),
        near.end());
      if (near.empty())
      {
        return;
      }
      edit.Set(positions, brick);
      for (const std::size_t triangle : near)
      {
        triangles.Hit(triangle, edit);
      }
    });
}

} // namespace deformvolume
