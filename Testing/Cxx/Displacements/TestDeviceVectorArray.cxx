// SPDX-License-Identifier: BSD-3-Clause
// The interfaces of VTK arrays for vtkDeviceVectorArray, with values on the host and with vectors
// of a device.
#include "FilterTesting.h"
#include "ImageFiles.h"
#include "RunTests.h"
#include "vtkArrayChanges.h"
#include "vtkDeviceVectorArray.h"

#include "Device.h"
#include "DeviceVectors.h"

#include <vtkArrayDispatch.h>
#include <vtkArrayIteratorTemplate.h>
#include <vtkIdList.h>
#include <vtkVariant.h>

#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

using Vectors = std::shared_ptr<deformvolume::DeviceVectors>;

float GetNumber(vtkIdType value)
{
  return 0.25F * static_cast<float>(value) - 3.0F;
}

std::vector<float> MakeNumbers(std::size_t tuples)
{
  std::vector<float> numbers;
  for (std::size_t i = 0; i < 3 * tuples; ++i)
  {
    numbers.push_back(GetNumber(static_cast<vtkIdType>(i)));
  }
  return numbers;
}

bool Has(vtkDataArray* array, const std::vector<float>& numbers)
{
  bool has = array->GetNumberOfValues() == static_cast<vtkIdType>(numbers.size());
  for (vtkIdType tuple = 0; has && tuple < array->GetNumberOfTuples(); ++tuple)
  {
    for (int c = 0; c < 3; ++c)
    {
      has =
        has && array->GetComponent(tuple, c) == numbers[static_cast<std::size_t>(3 * tuple + c)];
    }
  }
  return has;
}

// An array on the host, made by inserting values.
vtkSmartPointer<vtkDeviceVectorArray> MakeByInserting(std::size_t tuples)
{
  auto array = vtkSmartPointer<vtkDeviceVectorArray>::New();
  array->SetName("vectors");
  array->SetNumberOfComponents(3);
  const std::vector<float> numbers = MakeNumbers(tuples);
  for (std::size_t i = 0; i < tuples; ++i)
  {
    array->InsertNextTuple(&numbers[3 * i]);
  }
  return array;
}

Vectors MakeVectors(std::size_t tuples)
{
  const auto vectors = std::make_shared<deformvolume::DeviceVectors>("", tuples);
  vectors->Write(MakeNumbers(tuples).data());
  return vectors;
}

void CheckReading(vtkDeviceVectorArray* array)
{
  constexpr vtkIdType tuples = 50;
  EXPECT_EQ(array->GetNumberOfTuples(), tuples);
  EXPECT_EQ(array->GetNumberOfComponents(), 3);
  EXPECT_EQ(array->GetDataType(), VTK_FLOAT);
  EXPECT_TRUE(Has(array, MakeNumbers(50)));
  EXPECT_EQ(array->GetTuple(7)[1], double{ GetNumber(22) });
  EXPECT_EQ(array->GetValue(149), GetNumber(149));
  float tuple[3];
  array->GetTypedTuple(49, tuple);
  EXPECT_EQ(tuple[2], GetNumber(149));
  EXPECT_EQ(array->GetTypedComponent(3, 1), GetNumber(10));
  EXPECT_EQ(array->GetVariantValue(5).ToFloat(), GetNumber(5));
  EXPECT_EQ(array->LookupValue(vtkVariant(GetNumber(77))), 77);
  double range[2];
  array->GetRange(range, 1);
  EXPECT_EQ(range[0], double{ GetNumber(1) });
  EXPECT_EQ(range[1], double{ GetNumber(148) });
  array->GetRange(range, -1);
  EXPECT_TRUE(range[1] > 50.0 && range[1] < 60.0);
  // Copies into other arrays, and from them.
  vtkNew<vtkFloatArray> floats;
  floats->DeepCopy(array);
  EXPECT_TRUE(Has(floats, MakeNumbers(50)));
  vtkNew<vtkDeviceVectorArray> copy;
  copy->DeepCopy(floats);
  EXPECT_TRUE(Has(copy, MakeNumbers(50)));
  vtkNew<vtkDeviceVectorArray> again;
  again->DeepCopy(array);
  EXPECT_TRUE(Has(again, MakeNumbers(50)));
  vtkNew<vtkIdList> ids;
  ids->InsertNextId(4);
  vtkNew<vtkFloatArray> some;
  some->SetNumberOfComponents(3);
  some->SetNumberOfTuples(1);
  array->GetTuples(ids, some);
  EXPECT_EQ(some->GetValue(1), GetNumber(13));
  // Interfaces of older versions of VTK.
  EXPECT_TRUE(array->HasStandardMemoryLayout());
  EXPECT_EQ(static_cast<float*>(array->GetVoidPointer(11))[0], GetNumber(11));
  vtkSmartPointer<vtkArrayIterator> iterator;
  iterator.TakeReference(array->NewIterator());
  auto* typed = static_cast<vtkArrayIteratorTemplate<float>*>(iterator.Get());
  EXPECT_EQ(typed->GetNumberOfValues(), 150);
  EXPECT_EQ(typed->GetValue(100), GetNumber(100));
  const auto values = vtk::DataArrayValueRange<3>(array);
  EXPECT_EQ(static_cast<float>(values[20]), GetNumber(20));
  auto other = vtkSmartPointer<vtkDataArray>::Take(array->NewInstance());
  EXPECT_TRUE(other->IsA("vtkDeviceVectorArray"));
  EXPECT_EQ(other->GetNumberOfTuples(), 0);
}

void CheckWriting(vtkDeviceVectorArray* array)
{
  std::vector<float> numbers = MakeNumbers(50);
  array->SetComponent(2, 1, 9.0);
  numbers[7] = 9.0F;
  array->SetValue(10, -4.0F);
  numbers[10] = -4.0F;
  const double tuple[3] = { 5.0, 6.0, 7.0 };
  array->SetTuple(20, tuple);
  std::copy(tuple, tuple + 3, numbers.begin() + 60);
  array->InsertTuple(50, tuple);
  numbers.insert(numbers.end(), tuple, tuple + 3);
  EXPECT_TRUE(Has(array, numbers));
  EXPECT_FALSE(array->IsOnDevice());
  array->Resize(51);
  array->RemoveTuple(0);
  numbers.erase(numbers.begin(), numbers.begin() + 3);
  EXPECT_TRUE(Has(array, numbers));
  static_cast<float*>(array->WriteVoidPointer(150, 3))[1] = 8.0F;
  EXPECT_EQ(array->GetNumberOfTuples(), 51);
  EXPECT_EQ(array->GetComponent(50, 1), 8.0);
  array->Squeeze();
  EXPECT_EQ(array->GetComponent(49, 0), 5.0);
  array->SetNumberOfComponents(1);
  array->SetNumberOfTuples(4);
  array->Fill(2.5);
  EXPECT_EQ(array->GetComponent(3, 0), 2.5);
  EXPECT_FALSE(array->GetVectors(deformvolume::ResolveDevice(""))); // has one component
  array->Initialize();
  EXPECT_EQ(array->GetNumberOfTuples(), 0);
}

TEST(DeviceVectorArray, AsAnyArray)
{
  vtkNew<vtkDeviceVectorArray> empty;
  EXPECT_EQ(empty->GetNumberOfTuples(), 0);
  EXPECT_FALSE(empty->IsOnDevice());
  EXPECT_FALSE(empty->GetVectors(deformvolume::ResolveDevice("")));
  empty->Modified();
  empty->SetVectors(nullptr);
  const auto array = MakeByInserting(50);
  CheckReading(array);
  CheckWriting(array);
  // None of these accesses needed vectors on a device.
  EXPECT_EQ(array->GetNumberOfUploads(), 0);
}

TEST(DeviceVectorArray, Vectors)
{
  const Vectors vectors = MakeVectors(50);
  const bool ownMemory = !vectors->AreInHostMemory();
  vtkNew<vtkDeviceVectorArray> array;
  array->SetVectors(vectors);
  EXPECT_TRUE(array->IsOf(vectors));
  EXPECT_EQ(array->IsOnDevice(), ownMemory);
  EXPECT_EQ(array->GetNumberOfDownloads(), 0);
  CheckReading(array);
  EXPECT_EQ(array->GetNumberOfDownloads(), ownMemory ? 1 : 0);
  EXPECT_EQ(array->GetVectors(vectors->GetDevice()) == vectors, ownMemory);
  EXPECT_FALSE(array->GetVectors("another device"));
  // After Modified() the array has the values that the owner of the vectors has written.
  std::vector<float> numbers = MakeNumbers(50);
  numbers[31] = 100.0F;
  vectors->Write(numbers.data(), { { { 10, 11 } } });
  array->Modified();
  EXPECT_TRUE(array->IsOf(vectors));
  EXPECT_TRUE(Has(array, numbers));
  double range[2];
  array->GetRange(range, 1);
  EXPECT_EQ(range[1], 100.0);
  vtkNew<vtkArrayChanges> log;
  log->SetArray(array);
  numbers[31] = 200.0F;
  vectors->Write(numbers.data(), { { { 10, 11 } } });
  log->AddTuples(10, 10);
  EXPECT_TRUE(Has(array, numbers));
  // Writing to the array makes a copy on the host, and does not change the vectors of the owner.
  vectors->Write(MakeNumbers(50).data());
  array->Modified();
  CheckWriting(array);
  EXPECT_FALSE(array->IsOf(vectors));
  const std::vector<float> left(vectors->Read(), vectors->Read() + 150);
  EXPECT_EQ(left, MakeNumbers(50));
  array->SetVectors(vectors);
  EXPECT_TRUE(Has(array, left));
  auto* written = static_cast<float*>(array->GetVoidPointer(0));
  written[0] = 77.0F;
  EXPECT_TRUE(array->IsOf(vectors)); // before Modified()
  array->Modified();
  EXPECT_FALSE(array->IsOf(vectors));
  EXPECT_EQ(array->GetValue(0), 77.0F);
  EXPECT_EQ(array->GetValue(1), GetNumber(1));
  EXPECT_EQ(vectors->Read()[0], GetNumber(0));
}

TEST(DeviceVectorArray, Writer)
{
  const auto image = MakeImage({ { 0, 4, 0, 4, 0, 1 } });
  vtkNew<vtkDeviceVectorArray> array;
  array->SetName("vectors");
  array->SetVectors(MakeVectors(50));
  image->GetPointData()->SetVectors(array);
  const auto found = WriteAndRead(image, "TestDeviceVectorArray.vti");
  vtkDataArray* read = found->GetPointData()->GetArray("vectors");
  EXPECT_TRUE(read && Has(read, MakeNumbers(50)));
  vtkNew<vtkImageData> copy;
  copy->DeepCopy(image);
  EXPECT_TRUE(Has(copy->GetPointData()->GetArray("vectors"), MakeNumbers(50)));
}

// The same deformation by a vtkFloatArray and by a vtkDeviceVectorArray.
void CheckFilter(bool byField)
{
  const auto volume = MakeVolume({ { 0, 69, 0, 66, 0, 63 } }); // its field is read in place
  const vtkSmartPointer<vtkDataSet> floats = byField
    ? vtkSmartPointer<vtkDataSet>(MakeImage({ { 0, 69, 0, 66, 0, 63 } }))
    : vtkSmartPointer<vtkDataSet>(MakeMesh(volume, 9));
  SetDisplacements(floats,
    [](const glm::dvec3& p)
    { return p + glm::dvec3(1.3 * std::sin(0.1 * p.y), 0.7, 0.9 * std::cos(0.07 * p.x)); });
  const auto vectors = vtkSmartPointer<vtkDataSet>::Take(floats->NewInstance());
  vectors->ShallowCopy(floats);
  vtkNew<vtkDeviceVectorArray> array;
  array->SetName("displacement");
  array->DeepCopy(floats->GetPointData()->GetVectors());
  vectors->GetPointData()->SetVectors(array);
  Deformed expected(volume, floats);
  Deformed found(volume, vectors);
  for (const int mode :
    { vtkDeformVolumeFilter::DEFORMED_BOUNDS, vtkDeformVolumeFilter::VOLUME_BOUNDS })
  {
    expected.Filter->SetOutputBoundsMode(mode);
    found.Filter->SetOutputBoundsMode(mode);
    EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  }
  // The same tuples of both arrays are changed: three times without a log, then four times with
  // one.
  const bool ownMemory = deformvolume::GetDeviceAbilities("").OwnMemory;
  constexpr int firstLogged = 3;
  vtkNew<vtkArrayChanges> expectedLog;
  vtkNew<vtkArrayChanges> log;
  auto* changed = vtkFloatArray::SafeDownCast(floats->GetPointData()->GetVectors());
  for (int frame = 0; frame <= 2 * firstLogged; ++frame)
  {
    for (vtkIdType id = 100; id < 110; ++id)
    {
      const float move[3] = { 0.5F * static_cast<float>(frame % firstLogged), 0.25F, -0.5F };
      changed->SetTypedTuple(id, move);
      array->SetTypedTuple(id, move);
    }
    if (frame < firstLogged)
    {
      changed->Modified();
      array->Modified();
    }
    else
    {
      expectedLog->SetArray(changed);
      expectedLog->AddTuples(100, 109);
      log->SetArray(array);
      log->AddTuples(100, 109);
    }
    EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
    // On a device with memory of its own, partial updates need a field with a log. The first update
    // with a log reads the whole array, and the next one computes the bounds that later changes are
    // compared with.
    const bool inPart = !ownMemory || (byField && frame > firstLogged + 1);
    EXPECT_EQ(GetReported(found.Filter, "Bricks resampled"),
      inPart ? GetReported(expected.Filter, "Bricks resampled")
             : GetReported(found.Filter, "Bricks of the volume"));
  }
  // A coarse volume, and vectors that are an array of the volume, too.
  for (Deformed* one : { &expected, &found })
  {
    one->Filter->SetSamplingFactor(2);
  }
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  for (Deformed* one : { &expected, &found })
  {
    one->Filter->SetSamplingFactor(1);
  }
  if (byField)
  {
    Deformed self(floats, floats);
    Deformed sameSelf(vectors, vectors);
    EXPECT_TRUE(AreEqual(self.Update(), sameSelf.Update()));
  }
  // Vectors of a device, written by their owner.
  const auto tuples = static_cast<std::size_t>(array->GetNumberOfTuples());
  const auto shared = std::make_shared<deformvolume::DeviceVectors>("", tuples);
  shared->Write(changed->GetPointer(0));
  array->SetVectors(shared);
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  changed->SetComponent(120, 1, 0.75);
  changed->Modified();
  shared->Write(changed->GetPointer(0), { { { 120, 121 } } });
  array->Modified();
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  array->SetComponent(130, 1, 0.75);
  array->Modified();
  changed->SetComponent(130, 1, 0.75);
  changed->Modified();
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  // The error names the vector that is not finite.
  array->SetComponent(131, 2, std::nan(""));
  array->Modified();
  found.Filter->Update();
  EXPECT_EQ(found.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(found.LastError, " 131 "));
  array->SetComponent(131, 2, changed->GetComponent(131, 2));
  array->Modified();
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
}

} // namespace

TEST(DeviceVectorArray, Filter)
{
  CheckFilter(false);
  CheckFilter(true);
}
