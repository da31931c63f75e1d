// SPDX-License-Identifier: BSD-3-Clause
#include "CubeFifths.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

constexpr double Tolerance = 1e-3;

using Corners = std::array<glm::dvec3, 4>;

Corners GetCorners(const ElasticBody& body, const Tetrahedron& tetrahedron)
{
  Corners corners;
  std::transform(tetrahedron.begin(), tetrahedron.end(), corners.begin(),
    [&](std::int32_t node) { return body.Points[static_cast<std::size_t>(node)]; });
  return corners;
}

bool IsAbout(double length, double wanted)
{
  return std::abs(length - wanted) <= Tolerance * wanted;
}

// Whether the edges from one corner have the length `from`, and the other edges the length
// `between`.
bool HasEdges(const Corners& corners, std::size_t corner, double from, double between)
{
  for (std::size_t i = 0; i < 4; ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      const double wanted = i == corner || j == corner ? from : between;
      if (!IsAbout(glm::distance(corners[i], corners[j]), wanted))
      {
        return false;
      }
    }
  }
  return true;
}

bool IsFifth(const Corners& corners, double edge)
{
  const double diagonal = std::sqrt(2.0) * edge;
  bool isFifth = HasEdges(corners, 0, diagonal, diagonal);
  for (std::size_t i = 0; i < 4 && !isFifth; ++i)
  {
    isFifth = HasEdges(corners, i, edge, diagonal);
  }
  return isFifth;
}

} // namespace

double FindCubeEdge(Watch& watch, const ElasticBody& body)
{
  const Corners first = GetCorners(body, body.Tetrahedra.front());
  // Both kinds of tetrahedra have a face diagonal as their longest edge.
  double longest = 0.0;
  for (std::size_t i = 1; i < 4; ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      longest = std::max(longest, glm::distance(first[i], first[j]));
    }
  }
  const double edge = longest / std::sqrt(2.0);
  ForItems(watch, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      if (!IsFifth(GetCorners(body, body.Tetrahedra[t]), edge))
      {
        throw Error("The tetrahedron with the points " + ListNodes(body.Tetrahedra[t]) +
          " is not a fifth of a cube" +
          (t == 0 ? std::string() : " of the same size as those before it") +
          ". Springs simulate an elastic material only on lattices of equal cubes with five "
          "tetrahedra each: use "
          "vtkLatticeTetrahedraSource with EqualSpacing, or vtkFiniteElementDeformation, which "
          "takes any mesh.");
      }
    });
  return edge;
}

} // namespace deformvolume
