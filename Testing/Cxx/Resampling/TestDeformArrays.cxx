// SPDX-License-Identifier: BSD-3-Clause
// Point arrays of the volume: types, components, attributes, labels, background, and cell arrays,
// which are not resampled.
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

#include <limits>
#include <random>

using namespace filterTesting;

namespace
{

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
void TestIdentityOfTypes()
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
  VERIFY_EQUAL(GetExtent(output), Box);
  VERIFY_EQUAL(output->GetPointData()->GetNumberOfArrays(), made + 1);
  for (int i = 1; i <= made; ++i)
  {
    const std::string name = "array " + std::to_string(i);
    if (!HaveEqualBits(volume->GetPointData()->GetArray(name.c_str()),
          output->GetPointData()->GetArray(name.c_str())))
    {
      ++GetNumberOfFailures();
      std::cerr << "the array \"" << name << "\" of type "
                << volume->GetPointData()->GetArray(name.c_str())->GetDataTypeAsString()
                << " has not the same bits as that of the volume\n";
    }
  }
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  VERIFY(vtkCharArray::SafeDownCast(mask));
  VERIFY_EQUAL(mask->GetRange()[0], 1.0);
  VERIFY_EQUAL(deformed.Filter->GetNumberOfCoveredVoxels(), output->GetNumberOfPoints());
  VERIFY_EQUAL(deformed.Filter->GetNumberOfInvertedTetrahedra(), 0);
}

void TestOtherMemoryLayouts()
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
  VERIFY_EQUAL(result->GetNumberOfComponents(), 3);
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    for (int component = 0; component < 3; ++component)
    {
      VERIFY_EQUAL(result->GetComponent(id, component), 7.0 * id + component);
    }
  }
}

void TestRolesAndFieldData()
{
  auto volume = MakeVolume(Box);
  vtkPointData* data = volume->GetPointData();
  const auto add = [&](const char* name, int components)
  {
    vtkNew<vtkIntArray> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(volume->GetNumberOfPoints());
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
  VERIFY_CONTAINS(warning, "words");
  vtkImageData* output = deformed.Filter->GetOutput();
  vtkPointData* result = output->GetPointData();
  VERIFY(result->GetScalars() == result->GetArray("value") && result->GetScalars());
  VERIFY(result->GetVectors() == result->GetArray("velocity") && result->GetVectors());
  VERIFY(result->GetNormals() == result->GetArray("normal") && result->GetNormals());
  VERIFY(result->GetTensors() == result->GetArray("stress") && result->GetTensors());
  VERIFY(result->GetTCoords() == result->GetArray("texture") && result->GetTCoords());
  VERIFY(result->GetArray("plain"));
  VERIFY(!result->GetAbstractArray("words"));
  VERIFY_EQUAL(std::string(result->GetArray("stress")->GetComponentName(8)), "stress8");
  auto* passed = vtkStringArray::SafeDownCast(output->GetFieldData()->GetAbstractArray("patient"));
  VERIFY(passed && passed->GetValue(0) == "somebody");
}

// Global and pedigree ids are never interpolated, even if no array is categorical.
void TestIds()
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
    VERIFY(found);
    int mixed = 0;
    for (vtkIdType id = 0; found && id < found->GetNumberOfTuples(); ++id)
    {
      mixed += deformed.IsCovered(id) && found->GetValue(id) % 1000 != 0;
    }
    VERIFY_EQUAL(mixed, 0);
  }
}

void TestLabels()
{
  auto volume = MakeImage({ { 0, 8, 0, 8, 0, 8 } });
  // Ids that differ in bits which float and double do not have.
  vtkNew<vtkUnsignedLongLongArray> labels;
  labels->SetName("label");
  labels->SetNumberOfTuples(volume->GetNumberOfPoints());
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
  VERIFY_EQUAL(deformed.Filter->GetNumberOfCategoricalArrays(), 1);
  VERIFY_EQUAL(std::string(deformed.Filter->GetCategoricalArray(0)), "label");
  VERIFY(deformed.Filter->GetCategoricalArray(1) == nullptr);
  deformed.Update();
  auto* result = vtkUnsignedLongLongArray::SafeDownCast(deformed.GetValues());
  VERIFY(result);
  int counts[3] = { 0, 0, 0 };
  for (vtkIdType id = 0; result && id < result->GetNumberOfTuples(); ++id)
  {
    if (deformed.IsCovered(id))
    {
      const unsigned long long label = result->GetValue(id) - base;
      VERIFY(label <= 4 && label % 2 == 0);
      ++counts[label % 5 / 2];
    }
    else
    {
      VERIFY_EQUAL(result->GetValue(id), 0ULL);
    }
  }
  VERIFY(counts[0] > 50 && counts[1] > 50 && counts[2] > 50);
  // Labels that are not categorical are interpolated.
  deformed.Filter->RemoveCategoricalArray("label");
  deformed.Update();
  result = vtkUnsignedLongLongArray::SafeDownCast(deformed.GetValues());
  int mixed = 0;
  for (vtkIdType id = 0; id < result->GetNumberOfTuples(); ++id)
  {
    mixed += deformed.IsCovered(id) && (result->GetValue(id) - base) % 2 != 0 ? 1 : 0;
  }
  VERIFY(mixed > 0);
  // A misspelled name is a warning, once.
  deformed.Filter->AddCategoricalArray("Label");
  deformed.Filter->Update();
  VERIFY_CONTAINS(
    deformed.TakeWarning(), "no point arrays with these names of categorical arrays: Label");
  mesh->Modified();
  deformed.Filter->Update();
  VERIFY(deformed.TakeWarning().empty());
}

// Nearest interpolation gives the same result as categorical arrays, with both resamplers.
void TestNearestInterpolation()
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
    VERIFY_EQUAL(nearest.Filter->GetInterpolation(), 2);
    nearest.Update();
    Deformed categorical(volume, mesh);
    categorical.Filter->SetResampler(resampler);
    categorical.Filter->AddCategoricalArray("value");
    categorical.Update();
    VERIFY(HaveEqualBits(nearest.GetValues(), categorical.GetValues()));
    VERIFY(!HaveEqualBits(nearest.GetValues(), linear));
    // Back to linear interpolation.
    nearest.Filter->SetInterpolationToLinearInterpolation();
    nearest.Update();
    VERIFY(HaveEqualBits(nearest.GetValues(), linear));
  }
}

void TestBackgroundAndRounding()
{
  auto volume = MakeImage({ { 0, 4, 0, 4, 0, 4 } });
  AddScalars<unsigned char>(volume, "value", [](const glm::dvec3& p) { return 10.0 * p.x; });
  vtkNew<vtkFloatArray> both;
  both->SetName("pair");
  both->SetNumberOfComponents(2);
  both->SetNumberOfTuples(volume->GetNumberOfPoints());
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
  VERIFY_EQUAL(GetExtent(output), (Extent{ { 0, 5, -1, 5, -1, 5 } }));
  const double expected[6] = { 0, 4, 14, 24, 34, 0 };
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = GetPoint(output, id);
    const bool inside =
      p.x > 0.6 && p.x < 4.7 && p.y > -0.1 && p.y < 4.1 && p.z > -0.1 && p.z < 4.1;
    VERIFY_EQUAL(deformed.IsCovered(id), inside);
    VERIFY_EQUAL(
      deformed.GetValues()->GetComponent(id, 0), inside ? expected[static_cast<int>(p.x)] : 0.0);
    for (int component = 0; component < 2; ++component)
    {
      VERIFY_EQUAL(output->GetPointData()->GetArray("pair")->GetComponent(id, component),
        inside ? 2.0 : -1000.5);
    }
  }
}

// Programs write the values of an image, and call Modified() of the image only.
void TestWrittenValues()
{
  auto volume = MakeImage({ { 0, 7, 0, 7, 0, 7 } });
  AddScalars<int>(volume, "dose", [](const glm::dvec3&) { return 1.0; });
  const vtkSmartPointer<vtkDataArray> dose = volume->GetPointData()->GetScalars();
  AddScalars<int>(volume, "value", [](const glm::dvec3&) { return 1.0; });
  volume->GetPointData()->AddArray(dose);
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
      VERIFY_EQUAL(output->GetArray("value")->GetTuple1(0), value);
      VERIFY_EQUAL(output->GetArray("dose")->GetTuple1(0), value);
    }
  }
  // An image that has not been modified is not read again.
  deformed.Filter->RemoveDensityArray("dose");
  deformed.Update();
  const vtkIdType sent = GetReported(deformed.Filter, "Volumes sent");
  mesh->Modified();
  deformed.Update();
  VERIFY_EQUAL(GetReported(deformed.Filter, "Volumes sent"), sent);
}

void TestNotANumberStaysWithinItsTetrahedra()
{
  auto volume = MakeImage({ { 0, 7, 0, 7, 0, 7 } });
  AddScalars<double>(volume, "value", [](const glm::dvec3& p) { return p.x; });
  auto* values = vtkDoubleArray::SafeDownCast(volume->GetPointData()->GetScalars());
  values->SetValue(4 * 64 + 4 * 8 + 4, std::numeric_limits<double>::quiet_NaN());
  auto mesh = MakeMesh(volume);
  SetDisplacements(
    mesh, [](const glm::dvec3& p) { return 3.0 * p + glm::dvec3(0.25, 0.5, 0.125); });
  Deformed deformed(volume, mesh);
  vtkImageData* output = deformed.Update();
  int spoilt = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    if (std::isnan(deformed.GetValues()->GetComponent(id, 0)))
    {
      ++spoilt;
      const glm::dvec3 rest = (GetPoint(output, id) - glm::dvec3(0.25, 0.5, 0.125)) / 3.0;
      const glm::dvec3 distance = glm::abs(rest - 4.0);
      VERIFY(distance.x < 1.01 && distance.y < 1.01 && distance.z < 1.01);
    }
  }
  VERIFY(spoilt > 0);
}

void TestCellArraysAreNamedInAWarning()
{
  auto volume = MakeVolume();
  vtkNew<vtkFloatArray> pressure;
  pressure->SetName("pressure");
  pressure->SetNumberOfTuples(volume->GetNumberOfCells());
  pressure->Fill(1.0);
  volume->GetCellData()->AddArray(pressure);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->Update();
  const std::string warning = deformed.TakeWarning();
  VERIFY_CONTAINS(warning, "pressure");
  VERIFY(deformed.Filter->GetOutput()->GetCellData()->GetNumberOfArrays() == 0);
  VERIFY_EQUAL(deformed.TakeErrors(), 0);
}

} // namespace

int TestDeformArrays(int, char*[])
{
  if (!HasDoublePrecision())
  {
    std::cout << "skipped: the device has no double precision\n";
    return 125; // VTK_SKIP_RETURN_CODE
  }
  TestIdentityOfTypes();
  TestOtherMemoryLayouts();
  TestRolesAndFieldData();
  TestIds();
  TestLabels();
  TestNearestInterpolation();
  TestBackgroundAndRounding();
  TestWrittenValues();
  TestNotANumberStaysWithinItsTetrahedra();
  TestCellArraysAreNamedInAWarning();
  return GetExitCode();
}
