// SPDX-License-Identifier: BSD-3-Clause
#include "PolyhedronSplit.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace deformvolume
{

namespace
{

// The largest difference between the volume of a cell and that of its tetrahedra, relative to the
// volume of the cell.
constexpr double VolumeTolerance = 5e-7;

using Triangle = std::array<int, 3>; // indices in the cell's list of points

double GetVolume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d)
{
  return glm::dot(b - a, glm::cross(c - a, d - a)) / 6.0;
}

// Returns the normal of a triangle; its length is twice the area.
glm::dvec3 GetArea(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
  return glm::cross(b - a, c - a);
}

// Whether all points are on one side of each face, and all faces are convex, within the error of
// the positions. Most cells are convex; for them no volumes need to be computed.
bool IsConvex(const CellFaces& faces, const std::vector<glm::dvec3>& points, double error)
{
  for (const std::vector<int>& face : faces)
  {
    const auto at = [&](std::size_t i)
    { return points[static_cast<std::size_t>(face[i % face.size()])]; };
    glm::dvec3 normal(0.0);
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
    {
      normal += GetArea(at(0), at(i), at(i + 1));
    }
    const double length = glm::length(normal);
    double least = 0.0;
    double most = 0.0;
    for (const glm::dvec3& point : points)
    {
      const double side = glm::dot(normal, point - at(0));
      least = std::min(least, side);
      most = std::max(most, side);
    }
    if (!(length > 0.0) || (least < -error * length && most > error * length))
    {
      return false;
    }
    for (std::size_t i = 0; i < face.size(); ++i)
    {
      const glm::dvec3 area = GetArea(at(i), at(i + 1), at(i + 2));
      if (glm::dot(normal, area) < -error * std::sqrt(length) * length)
      {
        return false;
      }
    }
  }
  return true;
}

// Whether the faces close the cell: then their areas, as vectors that point outwards, add up to 0.
// Outwards is away from the mean of the points. error: of the positions.
bool IsClosed(const CellFaces& faces, const std::vector<glm::dvec3>& points, double error)
{
  glm::dvec3 center(0.0);
  for (const glm::dvec3& point : points)
  {
    center += point / static_cast<double>(points.size());
  }
  glm::dvec3 sum(0.0);
  double total = 0.0;
  double edges = 0.0;
  for (const std::vector<int>& face : faces)
  {
    const auto at = [&](std::size_t i)
    { return points[static_cast<std::size_t>(face[i % face.size()])]; };
    glm::dvec3 area(0.0);
    for (std::size_t i = 0; i < face.size(); ++i)
    {
      area += GetArea(at(0), at(i), at(i + 1));
      edges += glm::distance(at(i), at(i + 1));
    }
    sum += glm::dot(area, at(0) - center) < 0.0 ? -area : area;
    total += glm::length(area);
  }
  constexpr double rounding = 1e-9;
  return !(glm::length(sum) > rounding * total + error * edges);
}

// Splits a polygon into triangles: a fan around its first node if all triangles of the fan have the
// same orientation, otherwise by ear clipping.
std::vector<Triangle> SplitPolygon(
  const std::vector<int>& face, const std::vector<glm::dvec3>& points)
{
  const auto at = [&](int node) { return points[static_cast<std::size_t>(node)]; };
  std::vector<Triangle> fan;
  glm::dvec3 normal(0.0);
  for (std::size_t i = 1; i + 1 < face.size(); ++i)
  {
    fan.push_back({ { face[0], face[i], face[i + 1] } });
    normal += GetArea(at(face[0]), at(face[i]), at(face[i + 1]));
  }
  const double tolerance = 1e-12 * glm::dot(normal, normal);
  const auto getTurn = [&](int a, int b, int c)
  { return glm::dot(normal, GetArea(at(a), at(b), at(c))); };
  if (std::all_of(fan.begin(), fan.end(),
        [&](const Triangle& t) { return getTurn(t[0], t[1], t[2]) >= -tolerance; }))
  {
    return fan;
  }
  std::vector<Triangle> ears;
  std::vector<int> remaining = face;
  while (remaining.size() > 3)
  {
    std::size_t ear = remaining.size();
    for (std::size_t i = 0; i < remaining.size() && ear == remaining.size(); ++i)
    {
      const int before = remaining[(i + remaining.size() - 1) % remaining.size()];
      const int after = remaining[(i + 1) % remaining.size()];
      const bool isEmpty = std::none_of(remaining.begin(), remaining.end(),
        [&](int node)
        {
          return node != before && node != remaining[i] && node != after &&
            getTurn(before, remaining[i], node) >= -tolerance &&
            getTurn(remaining[i], after, node) >= -tolerance &&
            getTurn(after, before, node) >= -tolerance;
        });
      ear = isEmpty && getTurn(before, remaining[i], after) > tolerance ? i : ear;
    }
    if (ear == remaining.size())
    {
      return fan; // the polygon crosses itself
    }
    ears.push_back({ { remaining[(ear + remaining.size() - 1) % remaining.size()], remaining[ear],
      remaining[(ear + 1) % remaining.size()] } });
    remaining.erase(remaining.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  ears.push_back({ { remaining[0], remaining[1], remaining[2] } });
  return ears;
}

// Splits a face into triangles with its orientation. The split does not depend on the first node or
// on the orientation of the face.
std::vector<Triangle> SplitFace(const std::vector<int>& face, const std::vector<CellNode>& nodes,
  const std::vector<glm::dvec3>& points)
{
  const auto isLess = [&](int a, int b)
  { return nodes[static_cast<std::size_t>(a)] < nodes[static_cast<std::size_t>(b)]; };
  std::vector<int> canonical = face;
  std::rotate(canonical.begin(), std::min_element(canonical.begin(), canonical.end(), isLess),
    canonical.end());
  const bool isReversed = isLess(canonical.back(), canonical[1]);
  if (isReversed)
  {
    std::reverse(canonical.begin() + 1, canonical.end());
  }
  std::vector<Triangle> triangles = SplitPolygon(canonical, points);
  for (Triangle& triangle : triangles)
  {
    if (isReversed)
    {
      std::swap(triangle[1], triangle[2]);
    }
  }
  return triangles;
}

// Finds a point on the inner side of all triangles, at a large, but not the largest possible,
// distance from them. Returns false if none is found.
bool FindCenter(const std::vector<Triangle>& triangles, const std::vector<glm::dvec3>& points,
  double size, glm::dvec3& center)
{
  struct Plane
  {
    glm::dvec3 Normal; // outwards
    glm::dvec3 Origin;
  };
  std::vector<Plane> planes;
  for (const Triangle& triangle : triangles)
  {
    const glm::dvec3& origin = points[static_cast<std::size_t>(triangle[0])];
    const glm::dvec3 area = GetArea(origin, points[static_cast<std::size_t>(triangle[1])],
      points[static_cast<std::size_t>(triangle[2])]);
    const double length = glm::length(area);
    if (length > 1e-12 * size * size)
    {
      planes.push_back({ area / length, origin });
    }
  }
  glm::dvec3 mean(0.0);
  for (const glm::dvec3& point : points)
  {
    mean += point / static_cast<double>(points.size());
  }
  constexpr int mostSteps = 500;
  for (double margin = 0.25 * size; margin > 1e-5 * size; margin *= 0.5)
  {
    center = mean;
    for (int step = 0; step < mostSteps; ++step)
    {
      // Project beyond the plane that is violated most (over-relaxation).
      double most = 0.0;
      const Plane* worst = nullptr;
      for (const Plane& plane : planes)
      {
        const double over = glm::dot(plane.Normal, center - plane.Origin) + margin;
        if (over > most)
        {
          most = over;
          worst = &plane;
        }
      }
      if (!worst)
      {
        return true;
      }
      center -= (1.2 * most) * worst->Normal;
    }
  }
  return false;
}

// Returns weights of points. The weights add up to 1, the weighted sum of the points is a given
// position, and the sum of the squared weights is minimal.
std::vector<double> FindWeights(const std::vector<glm::dvec3>& points, const glm::dvec3& position)
{
  const auto count = static_cast<double>(points.size());
  glm::dvec3 mean(0.0);
  for (const glm::dvec3& point : points)
  {
    mean += point / count;
  }
  glm::dmat3 spread(0.0);
  for (const glm::dvec3& point : points)
  {
    spread += glm::outerProduct(point - mean, point - mean);
  }
  const glm::dvec3 factors = glm::inverse(spread) * (position - mean);
  std::vector<double> weights;
  for (const glm::dvec3& point : points)
  {
    weights.push_back(1.0 / count + glm::dot(factors, point - mean));
  }
  return weights;
}

} // namespace

bool SplitPolyhedron(const std::vector<CellNode>& nodes, const CellFaces& faces,
  const std::vector<glm::dvec3>& points, double rounding, PolyhedronSplit& split)
{
  split = PolyhedronSplit();
  SplitCell(nodes, faces, split.Tetrahedra);
  double error = 0.0; // the largest error of the positions
  for (const glm::dvec3& point : points)
  {
    const glm::dvec3 size = glm::abs(point);
    error = std::max({ error, rounding * size.x, rounding * size.y, rounding * size.z });
  }
  const bool isConvex = IsConvex(faces, points, error);
  const bool isClosed = IsClosed(faces, points, error);
  if (isConvex && isClosed)
  {
    return true;
  }
  // Flat cells, of which no side is outside, count as closed if their edges are.
  CellFaces oriented = faces;
  const bool isOriented = OrientFaces(oriented);
  if (isConvex || !isOriented)
  {
    split.IsOpen = !isClosed && !isOriented;
    return !split.IsOpen;
  }
  std::vector<Triangle> triangles;
  for (const std::vector<int>& face : oriented)
  {
    const std::vector<Triangle> some = SplitFace(face, nodes, points);
    triangles.insert(triangles.end(), some.begin(), some.end());
  }
  const auto at = [&](int node) { return points[static_cast<std::size_t>(node)]; };
  const auto sum = [&](const glm::dvec3& apex)
  {
    double volume = 0.0;
    for (const Triangle& t : triangles)
    {
      volume += GetVolume(apex, at(t[0]), at(t[1]), at(t[2]));
    }
    return volume;
  };
  double volume = sum(points[0]);
  if (volume < 0.0)
  {
    volume = -volume;
    for (Triangle& triangle : triangles)
    {
      std::swap(triangle[1], triangle[2]);
    }
  }
  std::map<std::int32_t, int> indices;
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    indices[nodes[i].Number] = static_cast<int>(i);
  }
  double filled = 0.0;
  for (const Tetrahedron& t : split.Tetrahedra)
  {
    filled += std::abs(
      GetVolume(at(indices[t[0]]), at(indices[t[1]]), at(indices[t[2]]), at(indices[t[3]])));
  }
  double area = 0.0;
  for (const Triangle& t : triangles)
  {
    area += 0.5 * glm::length(GetArea(at(t[0]), at(t[1]), at(t[2])));
  }
  const double tolerance = VolumeTolerance * volume + error * area;
  // True if a volume is NaN, too.
  if (!(volume > 0.0) || !(std::abs(filled - volume) > tolerance))
  {
    return true;
  }
  glm::dvec3 center(0.0);
  if (!FindCenter(triangles, points, std::cbrt(volume), center))
  {
    return false;
  }
  split.Tetrahedra.clear();
  split.CenterWeights = FindWeights(points, center);
  for (const Triangle& t : triangles)
  {
    split.Triangles.push_back({ { nodes[static_cast<std::size_t>(t[0])].Number,
      nodes[static_cast<std::size_t>(t[1])].Number,
      nodes[static_cast<std::size_t>(t[2])].Number } });
  }
  return true;
}

} // namespace deformvolume
