// SPDX-License-Identifier: BSD-3-Clause
// For the tests of vtkDeformVolumeFilter: volumes and meshes that world functions define, and
// checks.
#ifndef FilterTesting_h
#define FilterTesting_h

#include "Observed.h"

#include "../../Reported.h"

#include "vtkDeformVolumeFilter.h"
#include "vtkLatticeTetrahedraSource.h"

#include <vtkAOSDataArrayTemplate.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataArrayRange.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationIntegerVectorKey.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkTypeTraits.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>

namespace filterTesting
{

using Extent = std::array<int, 6>;

inline Extent GetExtent(vtkImageData* image)
{
  Extent extent;
  image->GetExtent(extent.data());
  return extent;
}

inline glm::dvec3 GetPoint(vtkDataSet* dataSet, vtkIdType id)
{
  glm::dvec3 point;
  dataSet->GetPoint(id, &point.x);
  return point;
}

using WorldFunction = std::function<double(const glm::dvec3&)>;
using WorldMap = std::function<glm::dvec3(const glm::dvec3&)>;

/// Adds a point array, whose values are a function of the world position, as active scalars.
template <typename T>
void AddScalars(vtkImageData* image, const char* name, const WorldFunction& function)
{
  vtkSmartPointer<vtkDataArray> made;
  made.TakeReference(vtkDataArray::CreateDataArray(vtkTypeTraits<T>::VTK_TYPE_ID));
  auto* array = static_cast<vtkAOSDataArrayTemplate<T>*>(made.Get());
  array->SetName(name);
  array->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkIdType id = 0; id < image->GetNumberOfPoints(); ++id)
  {
    array->SetValue(id, static_cast<T>(function(GetPoint(image, id))));
  }
  image->GetPointData()->AddArray(array);
  image->GetPointData()->SetActiveScalars(name);
}

inline vtkSmartPointer<vtkImageData> MakeImage(const Extent& extent,
  const glm::dvec3& spacing = glm::dvec3(1.0), const glm::dvec3& origin = glm::dvec3(0.0))
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(extent[0], extent[1], extent[2], extent[3], extent[4], extent[5]);
  image->SetSpacing(spacing.x, spacing.y, spacing.z);
  image->SetOrigin(origin.x, origin.y, origin.z);
  return image;
}

/// A rotation by 30 degrees about z, then by 50 degrees about x.
inline void SetObliqueDirection(vtkImageData* image)
{
  vtkNew<vtkMatrix3x3> direction;
  const double a = std::cos(0.5235987755982988);
  const double b = std::sin(0.5235987755982988);
  const double c = std::cos(0.8726646259971648);
  const double d = std::sin(0.8726646259971648);
  const double elements[9] = { a, -b, 0, c * b, c * a, -d, d * b, d * a, c };
  direction->DeepCopy(elements);
  image->SetDirectionMatrix(direction);
}

/// A volume with scalars "value" that vary from voxel to voxel.
inline vtkSmartPointer<vtkImageData> MakeVolume(const Extent& extent = { { 0, 9, 0, 8, 0, 7 } })
{
  auto volume = MakeImage(extent);
  AddScalars<short>(volume, "value",
    [](const glm::dvec3& p)
    { return 100.0 * std::sin(0.7 * p.x) + 90.0 * std::cos(0.9 * p.y) + 35.0 * p.z; });
  return volume;
}

/// A lattice of tetrahedra that fills bounds, with a number of nodes on each axis.
inline vtkSmartPointer<vtkUnstructuredGrid> MakeTetrahedra(
  const std::array<double, 6>& bounds, const std::array<int, 3>& nodes)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  source->SetNumberOfNodes(nodes[0], nodes[1], nodes[2]);
  source->EqualSpacingOff();
  source->SetBounds(bounds[0], bounds[1], bounds[2], bounds[3], bounds[4], bounds[5]);
  source->Update();
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->ShallowCopy(source->GetOutput());
  return mesh;
}

/// A lattice of tetrahedra over the world bounds of a volume, which are extended by a margin, in
/// world units, on each side. A negative margin makes the lattice smaller than the volume.
inline vtkSmartPointer<vtkUnstructuredGrid> MakeMesh(
  vtkImageData* volume, int nodes = 3, double margin = 0.5)
{
  std::array<double, 6> bounds;
  volume->GetBounds(bounds.data());
  for (std::size_t i = 0; i < 6; ++i)
  {
    bounds[i] += i % 2 == 0 ? -margin : margin;
  }
  return MakeTetrahedra(bounds, { { nodes, nodes, nodes } });
}

/// Sets displacements that move each point to its image by a map.
inline void SetDisplacements(
  vtkDataSet* dataSet, const WorldMap& map, const char* name = "displacement")
{
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName(name);
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(dataSet->GetNumberOfPoints());
  for (vtkIdType id = 0; id < dataSet->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(dataSet, id);
    const glm::dvec3 displacement = map(point) - point;
    vectors->SetTuple(id, &displacement.x);
  }
  dataSet->GetPointData()->SetVectors(vectors);
}

inline WorldMap Shift(double x, double y, double z)
{
  return [=](const glm::dvec3& point) { return point + glm::dvec3(x, y, z); };
}

/// Moves each point of a mesh to its image by a map.
inline void MovePoints(vtkPointSet* mesh, const WorldMap& map)
{
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = map(GetPoint(mesh, id));
    mesh->GetPoints()->SetPoint(id, &point.x);
  }
  mesh->GetPoints()->Modified();
}

/// The world position of a continuous index of an image.
inline glm::dvec3 GetWorld(vtkImageData* image, const glm::dvec3& index)
{
  glm::dvec3 world;
  image->TransformContinuousIndexToPhysicalPoint(&index.x, &world.x);
  return world;
}

inline glm::dvec3 GetVector(vtkDataSet* dataSet, vtkIdType id)
{
  glm::dvec3 vector;
  dataSet->GetPointData()->GetVectors()->GetTuple(id, &vector.x);
  return vector;
}

/// Returns the whole extent that an algorithm announces.
inline Extent GetWholeExtent(vtkAlgorithm* algorithm)
{
  Extent extent;
  algorithm->GetOutputInformation(0)->Get(
    vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
  return extent;
}

/// Copies a mesh, and moves its points by their displacements.
inline vtkSmartPointer<vtkUnstructuredGrid> MoveToDeformed(vtkUnstructuredGrid* mesh)
{
  auto moved = vtkSmartPointer<vtkUnstructuredGrid>::New();
  moved->DeepCopy(mesh);
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(mesh, id) + GetVector(mesh, id);
    moved->GetPoints()->SetPoint(id, &point.x);
  }
  return moved;
}

/// A vtkDeformVolumeFilter under test.
struct Deformed : Observed<vtkDeformVolumeFilter>
{
  Deformed() = default;
  Deformed(vtkDataObject* volume, vtkDataObject* deformation)
  {
    this->Filter->SetInputData(volume);
    this->Filter->SetDeformationData(deformation);
  }

  /// The number of errors of the filter since the last call.
  int TakeErrors()
  {
    const std::string message = this->Observer->GetErrorMessage();
    this->LastError = message;
    int count = 0;
    for (std::size_t at = message.find("ERROR: "); at != std::string::npos;
         at = message.find("ERROR: ", at + 1))
    {
      ++count;
    }
    this->ClearMessages();
    return count;
  }
  std::string TakeWarning()
  {
    const std::string message = this->Observer->GetWarningMessage();
    this->Observer->Clear();
    return message;
  }

  /// Updates the filter, checks that it reports no error, and returns the output.
  vtkImageData* Update()
  {
    this->Filter->Update();
    EXPECT_EQ(this->TakeErrors(), 0) << this->LastError;
    return this->Filter->GetOutput();
  }
  /// Updates the filter, which must report a warning that contains these words. Without words it
  /// must report no warning.
  vtkImageData* Expect(const std::string& words)
  {
    this->Observer->Clear();
    this->Filter->Update();
    const std::string warning = this->Observer->GetWarningMessage();
    EXPECT_TRUE(words.empty() ? warning.empty() : warning.find(words) != std::string::npos)
      << "expected " << (words.empty() ? "no warning" : "a warning with \"" + words + "\"")
      << " instead of \"" << warning << "\"";
    EXPECT_EQ(this->TakeErrors(), 0);
    return this->Filter->GetOutput();
  }
  vtkDataArray* GetValues() { return this->Filter->GetOutput()->GetPointData()->GetScalars(); }
  bool IsCovered(vtkIdType id)
  {
    vtkDataArray* mask = this->Filter->GetOutput()->GetPointData()->GetArray("vtkValidPointMask");
    return mask->GetComponent(id, 0) != 0.0;
  }

  std::string LastError;
};

inline std::string DescribeArray(vtkDataArray* array)
{
  if (!array)
  {
    return "none";
  }
  std::ostringstream text;
  text << (array->GetName() ? array->GetName() : "without a name") << ", "
       << array->GetDataTypeAsString() << ", " << array->GetNumberOfTuples() << " tuples of "
       << array->GetNumberOfComponents() << " components";
  return text.str();
}

/// Whether two arrays have the same type, size and bits.
inline testing::AssertionResult HaveEqualBits(vtkDataArray* first, vtkDataArray* second)
{
  if (!first || !second || first->GetDataType() != second->GetDataType() ||
    first->GetNumberOfComponents() != second->GetNumberOfComponents() ||
    first->GetNumberOfTuples() != second->GetNumberOfTuples())
  {
    return testing::AssertionFailure()
      << "first array: " << DescribeArray(first) << "; second array: " << DescribeArray(second);
  }
  const auto size = static_cast<std::size_t>(first->GetDataTypeSize());
  const auto values = static_cast<std::size_t>(first->GetNumberOfValues());
  const auto* const firstBytes = static_cast<const char*>(first->GetVoidPointer(0));
  const auto* const secondBytes = static_cast<const char*>(second->GetVoidPointer(0));
  if (std::memcmp(firstBytes, secondBytes, values * size) == 0)
  {
    return testing::AssertionSuccess();
  }
  std::ostringstream text;
  text << DescribeArray(first) << ": " << std::setprecision(17);
  std::size_t differences = 0;
  for (std::size_t i = 0; i < values; ++i)
  {
    if (std::memcmp(firstBytes + i * size, secondBytes + i * size, size) != 0 && ++differences == 1)
    {
      const int components = first->GetNumberOfComponents();
      const auto tuple = static_cast<vtkIdType>(i) / components;
      const auto component = static_cast<int>(static_cast<vtkIdType>(i) % components);
      text << "tuple " << tuple << ", component " << component << " is "
           << first->GetComponent(tuple, component) << " in the first array and "
           << second->GetComponent(tuple, component) << " in the second array, ";
    }
  }
  text << differences << " of " << values << " values differ";
  return testing::AssertionFailure() << text.str();
}

/// Adds a mask in which all tetrahedra are active.
inline vtkSmartPointer<vtkUnsignedCharArray> AddActiveTetrahedra(vtkImageData* volume)
{
  auto active = vtkSmartPointer<vtkUnsignedCharArray>::New();
  active->SetName("ActiveTetrahedra");
  active->SetNumberOfTuples(volume->GetNumberOfCells());
  active->Fill(31);
  volume->GetCellData()->AddArray(active);
  return active;
}

/// Whether two images have equal point arrays, extents, origins, spacings and directions.
inline testing::AssertionResult AreEqual(vtkImageData* first, vtkImageData* second)
{
  if (GetExtent(first) != GetExtent(second))
  {
    return testing::AssertionFailure()
      << "the extents are " << testing::PrintToString(GetExtent(first)) << " and "
      << testing::PrintToString(GetExtent(second));
  }
  const glm::dvec3 a = GetPoint(first, first->GetNumberOfPoints() - 1);
  const glm::dvec3 b = GetPoint(second, second->GetNumberOfPoints() - 1);
  if (a != b)
  {
    return testing::AssertionFailure() << "the last points are " << a.x << ' ' << a.y << ' ' << a.z
                                       << " and " << b.x << ' ' << b.y << ' ' << b.z;
  }
  const int arrays = first->GetPointData()->GetNumberOfArrays();
  if (arrays != second->GetPointData()->GetNumberOfArrays())
  {
    return testing::AssertionFailure() << "the numbers of point arrays are " << arrays << " and "
                                       << second->GetPointData()->GetNumberOfArrays();
  }
  for (int i = 0; i < arrays; ++i)
  {
    const testing::AssertionResult equality =
      HaveEqualBits(first->GetPointData()->GetArray(i), second->GetPointData()->GetArray(i));
    if (!equality)
    {
      return equality;
    }
  }
  return testing::AssertionSuccess();
}

/// Whether an image is a part of another one, bit by bit. Arrays are compared by name, because
/// their order changes when images are sent to other ranks.
inline testing::AssertionResult IsPartOf(vtkImageData* part, vtkImageData* whole)
{
  vtkNew<vtkImageData> cropped;
  cropped->ShallowCopy(whole);
  cropped->Crop(part->GetExtent());
  vtkPointData* expected = cropped->GetPointData();
  if (part->GetNumberOfPoints() == 0 || GetExtent(part) != GetExtent(cropped) ||
    GetPoint(part, part->GetNumberOfPoints() - 1) !=
      GetPoint(cropped, part->GetNumberOfPoints() - 1))
  {
    return testing::AssertionFailure() << "the extents or the points differ";
  }
  if (expected->GetNumberOfArrays() < 2)
  {
    return testing::AssertionFailure() << "the whole image has less than two arrays";
  }
  for (int i = 0; i < expected->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = expected->GetArray(i);
    const testing::AssertionResult equality =
      HaveEqualBits(array, part->GetPointData()->GetArray(array->GetName()));
    if (!equality)
    {
      return equality;
    }
  }
  return testing::AssertionSuccess();
}

/// Updates pieces of the output of a filter, and checks that they are equal to those of the whole
/// output.
inline void VerifyPieces(Deformed& deformed, int pieces, vtkImageData* whole)
{
  for (int piece = 0; piece < pieces; ++piece)
  {
    deformed.Filter->UpdatePiece(piece, pieces, 0);
    EXPECT_EQ(deformed.TakeErrors(), 0);
    vtkImageData* part = deformed.Filter->GetOutput();
    EXPECT_TRUE(
      part->GetNumberOfPoints() > 0 && part->GetNumberOfPoints() < whole->GetNumberOfPoints());
    EXPECT_TRUE(IsPartOf(part, whole));
  }
}

} // namespace filterTesting

#endif
