// SPDX-License-Identifier: BSD-3-Clause
#include "MeshBoundary.h"

#include "BarycentricMap.h"
#include "BoundaryFinder.h"
#include "FaceNeighbours.h"
#include "ParallelFor.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace deformvolume
{

namespace
{

bool IsLess(const glm::dvec3& a, const glm::dvec3& b)
{
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// A face of a tetrahedron, by the places of its nodes at rest in ascending order.
struct Face
{
  Triangle Places;
  bool IsAbove; // on which side of it the tetrahedron lies

  bool operator<(const Face& other) const
  {
    return std::lexicographical_compare(
      this->Places.begin(), this->Places.end(), other.Places.begin(), other.Places.end(), IsLess);
  }
};

// face: as FaceNeighbours numbers them.
Face GetFace(std::size_t face, const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const Tetrahedron& nodes = tetrahedra[face / 4];
  Face found;
  for (std::size_t i = 0, k = 0; k < 4; ++k)
  {
    if (k != face % 4)
    {
      found.Places[i++] = points[static_cast<std::size_t>(nodes[k])];
    }
  }
  std::sort(found.Places.begin(), found.Places.end(), IsLess);
  const Triangle& q = found.Places;
  found.IsAbove = glm::dot(glm::cross(q[1] - q[0], q[2] - q[0]),
                    points[static_cast<std::size_t>(nodes[face % 4])] - q[0]) > 0.0;
  return found;
}

// The faces that have tetrahedra on one side only. Those that have nodes in common are found first,
// as they are nearly all. tetrahedra: none is flat.
std::vector<Triangle> FindBoundaryFaces(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra)
{
  const FaceNeighbours neighbours(tetrahedra, points.size());
  constexpr std::size_t step = 65536;
  std::vector<std::vector<Face>> parts((neighbours.GetNumberOfFaces() + step - 1) / step);
  ParallelForParts(neighbours.GetNumberOfFaces(), step,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t face = begin; face < end; ++face)
      {
        const std::size_t next = neighbours.GetNext(face);
        const Face here = GetFace(face, points, tetrahedra);
        // More than two in one place may be anything.
        if (next == face || !neighbours.IsShared(face) ||
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
  // Where the mesh is split, or its parts were never joined, faces of different nodes are in one
  // place.
  std::sort(faces.begin(), faces.end());
  std::vector<Triangle> single;
  for (std::size_t i = 0; i < faces.size();)
  {
    std::size_t end = i;
    bool isOnBoth = false;
    for (; end < faces.size() && faces[end].Places == faces[i].Places; ++end)
    {
      isOnBoth = isOnBoth || faces[end].IsAbove != faces[i].IsAbove;
    }
    if (!isOnBoth)
    {
      single.push_back(faces[i].Places);
    }
    i = end;
  }
  return single;
}

// Those that are not flat: flat ones hold nothing, and their faces may be in one place.
std::vector<std::int32_t> FindSolid(
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

std::vector<Triangle> FindBoundaryFaces(const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<std::int32_t>& numbers)
{
  std::vector<Tetrahedron> solid;
  for (const std::int32_t number : numbers)
  {
    solid.push_back(tetrahedra[static_cast<std::size_t>(number)]);
  }
  return FindBoundaryFaces(points, solid);
}

} // namespace

bool HasMeshBoundary(const Extent& volume, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra)
{
  return GetNumberOfCells(volume) > 0 &&
    BoundaryFinder(volume, volume)
      .Cross(FindBoundaryFaces(restPoints, tetrahedra, FindSolid(restPoints, tetrahedra)), 0.0);
}

MeshBoundary FindMeshBoundary(const Extent& part, const Extent& whole,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra)
{
  if (GetNumberOfCells(part) == 0)
  {
    return MeshBoundary();
  }
  const std::vector<std::int32_t> numbers = FindSolid(restPoints, tetrahedra);
  BoundaryFinder finder(part, whole);
  if (!finder.Cross(FindBoundaryFaces(restPoints, tetrahedra, numbers), 0.0))
  {
    return MeshBoundary();
  }
  return finder.Collect(numbers.size(),
    [&](std::size_t i, const auto& add)
    {
      MeshBoundary::Piece piece;
      piece.Tetrahedron = numbers[i];
      const Tetrahedron& nodes = tetrahedra[static_cast<std::size_t>(numbers[i])];
      for (std::size_t k = 0; k < 4; ++k)
      {
        piece.Rest[k] = restPoints[static_cast<std::size_t>(nodes[k])];
        piece.Weights[k] = {};
        piece.Weights[k][k] = 1.0F;
      }
      add(piece);
    });
}

} // namespace deformvolume
