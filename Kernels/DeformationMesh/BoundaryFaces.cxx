// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryFaces.h"

#include "BarycentricMap.h"
#include "CoincidentPoints.h"
#include "FaceNeighbors.h"
#include "ParallelFor.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>

namespace deformvolume
{

namespace
{

bool IsLess(const glm::dvec3& a, const glm::dvec3& b)
{
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Whether a tetrahedron lies above one of its faces. Faces with the same positions have the same
// side above. face: as in FaceNeighbors.
bool IsAbove(std::size_t face, const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const Tetrahedron& nodes = tetrahedra[face / 4];
  const std::array<glm::dvec3, 3> q = GetPositions(
    { static_cast<std::int32_t>(face / 4), static_cast<std::int32_t>(face % 4) }, points, nodes);
  return glm::dot(glm::cross(q[1] - q[0], q[2] - q[0]),
           points[static_cast<std::size_t>(nodes[face % 4])] - q[0]) > 0.0;
}

// Finds the faces that have tetrahedra on one side only; the first one of several with the same
// nodes. No tetrahedron may be flat.
std::vector<std::uint32_t> FindSingleFaces(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra)
{
  const FaceNeighbors neighbors(tetrahedra, points.size());
  return CollectItems<std::uint32_t>(neighbors.GetNumberOfFaces(), 65536,
    [&](std::size_t face, std::vector<std::uint32_t>& single)
    {
      const bool isAbove = IsAbove(face, points, tetrahedra);
      bool isSingle = true;
      for (std::size_t next = neighbors.GetNext(face); next != face && isSingle;
           next = neighbors.GetNext(next))
      {
        isSingle = next > face && IsAbove(next, points, tetrahedra) == isAbove;
      }
      if (isSingle)
      {
        single.push_back(static_cast<std::uint32_t>(face));
      }
    });
}

} // namespace

std::array<glm::dvec3, 3> GetPositions(
  const TetrahedronFace& face, const std::vector<glm::dvec3>& points, const Tetrahedron& nodes)
{
  std::array<glm::dvec3, 3> positions;
  const std::array<std::int32_t, 3> corners = face.GetNodes(nodes);
  for (std::size_t k = 0; k < 3; ++k)
  {
    positions[k] = points[static_cast<std::size_t>(corners[k])];
  }
  std::sort(positions.begin(), positions.end(), IsLess);
  return positions;
}

std::vector<std::int32_t> FindSolidTetrahedra(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra)
{
  std::vector<std::int32_t> numbers;
  for (std::size_t t = 0; t < tetrahedra.size(); ++t)
  {
    BarycentricMap map;
    if (map.SetTetrahedron(tetrahedra[t], points))
    {
      numbers.push_back(static_cast<std::int32_t>(t));
    }
  }
  return numbers;
}

std::vector<TetrahedronFace> FindBoundaryFaces(const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<std::int32_t>& solid)
{
  std::vector<Tetrahedron> chosen;
  chosen.reserve(solid.size());
  // Where the mesh is split or its parts are not connected, faces with different nodes coincide.
  const std::vector<std::int32_t> places = FindCoincidentPoints(points);
  for (const std::int32_t number : solid)
  {
    Tetrahedron nodes = tetrahedra[static_cast<std::size_t>(number)];
    std::transform(nodes.begin(), nodes.end(), nodes.begin(),
      [&](std::int32_t node) { return places[static_cast<std::size_t>(node)]; });
    chosen.push_back(nodes);
  }
  std::vector<TetrahedronFace> faces;
  for (const std::uint32_t face : FindSingleFaces(points, chosen))
  {
    faces.push_back({ solid[face / 4], static_cast<std::int32_t>(face % 4) });
  }
  return faces;
}

} // namespace deformvolume
