// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryFinder.h"

#include "IndexBounds.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace deformvolume
{

namespace
{

// Largest size of a piece on an axis, in cells. The edge functions have 64 bits, which is enough
// for pieces of up to 5,000 output voxels.
constexpr double LargestPiece = 128.0;
// Tetrahedra that are larger than this number of cells on an axis are bisected at their longest
// edge. If all edges were halved instead, a tetrahedron with one distant node would become
// (length / 128)^2 slivers within the volume.
constexpr double LargestDivided = 4096.0;

// Returns the extent of the cells between voxels.
Extent GetCells(const Extent& voxels)
{
  return { { voxels[0], voxels[1] - 1, voxels[2], voxels[3] - 1, voxels[4], voxels[5] - 1 } };
}

// Adds the cells that a triangle crosses within the whole volume, and possibly some neighbors.
// tolerance: how far the triangle must extend into a cell; 0: it is enough to touch the cell.
void AddCells(const Triangle& face, const Extent& whole, double tolerance, CellSet& cells)
{
  const glm::dvec3 normal = glm::cross(face[1] - face[0], face[2] - face[0]);
  int k = 0; // the axis along which the normal is longest
  for (int axis = 1; axis < 3; ++axis)
  {
    k = std::abs(normal[axis]) > std::abs(normal[k]) ? axis : k;
  }
  if (!(std::abs(normal[k]) > 0.0))
  {
    return;
  }
  const int u = (k + 1) % 3;
  const int v = (k + 2) % 3;
  IndexBounds box = GetBox(face);
  for (int axis = 0; axis < 3; ++axis)
  {
    box.Min[axis] = std::max(box.Min[axis], whole[2 * axis] + BorderTolerance);
    box.Max[axis] = std::min(box.Max[axis], whole[2 * axis + 1] - BorderTolerance);
    if (box.Min[axis] > box.Max[axis])
    {
      return;
    }
  }
  const Extent& all = cells.GetCells();
  const auto getFirst = [&](int axis, double low)
  { return std::max<double>(std::ceil(low + tolerance) - 1.0, all[2 * axis]); };
  const auto getLast = [&](int axis, double high)
  { return std::min<double>(std::floor(high - tolerance), all[2 * axis + 1]); };
  const double slopes[2] = { -normal[u] / normal[k], -normal[v] / normal[k] };
  const double sign = normal[k] > 0.0 ? 1.0 : -1.0;
  glm::dvec3 cell;
  // The lower or upper side of the cell, clamped to the box of the triangle.
  const auto side = [&](int axis, bool upper)
  { return std::clamp(cell[axis] + (upper ? 1.0 : 0.0), box.Min[axis], box.Max[axis]); };
  for (cell[v] = getFirst(v, box.Min[v]); cell[v] <= getLast(v, box.Max[v]); ++cell[v])
  {
    for (cell[u] = getFirst(u, box.Min[u]); cell[u] <= getLast(u, box.Max[u]); ++cell[u])
    {
      bool meets = true;
      for (int edge = 0; edge < 3 && meets; ++edge)
      {
        const glm::dvec3& from = face[static_cast<std::size_t>(edge)];
        const glm::dvec3& to = face[static_cast<std::size_t>((edge + 1) % 3)];
        const double inward[2] = { -sign * (to[v] - from[v]), sign * (to[u] - from[u]) };
        // The edge function at the corner of the cell that is farthest inside.
        const double farthest = inward[0] * (side(u, inward[0] > 0.0) - from[u]) +
          inward[1] * (side(v, inward[1] > 0.0) - from[v]);
        meets = farthest >= 0.0;
      }
      if (!meets)
      {
        continue;
      }
      const auto getHeight = [&](bool high)
      {
        return face[0][k] + slopes[0] * (side(u, (slopes[0] > 0.0) == high) - face[0][u]) +
          slopes[1] * (side(v, (slopes[1] > 0.0) == high) - face[0][v]);
      };
      const double low = std::max(getHeight(false), box.Min[k]);
      const double high = std::min(getHeight(true), box.Max[k]);
      const double last = low <= high ? getLast(k, high) : -std::numeric_limits<double>::infinity();
      for (cell[k] = getFirst(k, low); cell[k] <= last; ++cell[k])
      {
        cells.Add(static_cast<std::int64_t>(cell.x), static_cast<std::int64_t>(cell.y),
          static_cast<std::int64_t>(cell.z));
      }
    }
  }
}

// Adds a layer of neighbors to the cells of a part: a crossed cell there affects cells of the part.
Extent Widen(const Extent& cells, const Extent& whole)
{
  Extent wide;
  for (int axis = 0; axis < 3; ++axis)
  {
    wide[2 * axis] = std::max(cells[2 * axis] - 1, whole[2 * axis]);
    wide[2 * axis + 1] = std::min(cells[2 * axis + 1] + 1, whole[2 * axis + 1]);
  }
  return wide;
}

// Bisects a tetrahedron at the midpoint of its longest edge.
std::array<MeshBoundary::Piece, 2> Halve(const MeshBoundary::Piece& whole)
{
  std::size_t first = 0;
  std::size_t second = 1;
  for (std::size_t a = 0; a < 4; ++a)
  {
    for (std::size_t b = a + 1; b < 4; ++b)
    {
      if (glm::distance(whole.Rest[a], whole.Rest[b]) >
        glm::distance(whole.Rest[first], whole.Rest[second]))
      {
        first = a;
        second = b;
      }
    }
  }
  std::array<MeshBoundary::Piece, 2> halves{ { whole, whole } };
  const glm::dvec3 middle = 0.5 * (whole.Rest[first] + whole.Rest[second]);
  halves[0].Rest[second] = halves[1].Rest[first] = middle;
  for (std::size_t k = 0; k < 4; ++k)
  {
    halves[0].Weights[second][k] = halves[1].Weights[first][k] =
      0.5F * (whole.Weights[first][k] + whole.Weights[second][k]);
  }
  return halves;
}

// Divides a tetrahedron into eight, at the midpoints of its edges.
std::array<MeshBoundary::Piece, 8> Divide(const MeshBoundary::Piece& whole)
{
  // Each corner of a part is the midpoint of two corners of the whole. The inner octahedron is
  // split along the diagonal from the midpoint of edge 0-2 to that of edge 1-3.
  static constexpr int parts[8][4][2] = { { { 0, 0 }, { 0, 1 }, { 0, 2 }, { 0, 3 } },
    { { 0, 1 }, { 1, 1 }, { 1, 2 }, { 1, 3 } }, { { 0, 2 }, { 1, 2 }, { 2, 2 }, { 2, 3 } },
    { { 0, 3 }, { 1, 3 }, { 2, 3 }, { 3, 3 } }, { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 3 } },
    { { 0, 1 }, { 0, 2 }, { 1, 3 }, { 1, 2 } }, { { 0, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } },
    { { 0, 2 }, { 1, 2 }, { 2, 3 }, { 1, 3 } } };
  std::array<MeshBoundary::Piece, 8> divided;
  for (std::size_t part = 0; part < 8; ++part)
  {
    MeshBoundary::Piece& piece = divided[part];
    piece.Tetrahedron = whole.Tetrahedron;
    for (std::size_t corner = 0; corner < 4; ++corner)
    {
      const auto a = static_cast<std::size_t>(parts[part][corner][0]);
      const auto b = static_cast<std::size_t>(parts[part][corner][1]);
      piece.Rest[corner] = 0.5 * (whole.Rest[a] + whole.Rest[b]);
      for (std::size_t k = 0; k < 4; ++k)
      {
        piece.Weights[corner][k] = 0.5F * (whole.Weights[a][k] + whole.Weights[b][k]);
      }
    }
  }
  return divided;
}

} // namespace

BoundaryFinder::BoundaryFinder(const Extent& part, const Extent& whole)
  : Whole(whole)
  , Cells(GetCells(part))
  , Crossed(Widen(this->Cells, GetCells(whole)))
  , Near(this->Cells)
{
}

bool BoundaryFinder::Cross(const std::vector<Triangle>& faces, double tolerance)
{
  ParallelForItems(faces.size(), 256,
    [&](std::size_t i) { AddCells(faces[i], this->Whole, tolerance, this->Crossed); });
  const Extent& c = this->Cells;
  this->Crossed.ForEach(
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    {
      for (std::int64_t k = std::max<std::int64_t>(z - 1, c[4]);
           k <= std::min<std::int64_t>(z + 1, c[5]); ++k)
      {
        for (std::int64_t j = std::max<std::int64_t>(y - 1, c[2]);
             j <= std::min<std::int64_t>(y + 1, c[3]); ++j)
        {
          for (std::int64_t i = std::max<std::int64_t>(x - 1, c[0]);
               i <= std::min<std::int64_t>(x + 1, c[1]); ++i)
          {
            this->Near.Add(i, j, k);
          }
        }
      }
    });
  return !this->Near.IsEmpty();
}

void BoundaryFinder::Add(
  const MeshBoundary::Piece& piece, std::vector<MeshBoundary::Piece>& pieces) const
{
  const std::array<glm::dvec3, 4>& rest = piece.Rest;
  VoxelBox box;
  double size = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto ends = std::minmax({ rest[0][axis], rest[1][axis], rest[2][axis], rest[3][axis] });
    const double low = std::floor(ends.first - BoundaryTolerance);
    const double high = std::floor(ends.second + BoundaryTolerance);
    if (!(low <= this->Cells[2 * axis + 1] && high >= this->Cells[2 * axis]))
    {
      return;
    }
    box.Min[axis] = std::max<std::int64_t>(
      static_cast<std::int64_t>(std::max(low, -4.0e9)), this->Cells[2 * axis]);
    box.Max[axis] = std::min<std::int64_t>(
      static_cast<std::int64_t>(std::min(high, 4.0e9)), this->Cells[2 * axis + 1]);
    size = std::max(size, ends.second - ends.first);
  }
  if (!this->Near.HasAny(box))
  {
    return;
  }
  const auto addAll = [&](const auto& parts)
  {
    for (const MeshBoundary::Piece& part : parts)
    {
      this->Add(part, pieces);
    }
  };
  if (size > LargestPiece)
  {
    size > LargestDivided ? addAll(Halve(piece)) : addAll(Divide(piece));
    return;
  }
  pieces.push_back(piece);
  if (glm::dot(rest[1] - rest[0], glm::cross(rest[2] - rest[0], rest[3] - rest[0])) < 0.0)
  {
    std::swap(pieces.back().Rest[2], pieces.back().Rest[3]);
    std::swap(pieces.back().Weights[2], pieces.back().Weights[3]);
  }
}

void BoundaryFinder::ListCells(MeshBoundary& boundary) const
{
  const Extent& c = this->Cells;
  const auto list = [&](const CellSet& cells, std::vector<std::int64_t>& numbers)
  {
    cells.ForEach(
      [&](std::int64_t x, std::int64_t y, std::int64_t z)
      {
        if (x >= c[0] && x <= c[1] && y >= c[2] && y <= c[3] && z >= c[4] && z <= c[5])
        {
          numbers.push_back(((z - c[4]) * GetSize(c, 1) + y - c[2]) * GetSize(c, 0) + x - c[0]);
        }
      });
  };
  list(this->Crossed, boundary.Crossed);
  list(this->Near, boundary.Near);
}

} // namespace deformvolume
