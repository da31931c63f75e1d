// SPDX-License-Identifier: BSD-3-Clause
#include "CuttingReference.h"

#include <algorithm>
#include <map>
#include <numeric>

using namespace deformvolume;

namespace reference
{
namespace
{

__extension__ typedef __int128 Wide;
using Direction = std::array<Wide, 3>;

Direction Subtract(const SnappedPoint& a, const SnappedPoint& b)
{
  return { { Wide(a.x) - b.x, Wide(a.y) - b.y, Wide(a.z) - b.z } };
}

Direction Cross(const Direction& u, const Direction& v)
{
  return { { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] } };
}

Wide Project(const Direction& direction, const SnappedPoint& point)
{
  return direction[0] * point.x + direction[1] * point.y + direction[2] * point.z;
}

// The sign of the movement by (e, e^2, e^3) along a direction.
int GetMovement(const Direction& direction)
{
  for (const Wide& component : direction)
  {
    if (component != 0)
    {
      return component > 0 ? 1 : -1;
    }
  }
  return 0;
}

// Whether the whole tetrahedron, moved by (e, e^2, e^3), lies before or behind the whole triangle.
bool AreApart(const Direction& direction, const SnappedTriangle& triangle,
  const std::array<SnappedPoint, 4>& tetrahedron)
{
  const int movement = GetMovement(direction);
  if (movement == 0)
  {
    return false;
  }
  bool isBehind = true;
  bool isBefore = true;
  for (const SnappedPoint& a : triangle)
  {
    for (const SnappedPoint& p : tetrahedron)
    {
      const Wide difference = Project(direction, p) - Project(direction, a);
      isBehind = isBehind && (difference > 0 || (difference == 0 && movement > 0));
      isBefore = isBefore && (difference < 0 || (difference == 0 && movement < 0));
    }
  }
  return isBehind || isBefore;
}

bool Meet(const SnappedTriangle& triangle, const std::array<SnappedPoint, 4>& tetrahedron)
{
  std::vector<Direction> edges;
  for (int k = 0; k < 3; ++k)
  {
    edges.push_back(Subtract(triangle[(k + 1) % 3], triangle[k]));
  }
  std::vector<Direction> others;
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < i; ++j)
    {
      others.push_back(Subtract(tetrahedron[i], tetrahedron[j]));
    }
  }
  const Direction normal = Cross(edges[0], edges[1]);
  if (GetMovement(normal) == 0)
  {
    return false; // no area
  }
  std::vector<Direction> directions{ normal };
  for (const Direction& a : others)
  {
    for (const Direction& b : edges)
    {
      directions.push_back(Cross(a, b));
    }
    for (const Direction& b : others)
    {
      directions.push_back(Cross(a, b));
    }
  }
  return std::none_of(directions.begin(), directions.end(),
    [&](const Direction& direction) { return AreApart(direction, triangle, tetrahedron); });
}

template <typename Function>
void ForEachTetrahedron(const Extent& vertices, Function&& function)
{
  std::size_t cell = 0;
  for (int z = vertices[4]; z < vertices[5]; ++z)
  {
    for (int y = vertices[2]; y < vertices[3]; ++y)
    {
      for (int x = vertices[0]; x < vertices[1]; ++x, ++cell)
      {
        for (int t = 0; t < 5; ++t)
        {
          function(cell, t, GetTetrahedron({ { x, y, z } }, t));
        }
      }
    }
  }
}

} // namespace

std::array<Place, 4> GetTetrahedron(const Place& cell, int t)
{
  // Vertices 1 to 8 of a cell with even indices, and the tetrahedra by these numbers.
  static const Place offsets[9] = { { { 0, 0, 0 } }, { { 0, 0, 0 } }, { { 1, 0, 0 } },
    { { 0, 0, 1 } }, { { 1, 0, 1 } }, { { 0, 1, 0 } }, { { 1, 1, 0 } }, { { 0, 1, 1 } },
    { { 1, 1, 1 } } };
  static const int tetrahedra[5][4] = { { 1, 3, 4, 7 }, { 7, 8, 4, 6 }, { 4, 2, 1, 6 },
    { 1, 5, 7, 6 }, { 7, 4, 6, 1 } };
  // Exchanges of vertex numbers on the axes where the index of the cell is odd.
  static const int exchanges[3][4][2] = { { { 1, 2 }, { 3, 4 }, { 5, 6 }, { 7, 8 } },
    { { 1, 5 }, { 2, 6 }, { 3, 7 }, { 4, 8 } }, { { 1, 3 }, { 2, 4 }, { 5, 7 }, { 6, 8 } } };
  std::array<Place, 4> places;
  for (int k = 0; k < 4; ++k)
  {
    int number = tetrahedra[t][k];
    for (int axis = 0; axis < 3; ++axis)
    {
      if (cell[axis] % 2 == 0)
      {
        continue;
      }
      for (const auto& pair : exchanges[axis])
      {
        if (number == pair[0] || number == pair[1])
        {
          number = pair[0] + pair[1] - number;
          break;
        }
      }
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      places[k][axis] = cell[axis] + offsets[number][axis];
    }
  }
  return places;
}

FreePositions::FreePositions(const Extent& vertices)
  : VertexPositions(vertices)
{
  for (int z = vertices[4]; z <= vertices[5]; ++z)
  {
    for (int y = vertices[2]; y <= vertices[3]; ++y)
    {
      for (int x = vertices[0]; x <= vertices[1]; ++x)
      {
        this->Points.emplace_back(256 * x, 256 * y, 256 * z);
      }
    }
  }
  this->Has.resize(this->Points.size(), true);
}

void FreePositions::Shake(std::mt19937& random, int steps, int unit)
{
  std::uniform_int_distribution<int> move(-steps / unit, steps / unit);
  for (SnappedPoint& point : this->Points)
  {
    point += SnappedPoint(unit * move(random), unit * move(random), unit * move(random));
  }
}

std::size_t FreePositions::GetNumber(const Place& vertex) const
{
  const Extent& all = this->GetBricks().GetVertices();
  return static_cast<std::size_t>(
    ((vertex[2] - all[4]) * GetSize(all, 1) + vertex[1] - all[2]) * GetSize(all, 0) + vertex[0] -
    all[0]);
}

SnappedBox FreePositions::GetBox(std::size_t brick) const
{
  const Extent vertices = this->GetBricks().GetVertices(brick);
  SnappedBox box;
  for (int z = vertices[4]; z <= vertices[5]; ++z)
  {
    for (int y = vertices[2]; y <= vertices[3]; ++y)
    {
      for (int x = vertices[0]; x <= vertices[1]; ++x)
      {
        const std::size_t number = this->GetNumber({ { x, y, z } });
        if (this->Has[number])
        {
          box.Add(this->Points[number]);
        }
      }
    }
  }
  return box;
}

SnappedBox FreePositions::GetBox() const
{
  SnappedBox box;
  for (std::size_t i = 0; i < this->Points.size(); ++i)
  {
    if (this->Has[i])
    {
      box.Add(this->Points[i]);
    }
  }
  return box;
}

void FreePositions::Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const
{
  for (int z = vertices[4]; z <= vertices[5]; ++z)
  {
    for (int y = vertices[2]; y <= vertices[3]; ++y)
    {
      for (int x = vertices[0]; x <= vertices[1]; ++x)
      {
        const std::size_t number = this->GetNumber({ { x, y, z } });
        *positions++ = this->Points[number];
        *hasPosition++ = this->Has[number];
      }
    }
  }
}

Mask Cut(const FreePositions& positions, const std::vector<SnappedTriangle>& triangles)
{
  Mask mask(positions.GetBricks().GetNumberOfCells());
  ForEachTetrahedron(positions.GetBricks().GetVertices(),
    [&](std::size_t cell, int t, const std::array<Place, 4>& places)
    {
      std::array<SnappedPoint, 4> tetrahedron;
      for (int k = 0; k < 4; ++k)
      {
        const std::size_t number = positions.GetNumber(places[k]);
        if (!positions.Has[number])
        {
          return;
        }
        tetrahedron[k] = positions.Points[number];
      }
      if (std::any_of(triangles.begin(), triangles.end(),
            [&](const SnappedTriangle& triangle) { return Meet(triangle, tetrahedron); }))
      {
        mask[cell] |= static_cast<unsigned char>(1U << t);
      }
    });
  return mask;
}

bool Holds(const std::array<SnappedPoint, 4>& tetrahedron, const SnappedPoint& point)
{
  for (int k = 0; k < 4; ++k)
  {
    const SnappedPoint& a = tetrahedron[(k + 1) % 4];
    const Direction normal =
      Cross(Subtract(tetrahedron[(k + 2) % 4], a), Subtract(tetrahedron[(k + 3) % 4], a));
    const Wide opposite = Project(normal, tetrahedron[k]) - Project(normal, a);
    if (opposite == 0)
    {
      return false; // no volume
    }
    const Wide height = Project(normal, point) - 4 * Project(normal, a);
    const int side = height != 0 ? (height > 0 ? 1 : -1) : GetMovement(normal);
    if (side != (opposite > 0 ? 1 : -1))
    {
      return false;
    }
  }
  return true;
}

Mask GetMask(const CellBricks& bricks, const TetrahedronSet& set)
{
  Mask mask(bricks.GetNumberOfCells());
  for (std::size_t i = 0; i < set.Bricks.size(); ++i)
  {
    const Extent cells = bricks.GetCells(set.Bricks[i]);
    const auto& size = bricks.GetSize();
    for (int place = 0; place < 512; ++place)
    {
      const int x = cells[0] + place % 8;
      const int y = cells[2] + place / 8 % 8;
      const int z = cells[4] + place / 64;
      if (x <= cells[1] && y <= cells[3] && z <= cells[5])
      {
        mask[static_cast<std::size_t>((z * size[1] + y) * size[0] + x)] =
          set.Blocks[i][static_cast<std::size_t>(place)];
      }
    }
  }
  return mask;
}

int Count(const Mask& mask)
{
  return std::accumulate(mask.begin(), mask.end(), 0,
    [](int sum, unsigned char byte)
    {
      for (; byte != 0; byte = static_cast<unsigned char>(byte & (byte - 1)))
      {
        ++sum;
      }
      return sum;
    });
}

std::vector<int> FindPieces(const Extent& vertices, const Mask& switchedOff, int& numberOfPieces)
{
  std::map<std::array<Place, 3>, std::vector<std::size_t>> faces;
  std::vector<int> pieces(5 * switchedOff.size(), -1);
  std::vector<std::size_t> left;
  ForEachTetrahedron(vertices,
    [&](std::size_t cell, int t, const std::array<Place, 4>& places)
    {
      if ((switchedOff[cell] >> t & 1) != 0)
      {
        return;
      }
      const std::size_t number = 5 * cell + static_cast<std::size_t>(t);
      left.push_back(number);
      for (int k = 0; k < 4; ++k)
      {
        std::array<Place, 3> face{ { places[(k + 1) % 4], places[(k + 2) % 4],
          places[(k + 3) % 4] } };
        std::sort(face.begin(), face.end());
        faces[face].push_back(number);
      }
    });
  std::vector<std::vector<std::size_t>> neighbors(pieces.size());
  for (const auto& [face, sides] : faces)
  {
    if (sides.size() == 2)
    {
      neighbors[sides[0]].push_back(sides[1]);
      neighbors[sides[1]].push_back(sides[0]);
    }
  }
  numberOfPieces = 0;
  for (const std::size_t first : left)
  {
    if (pieces[first] >= 0)
    {
      continue;
    }
    std::vector<std::size_t> rest{ first };
    pieces[first] = numberOfPieces;
    while (!rest.empty())
    {
      const std::size_t next = rest.back();
      rest.pop_back();
      for (const std::size_t neighbor : neighbors[next])
      {
        if (pieces[neighbor] < 0)
        {
          pieces[neighbor] = numberOfPieces;
          rest.push_back(neighbor);
        }
      }
    }
    ++numberOfPieces;
  }
  return pieces;
}

} // namespace reference
