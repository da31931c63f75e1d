// SPDX-License-Identifier: BSD-3-Clause
// Point arrays of the volume: types, components, attributes, labels, background, and cell arrays,
// which are not resampled.
#include "ArrayMaking.h"
#include "DeviceNeeds.h"
#include "FilterTesting.h"

#include <vtkCellData.h>
#include <vtkCharArray.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedLongLongArray.h>

#include <glm/common.hpp>

#include <random>

using namespace filterTesting;

namespace
{

class DeformArrays : public testing::Test
{
  void SetUp() override { SKIP_WITHOUT_DOUBLE_PRECISION() }
};

const Extent Box{ { -3, 6, 2, 9, 0, 8 } };

/// Fills an array with random bytes. Thus floating-point arrays also have denormal numbers,
/// infinities and NaNs.
void FillWithRandomBits(vtkDataArray* array, int components, vtkIdType tuples, unsigned int seed)
{
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  std::mt19937 random(seed);
  auto* bytes = static_cast<unsigned char*>(array->GetVoidPointer(0));
  const vtkIdType size = array->GetNumberOfValues() * array->GetDataTypeSize();
  for (vtkIdType i = 0; i < size; ++i)
  {
    bytes[i] = static_cast<unsigned char>(random());
  }
}

// Without a deformation, arrays of each numeric type, with 1 to 4 components, do not change by a
// bit.
TEST_F(DeformArrays, IdentityOfTypes)
{
  const int types[] = { VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_UNSIGNED_SHORT,
    VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG,
    VTK_FLOAT, VTK_DOUBLE, VTK_ID_TYPE };
  auto volume = MakeImage(Box, glm::dvec3(0.7, 1.3, 2.1), glm::dvec3(11.0, -5.3, 0.123));
  SetObliqueDirection(volume);
  int made = 0;
  for (const int type : types)
  {
    for (int components = 1; components <= 2; ++components)
    {
      vtkSmartPointer<vtkDataArray> array;
      array.TakeReference(vtkDataArray::CreateDataArray(type));
      FillWithRandomBits(array, components, volume->GetNumberOfPoints(), ++made);
      array->SetName(("array " + std::to_string(made)).c_str());
      volume->GetPointData()->AddArray(array);
    }
  }
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->AddCategoricalArray("array 4");
  vtkImageData* output = deformed.Update();
  EXPECT_EQ(GetExtent(output), Box);
  EXPECT_EQ(output->GetPointData()->GetNumberOfArrays(), made + 1);
  for (int i = 1; i <= made; ++i)
  {
    const std::string name = "array " + std::to_string(i);
    EXPECT_TRUE(HaveEqualBits(volume->GetPointData()->GetArray(name.c_str()),
      output->GetPointData()->GetArray(name.c_str())));
  }
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  EXPECT_TRUE(vtkCharArray::SafeDownCast(mask));
  EXPECT_EQ(mask->GetRange()[0], 1.0);
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), output->GetNumberOfPoints());
  EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), 0);
}

TEST_F(DeformArrays, OtherMemoryLayouts)
{
  auto volume = MakeImage(Box);
  vtkNew<vtkSOADataArrayTemplate<float>> planar;
  planar->SetName("planar");
  planar->SetNumberOfComponents(3);
  planar->SetNumberOfTuples(volume->GetNumberOfPoints());
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    for (int component = 0; component < 3; ++component)
    {
      planar->SetTypedComponent(id, component, static_cast<float>(7 * id + component));
    }
  }
  volume->GetPointData()->SetVectors(planar);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(2.0, 0.0, -1.0));
  Deformed deformed(volume, mesh);
  vtkDataArray* result = deformed.Update()->GetPointData()->GetArray("planar");
  EXPECT_EQ(result->GetNumberOfComponents(), 3);
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    for (int component = 0; component < 3; ++component)
    {
      EXPECT_EQ(result->GetComponent(id, component), 7.0 * id + component);
    }
  }
}

TEST_F(DeformArrays, RolesAndFieldData)
{
  auto volume = MakeVolume(Box);
  vtkPointData* data = volume->GetPointData();
  const auto add = [&](const char* name, int components)
  {
    const auto array = MakeArray<vtkIntArray>(name, volume->GetNumberOfPoints(), components);
    array->Fill(3.0);
    for (int i = 0; i < components; ++i)
    {
      array->SetComponentName(i, (std::string(name) + std::to_string(i)).c_str());
    }
    data->AddArray(array);
  };
  add("velocity", 3);
  add("normal", 3);
  add("stress", 9);
  add("texture", 2);
  add("plain", 4);
  data->SetActiveVectors("velocity");
  data->SetActiveNormals("normal");
  data->SetActiveTensors("stress");
  data->SetActiveTCoords("texture");
  vtkNew<vtkStringArray> patient;
  patient->SetName("patient");
  patient->InsertNextValue("somebody");
  volume->GetFieldData()->AddArray(patient);
  vtkNew<vtkStringArray> words;
  words->SetName("words");
  words->SetNumberOfValues(volume->GetNumberOfPoints());
  data->AddArray(words);

  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.5, 0.25, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->Update();
  const std::string warning = deformed.TakeWarning();
  EXPECT_TRUE(HasPart(warning, "words"));
  vtkImageData* output = deformed.Filter->GetOutput();
  vtkPointData* result = output->GetPointData();
  EXPECT_TRUE(result->GetScalars() == result->GetArray("value") && result->GetScalars());
  EXPECT_TRUE(result->GetVectors() == result->GetArray("velocity") && result->GetVectors());
  EXPECT_TRUE(result->GetNormals() == result->GetArray("normal") && result->GetNormals());
  EXPECT_TRUE(result->GetTensors() == result->GetArray("stress") && result->GetTensors());
  EXPECT_TRUE(result->GetTCoords() == result->GetArray("texture") && result->GetTCoords());
  EXPECT_TRUE(result->GetArray("plain"));
  EXPECT_FALSE(result->GetAbstractArray("words"));
  EXPECT_EQ(std::string(result->GetArray("stress")->GetComponentName(8)), "stress8");
  auto* passed = vtkStringArray::SafeDownCast(output->GetFieldData()->GetAbstractArray("patient"));
  EXPECT_TRUE(passed && passed->GetValue(0) == "somebody");
}

// Global and pedigree ids are never interpolated, even if no array is categorical.
TEST_F(DeformArrays, Ids)
{
  auto volume = MakeImage({ { 0, 8, 0, 8, 0, 8 } });
  vtkNew<vtkIdTypeArray> ids[2];
  for (int kind = 0; kind < 2; ++kind)
  {
    ids[kind]->SetName(kind == 0 ? "global" : "pedigree");
    for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
    {
      ids[kind]->InsertNextValue(1000 * id);
    }
  }
  volume->GetPointData()->SetGlobalIds(ids[0]);
  volume->GetPointData()->SetPedigreeIds(ids[1]);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, [](const glm::dvec3& p) { return 1.3 * p; });
  Deformed deformed(volume, mesh);
  vtkPointData* output = deformed.Update()->GetPointData();
  for (vtkAbstractArray* array :
    { static_cast<vtkAbstractArray*>(output->GetGlobalIds()), output->GetPedigreeIds() })
  {
    auto* const found = vtkIdTypeArray::SafeDownCast(array);
    EXPECT_TRUE(found);
    int mixed = 0;
    for (vtkIdType id = 0; found && id < found->GetNumberOfTuples(); ++id)
    {
      mixed += deformed.IsCovered(id) && found->GetValue(id) % 1000 != 0;
    }
    EXPECT_EQ(mixed, 0);
  }
}

TEST_F(DeformArrays, Labels)
{
  auto volume = MakeImage({ { 0, 8, 0, 8, 0, 8 } });
  // Ids that differ in bits which float and double do not have.
  const auto labels = MakeArray<vtkUnsignedLongLongArray>("label", volume->GetNumberOfPoints());
  const unsigned long long base = (1ULL << 60) + 1;
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    labels->SetValue(id, base + static_cast<unsigned long long>(id % 9 / 3) * 2);
  }
  volume->GetPointData()->SetScalars(labels);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh,
    [](const glm::dvec3& p)
    { return glm::dvec3(1.3 * p.x + 0.2 * p.y, 1.1 * p.y - 0.1 * p.z, p.z + 0.15 * p.x); });
  Deformed deformed(volume, mesh);
  deformed.Filter->AddCategoricalArray("label");
  EXPECT_EQ(deformed.Filter->GetNumberOfCategoricalArrays(), 1);
  EXPECT_EQ(std::string(deformed.Filter->GetCategoricalArray(0)), "label");
  EXPECT_EQ(deformed.Filter->GetCategoricalArray(1), nullptr);
  deformed.Update();
  auto* result = vtkUnsignedLongLongArray::SafeDownCast(deformed.GetValues());
  EXPECT_TRUE(result);
  int counts[3] = { 0, 0, 0 };
  for (vtkIdType id = 0; result && id < result->GetNumberOfTuples(); ++id)
  {
    if (deformed.IsCovered(id))
    {
      const unsigned long long label = result->GetValue(id) - base;
      EXPECT_TRUE(label <= 4 && label % 2 == 0);
      ++counts[label % 5 / 2];
    }
    else
    {
      EXPECT_EQ(result->GetValue(id), 0ULL);
    }
  }
  EXPECT_TRUE(counts[0] > 50 && counts[1] > 50 && counts[2] > 50);
  // Labels that are not categorical are interpolated.
  deformed.Filter->RemoveCategoricalArray("label");
  deformed.Update();
  result = vtkUnsignedLongLongArray::SafeDownCast(deformed.GetValues());
  int mixed = 0;
  for (vtkIdType id = 0; id < result->GetNumberOfTuples(); ++id)
  {
    mixed += deformed.IsCovered(id) && (result->GetValue(id) - base) % 2 != 0 ? 1 : 0;
  }
  EXPECT_GT(mixed, 0);
  // A misspelled name is a warning, once.
  deformed.Filter->AddCategoricalArray("Label");
  deformed.Filter->Update();
  EXPECT_TRUE(HasPart(
    deformed.TakeWarning(), "no point arrays with these names of categorical arrays: Label"));
  mesh->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
}

// Nearest interpolation gives the same result as categorical arrays, with both resamplers.
TEST_F(DeformArrays, NearestInterpolation)
{
  auto volume = MakeImage({ { 0, 8, 0, 8, 0, 8 } });
  AddScalars<float>(
    volume, "value", [](const glm::dvec3& p) { return 3.0 * p.x - 5.0 * p.y + 7.0 * p.z; });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh,
    [](const glm::dvec3& p)
    { return glm::dvec3(1.3 * p.x + 0.2 * p.y, 1.1 * p.y - 0.1 * p.z, p.z + 0.4); });
  for (const int resampler :
    { vtkDeformVolumeFilter::EXACT, vtkDeformVolumeFilter::MESH_RASTERIZATION })
  {
    Deformed nearest(volume, mesh);
    nearest.Filter->SetResampler(resampler);
    nearest.Update();
    const vtkSmartPointer<vtkDataArray> linear = nearest.GetValues();
    nearest.Filter->SetInterpolationToNearestInterpolation();
    EXPECT_EQ(nearest.Filter->GetInterpolation(), 2);
    nearest.Update();
    Deformed categorical(volume, mesh);
    categorical.Filter->SetResampler(resampler);
    categorical.Filter->AddCategoricalArray("value");
    categorical.Update();
    EXPECT_TRUE(HaveEqualBits(nearest.GetValues(), categorical.GetValues()));
    EXPECT_FALSE(HaveEqualBits(nearest.GetValues(), linear));
    // Back to linear interpolation.
    nearest.Filter->SetInterpolationToLinearInterpolation();
    nearest.Update();
    EXPECT_TRUE(HaveEqualBits(nearest.GetValues(), linear));
  }
}

TEST_F(DeformArrays, BackgroundAndRounding)
{
  auto volume = MakeImage({ { 0, 4, 0, 4, 0, 4 } });
  AddScalars<unsigned char>(volume, "value", [](const glm::dvec3& p) { return 10.0 * p.x; });
  const auto both = MakeArray<vtkFloatArray>("pair", volume->GetNumberOfPoints(), 2);
  both->Fill(2.0);
  volume->GetPointData()->AddArray(both);
  auto mesh = MakeMesh(volume);
  // The value 10 x, moved by 0.625 voxels, is 3.75 at the second voxel. It is rounded, not
  // truncated.
  SetDisplacements(mesh, Shift(0.625, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetPadding(1);
  deformed.Filter->SetBackgroundValue(-1000.5);
  vtkImageData* output = deformed.Update();
  EXPECT_EQ(GetExtent(output), (Extent{ { 0, 5, -1, 5, -1, 5 } }));
  const double expected[6] = { 0, 4, 14, 24, 34, 0 };
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = GetPoint(output, id);
    const bool inside =
      p.x > 0.6 && p.x < 4.7 && p.y > -0.1 && p.y < 4.1 && p.z > -0.1 && p.z < 4.1;
    EXPECT_EQ(deformed.IsCovered(id), inside);
    EXPECT_EQ(
      deformed.GetValues()->GetComponent(id, 0), inside ? expected[static_cast<int>(p.x)] : 0.0);
    for (int component = 0; component < 2; ++component)
    {
      EXPECT_EQ(output->GetPointData()->GetArray("pair")->GetComponent(id, component),
        inside ? 2.0 : -1000.5);
    }
  }
}

// Programs write the values of an image, and call Modified() of the image only.
TEST_F(DeformArrays, WrittenValues)
{
  auto volume = MakeImage({ { 0, 7, 0, 7, 0, 7 } });
  AddScalars<int>(volume, "dose", [](const glm::dvec3&) { return 1.0; });
  AddScalars<int>(volume, "value", [](const glm::dvec3&) { return 1.0; });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->AddDensityArray("dose");
  for (const int factor : { 1, 2, 1 })
  {
    deformed.Filter->SetSamplingFactor(factor);
    for (int value = 2; value < 5; ++value)
    {
      for (const char* const name : { "value", "dose" })
      {
        static_cast<int*>(volume->GetPointData()->GetArray(name)->GetVoidPointer(0))[0] = value;
      }
      volume->Modified();
      vtkPointData* output = deformed.Update()->GetPointData();
      EXPECT_EQ(output->GetArray("value")->GetTuple1(0), value);
      EXPECT_EQ(output->GetArray("dose")->GetTuple1(0), value);
    }
  }
  // An image that has not been modified is not read again.
  deformed.Filter->RemoveDensityArray("dose");
  deformed.Update();
  const vtkIdType sent = GetReported(deformed.Filter, "Volumes sent");
  mesh->Modified();
  deformed.Update();
  EXPECT_EQ(GetReported(deformed.Filter, "Volumes sent"), sent);
}

TEST_F(DeformArrays, CellArraysAreNamedInAWarning)
{
  auto volume = MakeVolume();
  const auto pressure = MakeArray<vtkFloatArray>("pressure", volume->GetNumberOfCells());
  pressure->Fill(1.0);
  volume->GetCellData()->AddArray(pressure);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->Update();
  const std::string warning = deformed.TakeWarning();
  EXPECT_TRUE(HasPart(warning, "pressure"));
  EXPECT_EQ(deformed.Filter->GetOutput()->GetCellData()->GetNumberOfArrays(), 0);
  EXPECT_EQ(deformed.TakeErrors(), 0);
}

} // namespace
