// SPDX-License-Identifier: BSD-3-Clause
// Outputs that stay on a device, which appears to be a graphics card with memory of its own, until
// they are read.
#include "ArrayMaking.h"
#include "FakeDriver.h"
#include "FilterTesting.h"
#include "ImageFiles.h"
#include "RunTests.h"

#include "Device.h"

#include <vtkArrayIteratorTemplate.h>
#include <vtkCallbackCommand.h>
#include <vtkFlyingEdges3D.h>
#include <vtkIdTypeArray.h>
#include <vtkMath.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkShortArray.h>
#include <vtkVariant.h>

#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

using namespace filterTesting;

namespace
{

const Extent VolumeExtent{ { 0, 40, 0, 30, 0, 25 } };
constexpr int NumberOfArrays = 6; // including vtkValidPointMask
constexpr int MostUnread = 5;     // without the ids, which are always copied to the host

// A volume with arrays of several types, with ids, and with an array of two components.
vtkSmartPointer<vtkImageData> MakeArrays()
{
  const auto volume = MakeVolume(VolumeExtent);
  vtkPointData* points = volume->GetPointData();
  AddScalars<double>(volume, "double", [](const glm::dvec3& p) { return p.x * 0.3 - p.y; });
  AddScalars<unsigned char>(volume, "byte", [](const glm::dvec3& p) { return p.z + p.x; });
  // Consecutive ids are equal when they are rounded to doubles.
  const auto ids = MakeArray<vtkIdTypeArray>("id", volume->GetNumberOfPoints());
  for (vtkIdType i = 0; i < ids->GetNumberOfValues(); ++i)
  {
    ids->SetValue(i, (vtkIdType{ 1 } << 60) + i);
  }
  points->SetGlobalIds(ids);
  vtkNew<vtkFloatArray> two;
  two->SetName("two");
  two->SetNumberOfComponents(2);
  two->SetComponentName(1, "second");
  two->SetNumberOfTuples(volume->GetNumberOfPoints());
  for (vtkIdType i = 0; i < two->GetNumberOfValues(); ++i)
  {
    two->SetValue(i, static_cast<float>(i % 997));
  }
  points->AddArray(two);
  points->SetActiveScalars("value");
  return volume;
}

const WorldMap Bend = [](const glm::dvec3& p)
{ return p + glm::dvec3(1.3 * std::sin(0.1 * p.y), 0.7, 0.9 * std::cos(0.07 * p.x)); };

// A filter whose output stays on the device, and one whose output does not.
struct Both
{
  explicit Both(vtkImageData* volume = MakeArrays(), int nodes = 9)
    : Volume(volume)
    , Mesh(MakeMesh(volume, nodes))
    , Found(volume, this->Mesh)
    , Expected(volume, this->Mesh)
  {
    SetDisplacements(this->Mesh, Bend);
    this->Found.Filter->OutputOnDeviceOn();
    for (Deformed* one : { &this->Found, &this->Expected })
    {
      one->Filter->SetBackgroundValue(7.0);
      one->Filter->SetOutputBoundsModeToVolumeBounds();
    }
  }
  void Move(double by, vtkIdType node = -1)
  {
    auto* vectors = vtkFloatArray::SafeDownCast(this->Mesh->GetPointData()->GetVectors());
    const vtkIdType first = std::max<vtkIdType>(node, 0);
    const vtkIdType last = node < 0 ? vectors->GetNumberOfTuples() - 1 : node;
    for (vtkIdType i = first; i <= last; ++i)
    {
      vectors->SetComponent(i, 0, vectors->GetComponent(i, 0) + by);
    }
    vectors->Modified();
  }
  vtkImageData* Update()
  {
    this->Expected.Update();
    return this->Found.Update();
  }
  // Compares an output with the expected one, and thus reads all arrays.
  void Check(vtkImageData* image)
  {
    EXPECT_TRUE(AreEqual(this->Expected.Filter->GetOutput(), image));
  }
  int GetNumberOfUnread() { return GetReported(this->Found.Filter, "Arrays on the device"); }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Found;
  Deformed Expected;
};

std::uint64_t CountRead(const std::function<void()>& function)
{
  FakeDriver::Get().BytesRead = 0;
  function();
  return FakeDriver::Get().BytesRead;
}

std::uint64_t GetBytes(vtkDataArray* array)
{
  return static_cast<std::uint64_t>(array->GetNumberOfValues()) *
    static_cast<std::uint64_t>(array->GetDataTypeSize());
}

vtkDataArray* GetArray(vtkImageData* image, const char* name)
{
  return image->GetPointData()->GetArray(name);
}

// An array is copied to the host when it is read for the first time, and only once.
TEST(OutputOnDevice, Reading)
{
  Both both;
  vtkImageData* image = nullptr;
  both.Update();
  both.Move(0.25);
  both.Expected.Update();
  const std::uint64_t copied = CountRead([&] { image = both.Found.Update(); });
  const std::uint64_t ids = GetBytes(GetArray(image, "id"));
  EXPECT_LT(copied - ids, 30000);
  EXPECT_EQ(both.GetNumberOfUnread(), MostUnread);
  EXPECT_EQ(both.Found.Filter->GetNumberOfCoveredVoxels(),
    both.Expected.Filter->GetNumberOfCoveredVoxels());
  // The description of an array can be read without a copy.
  vtkDataArray* value = GetArray(image, "value");
  EXPECT_EQ(value, image->GetPointData()->GetScalars());
  EXPECT_EQ(value->GetDataType(), VTK_SHORT);
  EXPECT_NE(vtkIdTypeArray::SafeDownCast(GetArray(image, "id")), nullptr); // is always on the host
  EXPECT_EQ(value->GetNumberOfTuples(), image->GetNumberOfPoints());
  EXPECT_EQ(GetArray(image, "two")->GetNumberOfComponents(), 2);
  EXPECT_EQ(std::string(GetArray(image, "two")->GetComponentName(1)), "second");
  EXPECT_EQ(image->GetScalarType(), VTK_SHORT);
  EXPECT_TRUE(value->HasStandardMemoryLayout());
  vtkNew<vtkImageData> shallow;
  shallow->ShallowCopy(image);
  EXPECT_EQ(both.GetNumberOfUnread(), MostUnread);
  std::uint64_t read = CountRead([&] { value->GetComponent(100, 0); });
  EXPECT_EQ(read, GetBytes(value));
  EXPECT_EQ(both.GetNumberOfUnread(), MostUnread - 1);
  read = CountRead([&] { both.Check(shallow); });
  std::uint64_t others = 0;
  for (int i = 0; i < NumberOfArrays; ++i)
  {
    others += GetBytes(image->GetPointData()->GetArray(i));
  }
  EXPECT_EQ(read, others - GetBytes(value) - ids);
  EXPECT_EQ(CountRead([&] { both.Check(image); }), 0U);
  EXPECT_EQ(both.GetNumberOfUnread(), 0);
}

// Each interface for reading is tested as the first access to an output.
TEST(OutputOnDevice, Interfaces)
{
  using Access = std::function<double(vtkDataArray*)>;
  constexpr vtkIdType id = 12345;
  const std::vector<Access> accesses = {
    [](vtkDataArray* array) { return array->GetComponent(id, 0); },
    [](vtkDataArray* array) { return array->GetTuple1(id); },
    [](vtkDataArray* array) { return array->GetTuple(id)[0]; },
    [](vtkDataArray* array) { return array->GetVariantValue(id).ToDouble(); },
    [](vtkDataArray* array)
    { return static_cast<double>(static_cast<short*>(array->GetVoidPointer(0))[id]); },
    [](vtkDataArray* array)
    { return static_cast<double>(static_cast<short*>(array->GetVoidPointer(id))[0]); },
    [](vtkDataArray* array)
    { return static_cast<double>(static_cast<short*>(array->WriteVoidPointer(0, 1))[id]); },
    [](vtkDataArray* array)
    {
      const auto iterator = vtkSmartPointer<vtkArrayIterator>::Take(array->NewIterator());
      return static_cast<double>(
        static_cast<vtkArrayIteratorTemplate<short>*>(iterator.Get())->GetValue(id));
    },
    [](vtkDataArray* array)
    {
      vtkNew<vtkShortArray> copy;
      copy->DeepCopy(array);
      return static_cast<double>(copy->GetValue(id));
    },
    [](vtkDataArray* array)
    {
      vtkNew<vtkShortArray> copy;
      copy->ShallowCopy(array);
      return static_cast<double>(copy->GetValue(id));
    },
    [](vtkDataArray* array)
    {
      const auto copy = vtkSmartPointer<vtkDataArray>::Take(array->NewInstance());
      EXPECT_NE(vtkShortArray::SafeDownCast(copy), nullptr);
      copy->InsertNextTuple(id, array);
      return copy->GetComponent(0, 0);
    },
    [](vtkDataArray* array) { return static_cast<double>(vtk::DataArrayValueRange(array)[id]); },
    [](vtkDataArray* array)
    {
      vtkNew<vtkShortArray> copy;
      copy->SetNumberOfTuples(3);
      array->GetTuples(id - 1, id + 1, copy);
      return static_cast<double>(copy->GetValue(1));
    },
    [](vtkDataArray* array)
    {
      array->SetComponent(0, 0, 5.0); // does not change other values
      return array->GetComponent(id, 0);
    },
    [](vtkDataArray* array)
    {
      array->Resize(2 * array->GetNumberOfTuples());
      return array->GetComponent(id, 0);
    },
    [](vtkDataArray* array)
    {
      const double five = 5.0;
      array->InsertNextTuple(&five);
      EXPECT_EQ(array->GetComponent(array->GetNumberOfTuples() - 1, 0), five);
      return array->GetComponent(id, 0);
    },
    [](vtkDataArray* array)
    {
      array->RemoveFirstTuple();
      return array->GetComponent(id - 1, 0);
    },
    [](vtkDataArray* array)
    {
      // Look up a value of the array: another tuple may have the same value.
      const double value = array->GetComponent(id, 0);
      const vtkIdType found = array->LookupValue(vtkVariant(static_cast<short>(value)));
      return array->GetComponent(found, 0);
    },
  };
  Both both;
  for (std::size_t i = 0; i < accesses.size(); ++i)
  {
    both.Move(0.01);
    vtkDataArray* value = GetArray(both.Update(), "value");
    EXPECT_EQ(both.GetNumberOfUnread(), MostUnread);
    const double found = accesses[i](value);
    const double expected =
      GetArray(both.Expected.Filter->GetOutput(), "value")->GetComponent(id, 0);
    EXPECT_EQ(found, expected) << "in accesses[" << i << "]";
    EXPECT_EQ(both.GetNumberOfUnread(), MostUnread - 1);
  }
  // Values that were written to an output are not in the next output.
  both.Move(0.01);
  both.Check(both.Update());
  double expected[2];
  double found[2];
  for (const int component : { 0, 1, -1 })
  {
    both.Move(0.01);
    vtkDataArray* two = GetArray(both.Update(), "two");
    two->GetRange(found, component);
    GetArray(both.Expected.Filter->GetOutput(), "two")->GetRange(expected, component);
    EXPECT_TRUE(found[0] == expected[0] && found[1] == expected[1]);
    // The range of written values.
    two->SetComponent(100, 0, -5000.0);
    two->SetComponent(200, 1, std::nan(""));
    two->SetComponent(300, 1, vtkMath::Inf());
    two->Modified();
    two->GetRange(found, 0);
    EXPECT_EQ(found[0], -5000.0);
    two->GetFiniteRange(found, 1);
    EXPECT_LT(found[1], 1000.0);
    two->GetRange(found, 1);
    EXPECT_EQ(found[1], vtkMath::Inf());
    // The range after the number of tuples has changed.
    two->SetNumberOfTuples(99);
    two->Modified();
    two->GetRange(found, 0);
    EXPECT_GE(found[0], 0.0);
    const double tuple[2] = { 5000.0, 0.0 };
    two->InsertNextTuple(tuple);
    two->Modified();
    two->GetRange(found, 0);
    EXPECT_EQ(found[1], 5000.0);
  }
}

// Ranges of arrays whose numbers of components or tuples have changed.
TEST(OutputOnDevice, RangesOfOtherShapes)
{
  Both both;
  vtkImageData* image = both.Update();
  double range[2];
  vtkDataArray* const shaped = GetArray(image, "value");
  shaped->SetNumberOfComponents(3);
  EXPECT_EQ(shaped->GetNumberOfTuples(), image->GetNumberOfPoints() / 3);
  shaped->GetRange(range, 2);
  double most = shaped->GetComponent(0, 2);
  for (vtkIdType i = 0; i < shaped->GetNumberOfTuples(); ++i)
  {
    most = std::max(most, shaped->GetComponent(i, 2));
  }
  EXPECT_EQ(range[1], most);
  vtkDataArray* const grown = GetArray(image, "byte");
  grown->InsertNextTuple1(255.0);
  grown->Modified();
  grown->GetRange(range);
  EXPECT_EQ(range[1], 255.0);
  grown->GetFiniteRange(range);
  EXPECT_EQ(range[1], 255.0);
}

// An array of the output that is emptied and filled again is an ordinary array.
TEST(OutputOnDevice, AsAnyArray)
{
  Both both;
  both.Update();
  vtkDataArray* two = GetArray(both.Found.Filter->GetOutput(), "two");
  EXPECT_EQ(CountRead([&] { two->Initialize(); }), 0U); // the values are not needed
  EXPECT_EQ(two->GetNumberOfTuples(), 0);
  EXPECT_EQ(two->GetVoidPointer(0), nullptr);
  two->SetNumberOfComponents(3);
  for (int i = 0; i < 100; ++i)
  {
    const double tuple[3] = { 1.0 * i, 2.0 * i, 3.0 * i };
    two->InsertNextTuple(tuple);
  }
  two->Squeeze();
  EXPECT_EQ(two->GetNumberOfTuples(), 100);
  EXPECT_EQ(two->GetComponent(99, 2), 297.0);
  EXPECT_EQ(two->GetComponent(3, 1), 6.0);
  two->SetNumberOfTuples(2);
  two->Fill(4.5);
  EXPECT_EQ(two->GetComponent(1, 2), 4.5);
  both.Move(0.2);
  both.Check(both.Update());
}

// Filters, copies and writers of VTK.
TEST(OutputOnDevice, Filters)
{
  Both both;
  const auto compare = [&](const std::function<vtkSmartPointer<vtkDataObject>(vtkImageData*)>& run)
  {
    both.Move(0.1);
    both.Update();
    const auto found = run(both.Found.Filter->GetOutput());
    const auto expected = run(both.Expected.Filter->GetOutput());
    if (auto* image = vtkImageData::SafeDownCast(found))
    {
      EXPECT_TRUE(AreEqual(vtkImageData::SafeDownCast(expected), image));
      return;
    }
    auto* points = vtkPolyData::SafeDownCast(found);
    auto* others = vtkPolyData::SafeDownCast(expected);
    EXPECT_GT(points->GetNumberOfPoints(), 100);
    EXPECT_TRUE(HaveEqualBits(points->GetPoints()->GetData(), others->GetPoints()->GetData()));
  };
  compare(
    [](vtkImageData* image)
    {
      vtkNew<vtkFlyingEdges3D> contour;
      contour->SetInputData(image);
      contour->SetValue(0, 400.0);
      contour->Update();
      return vtkSmartPointer<vtkDataObject>(contour->GetOutput());
    });
  compare(
    [](vtkImageData* image)
    {
      vtkNew<vtkImageData> copy;
      copy->DeepCopy(image);
      EXPECT_NE(vtkShortArray::SafeDownCast(GetArray(copy, "value")), nullptr);
      EXPECT_NE(vtkIdTypeArray::SafeDownCast(GetArray(copy, "id")), nullptr);
      return vtkSmartPointer<vtkDataObject>(copy);
    });
  compare([](vtkImageData* image)
    { return vtkSmartPointer<vtkDataObject>(WriteAndRead(image, "TestOutputOnDevice.vti")); });
  // The output as the volume of another filter on the same device.
  both.Move(0.1);
  both.Update();
  Deformed again(both.Found.Filter->GetOutput(), both.Mesh);
  Deformed expected(both.Expected.Filter->GetOutput(), both.Mesh);
  again.Filter->OutputOnDeviceOn();
  EXPECT_TRUE(AreEqual(expected.Update(), again.Update()));
}

// An output that a caller holds does not change when the filter executes again.
TEST(OutputOnDevice, HeldOutputs)
{
  Both both;
  vtkNew<vtkImageData> held;
  vtkNew<vtkImageData> wanted;
  const auto hold = [&]
  {
    both.Move(0.3);
    held->ShallowCopy(both.Update());
    wanted->DeepCopy(both.Expected.Filter->GetOutput());
    EXPECT_EQ(both.GetNumberOfUnread(), MostUnread);
  };
  const auto check = [&]
  {
    EXPECT_TRUE(AreEqual(wanted, held));
    EXPECT_EQ(CountRead([&] { EXPECT_TRUE(AreEqual(wanted, held)); }), 0U);
  };
  hold();
  for (int i = 0; i < 3; ++i) // another whole output, while the last one is held
  {
    both.Move(0.3);
    both.Check(both.Update());
    check();
    hold();
  }
  both.Move(0.3, 400); // a partial update, in the same memory
  both.Check(both.Update());
  check();
  hold();
  both.Found.Filter->SetResamplerToMeshRasterization();
  both.Expected.Filter->SetResamplerToMeshRasterization();
  both.Move(0.3);
  both.Check(both.Update());
  check();
  hold();
  both.Found.Filter->SetSamplingFactor(2);
  both.Expected.Filter->SetSamplingFactor(2);
  both.Check(both.Update());
  check();
  hold();
  both.Found.Filter->OutputOnDeviceOff();
  both.Move(0.3);
  both.Check(both.Update());
  EXPECT_EQ(both.GetNumberOfUnread(), 0);
  check();
  both.Found.Filter->OutputOnDeviceOn();
  both.Found.Filter->SetResamplerToExact();
  both.Expected.Filter->SetResamplerToExact();
  hold();
  // A failed execution.
  both.Found.Filter->SetDisplacementScale(std::nan(""));
  both.Found.Filter->Update();
  EXPECT_EQ(both.Found.TakeErrors(), 1);
  both.Found.Filter->SetDisplacementScale(1.0);
  check();
  hold();
  // An output that is released is not copied to the host.
  held->Initialize();
  both.Move(0.3);
  both.Expected.Update();
  EXPECT_LT(CountRead([&] { both.Found.Update(); }),
    GetBytes(GetArray(both.Found.Filter->GetOutput(), "id")) + 30000);
  hold();
  both.Found.Filter->ReleaseDeviceMemory();
  EXPECT_EQ(both.GetNumberOfUnread(), 0);
  EXPECT_EQ(both.Found.Filter->GetDeviceMemory(), 0);
  check();
  // The held output is written: the next output has other memory.
  hold();
  GetArray(held, "value")->Fill(3.0);
  both.Move(0.3, 400);
  both.Check(both.Update());
  EXPECT_EQ(GetArray(held, "value")->GetComponent(77, 0), 3.0);
  // The output is written and not held: the next output must not be an update of it.
  both.Move(0.3, 400);
  both.Check(both.Update());
  vtkDataArray* value = GetArray(both.Found.Filter->GetOutput(), "value");
  value->Fill(4.0);
  value->Modified();
  held->Initialize();
  both.Move(0.3, 400);
  both.Check(both.Update());
}

TEST(OutputOnDevice, DeletedFilter)
{
  for (const bool isRasterized : { false, true })
  {
    vtkNew<vtkImageData> held;
    vtkNew<vtkImageData> wanted;
    {
      Both both;
      for (Deformed* one : { &both.Found, &both.Expected })
      {
        one->Filter->SetResampler(
          isRasterized ? vtkDeformVolumeFilter::MESH_RASTERIZATION : vtkDeformVolumeFilter::EXACT);
      }
      held->ShallowCopy(both.Update());
      wanted->ShallowCopy(both.Expected.Filter->GetOutput());
      EXPECT_EQ(both.GetNumberOfUnread(), MostUnread);
    }
    EXPECT_GT(CountRead([&] { EXPECT_TRUE(AreEqual(wanted, held)); }), 0);
    {
      Both both;
      held->ShallowCopy(both.Update());
    }
    held->Initialize(); // releases an output that was not read
  }
}

// When each output is read, only changed values are copied, whether the previous output is held or
// not. Kernels.TestDeviceOutput compares partial updates of outputs that were read or not.
TEST(OutputOnDevice, Incremental)
{
  Both both(MakeVolume({ { 0, 200, 0, 60, 0, 40 } }), 12);
  both.Update();
  vtkNew<vtkImageData> held;
  for (int step = 0; step < 6; ++step)
  {
    both.Move(0.2, 800);
    both.Expected.Update();
    const std::uint64_t read = CountRead([&] { both.Check(both.Found.Update()); });
    if (step != 0 && step != 3) // in these steps new memory of the host is allocated
    {
      EXPECT_LT(read, GetBytes(GetArray(both.Found.Filter->GetOutput(), "value")) / 4 + 60000);
    }
    if (step >= 2)
    {
      held->ShallowCopy(both.Found.Filter->GetOutput());
    }
  }
}

// Several threads read an output for the first time at once.
TEST(OutputOnDevice, Threads)
{
  Both both;
  for (int round = 0; round < 20; ++round)
  {
    both.Move(0.02);
    vtkDataArray* value = GetArray(both.Update(), "value");
    vtkDataArray* expected = GetArray(both.Expected.Filter->GetOutput(), "value");
    const std::uint64_t read = CountRead(
      [&]
      {
        std::vector<int> wrong(8);
        std::vector<std::thread> threads;
        for (std::size_t i = 0; i < wrong.size(); ++i)
        {
          threads.emplace_back(
            [&, i]
            {
              for (auto id = static_cast<vtkIdType>(i); id < value->GetNumberOfTuples(); id += 8)
              {
                wrong[i] += value->GetComponent(id, 0) != expected->GetComponent(id, 0);
              }
            });
        }
        for (std::thread& thread : threads)
        {
          thread.join();
        }
        EXPECT_EQ(wrong, std::vector<int>(8));
      });
    EXPECT_EQ(read, GetBytes(value));
  }
  // A thread reads an array while the filter copies it to the host.
  for (int round = 0; round < 20; ++round)
  {
    both.Move(0.02);
    vtkNew<vtkImageData> held;
    held->ShallowCopy(both.Update());
    vtkNew<vtkImageData> wanted;
    wanted->DeepCopy(both.Expected.Filter->GetOutput());
    std::thread reader([&] { GetArray(held, "double")->GetVoidPointer(0); });
    if (round % 2 == 0)
    {
      both.Move(0.02);
      both.Found.Update();
    }
    else
    {
      both.Found.Filter->ReleaseDeviceMemory();
    }
    reader.join();
    EXPECT_TRUE(AreEqual(wanted, held));
  }
}

struct Errors
{
  void Observe(vtkDataArray* array)
  {
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(this);
    command->SetCallback(
      [](vtkObject* caller, unsigned long, void* self, void* text)
      {
        auto* errors = static_cast<Errors*>(self);
        ++errors->Number;
        errors->Text = static_cast<const char*>(text);
        // An observer of the error may read the array.
        errors->Seen = vtkDataArray::SafeDownCast(caller)->GetComponent(5, 0);
      });
    array->AddObserver(vtkCommand::ErrorEvent, command);
  }
  int Number = 0;
  std::string Text;
  double Seen = 0.0;
};

bool IsAll(vtkDataArray* array, double value)
{
  for (vtkIdType id = 0; id < array->GetNumberOfTuples(); ++id)
  {
    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
    {
      if (array->GetComponent(id, c) != value)
      {
        return false;
      }
    }
  }
  return true;
}

// The device is lost before the output is read.
TEST(OutputOnDevice, LostDevice)
{
  enum
  {
    Reads,
    UpdatesBefore, // an update copies the output to the host
    DeletesBefore
  };
  for (const int way : { Reads, UpdatesBefore, DeletesBefore })
  {
    for (const bool atOnce : { false, true })
    {
      vtkNew<vtkImageData> held;
      Errors errors[2];
      // No ids: the update would copy them to the host.
      auto both = std::make_unique<Both>(MakeVolume(VolumeExtent));
      held->ShallowCopy(both->Update());
      errors[0].Observe(GetArray(held, "value"));
      errors[1].Observe(GetArray(held, "vtkValidPointMask"));
      if (way == DeletesBefore)
      {
        both.reset();
      }
      FakeDriver::Get().ReadError = -36; // CL_INVALID_COMMAND_QUEUE
      FakeDriver::Get().FailsAtOnce = atOnce;
      if (way == UpdatesBefore)
      {
        both->Move(0.1);
        both->Found.Update(); // this update copies no array of its own output
      }
      EXPECT_TRUE(IsAll(GetArray(held, "value"), 7.0));
      EXPECT_TRUE(IsAll(GetArray(held, "vtkValidPointMask"), 0.0));
      EXPECT_TRUE(IsAll(GetArray(held, "value"), 7.0));
      FakeDriver::Get().ReadError = 0;
      FakeDriver::Get().FailsAtOnce = false;
      EXPECT_EQ(errors[0].Number, 1);
      EXPECT_EQ(errors[1].Number, 1);
      EXPECT_EQ(errors[0].Seen, 7.0);
      EXPECT_TRUE(HasPart(errors[0].Text, "The OpenCL device was lost"));
      EXPECT_TRUE(HasPart(errors[0].Text, "background"));
      if (both)
      {
        both->Move(0.1);
        both->Check(both->Update());
      }
    }
  }
}

// The update fails if an array that must be copied to the host cannot be copied.
TEST(OutputOnDevice, FailedUpdate)
{
  Both both;
  both.Update();
  both.Move(0.1);
  FakeDriver::Get().ReadError = -36; // CL_INVALID_COMMAND_QUEUE, when the ids are copied
  both.Found.Filter->Update();
  EXPECT_EQ(both.Found.TakeErrors(), 1);
  EXPECT_EQ(both.Found.Filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_EQ(both.GetNumberOfUnread(), 0);
  FakeDriver::Get().ReadError = 0;
  both.Found.Filter->Modified();
  both.Check(both.Update());
}

// The device memory of outputs, and a memory limit that suffices for one output only.
TEST(OutputOnDevice, Memory)
{
  Both both;
  both.Update();
  both.Update();
  const vtkTypeInt64 held = both.Found.Filter->GetDeviceMemory();
  EXPECT_EQ(held, both.Expected.Filter->GetDeviceMemory());
  both.Check(both.Found.Filter->GetOutput());
  EXPECT_EQ(both.Found.Filter->GetDeviceMemory(), held);
  // Mesh rasterization does not keep an output for partial updates.
  for (Deformed* one : { &both.Found, &both.Expected })
  {
    one->Filter->SetResamplerToMeshRasterization();
  }
  both.Update();
  std::uint64_t bytes = 0;
  for (int i = 0; i < NumberOfArrays; ++i)
  {
    vtkDataArray* array = both.Found.Filter->GetOutput()->GetPointData()->GetArray(i);
    bytes += array->GetDataType() == VTK_ID_TYPE ? 0 : GetBytes(array);
  }
  EXPECT_EQ(both.Found.Filter->GetDeviceMemory(),
    both.Expected.Filter->GetDeviceMemory() + static_cast<vtkTypeInt64>(bytes));
  both.Check(both.Found.Filter->GetOutput());
  EXPECT_EQ(both.Found.Filter->GetDeviceMemory(), both.Expected.Filter->GetDeviceMemory());
  // The limit is the memory that an update needs, and an output is held.
  for (Deformed* one : { &both.Found, &both.Expected })
  {
    one->Filter->SetResamplerToExact();
  }
  both.Found.Filter->SetMemoryLimit(1);
  both.Found.Filter->Update();
  EXPECT_EQ(both.Found.TakeErrors(), 1);
  const std::string& message = both.Found.LastError;
  const std::size_t needed = message.find("device: ");
  EXPECT_NE(needed, std::string::npos);
  both.Found.Filter->SetMemoryLimit(std::stoll(message.substr(needed + 8)));
  vtkNew<vtkImageData> first;
  first->ShallowCopy(both.Update());
  vtkNew<vtkImageData> wanted;
  wanted->DeepCopy(both.Expected.Filter->GetOutput());
  EXPECT_EQ(both.GetNumberOfUnread(), MostUnread);
  for (int i = 0; i < 3; ++i)
  {
    both.Move(0.3);
    both.Check(both.Update());
  }
  EXPECT_TRUE(AreEqual(wanted, first));
}

} // namespace
