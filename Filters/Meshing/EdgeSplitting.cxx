// SPDX-License-Identifier: BSD-3-Clause
#include "MeshRefinement.h"

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <map>

namespace deformvolume
{
namespace
{

using Tetrahedron = std::array<vtkIdType, 4>;

struct LongEdge
{
  double Length;
  std::vector<std::size_t> Tetrahedra;
};

using LongEdges = std::map<std::array<vtkIdType, 2>, LongEdge>;

bool IsTooLong(
  const glm::dvec3& a, const glm::dvec3& b, const std::vector<RefinementSphere>& spheres)
{
  const double length = glm::distance(a, b);
  return std::any_of(spheres.begin(), spheres.end(),
    [&](const RefinementSphere& sphere)
    { return length > sphere.EdgeLength && GetDistance(sphere.Center, a, b) < sphere.Radius; });
}

LongEdges FindLongEdges(const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<RefinementSphere>& spheres)
{
  LongEdges edges;
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
  {
    for (int k = 0; k < 4; ++k)
    {
      for (int j = 0; j < k; ++j)
      {
        const vtkIdType low = std::min(tetrahedra[i][j], tetrahedra[i][k]);
        const vtkIdType high = std::max(tetrahedra[i][j], tetrahedra[i][k]);
        if (IsTooLong(points[low], points[high], spheres))
        {
          LongEdge& edge = edges[{ { low, high } }];
          edge.Length = glm::distance(points[low], points[high]);
          edge.Tetrahedra.push_back(i);
        }
      }
    }
  }
  return edges;
}

// Halves the longest edges, and of the others those that share no tetrahedron with a longer one.
void SplitEdges(
  const LongEdges& edges, std::vector<glm::dvec3>& points, std::vector<Tetrahedron>& tetrahedra)
{
  std::vector<LongEdges::const_iterator> order;
  for (auto edge = edges.begin(); edge != edges.end(); ++edge)
  {
    order.push_back(edge);
  }
  std::stable_sort(order.begin(), order.end(),
    [](const auto& a, const auto& b) { return a->second.Length > b->second.Length; });
  std::vector<bool> split(tetrahedra.size(), false);
  for (const auto& edge : order)
  {
    const std::vector<std::size_t>& around = edge->second.Tetrahedra;
    if (std::any_of(around.begin(), around.end(), [&](std::size_t i) { return split[i]; }))
    {
      continue;
    }
    const auto middle = static_cast<vtkIdType>(points.size());
    points.push_back(0.5 * (points[edge->first[0]] + points[edge->first[1]]));
    for (const std::size_t i : around)
    {
      split[i] = true;
      Tetrahedron other = tetrahedra[i];
      std::replace(tetrahedra[i].begin(), tetrahedra[i].end(), edge->first[0], middle);
      std::replace(other.begin(), other.end(), edge->first[1], middle);
      tetrahedra.push_back(other);
    }
  }
}

} // namespace

void SplitLongEdges(vtkUnstructuredGrid* mesh, const std::vector<RefinementSphere>& spheres)
{
  if (spheres.empty())
  {
    return;
  }
  std::vector<glm::dvec3> points(mesh->GetNumberOfPoints());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    double point[3];
    mesh->GetPoint(static_cast<vtkIdType>(i), point);
    points[i] = glm::dvec3(point[0], point[1], point[2]);
  }
  std::vector<Tetrahedron> tetrahedra;
  vtkCellArray* cells = mesh->GetCells();
  vtkIdType size;
  const vtkIdType* ids;
  for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
  {
    tetrahedra.push_back({ { ids[0], ids[1], ids[2], ids[3] } });
  }
  LongEdges edges = FindLongEdges(points, tetrahedra, spheres);
  if (edges.empty())
  {
    return;
  }
  for (; !edges.empty(); edges = FindLongEdges(points, tetrahedra, spheres))
  {
    SplitEdges(edges, points, tetrahedra);
  }
  vtkNew<vtkPoints> newPoints;
  newPoints->SetDataTypeToDouble();
  for (const glm::dvec3& point : points)
  {
    newPoints->InsertNextPoint(point.x, point.y, point.z);
  }
  vtkNew<vtkCellArray> newCells;
  for (const Tetrahedron& tetrahedron : tetrahedra)
  {
    newCells->InsertNextCell(4, tetrahedron.data());
  }
  mesh->SetPoints(newPoints);
  mesh->SetCells(VTK_TETRA, newCells);
}

} // namespace deformvolume
