// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceGrowth.h"

#include "ParallelFor.h"

#include "vtkCellArray.h"
#include "vtkGenericCell.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStaticCellLocator.h"
#include "vtkTriangle.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace deformvolume
{
namespace
{

constexpr vtkIdType SomeVoxels = 30000;
constexpr int Rounds = 20;

using Triangle = std::array<vtkIdType, 3>;

std::vector<Triangle> GetTriangles(vtkPolyData* surface)
{
  std::vector<Triangle> triangles;
  triangles.reserve(surface->GetNumberOfPolys());
  vtkCellArray* cells = surface->GetPolys();
  vtkIdType size;
  const vtkIdType* ids;
  for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
  {
    triangles.push_back({ { ids[0], ids[1], ids[2] } });
  }
  return triangles;
}

std::vector<glm::dvec3> GetPoints(vtkPolyData* surface)
{
  std::vector<glm::dvec3> points(surface->GetNumberOfPoints());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    double point[3];
    surface->GetPoint(static_cast<vtkIdType>(i), point);
    points[i] = glm::dvec3(point[0], point[1], point[2]);
  }
  return points;
}

// 1 where the normals of the triangles point outwards, -1 where they point inwards.
double GetOrientation(const std::vector<glm::dvec3>& points, const std::vector<Triangle>& triangles)
{
  double volume = 0.0;
  for (const Triangle& triangle : triangles)
  {
    const glm::dvec3& a = points[triangle[0]];
    volume += glm::dot(a, glm::cross(points[triangle[1]], points[triangle[2]]));
  }
  return volume < 0.0 ? -1.0 : 1.0;
}

// Where a row of voxels goes through a triangle.
struct Crossing
{
  double X;
  int Sign;
};

struct RowCrossing
{
  vtkIdType Row;
  Crossing Place;
};

// On which side of an edge a row lies. The two triangles of an edge get opposite answers, whatever
// the rounding, so that a row never slips through between them.
bool IsLeft(const std::vector<glm::dvec3>& points, vtkIdType from, vtkIdType to, double y, double z)
{
  const bool reversed = to < from;
  const glm::dvec3& a = points[reversed ? to : from];
  const glm::dvec3& b = points[reversed ? from : to];
  const bool left = (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y) >= 0.0;
  return left != reversed;
}

// points: in voxels. Rows are looked at a tiny bit beside where they are, so that they do not go
// through vertices.
void CrossRows(const std::vector<glm::dvec3>& points, const Triangle& triangle,
  const BodyVoxels& body, std::vector<RowCrossing>& crossings)
{
  constexpr double asideY = 1.37e-7;
  constexpr double asideZ = 2.11e-7;
  const glm::dvec3& a = points[triangle[0]];
  const glm::dvec3& b = points[triangle[1]];
  const glm::dvec3& c = points[triangle[2]];
  const double normal = (b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y);
  if (normal == 0.0)
  {
    return;
  }
  const auto first = [](double least) { return std::max(0.0, std::ceil(least - 1e-6)); };
  const auto last = [](double greatest, int size)
  { return std::min(size - 1.0, std::floor(greatest + 1e-6)); };
  const int lastY = static_cast<int>(last(std::max({ a.y, b.y, c.y }), body.Size[1]));
  const int lastZ = static_cast<int>(last(std::max({ a.z, b.z, c.z }), body.Size[2]));
  for (int k = static_cast<int>(first(std::min({ a.z, b.z, c.z }))); k <= lastZ; ++k)
  {
    for (int j = static_cast<int>(first(std::min({ a.y, b.y, c.y }))); j <= lastY; ++j)
    {
      const vtkIdType row = vtkIdType(k) * body.Size[1] + j;
      if (body.RowStarts[row] == body.RowStarts[row + 1])
      {
        continue;
      }
      const double y = j + asideY;
      const double z = k + asideZ;
      const bool left = IsLeft(points, triangle[0], triangle[1], y, z);
      if (left != IsLeft(points, triangle[1], triangle[2], y, z) ||
        left != IsLeft(points, triangle[2], triangle[0], y, z))
      {
        continue;
      }
      const double u = ((y - a.y) * (c.z - a.z) - (z - a.z) * (c.y - a.y)) / normal;
      const double v = ((b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y)) / normal;
      crossings.push_back({ row, { a.x + u * (b.x - a.x) + v * (c.x - a.x), left ? 1 : -1 } });
    }
  }
}

// Calls outside(begin, end) for the parts of a run that no pair of crossings encloses.
template <typename Function>
void ForEachOutside(
  const VoxelRun& run, const Crossing* crossing, const Crossing* end, Function&& outside)
{
  int winding = 0;
  double x = run.Begin;
  const double last = run.End - 1;
  for (; x <= last; ++crossing)
  {
    const double next = crossing < end ? std::ceil(crossing->X) : last + 1.0;
    if (next > x)
    {
      const double stop = std::min(next, last + 1.0);
      if (winding == 0)
      {
        outside(static_cast<int>(x), static_cast<int>(stop));
      }
      x = stop;
    }
    if (crossing == end)
    {
      break;
    }
    winding += crossing->Sign;
  }
}

// What moves a vertex in one round: the longest of the moves that voxels ask for.
void Ask(glm::dvec3& move, const glm::dvec3& other)
{
  if (glm::dot(other, other) > glm::dot(move, move))
  {
    move = other;
  }
}

struct Closest
{
  glm::dvec3 Position;
  vtkIdType Triangle;
  double Distance;
};

std::vector<Closest> FindClosest(
  vtkPolyData* surface, const std::vector<VoxelIndex>& voxels, const glm::dvec3& spacing)
{
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(surface);
  locator->BuildLocator();
  std::vector<Closest> result(voxels.size());
  ParallelFor(0, static_cast<vtkIdType>(voxels.size()), 256,
    [&](vtkIdType begin, vtkIdType end)
    {
      vtkNew<vtkGenericCell> cell;
      for (vtkIdType i = begin; i < end; ++i)
      {
        const glm::dvec3 voxel = spacing * glm::dvec3(voxels[i][0], voxels[i][1], voxels[i][2]);
        const double query[3] = { voxel.x, voxel.y, voxel.z };
        double closest[3] = { 0.0, 0.0, 0.0 };
        vtkIdType triangle = -1;
        int part = 0;
        double square = 0.0;
        locator->FindClosestPoint(query, closest, cell, triangle, part, square);
        result[i] = { glm::dvec3(closest[0], closest[1], closest[2]), triangle, std::sqrt(square) };
      }
    });
  return result;
}

// The surface a little smaller, by that much at each vertex: voxels that are outside of it, but
// just inside the surface, can be outside the mesh once positions are rounded.
vtkSmartPointer<vtkPolyData> Shrink(vtkPolyData* surface, const std::vector<glm::dvec3>& points,
  const std::vector<Triangle>& triangles, double inwards)
{
  std::vector<glm::dvec3> normals(points.size(), glm::dvec3(0.0));
  for (const Triangle& triangle : triangles)
  {
    const glm::dvec3& a = points[triangle[0]];
    const glm::dvec3 normal = glm::cross(points[triangle[1]] - a, points[triangle[2]] - a);
    for (const vtkIdType point : triangle)
    {
      normals[point] += normal;
    }
  }
  vtkNew<vtkPoints> moved;
  moved->SetDataTypeToDouble();
  moved->SetNumberOfPoints(static_cast<vtkIdType>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const double length = glm::length(normals[i]);
    const glm::dvec3 point = length > 0.0 ? points[i] + inwards / length * normals[i] : points[i];
    moved->SetPoint(static_cast<vtkIdType>(i), point.x, point.y, point.z);
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(moved);
  result->SetPolys(surface->GetPolys());
  return result;
}

} // namespace

OutsideVoxels FindOutside(vtkPolyData* surface, const BodyVoxels& body, const glm::dvec3& spacing)
{
  std::vector<glm::dvec3> points = GetPoints(surface);
  for (glm::dvec3& point : points)
  {
    point /= spacing;
  }
  std::vector<RowCrossing> crossings;
  for (const Triangle& triangle : GetTriangles(surface))
  {
    CrossRows(points, triangle, body, crossings);
  }
  // By row, and by place in a row.
  std::vector<vtkIdType> starts(body.NumberOfRows() + 1, 0);
  for (const RowCrossing& crossing : crossings)
  {
    ++starts[crossing.Row + 1];
  }
  for (std::size_t row = 1; row < starts.size(); ++row)
  {
    starts[row] += starts[row - 1];
  }
  std::vector<Crossing> sorted(crossings.size());
  std::vector<vtkIdType> ends(starts.begin(), starts.end() - 1);
  for (const RowCrossing& crossing : crossings)
  {
    sorted[ends[crossing.Row]++] = crossing.Place;
  }

  OutsideVoxels result;
  for (int pass = 0; pass < 2; ++pass)
  {
    const vtkIdType stride = result.Count / SomeVoxels + 1;
    vtkIdType count = 0;
    for (vtkIdType row = 0; row < body.NumberOfRows(); ++row)
    {
      Crossing* begin = sorted.data() + starts[row];
      Crossing* end = sorted.data() + starts[row + 1];
      if (pass == 0)
      {
        std::sort(begin, end, [](const Crossing& a, const Crossing& b) { return a.X < b.X; });
      }
      for (vtkIdType i = body.RowStarts[row]; i < body.RowStarts[row + 1]; ++i)
      {
        ForEachOutside(body.Runs[i], begin, end,
          [&](int from, int to)
          {
            for (int x = from; x < to; ++x, ++count)
            {
              if (pass == 1 && count % stride == 0)
              {
                result.Some.push_back({ { x, static_cast<int>(row % body.Size[1]),
                  static_cast<int>(row / body.Size[1]) } });
              }
            }
          });
      }
    }
    result.Count = count;
  }
  return result;
}

bool GrowAroundBody(vtkPolyData* surface, const BodyVoxels& body, const BodyVoxels& target,
  const glm::dvec3& spacing, double reach, vtkIdType allowed, const std::function<void()>& check)
{
  const std::vector<Triangle> triangles = GetTriangles(surface);
  std::vector<glm::dvec3> points = GetPoints(surface);
  const double outwards = GetOrientation(points, triangles);
  const double beyond = 0.05 * std::min({ spacing.x, spacing.y, spacing.z });
  std::vector<glm::dvec3> moves(points.size());
  for (int round = 0; round < Rounds; ++round)
  {
    check();
    // The last rounds are for what counts.
    const bool aim = round < Rounds / 2;
    const auto shrunk = Shrink(surface, points, triangles, -outwards * 0.4 * beyond);
    const OutsideVoxels outside = FindOutside(shrunk, aim ? target : body, spacing);
    if (outside.Count == 0)
    {
      return true;
    }
    std::fill(moves.begin(), moves.end(), glm::dvec3(0.0));
    const std::vector<Closest> closest = FindClosest(surface, outside.Some, spacing);
    for (std::size_t i = 0; i < closest.size(); ++i)
    {
      const Closest& place = closest[i];
      if (place.Triangle < 0 || !(place.Distance <= reach))
      {
        return false;
      }
      const VoxelIndex& index = outside.Some[i];
      const Triangle& triangle = triangles[place.Triangle];
      const glm::dvec3 corners[3] = { points[triangle[0]], points[triangle[1]],
        points[triangle[2]] };
      const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
      const double area = glm::dot(normal, normal);
      if (!(area > 0.0))
      {
        return false;
      }
      // The smallest moves of the corners that bring the closest point a bit beyond the voxel.
      const glm::dvec3 voxel = spacing * glm::dvec3(index[0], index[1], index[2]);
      glm::dvec3 direction = voxel - place.Position;
      direction =
        place.Distance > beyond ? direction / place.Distance : outwards / std::sqrt(area) * normal;
      const glm::dvec3 way = (place.Distance + beyond) * direction;
      double weights[3];
      double squares = 0.0;
      for (int k = 0; k < 3; ++k)
      {
        weights[k] = std::max(0.0,
          glm::dot(normal,
            glm::cross(
              corners[(k + 1) % 3] - place.Position, corners[(k + 2) % 3] - place.Position)) /
            area);
        squares += weights[k] * weights[k];
      }
      for (int k = 0; k < 3 && squares > 0.0; ++k)
      {
        Ask(moves[triangle[k]], weights[k] / squares * way);
      }
    }
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      points[i] += moves[i];
      surface->GetPoints()->SetPoint(
        static_cast<vtkIdType>(i), points[i].x, points[i].y, points[i].z);
    }
    surface->GetPoints()->Modified();
    surface->Modified();
  }
  return FindOutside(surface, body, spacing).Count <= allowed;
}

} // namespace deformvolume
