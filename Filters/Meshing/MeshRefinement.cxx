// SPDX-License-Identifier: BSD-3-Clause
#include "MeshRefinement.h"

#include "ClosedSurface.h"

#include "vtkCellArray.h"
#include "vtkGenericCell.h"
#include "vtkMath.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace deformvolume
{
namespace
{

// Edges of the surface and of the lattice inside are that much shorter than asked for, since those
// between the two are longer.
constexpr double SurfaceShare = 0.75;
constexpr double LatticeShare = 0.75;
// How close to the surface points of the lattice come, in lattice constants.
constexpr double Clearance = 0.45;
// How much longer edges may be for each unit of length beyond a sphere.
constexpr double Growth = 0.5;

// The longest that an edge between two points may be.
double AllowedLength(
  const glm::dvec3& a, const glm::dvec3& b, const std::vector<RefinementSphere>& spheres)
{
  double allowed = std::numeric_limits<double>::infinity();
  for (const RefinementSphere& sphere : spheres)
  {
    const double beyond = std::max(0.0, GetDistance(sphere.Center, a, b) - sphere.Radius);
    allowed = std::min(allowed, SurfaceShare * sphere.EdgeLength + Growth * beyond);
  }
  return allowed;
}

// A surface of which edges are halved, all of their triangles alike.
class SplitSurface
{
public:
  using Triangle = std::array<vtkIdType, 3>;

  SplitSurface(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres)
    : Spheres(spheres)
  {
    this->Points.resize(surface->GetNumberOfPoints());
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      double point[3];
      surface->GetPoint(static_cast<vtkIdType>(i), point);
      this->Points[i] = glm::dvec3(point[0], point[1], point[2]);
    }
    vtkCellArray* cells = surface->GetPolys();
    vtkIdType size;
    const vtkIdType* ids;
    for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
    {
      this->Triangles.push_back({ { ids[0], ids[1], ids[2] } });
    }
  }

  // Returns whether an edge was too long.
  bool SplitOnce()
  {
    this->Middles.clear();
    const std::size_t before = this->Triangles.size();
    std::vector<Triangle> result;
    result.reserve(before);
    for (const Triangle& triangle : this->Triangles)
    {
      this->Split(triangle, result);
    }
    this->Triangles.swap(result);
    return this->Triangles.size() > before;
  }

  vtkSmartPointer<vtkPolyData> Get() const
  {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const glm::dvec3& point : this->Points)
    {
      points->InsertNextPoint(point.x, point.y, point.z);
    }
    vtkNew<vtkCellArray> cells;
    for (const Triangle& triangle : this->Triangles)
    {
      cells->InsertNextCell(3, triangle.data());
    }
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    surface->SetPoints(points);
    surface->SetPolys(cells);
    return surface;
  }

private:
  // The point in the middle of an edge that is too long, or else -1.
  vtkIdType Middle(vtkIdType from, vtkIdType to)
  {
    const vtkIdType low = std::min(from, to);
    const vtkIdType high = std::max(from, to);
    const std::uint64_t key =
      (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
    const auto known = this->Middles.find(key);
    if (known != this->Middles.end())
    {
      return known->second;
    }
    const glm::dvec3 a = this->Points[low];
    const glm::dvec3 b = this->Points[high];
    vtkIdType middle = -1;
    if (glm::distance(a, b) > AllowedLength(a, b, this->Spheres))
    {
      middle = static_cast<vtkIdType>(this->Points.size());
      this->Points.push_back(0.5 * (a + b));
    }
    this->Middles.emplace(key, middle);
    return middle;
  }

  void Split(const Triangle& triangle, std::vector<Triangle>& result)
  {
    vtkIdType middles[3]; // of the edges that begin at the corners
    int count = 0;
    for (int k = 0; k < 3; ++k)
    {
      middles[k] = this->Middle(triangle[k], triangle[(k + 1) % 3]);
      count += middles[k] >= 0;
    }
    if (count == 0)
    {
      result.push_back(triangle);
      return;
    }
    if (count == 3)
    {
      for (int k = 0; k < 3; ++k)
      {
        result.push_back({ { triangle[k], middles[k], middles[(k + 2) % 3] } });
      }
      result.push_back({ { middles[0], middles[1], middles[2] } });
      return;
    }
    // The corner opposite to the edge that is split, or at the end of the edge that is not, first.
    int first = 0;
    while (count == 1 ? middles[(first + 1) % 3] < 0 : middles[(first + 2) % 3] >= 0)
    {
      ++first;
    }
    const vtkIdType a = triangle[first];
    const vtkIdType b = triangle[(first + 1) % 3];
    const vtkIdType c = triangle[(first + 2) % 3];
    if (count == 1)
    {
      const vtkIdType middle = middles[(first + 1) % 3];
      result.push_back({ { a, b, middle } });
      result.push_back({ { a, middle, c } });
      return;
    }
    // a-b and b-c are split: the corner at b, and a quadrangle with the shorter of its diagonals.
    const vtkIdType ab = middles[first];
    const vtkIdType bc = middles[(first + 1) % 3];
    result.push_back({ { ab, b, bc } });
    if (glm::distance(this->Points[a], this->Points[bc]) <
      glm::distance(this->Points[ab], this->Points[c]))
    {
      result.push_back({ { a, ab, bc } });
      result.push_back({ { a, bc, c } });
    }
    else
    {
      result.push_back({ { a, ab, c } });
      result.push_back({ { ab, bc, c } });
    }
  }

  const std::vector<RefinementSphere>& Spheres;
  std::vector<glm::dvec3> Points;
  std::vector<Triangle> Triangles;
  std::unordered_map<std::uint64_t, vtkIdType> Middles;
};

// Whether a sphere before this one has points here, at least as close together.
bool IsTaken(
  const glm::dvec3& point, const std::vector<RefinementSphere>& spheres, std::size_t index)
{
  for (std::size_t i = 0; i < spheres.size(); ++i)
  {
    const bool finer = spheres[i].EdgeLength < spheres[index].EdgeLength ||
      (spheres[i].EdgeLength == spheres[index].EdgeLength && i < index);
    // As far as its lattice reaches, and a bit more.
    if (finer &&
      glm::distance(point, spheres[i].Center) < spheres[i].Radius + 1.5 * spheres[i].EdgeLength)
    {
      return true;
    }
  }
  return false;
}

} // namespace

double GetDistance(const glm::dvec3& point, const glm::dvec3& a, const glm::dvec3& b)
{
  const glm::dvec3 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0.0 ? std::clamp(glm::dot(point - a, along) / square, 0.0, 1.0) : 0.0;
  return glm::distance(a + t * along, point);
}

double EstimateTetrahedra(vtkPolyData* surface, const std::vector<RefinementSphere>& spheres)
{
  double bounds[6];
  surface->GetBounds(bounds);
  const double area = spheres.empty() ? 0.0 : SurfaceArea(surface);
  double count = 0.0;
  for (const RefinementSphere& sphere : spheres)
  {
    // Of the cube around the sphere, the part in the bounds of the surface.
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

vtkSmartPointer<vtkPolyData> RefineSurface(
  vtkPolyData* surface, const std::vector<RefinementSphere>& spheres)
{
  if (spheres.empty())
  {
    return surface;
  }
  SplitSurface split(surface, spheres);
  while (split.SplitOnce())
  {
  }
  return split.Get();
}

std::vector<glm::dvec3> MakePoints(
  vtkPolyData* surface, const std::vector<RefinementSphere>& spheres)
{
  std::vector<glm::dvec3> points;
  if (spheres.empty())
  {
    return points;
  }
  double bounds[6];
  surface->GetBounds(bounds);
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(surface);
  locator->BuildLocator();
  vtkNew<vtkGenericCell> cell;
  for (std::size_t index = 0; index < spheres.size(); ++index)
  {
    // A body-centred cubic lattice: the tetrahedra of its Delaunay triangulation are all alike, and
    // no edge is longer than the lattice constant.
    const RefinementSphere& sphere = spheres[index];
    const double constant = LatticeShare * sphere.EdgeLength;
    const double reach = sphere.Radius + constant;
    int first[3];
    int last[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double low = std::max(bounds[2 * axis], sphere.Center[axis] - reach);
      const double high = std::min(bounds[2 * axis + 1], sphere.Center[axis] + reach);
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
          if (glm::length(offset) > reach || IsTaken(point, spheres, index))
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
