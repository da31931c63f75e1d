// SPDX-License-Identifier: BSD-3-Clause
#include "SessionPositions.h"

#include "VoxelSize.h"

#include "vtkAdaptiveSubdivisionFilter.h"
#include "vtkCallbackCommand.h"
#include "vtkClipPolyData.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDeformGeometryFilter.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkTriangleFilter.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

namespace
{

glm::dvec3 GetVector(vtkDataArray* vectors, vtkIdType id)
{
  double tuple[3];
  vectors->GetTuple(id, tuple);
  return { tuple[0], tuple[1], tuple[2] };
}

glm::dvec3 GetPosition(vtkDataSet* dataSet, vtkIdType id)
{
  double position[3];
  dataSet->GetPoint(id, position);
  return { position[0], position[1], position[2] };
}

// Trilinear interpolation of displacements, constant outside the field.
glm::dvec3 Interpolate(vtkImageData* field, const glm::dvec3& position)
{
  vtkDataArray* vectors = field->GetPointData()->GetVectors();
  const int* extent = field->GetExtent();
  const double world[3] = { position.x, position.y, position.z };
  double index[3];
  field->TransformPhysicalPointToContinuousIndex(world, index);
  int low[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const double first = extent[2 * axis];
    const double last = extent[2 * axis + 1];
    const double inside = std::clamp(index[axis], first, last);
    low[axis] = static_cast<int>(std::min(std::floor(inside), last - 1.0));
    part[axis] = inside - low[axis];
  }
  glm::dvec3 sum(0.0);
  for (int corner = 0; corner < 8; ++corner)
  {
    int at[3];
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int step = (corner >> axis) & 1;
      at[axis] = low[axis] + step;
      weight *= step == 1 ? part[axis] : 1.0 - part[axis];
    }
    if (weight > 0.0)
    {
      sum += weight * GetVector(vectors, field->ComputePointId(at));
    }
  }
  return sum;
}

struct NearestVoxel
{
  double Square = std::numeric_limits<double>::infinity(); // of the distance
  vtkIdType Id = 0;

  bool IsBetterThan(const NearestVoxel& other) const
  {
    return this->Square < other.Square || (this->Square == other.Square && this->Id < other.Id);
  }
};

// Returns the rest position of the voxel whose deformed position is the nearest. Of equally near
// voxels, takes the first one, so that the result does not depend on the number of threads.
glm::dvec3 FindNearestVoxel(vtkImageData* field, const glm::dvec3& deformed)
{
  vtkDataArray* vectors = field->GetPointData()->GetVectors();
  const bool areFloats = vectors->GetDataType() == VTK_FLOAT && vectors->HasStandardMemoryLayout();
  const float* floats = areFloats ? static_cast<float*>(vectors->GetVoidPointer(0)) : nullptr;
  const int* extent = field->GetExtent();
  const vtkIdType width = extent[1] - extent[0] + 1;
  const glm::dvec3 along = GetPosition(field, 1) - GetPosition(field, 0);
  NearestVoxel best;
  std::mutex mutex;
  vtkSMPTools::For(0, field->GetNumberOfPoints() / width,
    [&](vtkIdType begin, vtkIdType end)
    {
      NearestVoxel nearest;
      for (vtkIdType row = begin; row < end; ++row)
      {
        const glm::dvec3 first = GetPosition(field, row * width) - deformed;
        for (vtkIdType x = 0; x < width; ++x)
        {
          const vtkIdType id = row * width + x;
          const glm::dvec3 vector = floats
            ? glm::dvec3(floats[3 * id], floats[3 * id + 1], floats[3 * id + 2])
            : GetVector(vectors, id);
          const glm::dvec3 distance = first + static_cast<double>(x) * along + vector;
          const NearestVoxel found{ glm::dot(distance, distance), id };
          nearest = found.IsBetterThan(nearest) ? found : nearest;
        }
      }
      const std::lock_guard<std::mutex> lock(mutex);
      best = nearest.IsBetterThan(best) ? nearest : best;
    });
  return GetPosition(field, best.Id);
}

// Returns whether the iteration has converged. It may not if the field is folded or torn.
bool SearchField(vtkImageData* field, const glm::dvec3& deformed, glm::dvec3& rest)
{
  const double tolerance = 1e-3 * deformvolume::GetSmallestVoxelSize(field);
  rest = deformed;
  // Damped by one half, because the displacement may change as much as the position.
  for (int i = 0; i < 60; ++i)
  {
    const glm::dvec3 residual = deformed - rest - Interpolate(field, rest);
    if (glm::length(residual) <= tolerance)
    {
      return true;
    }
    rest += 0.5 * residual;
  }
  return false;
}

// Returns the displacement of the node whose deformed position is the nearest.
glm::dvec3 FindNearestDisplacement(vtkDataSet* mesh, const glm::dvec3& deformed)
{
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  double least = std::numeric_limits<double>::infinity();
  glm::dvec3 nearest(0.0);
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 displacement = GetVector(vectors, id);
    const double distance = glm::distance(GetPosition(mesh, id) + displacement, deformed);
    if (distance < least)
    {
      least = distance;
      nearest = displacement;
    }
  }
  return nearest;
}

// Removes what lies farther from a deformed body than an edge of the subdivided sheet, because the
// time of the subdivision grows with the square of the number of triangles. Returns the whole sheet
// if all of it is far, so that the cut is an edit that can be undone.
vtkSmartPointer<vtkPolyData> CutOffFarParts(
  vtkPolyData* sheet, vtkDataSet* deformation, double edge)
{
  const double most = deformation->GetPointData()->GetVectors()->GetRange(-1)[1] + edge;
  vtkSmartPointer<vtkPolyData> kept = sheet;
  for (int side = 0; side < 6; ++side)
  {
    const double sign = side % 2 == 0 ? 1.0 : -1.0;
    const double border = deformation->GetBounds()[side] - sign * most;
    if (sign * kept->GetBounds()[side] >= sign * border)
    {
      continue;
    }
    vtkNew<vtkPlane> plane;
    double origin[3] = { 0.0, 0.0, 0.0 };
    double normal[3] = { 0.0, 0.0, 0.0 };
    origin[side / 2] = border;
    normal[side / 2] = sign;
    plane->SetOrigin(origin);
    plane->SetNormal(normal);
    vtkNew<vtkClipPolyData> clip;
    clip->SetInputData(kept);
    clip->SetClipFunction(plane);
    clip->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputConnection(clip->GetOutputPort());
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->Update();
    kept = triangles->GetOutput();
    if (kept->GetNumberOfPolys() == 0)
    {
      return sheet;
    }
  }
  return kept;
}

} // namespace

namespace deformvolume
{

PositionSearch::PositionSearch()
{
  vtkNew<vtkCallbackCommand> nothing; // without it, points outside are a warning
  for (int isToRest = 0; isToRest < 2; ++isToRest)
  {
    vtkDeformGeometryFilter* filter = this->Filters[isToRest];
    filter->AddObserver(vtkCommand::WarningEvent, nothing);
    filter->AddObserver(vtkCommand::ErrorEvent, nothing);
    filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, nothing);
    filter->SetOutsideModeToExtrapolate();
    filter->SetInverse(isToRest != 0);
  }
}

PositionSearch::~PositionSearch() = default;

void PositionSearch::MoveWithMesh(vtkPolyData* sheet, vtkDataSet* mesh, bool isToRest)
{
  vtkDeformGeometryFilter* filter = this->Filters[isToRest ? 1 : 0];
  filter->SetInputData(sheet);
  filter->SetDeformationData(mesh);
  if (filter->GetExecutive()->Update(0) == 0)
  {
    throw std::runtime_error("The deformation mesh cannot move positions. Check that its "
                             "displacements are finite.");
  }
  auto* moved = vtkPolyData::SafeDownCast(filter->GetOutput());
  vtkPoints* points = sheet->GetPoints();
  vtkDataArray* isMoved = moved->GetPointData()->GetArray("vtkValidPointMask");
  for (vtkIdType id = 0; id < points->GetNumberOfPoints(); ++id)
  {
    if (isMoved->GetComponent(id, 0) != 0.0)
    {
      points->SetPoint(id, moved->GetPoint(id));
    }
    else
    {
      // Far outside the tissue, where the extrapolated map may have no inverse.
      const glm::dvec3 position = GetPosition(sheet, id);
      const glm::dvec3 rest = position - FindNearestDisplacement(mesh, position);
      points->SetPoint(id, &rest.x);
    }
  }
}

glm::dvec3 PositionSearch::MoveWithMesh(const glm::dvec3& position, vtkDataSet* mesh, bool isToRest)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->InsertNextPoint(&position.x);
  vtkNew<vtkPolyData> sheet;
  sheet->SetPoints(points);
  this->MoveWithMesh(sheet, mesh, isToRest);
  return GetPosition(sheet, 0);
}

glm::dvec3 PositionSearch::FindRestPosition(vtkDataSet* deformation, const glm::dvec3& deformed)
{
  auto* field = vtkImageData::SafeDownCast(deformation);
  if (!field)
  {
    return this->MoveWithMesh(deformed, deformation, true);
  }
  glm::dvec3 rest;
  return SearchField(field, deformed, rest) ? rest : FindNearestVoxel(field, deformed);
}

glm::dvec3 PositionSearch::FindDeformedPosition(vtkDataSet* deformation, const glm::dvec3& rest)
{
  auto* field = vtkImageData::SafeDownCast(deformation);
  return field ? rest + Interpolate(field, rest) : this->MoveWithMesh(rest, deformation, false);
}

vtkSmartPointer<vtkPolyData> PositionSearch::MoveToRest(vtkPolyData* sheet, vtkDataSet* deformation)
{
  constexpr double edgesOnBody = 40.0;
  constexpr double mostEdges = 60.0; // on the diagonal of a sheet
  const double edge = deformation->GetLength() / edgesOnBody;
  const vtkSmartPointer<vtkPolyData> kept = CutOffFarParts(sheet, deformation, edge);
  vtkNew<vtkAdaptiveSubdivisionFilter> fine;
  fine->SetInputData(kept);
  fine->SetMaximumEdgeLength(std::max(edge, kept->GetLength() / mostEdges));
  fine->SetMaximumTriangleArea(VTK_DOUBLE_MAX);
  fine->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  fine->Update();
  const auto rest = vtkSmartPointer<vtkPolyData>::New();
  rest->DeepCopy(fine->GetOutput());
  auto* field = vtkImageData::SafeDownCast(deformation);
  if (!field)
  {
    this->MoveWithMesh(rest, deformation, true);
    return rest;
  }
  vtkPoints* points = rest->GetPoints();
  for (vtkIdType id = 0; id < points->GetNumberOfPoints(); ++id)
  {
    // Where a field is folded or torn, the last estimate is sufficient for a sheet.
    glm::dvec3 position;
    SearchField(field, GetPosition(rest, id), position);
    points->SetPoint(id, &position.x);
  }
  return rest;
}

} // namespace deformvolume
