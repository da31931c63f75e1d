// SPDX-License-Identifier: BSD-3-Clause
#include "ClosedSurface.h"

#include "vtkAdaptiveSubdivisionFilter.h"
#include "vtkCellArray.h"
#include "vtkCleanPolyData.h"
#include "vtkDoubleArray.h"
#include "vtkFeatureEdges.h"
#include "vtkMassProperties.h"
#include "vtkMath.h"
#include "vtkOBBTree.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkQuadricDecimation.h"
#include "vtkTriangleFilter.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/vec3.hpp>

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

// Returns the polygons of a surface, with its points moved to the results of move(point).
template <typename Move>
vtkSmartPointer<vtkPolyData> MovePoints(vtkPolyData* surface, const Move& move)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(surface->GetNumberOfPoints());
  for (vtkIdType id = 0; id < surface->GetNumberOfPoints(); ++id)
  {
    glm::dvec3 point;
    surface->GetPoint(id, &point.x);
    point = move(point);
    points->SetPoint(id, &point.x);
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(points);
  result->SetPolys(surface->GetPolys());
  return result;
}

// Whether all points lie in one plane: the oriented bounding box is thinner than 1e-6 of its
// length.
bool LiesInPlane(vtkPolyData* surface)
{
  // vtkOBBTree has absolute tolerances, and finds infinite boxes for points that are far apart.
  if (!(surface->GetLength() > 0.0))
  {
    return true;
  }
  const double scale = 1.0 / surface->GetLength();
  const glm::dvec3 center = glm::make_vec3(surface->GetCenter());
  const auto scaled =
    MovePoints(surface, [&](const glm::dvec3& point) { return scale * (point - center); });
  double corner[3];
  double axes[3][3]; // the longest first
  double sizes[3];
  vtkNew<vtkOBBTree> tree;
  tree->ComputeOBB(scaled->GetPoints(), corner, axes[0], axes[1], axes[2], sizes);
  return !(vtkMath::Norm(axes[2]) > 1e-6 * vtkMath::Norm(axes[0]));
}

// Makes decimation keep triangles with edges of about the length 1 where the surface is flat or
// straight. Sets the vectors of the surface. There the quadrics of positions have no error, but
// those of squared coordinates have: linear interpolation of a square along an edge is wrong by up
// to a quarter of the squared length.
void LimitEdges(vtkQuadricDecimation* decimation, vtkPolyData* surface)
{
  vtkNew<vtkDoubleArray> squares;
  squares->SetNumberOfComponents(3);
  squares->SetNumberOfTuples(surface->GetNumberOfPoints());
  for (vtkIdType id = 0; id < surface->GetNumberOfPoints(); ++id)
  {
    glm::dvec3 point;
    surface->GetPoint(id, &point.x);
    point *= point;
    squares->SetTuple(id, &point.x);
  }
  double range = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double* const limits = squares->GetRange(axis);
    range = std::max(range, limits[1] - limits[0]);
  }
  surface->GetPointData()->SetVectors(squares);
  decimation->AttributeErrorMetricOn();
  // The filter divides by the range. A smaller factor than a quarter gives longer edges on flat
  // surfaces, a greater one on round surfaces.
  decimation->SetVectorsWeight(0.25 * range);
}

} // namespace

vtkSmartPointer<vtkPolyData> CleanTriangles(vtkPolyData* surface)
{
  // The filters below silently drop or merge cells with points that do not exist or are not finite.
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
  if (LiesInPlane(surface))
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

vtkSmartPointer<vtkPolyData> Decimate(vtkPolyData* surface, double edgeLength)
{
  vtkNew<vtkMassProperties> properties;
  properties->SetInputData(surface);
  const double wanted =
    std::max(20.0, properties->GetSurfaceArea() / (std::sqrt(3.0) / 4.0 * edgeLength * edgeLength));
  const double present = static_cast<double>(surface->GetNumberOfPolys());
  if (present <= wanted)
  {
    return surface;
  }
  // Decimation moves nodes, but adds none: the sides of a cylinder may have none but at their ends.
  const auto split = SplitLongEdges(surface, 1.5 * edgeLength);
  // The decimation has absolute tolerances.
  const glm::dvec3 center = glm::make_vec3(split->GetCenter());
  const double scale = 1.0 / edgeLength;
  const glm::dvec3 shift = -center / edgeLength;
  const auto input =
    MovePoints(split, [&](const glm::dvec3& point) { return scale * point + shift; });
  vtkNew<vtkQuadricDecimation> decimation;
  LimitEdges(decimation, input);
  decimation->SetInputData(input);
  decimation->SetTargetReduction(1.0 - wanted / static_cast<double>(split->GetNumberOfPolys()));
  decimation->VolumePreservationOn();
  // VTK prints a warning for each edge whose equations have no unique solution, and then uses a
  // point on the edge.
  const int displaysWarnings = vtkObject::GetGlobalWarningDisplay();
  vtkObject::GlobalWarningDisplayOff();
  decimation->Update();
  vtkObject::SetGlobalWarningDisplay(displaysWarnings);
  auto decimated = CleanTriangles(MovePoints(
    decimation->GetOutput(), [&](const glm::dvec3& point) { return edgeLength * point + center; }));
  return IsClosedManifold(decimated) ? decimated : nullptr;
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
