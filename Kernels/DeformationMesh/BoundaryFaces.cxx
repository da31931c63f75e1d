// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryFaces.h"

#include "BarycentricMap.h"
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

// A face of a tetrahedron, ordered by the positions of its nodes at rest.
struct Face
{
  std::array<glm::dvec3, 3> Positions;
  bool IsAbove;         // the side of the face on which the tetrahedron lies
  std::uint32_t Number; // as in FaceNeighbors

  bool operator<(const Face& other) const
  {
    return std::lexicographical_compare(this->Positions.begin(), this->Positions.end(),
      other.Positions.begin(), other.Positions.end(), IsLess);
  }
};

Face GetFace(std::size_t face, const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const Tetrahedron& nodes = tetrahedra[face / 4];
  Face found;
  found.Number = static_cast<std::uint32_t>(face);
  found.Positions = GetPositions(
    { static_cast<std::int32_t>(face / 4), static_cast<std::int32_t>(face % 4) }, points, nodes);
  const std::array<glm::dvec3, 3>& q = found.Positions;
  found.IsAbove = glm::dot(glm::cross(q[1] - q[0], q[2] - q[0]),
                    points[static_cast<std::size_t>(nodes[face % 4])] - q[0]) > 0.0;
  return found;
}

// Finds the faces that have tetrahedra on one side only. The first step finds pairs of faces with
// the same nodes, which are nearly all inner faces. No tetrahedron may be flat.
std::vector<std::uint32_t> FindSingleFaces(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra)
{
  const FaceNeighbors neighbors(tetrahedra, points.size());
  constexpr std::size_t step = 65536;
  std::vector<std::vector<Face>> parts((neighbors.GetNumberOfFaces() + step - 1) / step);
  ParallelForParts(neighbors.GetNumberOfFaces(), step,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t face = begin; face < end; ++face)
      {
        const std::size_t next = neighbors.GetNext(face);
        const Face here = GetFace(face, points, tetrahedra);
        // More than two faces with the same nodes are left to the second step.
        if (next == face || !neighbors.IsShared(face) ||
          GetFace(next, points, tetrahedra).IsAbove == here.IsAbove)
        {
          parts[begin / step].push_back(here);
        }
      }
    });
  std::vector<Face> faces;
  for (const std::vector<Face>& part : parts)
  {
    faces.insert(faces.end(), part.begin(), part.end());
  }
  // The second step compares positions: where the mesh is split or its parts are not connected,
  // faces with different nodes coincide.
  std::sort(faces.begin(), faces.end());
  std::vector<std::uint32_t> single;
  for (std::size_t i = 0; i < faces.size();)
  {
    std::size_t end = i;
    bool isOnBoth = false;
    std::uint32_t first = faces[i].Number;
    for (; end < faces.size() && faces[end].Positions == faces[i].Positions; ++end)
    {
      isOnBoth = isOnBoth || faces[end].IsAbove != faces[i].IsAbove;
      first = std::min(first, faces[end].Number);
    }
    if (!isOnBoth)
    {
      single.push_back(first);
    }
    i = end;
  }
  std::sort(single.begin(), single.end());
  return single;
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
  for (const std::int32_t number : solid)
  {
    chosen.push_back(tetrahedra[static_cast<std::size_t>(number)]);
  }
  std::vector<TetrahedronFace> faces;
  for (const std::uint32_t face : FindSingleFaces(points, chosen))
  {
    faces.push_back({ solid[face / 4], static_cast<std::int32_t>(face % 4) });
  }
  return faces;
}

} // namespace deformvolume
