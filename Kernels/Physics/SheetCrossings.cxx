// SPDX-License-Identifier: BSD-3-Clause
#include "SheetCrossings.h"

#include "Error.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string>

namespace deformvolume
{
namespace
{

// The box of the mesh, in steps.
SnappedBox GetMeshBox()
{
  SnappedBox box;
  box.Add(SnappedPoint(0));
  box.Add(SnappedPoint(MeshSteps::Length));
  return box;
}

// In lengths of the mesh. The limit of Sheet is slightly larger: 2^20.
constexpr double FarthestPoint = 1e6;

// Converts the sheet to voxels, the unit of Sheet, such that the steps of Sheet are the steps of
// the mesh.
std::vector<SnappedTriangle> SnapSheet(const MeshSteps& steps,
  const std::vector<glm::dvec3>& points, const std::vector<Sheet::Triangle>& triangles)
{
  std::vector<glm::dvec3> indices(points.size());
  std::transform(points.begin(), points.end(), indices.begin(),
    [&](const glm::dvec3& point) { return steps.Get(point) / static_cast<double>(StepsPerVoxel); });
  constexpr double meshLength =
    static_cast<double>(MeshSteps::Length) / static_cast<double>(StepsPerVoxel);
  for (const Sheet::Triangle& triangle : triangles)
  {
    for (const std::int64_t point : triangle)
    {
      const glm::dvec3 far = glm::abs(indices[static_cast<std::size_t>(point)]);
      if (!(std::max(far.x, std::max(far.y, far.z)) <= FarthestPoint * meshLength))
      {
        throw Error("Point " + std::to_string(point) +
          " of the sheet is more than a million times as far away as the mesh is long. Give the "
          "sheet in the coordinates of the mesh, or bring the point nearer.");
      }
    }
  }
  return Sheet(indices, triangles).Divide(GetMeshBox());
}

bool Contains(const SnappedBox& box, const SnappedBox& other)
{
  return glm::min(box.Min, other.Min) == box.Min && glm::max(box.Max, other.Max) == box.Max;
}

} // namespace

MeshSteps::MeshSteps(const glm::dvec3& low, const glm::dvec3& high)
  : Low(low)
  , Scale(0.0)
{
  const glm::dvec3 size = high - low;
  const double longest = std::max(size.x, std::max(size.y, size.z));
  const double scale = static_cast<double>(MeshSteps::Length) / longest;
  if (longest > 0.0 && std::isfinite(scale))
  {
    this->Scale = scale;
  }
}

SheetCrossings::SheetCrossings(const MeshSteps& steps, const std::vector<glm::dvec3>& points,
  const std::vector<Sheet::Triangle>& triangles, int depth)
  : Cells(std::int64_t{ 1 } << depth)
  , CellSize(MeshSteps::Length >> depth)
  , CellShift(0)
{
  while (std::int64_t{ 1 } << this->CellShift < this->CellSize)
  {
    ++this->CellShift;
  }
  const std::vector<SnappedTriangle> divided = SnapSheet(steps, points, triangles);
  if (divided.empty())
  {
    return;
  }
  this->Crossings.reserve(divided.size());
  for (const SnappedTriangle& triangle : divided)
  {
    this->Crossings.emplace_back(triangle);
  }
  this->Tree =
    BoxTree<SnappedBox>(divided, [](const SnappedTriangle& triangle) { return GetBox(triangle); });
  this->Sums.assign(this->GetIndex(0, 0, this->Cells + 1), 0);
  std::vector<std::size_t> numbers(divided.size());
  std::iota(numbers.begin(), numbers.end(), std::size_t{ 0 });
  this->MarkCells(SnappedPoint(0), depth, numbers);
  this->SumCells();
}

void SheetCrossings::MarkCells(
  const SnappedPoint& firstCell, int level, const std::vector<std::size_t>& numbers)
{
  SnappedBox box;
  box.Add(firstCell * this->CellSize);
  box.Add((firstCell + (std::int64_t{ 1 } << level)) * this->CellSize);
  const auto intersects = [&](std::size_t number)
  {
    const SnappedBox& other = this->Tree.GetBox(number);
    return other.Overlaps(box) &&
      (Contains(box, other) || this->Crossings[number].MayIntersect(box));
  };
  if (level == 0)
  {
    if (std::any_of(numbers.begin(), numbers.end(), intersects))
    {
      this->Sums[this->GetIndex(firstCell.x + 1, firstCell.y + 1, firstCell.z + 1)] = 1;
    }
    return;
  }
  std::vector<std::size_t> near;
  std::copy_if(numbers.begin(), numbers.end(), std::back_inserter(near), intersects);
  for (int child = 0; child < 8 && !near.empty(); ++child)
  {
    const SnappedPoint offset(child & 1, child >> 1 & 1, child >> 2);
    this->MarkCells(firstCell + offset * (std::int64_t{ 1 } << (level - 1)), level - 1, near);
  }
}

void SheetCrossings::SumCells()
{
  for (std::int64_t z = 1; z <= this->Cells; ++z)
  {
    for (std::int64_t y = 1; y <= this->Cells; ++y)
    {
      std::int32_t row = 0;
      for (std::int64_t x = 1; x <= this->Cells; ++x)
      {
        row += this->Sums[this->GetIndex(x, y, z)];
        this->Sums[this->GetIndex(x, y, z)] = row + this->Sums[this->GetIndex(x, y - 1, z)] +
          this->Sums[this->GetIndex(x, y, z - 1)] - this->Sums[this->GetIndex(x, y - 1, z - 1)];
      }
    }
  }
}

bool SheetCrossings::HasMarkedCells(const SnappedBox& box) const
{
  SnappedPoint low;
  SnappedPoint high;
  for (int axis = 0; axis < 3; ++axis)
  {
    low[axis] = this->GetCell(box.Min[axis]);
    high[axis] = this->GetCell(box.Max[axis]) + 1;
  }
  const auto below = [&](std::int64_t x, std::int64_t y, std::int64_t z)
  { return this->Sums[this->GetIndex(x, y, z)]; };
  const auto ofLayers = [&](std::int64_t z)
  {
    return below(high.x, high.y, z) - below(low.x, high.y, z) - below(high.x, low.y, z) +
      below(low.x, low.y, z);
  };
  return ofLayers(high.z) != ofLayers(low.z);
}

bool SheetCrossings::MayIntersect(const SnappedBox& box, std::vector<std::size_t>& scratch) const
{
  if (!this->HasMarkedCells(box))
  {
    return false;
  }
  scratch.clear();
  this->Tree.Find(box, scratch);
  return std::any_of(scratch.begin(), scratch.end(),
    [&](std::size_t number) { return this->Crossings[number].MayIntersect(box); });
}

bool SheetCrossings::IsCrossedOddly(
  const SnappedPoint& p, const SnappedPoint& q, std::vector<std::size_t>& scratch) const
{
  SnappedBox box;
  box.Add(p);
  box.Add(q);
  if (!this->HasMarkedCells(box))
  {
    return false;
  }
  scratch.clear();
  this->Tree.Find(box, scratch);
  return std::count_if(scratch.begin(), scratch.end(),
           [&](std::size_t number)
           {
             const TriangleCrossing& crossing = this->Crossings[number];
             return crossing.IsAbove(p) != crossing.IsAbove(q) && crossing.CrossesEdge(p, q);
           }) %
    2 !=
    0;
}

} // namespace deformvolume
