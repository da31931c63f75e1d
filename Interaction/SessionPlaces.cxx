// SPDX-License-Identifier: BSD-3-Clause
#include "SessionPlaces.h"

#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSMPTools.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>

namespace
{

glm::dvec3 GetVector(vtkDataArray* vectors, vtkIdType id)
{
  double tuple[3];
  vectors->GetTuple(id, tuple);
  return { tuple[0], tuple[1], tuple[2] };
}

glm::dvec3 GetPlace(vtkDataSet* dataSet, vtkIdType id)
{
  double place[3];
  dataSet->GetPoint(id, place);
  return { place[0], place[1], place[2] };
}

// Trilinear, and constant outside.
glm::dvec3 Interpolate(vtkImageData* field, const glm::dvec3& place)
{
  vtkDataArray* vectors = field->GetPointData()->GetVectors();
  const int* extent = field->GetExtent();
  const double world[3] = { place.x, place.y, place.z };
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

// The voxel that has come nearest; of equals the first one, whatever the number of threads.
glm::dvec3 FindNearestVoxel(vtkImageData* field, const glm::dvec3& deformed)
{
  vtkDataArray* vectors = field->GetPointData()->GetVectors();
  const bool areFloats = vectors->GetDataType() == VTK_FLOAT && vectors->HasStandardMemoryLayout();
  const float* floats = areFloats ? static_cast<float*>(vectors->GetVoidPointer(0)) : nullptr;
  const int* extent = field->GetExtent();
  const vtkIdType width = extent[1] - extent[0] + 1;
  const glm::dvec3 along = GetPlace(field, 1) - GetPlace(field, 0);
  NearestVoxel best;
  std::mutex mutex;
  vtkSMPTools::For(0, field->GetNumberOfPoints() / width,
    [&](vtkIdType begin, vtkIdType end)
    {
      NearestVoxel nearest;
      for (vtkIdType row = begin; row < end; ++row)
      {
        const glm::dvec3 first = GetPlace(field, row * width) - deformed;
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
  return GetPlace(field, best.Id);
}

// Whether the iteration came to an end; where the body is folded or torn it need not.
bool SearchField(vtkImageData* field, const glm::dvec3& deformed, glm::dvec3& rest)
{
  const double* spacing = field->GetSpacing();
  const double tolerance = 1e-3 * std::min({ spacing[0], spacing[1], spacing[2] });
  rest = deformed;
  // Half of the way each time, as the field may change by as much as the place.
  for (int i = 0; i < 60; ++i)
  {
    const glm::dvec3 left = deformed - rest - Interpolate(field, rest);
    if (glm::length(left) <= tolerance)
    {
      return true;
    }
    rest += 0.5 * left;
  }
  return false;
}

struct Tetrahedron
{
  std::array<glm::dvec3, 4> Rest;
  std::array<glm::dvec3, 4> Deformed;
};

using Corners = std::array<glm::dvec3, 4>;

// The tetrahedron that holds a place, or is nearest by its least barycentric coordinate.
glm::dvec3 MapInMesh(
  vtkDataSet* mesh, const glm::dvec3& place, Corners Tetrahedron::*from, Corners Tetrahedron::*to)
{
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  double best = -std::numeric_limits<double>::infinity();
  glm::dvec3 found = place;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells() && best < 0.0; ++cell)
  {
    mesh->GetCellPoints(cell, ids);
    if (ids->GetNumberOfIds() != 4)
    {
      continue;
    }
    Tetrahedron tetrahedron;
    for (int i = 0; i < 4; ++i)
    {
      tetrahedron.Rest[i] = GetPlace(mesh, ids->GetId(i));
      tetrahedron.Deformed[i] = tetrahedron.Rest[i] + GetVector(vectors, ids->GetId(i));
    }
    const Corners& source = tetrahedron.*from;
    const Corners& target = tetrahedron.*to;
    const glm::dmat3 edges(source[1] - source[0], source[2] - source[0], source[3] - source[0]);
    const glm::dvec3 weights = glm::inverse(edges) * (place - source[0]);
    const double least =
      std::min({ weights.x, weights.y, weights.z, 1.0 - weights.x - weights.y - weights.z });
    if (least > best) // not where the tetrahedron is flat
    {
      best = least;
      found = target[0] + weights.x * (target[1] - target[0]) +
        weights.y * (target[2] - target[0]) + weights.z * (target[3] - target[0]);
    }
  }
  return found;
}

} // namespace

glm::dvec3 deformvolume::EstimateRestPlace(vtkDataSet* deformation, const glm::dvec3& deformed)
{
  if (auto* field = vtkImageData::SafeDownCast(deformation))
  {
    glm::dvec3 rest;
    SearchField(field, deformed, rest);
    return rest;
  }
  return MapInMesh(deformation, deformed, &Tetrahedron::Deformed, &Tetrahedron::Rest);
}

glm::dvec3 deformvolume::FindRestPlace(vtkDataSet* deformation, const glm::dvec3& deformed)
{
  auto* field = vtkImageData::SafeDownCast(deformation);
  if (!field)
  {
    return EstimateRestPlace(deformation, deformed);
  }
  glm::dvec3 rest;
  return SearchField(field, deformed, rest) ? rest : FindNearestVoxel(field, deformed);
}

glm::dvec3 deformvolume::FindDeformedPlace(vtkDataSet* deformation, const glm::dvec3& rest)
{
  if (auto* field = vtkImageData::SafeDownCast(deformation))
  {
    return rest + Interpolate(field, rest);
  }
  return MapInMesh(deformation, rest, &Tetrahedron::Rest, &Tetrahedron::Deformed);
}
