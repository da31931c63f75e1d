// SPDX-License-Identifier: BSD-3-Clause
#include "RandomDisplacements.h"

#include "WrittenTuples.h"

#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkUnsignedCharArray.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <limits>

namespace fuzz
{

namespace
{

// A map from a point to its displacement, both in voxels.
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

glm::dvec3 GetVoxelPosition(vtkDataSet* points, vtkIdType point, vtkImageData* volume)
{
  double world[3];
  points->GetPoint(point, world);
  glm::dvec3 index(0.0);
  volume->TransformPhysicalPointToContinuousIndex(world, &index.x);
  return index - glm::dvec3(volume->GetExtent()[0], volume->GetExtent()[2], volume->GetExtent()[4]);
}

// Converts a displacement in voxels to world units.
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

glm::dvec3 RoundToSteps(const glm::dvec3& vector)
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
    GetWorldVector(geometry == Geometry::Exact ? RoundToSteps(inVoxels) : inVoxels, volume);
  vectors->SetTuple(point, &world.x);
}

vtkIdType PickTuple(vtkDataArray* array, Random& random)
{
  const vtkIdType count = array->GetNumberOfTuples();
  // Arrays are compared by blocks of 512 tuples.
  return count > 512 && random.Chance(0.1)
    ? random.Pick({ vtkIdType{ 0 }, vtkIdType{ 511 }, vtkIdType{ 512 }, count - 1 })
    : static_cast<vtkIdType>(random.Bits() % static_cast<std::uint64_t>(count));
}

// Makes displacements that are an error. Returns a function that reverts this.
std::function<void()> AddError(
  const vtkSmartPointer<vtkDataArray>& vectors, Random& random, std::ostream& log)
{
  log << "  displacements with an error\n";
  const vtkIdType tuple = PickTuple(vectors, random);
  const int component = random.Int(0, 2);
  const double before = vectors->GetComponent(tuple, component);
  const auto set = [=](double value)
  {
    vectors->SetComponent(tuple, component, value);
    MarkWritten(vectors, tuple, tuple);
  };
  set(random.Pick({ std::numeric_limits<double>::quiet_NaN(),
    std::numeric_limits<double>::infinity(), 1e30, -1e9 }));
  return [=]() { set(before); };
}

// Moves one point, the points near it, or all points.
void MoveSome(vtkDataSet* points, vtkDataArray* vectors, vtkImageData* volume, Random& random,
  Geometry geometry)
{
  const vtkIdType first = PickTuple(vectors, random);
  const glm::dvec3 center = GetVoxelPosition(points, first, volume);
  const bool isOfVoxels = vectors->GetNumberOfTuples() > 20000;
  const double radius = random.Pick({ 0.0, 0.0, 0.0, 6.0, 9.0, isOfVoxels ? 6.0 : 1e3 });
  // A point that moves far folds its cells.
  const double most = random.Pick({ 0.3, radius > 0.0 ? 1.0 : 12.0, radius > 0.0 ? 0.3 : 12.0 }) *
    (isOfVoxels && radius > 0.0 ? 0.3 : 1.0);
  for (vtkIdType point = 0; point < points->GetNumberOfPoints(); ++point)
  {
    if (point == first ||
      (radius > 0.0 && glm::distance(GetVoxelPosition(points, point, volume), center) <= radius))
    {
      SetVector(vectors, point, MakeVector(random, most), volume, geometry);
      MarkWritten(vectors, point, point);
    }
  }
}

void HideSome(vtkImageData* field, Random& random)
{
  const char* const name = vtkDataSetAttributes::GhostArrayName();
  vtkSmartPointer<vtkUnsignedCharArray> ghosts =
    vtkUnsignedCharArray::SafeDownCast(field->GetPointData()->GetArray(name));
  if (ghosts && random.Chance(0.3))
  {
    field->GetPointData()->RemoveArray(name);
    return;
  }
  if (!ghosts)
  {
    ghosts = vtkSmartPointer<vtkUnsignedCharArray>::New();
    ghosts->SetName(name);
    ghosts->SetNumberOfTuples(field->GetNumberOfPoints());
    ghosts->Fill(0);
    field->GetPointData()->AddArray(ghosts);
  }
  ghosts->SetValue(PickTuple(ghosts, random), vtkDataSetAttributes::HIDDENPOINT);
  ghosts->Modified();
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
    SetVector(vectors, point, map(GetVoxelPosition(points, point, volume)), volume, geometry);
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

std::function<void()> EditDisplacements(
  vtkDataSet* points, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log)
{
  const vtkSmartPointer<vtkDataArray> vectors = points->GetPointData()->GetArray(DISPLACEMENTS);
  // A large volume that is folded everywhere takes long.
  const bool isLarge = points->GetNumberOfPoints() > 600;
  const int kind = random.Int(isLarge ? 1 : 0, 15);
  log << "displacements, edit " << kind << '\n';
  if (!vectors || vectors->GetNumberOfTuples() != points->GetNumberOfPoints() || kind == 0)
  {
    SetDisplacements(points, volume, random, geometry, log);
    return {};
  }
  const vtkIdType count = vectors->GetNumberOfTuples();
  if (count == 0)
  {
    return {};
  }
  auto* field = geometry == Geometry::Any ? vtkImageData::SafeDownCast(points) : nullptr;
  switch (kind)
  {
    case 1: // no change
      vectors->Modified();
      return {};
    case 2:
      MoveSome(points, vectors, volume, random, geometry);
      return AddError(vectors, random, log);
    case 3: // fewer tuples than points, in the same array
      if (random.Chance(0.3))
      {
        vectors->SetNumberOfTuples(count - 1);
        vectors->Modified();
        return [=]()
        {
          vectors->SetNumberOfTuples(count);
          vectors->SetTuple3(count - 1, 0.0, 0.0, 0.0);
          vectors->Modified();
        };
      }
      return {};
    case 4: // another array with the same values
    {
      const auto copy = vtkSmartPointer<vtkDataArray>::Take(
        vtkDataArray::CreateDataArray(random.Pick({ VTK_FLOAT, VTK_DOUBLE })));
      copy->DeepCopy(vectors);
      copy->SetName(DISPLACEMENTS);
      points->GetPointData()->AddArray(copy);
      return {};
    }
    case 5:
    {
      const Map map = MakeMap(random, log);
      for (vtkIdType point = 0; point < count && !isLarge; ++point)
      {
        SetVector(vectors, point, map(GetVoxelPosition(points, point, volume)), volume, geometry);
      }
      if (isLarge)
      {
        vectors->Fill(0.25);
      }
      vectors->Modified();
      return {};
    }
    case 6:
      StartLog(vectors);
      return {};
    case 7:
    case 8:
      if (field)
      {
        HideSome(field, random);
        return {};
      }
      [[fallthrough]];
    default:
      MoveSome(points, vectors, volume, random, geometry);
  }
  if (kind == 9) // some changes are not logged
  {
    SetVector(vectors, PickTuple(vectors, random), MakeVector(random, 0.3), volume, geometry);
    vectors->Modified();
  }
  return {};
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
