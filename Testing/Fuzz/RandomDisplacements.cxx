// SPDX-License-Identifier: BSD-3-Clause
#include "RandomDisplacements.h"

#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSOADataArrayTemplate.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <functional>
#include <limits>

namespace fuzz
{

namespace
{

// From a point in voxels to its displacement in voxels.
using Map = std::function<glm::dvec3(const glm::dvec3&)>;

glm::dvec3 MakeVector(Random& random, double size)
{
  const double x = random.Real(-size, size);
  const double y = random.Real(-size, size);
  return { x, y, random.Real(-size, size) };
}

Map MakeMap(Random& random, std::ostream& log)
{
  const int kind = random.Int(0, 9);
  log << "displacements " << kind << '\n';
  switch (kind)
  {
    case 0:
      return [](const glm::dvec3&) { return glm::dvec3(0.0); };
    case 1:
    {
      const glm::dvec3 shift(random.Int(-5, 5), random.Int(-5, 5), random.Int(-5, 5));
      return [=](const glm::dvec3&) { return shift; };
    }
    case 2:
    {
      const glm::dvec3 shift = MakeVector(random, 4.0);
      return [=](const glm::dvec3&) { return shift; };
    }
    case 3:
    case 4:
    {
      glm::dmat3 matrix(0.0);
      for (int column = 0; column < 3; ++column)
      {
        matrix[column] = MakeVector(random, kind == 3 ? 0.3 : 1.2);
      }
      return [=](const glm::dvec3& point) { return matrix * point; };
    }
    case 5:
    case 6:
    {
      const glm::dvec3 wave = MakeVector(random, 0.6);
      const glm::dvec3 size = MakeVector(random, 2.0);
      return [=](const glm::dvec3& point) { return std::sin(glm::dot(wave, point)) * size; };
    }
    case 7:
      return [&random](const glm::dvec3&) { return MakeVector(random, 0.4); };
    case 8:
      return [&random](const glm::dvec3&)
      { return random.Chance(0.1) ? MakeVector(random, 6.0) : glm::dvec3(0.0); };
    default:
      return [&random](const glm::dvec3&) { return MakeVector(random, 3.0); };
  }
}

glm::dvec3 GetPlace(vtkDataSet* points, vtkIdType point, vtkImageData* volume)
{
  double world[3];
  points->GetPoint(point, world);
  glm::dvec3 place(0.0);
  volume->TransformPhysicalPointToContinuousIndex(world, &place.x);
  return place - glm::dvec3(volume->GetExtent()[0], volume->GetExtent()[2], volume->GetExtent()[4]);
}

// A displacement in voxels as one in world units.
glm::dvec3 GetWorldVector(const glm::dvec3& vector, vtkImageData* volume)
{
  const double* spacing = volume->GetSpacing();
  glm::dvec3 world(0.0);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      world[row] +=
        volume->GetDirectionMatrix()->GetElement(row, column) * spacing[column] * vector[column];
    }
  }
  return world;
}

glm::dvec3 RoundToGrain(const glm::dvec3& vector)
{
  glm::dvec3 rounded;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double limited = std::fmin(std::fmax(vector[axis], -7.0), 7.0);
    rounded[axis] = std::round(256.0 * limited) / 256.0;
  }
  return rounded;
}

void SetVector(vtkDataArray* vectors, vtkIdType point, const glm::dvec3& inVoxels,
  vtkImageData* volume, Geometry geometry)
{
  const glm::dvec3 world =
    GetWorldVector(geometry == Geometry::Exact ? RoundToGrain(inVoxels) : inVoxels, volume);
  vectors->SetTuple(point, &world.x);
}

void AddError(vtkDataArray* vectors, Random& random, std::ostream& log)
{
  log << "  displacements with an error\n";
  vectors->SetComponent(static_cast<vtkIdType>(
                          random.Bits() % static_cast<std::uint64_t>(vectors->GetNumberOfTuples())),
    random.Int(0, 2),
    random.Pick({ std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
      1e30, -1e9 }));
}

} // namespace

void SetDisplacements(
  vtkDataSet* points, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log)
{
  vtkSmartPointer<vtkDataArray> vectors;
  const int type = geometry == Geometry::Exact ? 0 : random.Int(0, 9);
  switch (type)
  {
    case 7:
      vectors = vtkSmartPointer<vtkSOADataArrayTemplate<float>>::New();
      break;
    case 8:
      vectors = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(VTK_SHORT));
      break;
    default:
      vectors = vtkSmartPointer<vtkDataArray>::Take(
        vtkDataArray::CreateDataArray(type < 4 ? VTK_FLOAT : VTK_DOUBLE));
  }
  vectors->SetName(DISPLACEMENTS);
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(points->GetNumberOfPoints());
  const Map map = MakeMap(random, log);
  for (vtkIdType point = 0; point < points->GetNumberOfPoints(); ++point)
  {
    SetVector(vectors, point, map(GetPlace(points, point, volume)), volume, geometry);
  }
  if (random.Chance(0.02) && points->GetNumberOfPoints() > 0)
  {
    AddError(vectors, random, log);
  }
  if (random.Chance(0.5))
  {
    points->GetPointData()->SetVectors(vectors);
  }
  else
  {
    points->GetPointData()->AddArray(vectors);
  }
}

void EditDisplacements(
  vtkDataSet* points, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log)
{
  const vtkSmartPointer<vtkDataArray> vectors = points->GetPointData()->GetArray(DISPLACEMENTS);
  const int kind = random.Int(0, 11);
  log << "displacements, edit " << kind << '\n';
  if (!vectors || vectors->GetNumberOfTuples() != points->GetNumberOfPoints() || kind == 0)
  {
    SetDisplacements(points, volume, random, geometry, log);
    return;
  }
  const auto count = static_cast<std::uint64_t>(vectors->GetNumberOfTuples());
  if (count == 0)
  {
    return;
  }
  switch (kind)
  {
    case 1: // nothing
      break;
    case 2:
      if (random.Chance(0.3))
      {
        AddError(vectors, random, log);
      }
      break;
    case 3: // shorter than the points, in place
      if (random.Chance(0.3))
      {
        vectors->SetNumberOfTuples(static_cast<vtkIdType>(count) - 1);
      }
      break;
    case 4: // another array with the same values
    {
      const auto copy = vtkSmartPointer<vtkDataArray>::Take(vectors->NewInstance());
      copy->DeepCopy(vectors);
      points->GetPointData()->AddArray(copy);
      break;
    }
    case 5:
    {
      const Map map = MakeMap(random, log);
      for (vtkIdType point = 0; point < points->GetNumberOfPoints(); ++point)
      {
        SetVector(vectors, point, map(GetPlace(points, point, volume)), volume, geometry);
      }
      break;
    }
    default:
      for (int i = random.Pick({ 1, 1, 2, 5 }); i > 0; --i)
      {
        SetVector(vectors, static_cast<vtkIdType>(random.Bits() % count),
          MakeVector(random, random.Pick({ 0.3, 1.0, 5.0 })), volume, geometry);
      }
  }
  vectors->Modified();
}

vtkSmartPointer<vtkImageData> MakeField(
  vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log)
{
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  if (geometry == Geometry::Any && random.Chance(0.7))
  {
    int extent[6];
    volume->GetExtent(extent);
    double first[3];
    volume->TransformContinuousIndexToPhysicalPoint(extent[0] + random.Real(-1.0, 0.5),
      extent[2] + random.Real(-1.0, 0.5), extent[4] + random.Real(-1.0, 0.5), first);
    double spacing[3];
    volume->GetSpacing(spacing);
    int dimensions[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      dimensions[axis] = random.Int(random.Chance(0.05) ? 1 : 2, 7);
      spacing[axis] *= random.Real(0.8, 1.5) * (extent[2 * axis + 1] - extent[2 * axis]) /
        (dimensions[axis] > 1 ? dimensions[axis] - 1 : 1);
    }
    field->SetExtent(0, dimensions[0] - 1, 0, dimensions[1] - 1, 0, dimensions[2] - 1);
    field->SetOrigin(first);
    field->SetSpacing(spacing);
  }
  log << "displacement field of " << field->GetDimensions()[0] << 'x' << field->GetDimensions()[1]
      << 'x' << field->GetDimensions()[2] << '\n';
  SetDisplacements(field, volume, random, geometry, log);
  return field;
}

} // namespace fuzz
