// SPDX-License-Identifier: BSD-3-Clause
// Arrays of the volume are read in place, and memory of outputs is reused: the references that are
// held, and that no array changes while somebody else holds it.
#include "DeviceNeeds.h"
#include "FilterTesting.h"

#include <vtkImageShiftScale.h>
#include <vtkLookupTable.h>
#include <vtkMath.h>
#include <vtkSOADataArrayTemplate.h>

using namespace filterTesting;

namespace
{

class DeformMemory : public testing::Test
{
  void SetUp() override { SKIP_WITHOUT_DOUBLE_PRECISION() }
};

struct Subject
{
  Subject()
    : Volume(MakeVolume({ { 0, 24, 0, 19, 0, 18 } }))
    , Mesh(MakeMesh(Volume))
    , Filtered(Volume, Mesh)
  {
    Filtered.Filter->SetOutputBoundsModeToVolumeBounds();
    this->Move(0.25);
  }

  void Move(double amount) { SetDisplacements(this->Mesh, Shift(amount, 0.1, 0.0)); }

  /// The output of a new filter with the same inputs.
  vtkSmartPointer<vtkImageData> GetFresh()
  {
    Deformed fresh(this->Volume, this->Mesh);
    fresh.Filter->SetOutputBoundsMode(this->Filtered.Filter->GetOutputBoundsMode());
    fresh.Filter->SetBackgroundValue(this->Filtered.Filter->GetBackgroundValue());
    auto copy = vtkSmartPointer<vtkImageData>::New();
    copy->ShallowCopy(fresh.Update());
    return copy;
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Filtered;
};

// An output that a caller holds is not written again, even if only one of its arrays is held.
TEST_F(DeformMemory, HeldOutputs)
{
  Subject subject;
  vtkNew<vtkImageData> held;
  held->ShallowCopy(subject.Filtered.Update());
  vtkNew<vtkImageData> before;
  before->DeepCopy(held);
  subject.Move(1.75);
  EXPECT_TRUE(AreEqual(subject.Filtered.Update(), subject.GetFresh()));
  EXPECT_TRUE(AreEqual(held, before));
  EXPECT_FALSE(AreEqual(subject.Filtered.Filter->GetOutput(), before));

  vtkSmartPointer<vtkDataArray> values = subject.Filtered.GetValues();
  vtkNew<vtkImageData> second;
  second->DeepCopy(subject.Filtered.Filter->GetOutput());
  subject.Move(-2.5);
  EXPECT_TRUE(AreEqual(subject.Filtered.Update(), subject.GetFresh()));
  EXPECT_TRUE(HaveEqualBits(values, second->GetPointData()->GetScalars()));
}

// An output that no caller holds is written again, and downstream filters detect the change.
TEST_F(DeformMemory, ReusedOutputs)
{
  Subject subject;
  vtkNew<vtkImageShiftScale> after;
  after->SetInputConnection(subject.Filtered.Filter->GetOutputPort());
  after->SetShift(3.0);
  after->SetOutputScalarTypeToDouble();
  after->Update();
  const void* memory = subject.Filtered.GetValues()->GetVoidPointer(0);
  double range[2];
  subject.Filtered.GetValues()->GetRange(range);
  for (int i = 1; i < 4; ++i)
  {
    subject.Move(0.5 * i);
    subject.Volume->GetPointData()->GetScalars()->SetComponent(800, 0, 1000.0 * i);
    subject.Volume->GetPointData()->GetScalars()->Modified();
    const vtkMTimeType time = subject.Filtered.GetValues()->GetMTime();
    after->Update();
    EXPECT_EQ(subject.Filtered.GetValues()->GetVoidPointer(0), memory);
    EXPECT_GT(subject.Filtered.GetValues()->GetMTime(), time);
    const auto fresh = subject.GetFresh();
    EXPECT_TRUE(AreEqual(subject.Filtered.Filter->GetOutput(), fresh));
    EXPECT_EQ(subject.Filtered.GetValues()->GetRange()[1],
      fresh->GetPointData()->GetScalars()->GetRange()[1]);
    EXPECT_EQ(after->GetOutput()->GetPointData()->GetScalars()->GetComponent(900, 0),
      fresh->GetPointData()->GetScalars()->GetComponent(900, 0) + 3.0);
  }
}

// Memory is reused for smaller outputs, unless more than half of it would be unused.
TEST_F(DeformMemory, OutputsOfOtherSizes)
{
  Subject subject;
  subject.Filtered.Filter->SetOutputBoundsModeToDeformedBounds();
  const auto update = [&](double scale)
  {
    SetDisplacements(subject.Mesh, [&](const glm::dvec3& p) { return scale * p; });
    EXPECT_TRUE(AreEqual(subject.Filtered.Update(), subject.GetFresh()));
    return subject.Filtered.GetValues();
  };
  const vtkIdType whole = update(1.0)->GetNumberOfTuples();
  vtkIdType size = update(1.3)->GetSize();
  EXPECT_GT(subject.Filtered.GetValues()->GetNumberOfTuples(), whole);
  const void* memory = subject.Filtered.GetValues()->GetVoidPointer(0);
  for (const double scale : { 1.2, 1.28, 1.15, 1.3 })
  {
    vtkDataArray* values = update(scale);
    EXPECT_EQ(values->GetVoidPointer(0), memory);
    EXPECT_EQ(values->GetSize(), size);
  }
  // A larger output, one of less than half the size, and one while the last output is held.
  EXPECT_GT(update(1.33)->GetSize(), size);
  size = subject.Filtered.GetValues()->GetSize();
  EXPECT_LT(update(0.9)->GetSize(), size / 2);
  vtkNew<vtkImageData> held;
  held->ShallowCopy(subject.Filtered.Filter->GetOutput());
  vtkNew<vtkImageData> before;
  before->DeepCopy(held);
  update(1.2);
  EXPECT_TRUE(AreEqual(held, before));
}

// An array that is reused has the description of a new one.
TEST_F(DeformMemory, DescriptionOfArrays)
{
  Subject subject;
  vtkNew<vtkLookupTable> table;
  subject.Filtered.Update();
  vtkDataArray* values = subject.Volume->GetPointData()->GetScalars();
  values->SetName("other");
  values->SetLookupTable(table);
  values->SetComponentName(0, "first");
  subject.Volume->Modified();
  subject.Filtered.Update();
  EXPECT_EQ(std::string(subject.Filtered.GetValues()->GetName()), std::string("other"));
  EXPECT_EQ(std::string(subject.Filtered.GetValues()->GetComponentName(0)), std::string("first"));
  EXPECT_EQ(subject.Filtered.GetValues()->GetLookupTable(), table);
  subject.Volume->GetPointData()->SetScalars(nullptr);
  subject.Volume->GetPointData()->RemoveArray("other");
  AddScalars<float>(subject.Volume, "third", [](const glm::dvec3& p) { return p.x - p.z; });
  EXPECT_TRUE(AreEqual(subject.Filtered.Update(), subject.GetFresh()));
  EXPECT_EQ(std::string(subject.Filtered.GetValues()->GetName()), std::string("third"));
  EXPECT_EQ(subject.Filtered.GetValues()->GetComponentName(0), nullptr);
  EXPECT_EQ(subject.Filtered.GetValues()->GetLookupTable(), nullptr);
}

// A CPU device does not copy the arrays of the volume. The filter holds references to them as long
// as it needs them.
TEST_F(DeformMemory, VolumeInPlace)
{
  Subject subject;
  vtkDataArray* values = subject.Volume->GetPointData()->GetScalars();
  const int references = values->GetReferenceCount();
  subject.Filtered.Update();
  const vtkTypeInt64 memory = subject.Filtered.Filter->GetDeviceMemory();
  EXPECT_GT(memory, 0);
  const bool inPlace = values->GetReferenceCount() > references;
  subject.Filtered.Filter->ReleaseDeviceMemory();
  EXPECT_EQ(values->GetReferenceCount(), references);

  // An array in another memory layout is copied on any device.
  auto soa = vtkSmartPointer<vtkSOADataArrayTemplate<double>>::New();
  soa->SetNumberOfComponents(2);
  soa->SetNumberOfTuples(subject.Volume->GetNumberOfPoints());
  soa->SetName("pairs");
  for (vtkIdType i = 0; i < soa->GetNumberOfTuples(); ++i)
  {
    soa->SetComponent(i, 0, 0.5 * i);
    soa->SetComponent(i, 1, -1.0 * i);
  }
  subject.Volume->GetPointData()->AddArray(soa);
  const int soaReferences = soa->GetReferenceCount();
  subject.Filtered.Filter->Modified();
  EXPECT_TRUE(AreEqual(subject.Filtered.Update(), subject.GetFresh()));
  EXPECT_EQ(soa->GetReferenceCount(), soaReferences);
  if (inPlace)
  {
    // Device memory holds the static mapping and the states of vertices, not the values.
    EXPECT_EQ(subject.Filtered.Filter->GetDeviceMemory(), memory);
  }

  // Another volume replaces the first one, whose arrays are released.
  auto other = MakeVolume({ { 0, 24, 0, 19, 0, 18 } });
  subject.Filtered.Filter->SetInputData(other);
  subject.Volume->GetPointData()->RemoveArray("pairs");
  subject.Filtered.Update();
  EXPECT_EQ(values->GetReferenceCount(), references);
}

// When the pipeline releases an output, the filter does not keep its memory.
TEST_F(DeformMemory, ReleasedOutputs)
{
  for (const bool failing : { false, true })
  {
    Subject subject;
    subject.Filtered.Filter->SetReleaseDataFlag(failing ? 0 : 1);
    vtkSmartPointer<vtkDataArray> values;
    subject.Filtered.Update();
    values = subject.Filtered.GetValues();
    if (failing)
    {
      subject.Filtered.Filter->SetDisplacementScale(vtkMath::Inf());
      subject.Filtered.Filter->Update();
      EXPECT_EQ(subject.Filtered.TakeErrors(), 1);
      subject.Filtered.Filter->SetDisplacementScale(1.0);
    }
    else
    {
      subject.Filtered.Filter->GetOutput()->ReleaseData();
    }
    EXPECT_EQ(values->GetReferenceCount(), 1);
    subject.Filtered.Filter->Modified();
    EXPECT_TRUE(AreEqual(subject.Filtered.Update(), subject.GetFresh()));
  }
}

// When the deformation is replaced, the memory of the previous one is released and does not count
// toward the memory limit, even if the volume is replaced at the same time.
TEST_F(DeformMemory, OtherDeformations)
{
  for (const bool otherVolume : { false, true })
  {
    Subject subject;
    const auto volume = otherVolume ? MakeVolume({ { 0, 22, 0, 19, 0, 18 } }) : subject.Volume;
    vtkNew<vtkImageData> field;
    field->SetDimensions(3, 3, 3);
    field->SetSpacing(20.0, 20.0, 20.0);
    field->SetOrigin(-5.0, -5.0, -5.0);
    SetDisplacements(field, Shift(0.5, 0.25, 0.0));
    Deformed fresh(volume, field);
    fresh.Filter->SetOutputBoundsModeToVolumeBounds();
    fresh.Update();
    const vtkIdType enough = fresh.Filter->GetDeviceMemory();
    EXPECT_GT(enough, 0);
    const auto mesh = MakeMesh(subject.Volume, 12);
    SetDisplacements(mesh, Shift(0.5, 0.25, 0.0));
    Deformed tested(subject.Volume, mesh);
    tested.Filter->SetOutputBoundsModeToVolumeBounds();
    tested.Update();
    EXPECT_GT(tested.Filter->GetDeviceMemory(), enough);
    tested.Filter->SetInputData(volume);
    tested.Filter->SetDeformationData(field);
    tested.Filter->SetMemoryLimit(4 * enough);
    EXPECT_TRUE(AreEqual(tested.Update(), fresh.Filter->GetOutput()));
    EXPECT_EQ(tested.TakeErrors(), 0);
    EXPECT_EQ(tested.Filter->GetDeviceMemory(), enough);
  }
}

} // namespace
