// SPDX-License-Identifier: BSD-3-Clause
#include "MeshRefinement.h"

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkGenericCell.h"
#include "vtkMassProperties.h"
#include "vtkMath.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStaticCellLocator.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace deformvolume
{
namespace
{

// Factors on the requested length for edges of the surface and of the lattice of points inside.
// They are less than 1, since edges between the surface and the lattice are longer.
constexpr double SurfaceShare = 0.75;
constexpr double LatticeShare = 0.75;
// Least distance of lattice points from the surface, in lattice constants.
constexpr double Clearance = 0.45;
// By how much the largest edge length increases for each unit of distance from a sphere.
constexpr double SurfaceGrowth = 0.5;

using Edge = std::array<vtkIdType, 2>;

struct LongEdge
{
  double Length;
  std::vector<std::size_t> Around;
};

/// A mesh of triangles or tetrahedra whose long edges are split. The largest edge length within a
/// sphere is `share` times the EdgeLength of the sphere. Outside, it increases by `growth` for each
/// unit of distance from the sphere.
template <int N>
class SplitMesh
{
public:
  using Simplex = std::array<vtkIdType, N>;

  SplitMesh(vtkPointSet* mesh, vtkCellArray* cells, const std::vector<RefinementSphere>& spheres,
    double share, double growth)
    : Spheres(spheres)
    , Share(share)
    , Growth(growth)
  {
    this->Points.resize(mesh->GetNumberOfPoints());
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      mesh->GetPoint(static_cast<vtkIdType>(i), &this->Points[i].x);
    }
    vtkIdType size;
    const vtkIdType* ids;
    for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
    {
      Simplex simplex;
      std::copy_n(ids, N, simplex.begin());
      this->Simplices.push_back(simplex);
    }
  }

  // Splits the longest edge of each cell with an edge that is too long, unless a neighbor has a
  // longer one to split. Splitting the longest edges keeps the quality of the cells. Returns
  // whether there was an edge to split.
  bool SplitOnce()
  {
    std::map<Edge, LongEdge> edges;
    for (const Simplex& simplex : this->Simplices)
    {
      Edge longest{ { 0, 0 } };
      double length = 0.0;
      bool isTooLong = false;
      this->ForEachEdge(simplex,
        [&](const Edge& edge, double edgeLength)
        {
          isTooLong = isTooLong || this->IsTooLong(edge, edgeLength);
          // Of several longest edges the lowest one, so that all cells around it choose the same.
          if (edgeLength > length || (edgeLength == length && edge < longest))
          {
            length = edgeLength;
            longest = edge;
          }
        });
      if (isTooLong)
      {
        edges[longest].Length = length;
      }
    }
    if (edges.empty())
    {
      return false;
    }
    for (std::size_t i = 0; i < this->Simplices.size(); ++i)
    {
      this->ForEachEdge(this->Simplices[i],
        [&](const Edge& edge, double)
        {
          const auto found = edges.find(edge);
          if (found != edges.end())
          {
            found->second.Around.push_back(i);
          }
        });
    }
    std::vector<std::map<Edge, LongEdge>::const_iterator> order;
    for (auto edge = edges.begin(); edge != edges.end(); ++edge)
    {
      order.push_back(edge);
    }
    std::stable_sort(order.begin(), order.end(),
      [](const auto& a, const auto& b) { return a->second.Length > b->second.Length; });
    std::vector<bool> split(this->Simplices.size(), false);
    for (const auto& edge : order)
    {
      const std::vector<std::size_t>& around = edge->second.Around;
      if (std::none_of(around.begin(), around.end(), [&](std::size_t i) { return split[i]; }))
      {
        this->Split(edge->first, around, split);
      }
    }
    return true;
  }

  vtkSmartPointer<vtkPoints> MakePoints() const
  {
    auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetDataTypeToDouble();
    for (const glm::dvec3& point : this->Points)
    {
      points->InsertNextPoint(&point.x);
    }
    return points;
  }

  vtkSmartPointer<vtkCellArray> MakeCells() const
  {
    auto cells = vtkSmartPointer<vtkCellArray>::New();
    for (const Simplex& simplex : this->Simplices)
    {
      cells->InsertNextCell(N, simplex.data());
    }
    return cells;
  }

private:
  template <typename Function>
  void ForEachEdge(const Simplex& simplex, Function&& function) const
  {
    for (int k = 0; k < N; ++k)
    {
      for (int j = 0; j < k; ++j)
      {
        const Edge edge{ { std::min(simplex[j], simplex[k]), std::max(simplex[j], simplex[k]) } };
        function(edge, glm::distance(this->Points[edge[0]], this->Points[edge[1]]));
      }
    }
  }

  bool IsTooLong(const Edge& edge, double length) const
  {
    const glm::dvec3& a = this->Points[edge[0]];
    const glm::dvec3 along = this->Points[edge[1]] - a;
    return std::any_of(this->Spheres.begin(), this->Spheres.end(),
      [&](const RefinementSphere& sphere)
      {
        const double t = glm::dot(sphere.Center - a, along) / (length * length);
        const double beyond =
          glm::distance(a + std::clamp(t, 0.0, 1.0) * along, sphere.Center) - sphere.Radius;
        return length >
          this->Share * sphere.EdgeLength + (beyond > 0.0 ? this->Growth * beyond : 0.0);
      });
  }

  void Split(const Edge& edge, const std::vector<std::size_t>& around, std::vector<bool>& split)
  {
    const auto middle = static_cast<vtkIdType>(this->Points.size());
    this->Points.push_back(0.5 * (this->Points[edge[0]] + this->Points[edge[1]]));
    for (const std::size_t i : around)
    {
      split[i] = true;
      Simplex other = this->Simplices[i];
      std::replace(this->Simplices[i].begin(), this->Simplices[i].end(), edge[0], middle);
      std::replace(other.begin(), other.end(), edge[1], middle);
      this->Simplices.push_back(other);
    }
  }

  const std::vector<RefinementSphere>& Spheres;
  std::vector<glm::dvec3> Points;
  double Share;
  double Growth;
  std::vector<Simplex> Simplices;
};

// Whether a point lies in or near another sphere that has its own lattice points there. This is a
// sphere with a shorter edge length, or an earlier sphere with the same edge length.
bool IsTaken(
  const glm::dvec3& point, const std::vector<RefinementSphere>& spheres, std::size_t index)
{
  for (std::size_t i = 0; i < spheres.size(); ++i)
  {
    const bool finer = spheres[i].EdgeLength < spheres[index].EdgeLength ||
      (spheres[i].EdgeLength == spheres[index].EdgeLength && i < index);
    // The lattice of the other sphere extends beyond its radius. Points keep some distance from it.
    if (finer &&
      glm::distance(point, spheres[i].Center) < spheres[i].Radius + 1.5 * spheres[i].EdgeLength)
    {
      return true;
    }
  }
  return false;
}

} // namespace

double EstimateTetrahedra(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres)
{
  double bounds[6];
  surface->GetBounds(bounds);
  vtkNew<vtkMassProperties> properties;
  properties->SetInputData(surface);
  const double area = properties->GetSurfaceArea();
  double count = 0.0;
  for (const RefinementSphere& sphere : spheres)
  {
    // The part of the sphere's bounding cube within the bounds of the surface.
    double volume = 1.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      volume *= std::max(0.0,
        std::min(bounds[2 * axis + 1], sphere.Center[axis] + sphere.Radius) -
          std::max(bounds[2 * axis], sphere.Center[axis] - sphere.Radius));
    }
    const double lattice = LatticeShare * sphere.EdgeLength;
    count += 12.0 * vtkMath::Pi() / 6.0 * volume / (lattice * lattice * lattice);
    count += std::min(area, 4.0 * vtkMath::Pi() * sphere.Radius * sphere.Radius) /
      (std::sqrt(3.0) / 4.0 * lattice * lattice);
  }
  return count;
}

void SplitLongEdges(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres)
{
  SplitMesh<3> split(surface, surface->GetPolys(), spheres, SurfaceShare, SurfaceGrowth);
  while (split.SplitOnce())
  {
  }
  surface->SetPoints(split.MakePoints());
  surface->SetPolys(split.MakeCells());
}

void SplitLongEdges(vtkUnstructuredGrid* mesh, const std::vector<RefinementSphere>& spheres)
{
  SplitMesh<4> split(mesh, mesh->GetCells(), spheres, 1.0, VTK_DOUBLE_MAX);
  while (split.SplitOnce())
  {
  }
  mesh->SetPoints(split.MakePoints());
  mesh->SetCells(VTK_TETRA, split.MakeCells());
}

std::vector<glm::dvec3> MakePoints(
  vtkPolyData* surface, const std::vector<RefinementSphere>& spheres)
{
  std::vector<glm::dvec3> points;
  double bounds[6];
  surface->GetBounds(bounds);
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(surface);
  locator->BuildLocator();
  vtkNew<vtkGenericCell> cell;
  for (std::size_t index = 0; index < spheres.size(); ++index)
  {
    // A body-centered cubic lattice: the tetrahedra of its Delaunay triangulation are congruent,
    // and no edge is longer than the lattice constant.
    const RefinementSphere& sphere = spheres[index];
    const double constant = LatticeShare * sphere.EdgeLength;
    const double radius = sphere.Radius + constant;
    int first[3];
    int last[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double low = std::max(bounds[2 * axis], sphere.Center[axis] - radius);
      const double high = std::min(bounds[2 * axis + 1], sphere.Center[axis] + radius);
      first[axis] = static_cast<int>(std::ceil((low - sphere.Center[axis]) / constant * 2.0));
      last[axis] = static_cast<int>(std::floor((high - sphere.Center[axis]) / constant * 2.0));
    }
    for (int k = first[2]; k <= last[2]; ++k)
    {
      for (int j = first[1]; j <= last[1]; ++j)
      {
        for (int i = first[0]; i <= last[0]; ++i)
        {
          if ((i ^ j) & 1 || (j ^ k) & 1)
          {
            continue;
          }
          const glm::dvec3 offset = 0.5 * constant * glm::dvec3(i, j, k);
          const glm::dvec3 point = sphere.Center + offset;
          if (glm::length(offset) > radius || IsTaken(point, spheres, index))
          {
            continue;
          }
          double closest[3];
          vtkIdType triangle;
          int part;
          double square;
          const double query[3] = { point.x, point.y, point.z };
          if (!locator->FindClosestPointWithinRadius(const_cast<double*>(query),
                Clearance * constant, closest, cell, triangle, part, square))
          {
            points.push_back(point);
          }
        }
      }
    }
  }
  return points;
}

} // namespace deformvolume
