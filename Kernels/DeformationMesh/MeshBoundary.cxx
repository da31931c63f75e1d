// SPDX-License-Identifier: BSD-3-Clause
#include "MeshBoundary.h"

#include "BoundaryFaces.h"
#include "BoundaryFinder.h"

namespace deformvolume
{

namespace
{

std::vector<Triangle> GetTriangles(const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<std::int32_t>& solid)
{
  std::vector<Triangle> triangles;
  for (const TetrahedronFace& face : FindBoundaryFaces(points, tetrahedra, solid))
  {
    triangles.push_back(
      GetPositions(face, points, tetrahedra[static_cast<std::size_t>(face.Tetrahedron)]));
  }
  return triangles;
}

} // namespace

bool HasMeshBoundary(const Extent& volume, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra)
{
  return GetNumberOfCells(volume) > 0 &&
    BoundaryFinder(volume, volume)
      .Cross(
        GetTriangles(restPoints, tetrahedra, FindSolidTetrahedra(restPoints, tetrahedra)), 0.0);
}

MeshBoundary FindMeshBoundary(const Extent& part, const Extent& whole,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra)
{
  if (GetNumberOfCells(part) == 0)
  {
    return MeshBoundary();
  }
  const std::vector<std::int32_t> numbers = FindSolidTetrahedra(restPoints, tetrahedra);
  BoundaryFinder finder(part, whole);
  if (!finder.Cross(GetTriangles(restPoints, tetrahedra, numbers), 0.0))
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
