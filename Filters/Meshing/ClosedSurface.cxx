// SPDX-License-Identifier: BSD-3-Clause
#include "ClosedSurface.h"

#include "vtkAdaptiveSubdivisionFilter.h"
#include "vtkCellArray.h"
#include "vtkCleanPolyData.h"
#include "vtkFeatureEdges.h"
#include "vtkMath.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkQuadricDecimation.h"
#include "vtkTriangle.h"
#include "vtkTriangleFilter.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

vtkIdType CountEdges(vtkPolyData* surface, bool boundary, bool nonManifold)
{
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(surface);
  edges->SetBoundaryEdges(boundary);
  edges->SetNonManifoldEdges(nonManifold);
  edges->FeatureEdgesOff();
  edges->ManifoldEdgesOff();
  edges->ColoringOff();
  edges->Update();
  return edges->GetOutput()->GetNumberOfLines();
}

template <typename Function>
void ForEachTriangle(vtkPolyData* surface, Function&& function)
{
  vtkCellArray* triangles = surface->GetPolys();
  vtkIdType size;
  const vtkIdType* ids;
  for (triangles->InitTraversal(); triangles->GetNextCell(size, ids);)
  {
    double corners[3][3];
    for (int k = 0; k < 3; ++k)
    {
      surface->GetPoint(ids[k], corners[k]);
    }
    function(corners);
  }
}

// Whether all points lie in one plane, to double precision: the smallest extent of their ellipsoid
// of inertia against the largest.
bool IsFlat(vtkPolyData* surface)
{
  const vtkIdType count = surface->GetNumberOfPoints();
  double center[3];
  surface->GetCenter(center);
  const double length = surface->GetLength();
  double mean[3] = { 0.0, 0.0, 0.0 };
  double moments[3][3] = { { 0.0 } };
  for (vtkIdType i = 0; i < count; ++i)
  {
    double point[3];
    surface->GetPoint(i, point);
    for (int row = 0; row < 3; ++row)
    {
      point[row] = (point[row] - center[row]) / length;
      mean[row] += point[row] / count;
    }
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        moments[row][column] += point[row] * point[column] / count;
      }
    }
  }
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      moments[row][column] -= mean[row] * mean[column];
    }
  }
  double values[3];
  double vectors[3][3];
  double* rows[3] = { moments[0], moments[1], moments[2] };
  double* columns[3] = { vectors[0], vectors[1], vectors[2] };
  vtkMath::Jacobi(rows, values, columns); // sorted, the largest first
  return !(values[2] > 1e-12 * values[0]);
}

} // namespace

vtkSmartPointer<vtkPolyData> CleanTriangles(vtkPolyData* surface)
{
  // The filters below drop or merge cells with such points without a word.
  const vtkIdType numberOfPoints = surface->GetNumberOfPoints();
  for (vtkCellArray* cells : { surface->GetPolys(), surface->GetStrips() })
  {
    if (!cells->IsValid())
    {
      throw Error("The offsets of the surface's polygons do not fit their connectivity. Correct "
                  "the polygons.");
    }
    vtkIdType size;
    const vtkIdType* ids;
    for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
    {
      for (vtkIdType k = 0; k < size; ++k)
      {
        if (ids[k] < 0 || ids[k] >= numberOfPoints)
        {
          throw Error("A polygon of the surface uses point " + std::to_string(ids[k]) +
            ", and there are only " + std::to_string(numberOfPoints) +
            " points. Correct the polygons.");
        }
        double point[3];
        surface->GetPoint(ids[k], point);
        if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]))
        {
          throw Error("The surface has a point that is not finite (NaN or infinite).");
        }
      }
    }
  }
  auto geometry = vtkSmartPointer<vtkPolyData>::New();
  geometry->SetPoints(surface->GetPoints());
  geometry->SetPolys(surface->GetPolys());
  geometry->SetStrips(surface->GetStrips());
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(geometry);
  triangles->PassVertsOff();
  triangles->PassLinesOff();
  vtkNew<vtkCleanPolyData> clean;
  clean->SetInputConnection(triangles->GetOutputPort());
  clean->SetTolerance(0.0);
  clean->ConvertPolysToLinesOff();
  clean->ConvertLinesToPointsOff();
  clean->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  clean->Update();
  return clean->GetOutput();
}

bool IsClosedManifold(vtkPolyData* surface)
{
  return surface->GetNumberOfPolys() >= 4 && CountEdges(surface, true, true) == 0;
}

void CheckClosedSurface(vtkPolyData* surface)
{
  if (surface->GetNumberOfPolys() == 0)
  {
    throw Error("The surface is empty: it has no polygons.");
  }
  if (IsFlat(surface))
  {
    throw Error("The surface is flat: all its points lie in one plane, so it encloses nothing.");
  }
  if (const vtkIdType open = CountEdges(surface, true, false))
  {
    throw Error("The surface is not closed: " + std::to_string(open) +
      " edges belong to one triangle only. Fill its holes, with vtkFillHolesFilter for instance; "
      "where points only seem to coincide, merge them with vtkCleanPolyData.");
  }
  if (const vtkIdType odd = CountEdges(surface, false, true))
  {
    throw Error("The surface is not manifold: " + std::to_string(odd) +
      " edges belong to more than two triangles. Remove the superfluous triangles.");
  }
}

double SurfaceArea(vtkPolyData* surface)
{
  double area = 0.0;
  ForEachTriangle(surface,
    [&area](const double corners[3][3])
    { area += vtkTriangle::TriangleArea(corners[0], corners[1], corners[2]); });
  return area;
}

double EnclosedVolume(vtkPolyData* surface)
{
  double center[3];
  surface->GetCenter(center);
  double volume = 0.0;
  ForEachTriangle(surface,
    [&](const double corners[3][3])
    {
      double edges[3][3];
      for (int k = 0; k < 3; ++k)
      {
        vtkMath::Subtract(corners[k], center, edges[k]);
      }
      volume += vtkMath::Determinant3x3(edges[0], edges[1], edges[2]) / 6.0;
    });
  return std::abs(volume);
}

vtkSmartPointer<vtkPolyData> Decimate(vtkPolyData* surface, double edgeLength)
{
  const double wanted =
    std::max(20.0, SurfaceArea(surface) / (std::sqrt(3.0) / 4.0 * edgeLength * edgeLength));
  const double present = static_cast<double>(surface->GetNumberOfPolys());
  if (present <= wanted)
  {
    return nullptr;
  }
  vtkNew<vtkQuadricDecimation> decimation;
  decimation->SetInputData(surface);
  decimation->SetTargetReduction(1.0 - wanted / present);
  decimation->VolumePreservationOn();
  decimation->Update();
  return CleanTriangles(decimation->GetOutput());
}

vtkSmartPointer<vtkPolyData> SplitLongEdges(vtkPolyData* surface, double edgeLength)
{
  vtkNew<vtkAdaptiveSubdivisionFilter> subdivision;
  subdivision->SetInputData(surface);
  subdivision->SetMaximumEdgeLength(edgeLength);
  subdivision->SetMaximumTriangleArea(VTK_DOUBLE_MAX);
  subdivision->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  subdivision->Update();
  return CleanTriangles(subdivision->GetOutput());
}

} // namespace deformvolume
