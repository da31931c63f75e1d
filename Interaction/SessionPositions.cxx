// SPDX-License-Identifier: BSD-3-Clause
#include "SessionPositions.h"

#include "VoxelSize.h"

#include "vtkAdaptiveSubdivisionFilter.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDeformGeometryFilter.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <mutex>
#include <vector>

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

// The nodes of a tetrahedron of four or ten nodes, at rest and deformed. A tetrahedron of ten nodes
// gets an eleventh node in its middle, as in vtkDeformVolumeFilter.
struct CellNodes
{
  std::vector<glm::dvec3> Rest;
  std::vector<glm::dvec3> Deformed;
};

using Positions = std::vector<glm::dvec3>;
using Corners = std::array<std::size_t, 4>;

constexpr std::size_t LinearNodes = 4;
constexpr std::size_t QuadraticNodes = 10;

// Returns the tetrahedra into which a cell is split.
const std::vector<Corners>& GetParts(std::size_t numberOfNodes)
{
  static const std::vector<Corners> none;
  static const std::vector<Corners> linear = { { { 0, 1, 2, 3 } } };
  // Four tetrahedra at the corners, and eight around the middle.
  static const std::vector<Corners> quadratic = { { { 0, 4, 6, 7 } }, { { 1, 4, 5, 8 } },
    { { 2, 5, 6, 9 } }, { { 3, 7, 8, 9 } }, { { 10, 4, 6, 7 } }, { { 10, 4, 5, 8 } },
    { { 10, 5, 6, 9 } }, { { 10, 7, 8, 9 } }, { { 10, 4, 5, 6 } }, { { 10, 4, 8, 7 } },
    { { 10, 5, 9, 8 } }, { { 10, 6, 9, 7 } } };
  return numberOfNodes == LinearNodes ? linear : numberOfNodes == QuadraticNodes ? quadratic : none;
}

void AddMiddle(Positions& positions)
{
  glm::dvec3 middle(0.0);
  for (std::size_t i = 0; i < QuadraticNodes; ++i)
  {
    middle += (i < LinearNodes ? -0.125 : 0.25) * positions[i];
  }
  positions.push_back(middle);
}

CellNodes ReadCell(vtkDataSet* mesh, vtkDataArray* vectors, vtkIdList* ids)
{
  CellNodes nodes;
  for (const vtkIdType id : *ids)
  {
    nodes.Rest.push_back(GetPosition(mesh, id));
    nodes.Deformed.push_back(nodes.Rest.back() + GetVector(vectors, id));
  }
  if (nodes.Rest.size() == QuadraticNodes)
  {
    AddMiddle(nodes.Rest);
    AddMiddle(nodes.Deformed);
  }
  return nodes;
}

// Maps a position by the tetrahedron that contains it, or else by the nearest one: that whose
// smallest barycentric coordinate is the largest.
glm::dvec3 MapInMesh(vtkDataSet* mesh, const glm::dvec3& position, Positions CellNodes::*from,
  Positions CellNodes::*to)
{
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  double best = -std::numeric_limits<double>::infinity();
  glm::dvec3 found = position;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells() && best < 0.0; ++cell)
  {
    mesh->GetCellPoints(cell, ids);
    const std::vector<Corners>& parts = GetParts(static_cast<std::size_t>(ids->GetNumberOfIds()));
    const CellNodes nodes = parts.empty() ? CellNodes() : ReadCell(mesh, vectors, ids);
    for (const Corners& part : parts)
    {
      const auto get = [&](Positions CellNodes::*positions, std::size_t i) -> const glm::dvec3&
      { return (nodes.*positions)[part[i]]; };
      const glm::dvec3& origin = get(from, 0);
      const glm::dmat3 edges(get(from, 1) - origin, get(from, 2) - origin, get(from, 3) - origin);
      const glm::dvec3 weights = glm::inverse(edges) * (position - origin);
      const double least =
        std::min({ weights.x, weights.y, weights.z, 1.0 - weights.x - weights.y - weights.z });
      if (least > best) // false if the tetrahedron is flat
      {
        best = least;
        found = get(to, 0) + weights.x * (get(to, 1) - get(to, 0)) +
          weights.y * (get(to, 2) - get(to, 0)) + weights.z * (get(to, 3) - get(to, 0));
      }
    }
  }
  return found;
}

// As FindRestPosition(), but if a field is folded or torn, it does not search for the nearest
// voxel.
glm::dvec3 EstimateRestPosition(vtkDataSet* deformation, const glm::dvec3& deformed)
{
  if (auto* field = vtkImageData::SafeDownCast(deformation))
  {
    glm::dvec3 rest;
    SearchField(field, deformed, rest);
    return rest;
  }
  return MapInMesh(deformation, deformed, &CellNodes::Deformed, &CellNodes::Rest);
}

} // namespace

glm::dvec3 deformvolume::FindRestPosition(vtkDataSet* deformation, const glm::dvec3& deformed)
{
  auto* field = vtkImageData::SafeDownCast(deformation);
  if (!field)
  {
    return EstimateRestPosition(deformation, deformed);
  }
  glm::dvec3 rest;
  return SearchField(field, deformed, rest) ? rest : FindNearestVoxel(field, deformed);
}

glm::dvec3 deformvolume::FindDeformedPosition(vtkDataSet* deformation, const glm::dvec3& rest)
{
  if (auto* field = vtkImageData::SafeDownCast(deformation))
  {
    return rest + Interpolate(field, rest);
  }
  return MapInMesh(deformation, rest, &CellNodes::Rest, &CellNodes::Deformed);
}

vtkSmartPointer<vtkPolyData> deformvolume::MoveToRest(vtkPolyData* sheet, vtkDataSet* deformation)
{
  constexpr double edgesOnBody = 40.0;
  constexpr double mostEdges = 300.0; // on the diagonal of a sheet
  vtkNew<vtkAdaptiveSubdivisionFilter> fine;
  fine->SetInputData(sheet);
  fine->SetMaximumEdgeLength(
    std::max(deformation->GetLength() / edgesOnBody, sheet->GetLength() / mostEdges));
  fine->SetMaximumTriangleArea(VTK_DOUBLE_MAX);
  fine->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  fine->Update();
  const auto rest = vtkSmartPointer<vtkPolyData>::New();
  rest->DeepCopy(fine->GetOutput());
  vtkPoints* points = rest->GetPoints();
  vtkPoints* moved = nullptr;
  vtkDataArray* isMoved = nullptr;
  vtkNew<vtkDeformGeometryFilter> inverse; // is faster than estimates in a mesh
  if (!vtkImageData::SafeDownCast(deformation))
  {
    vtkNew<vtkCallbackCommand> nothing; // without it, points outside are a warning
    inverse->AddObserver(vtkCommand::WarningEvent, nothing);
    inverse->AddObserver(vtkCommand::ErrorEvent, nothing);
    inverse->SetInputData(fine->GetOutput());
    inverse->SetDeformationData(deformation);
    inverse->SetOutsideMode(vtkDeformGeometryFilter::EXTRAPOLATE);
    inverse->InverseOn();
    inverse->Update();
    auto* output = vtkPolyData::SafeDownCast(inverse->GetOutput());
    moved = output && output->GetNumberOfPoints() > 0 ? output->GetPoints() : nullptr;
    isMoved = moved ? output->GetPointData()->GetArray("vtkValidPointMask") : nullptr;
  }
  for (vtkIdType id = 0; id < points->GetNumberOfPoints(); ++id)
  {
    glm::dvec3 position;
    points->GetPoint(id, &position.x);
    if (isMoved && isMoved->GetComponent(id, 0) != 0.0)
    {
      moved->GetPoint(id, &position.x);
    }
    else
    {
      // Points of a sheet can lie outside the tissue, where an estimate is sufficient.
      position = EstimateRestPosition(deformation, position);
    }
    points->SetPoint(id, &position.x);
  }
  return rest;
}
