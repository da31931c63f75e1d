// SPDX-License-Identifier: BSD-3-Clause
// vtkChainMailDeformation: each misuse is one error, and the next drag works.
#include "ChainMailTesting.h"

#include <vtkMultiBlockDataSet.h>
#include <vtkShortArray.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <limits>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

template <typename Array>
vtkSmartPointer<Array> MakeArray(const char* name, int components, vtkIdType tuples, int value = 0)
{
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  for (vtkIdType i = 0; i < components * tuples; ++i)
  {
    array->SetVariantValue(i, vtkVariant(value));
  }
  return array;
}

void CheckHandles(Dragged& dragged, const std::vector<Handle>& good)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto tryHandles = [&](const std::vector<Handle>& handles)
  {
    dragged.Filter->SetHandlesData(MakeHandles(handles));
    return dragged.TryUpdate();
  };
  const glm::dvec3 inside(4, 4, 4);
  EXPECT_TRUE(
    HasPart(tryHandles({ good[0], { glm::dvec3(4, 4, 50), inside } }), "Handle 1 lies outside"));
  EXPECT_TRUE(HasPart(tryHandles({ { inside, glm::dvec3(5000, 4, 4) } }), "Move it less"));
  EXPECT_TRUE(HasPart(tryHandles({ { inside, glm::dvec3(4, nan, 4) } }), "Point 0 of the handles"));
  EXPECT_TRUE(
    HasPart(tryHandles({ { glm::dvec3(4, nan, 4), inside } }), "Rest position 0 of the handles"));
  const vtkSmartPointer<vtkPolyData> handles = MakeHandles(good);
  vtkPointData* arrays = handles->GetPointData();
  dragged.Filter->SetHandlesData(handles);
  arrays->RemoveArray("RestPosition");
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "no point array \"RestPosition\""));
  arrays->AddArray(MakeArray<vtkDoubleArray>("RestPosition", 2, 1));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "3 components and 1 tuples"));
  arrays->AddArray(MakeArray<vtkDoubleArray>("RestPosition", 3, 2));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "2 tuples of 3 components"));
  arrays->AddArray(MakeArray<vtkStringArray>("RestPosition", 3, 1));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "numeric type"));
  dragged.Filter->SetHandlesData(MakeHandles(good));
}

void CheckVolumeArrays(Dragged& dragged, vtkImageData* volume)
{
  const vtkIdType points = volume->GetNumberOfPoints();
  vtkPointData* pointData = volume->GetPointData();
  vtkCellData* cellData = volume->GetCellData();
  cellData->AddArray(MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", 1, points, 31));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "\"ActiveTetrahedra\""));
  cellData->AddArray(
    MakeArray<vtkFloatArray>("ActiveTetrahedra", 1, volume->GetNumberOfCells(), 31));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "type unsigned char"));
  cellData->RemoveArray("ActiveTetrahedra");
  pointData->AddArray(MakeArray<vtkUnsignedCharArray>("Pinned", 2, points));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "\"Pinned\""));
  pointData->AddArray(MakeArray<vtkUnsignedCharArray>("Pinned", 1, points - 1));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "1 component and"));
  pointData->RemoveArray("Pinned");

  dragged.Filter->SetMaterialArrayName("labels");
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "no point array \"labels\""));
  pointData->AddArray(MakeArray<vtkShortArray>("labels", 3, points));
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "\"labels\""));
  for (const int label : { 5, 255, 256, -1 })
  {
    const vtkSmartPointer<vtkShortArray> labels = MakeArray<vtkShortArray>("labels", 1, points);
    labels->SetValue(17, static_cast<short>(label));
    pointData->AddArray(labels);
    EXPECT_TRUE(HasPart(dragged.TryUpdate(), "Voxel 17 has the value " + std::to_string(label)));
  }
  const vtkSmartPointer<vtkDoubleArray> fractions =
    MakeArray<vtkDoubleArray>("labels", 1, points, 1);
  fractions->SetValue(3, 1.5);
  pointData->AddArray(fractions);
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "Voxel 3 has the value 1.5"));
  pointData->RemoveArray("labels");
  dragged.Filter->SetMaterialArrayName("");
}

void CheckMaterials(Dragged& dragged)
{
  dragged.Filter->SetDefaultMaterial(9);
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "DefaultMaterial 9 is not defined"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double bad[][3] = { { 1.5, 2, 0.5 }, { 0.5, 0.9, 0.5 }, { -1, 2, 0.5 }, { 0.5, 2, -1 },
    { nan, 2, 1 }, { 0.5, nan, 1 }, { 0.5, 2, nan } };
  for (const auto& limits : bad)
  {
    dragged.Filter->SetMaterial(9, limits[0], limits[1], limits[2]);
    EXPECT_TRUE(HasPart(dragged.TryUpdate(), "Material 9 has the"));
  }
  dragged.Filter->ClearMaterials();
  dragged.Filter->SetDefaultMaterial(1);
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "DefaultMaterial 1 is not defined"));
  EXPECT_EQ(dragged.Filter->GetNumberOfMaterials(), 0);
  dragged.Filter->SetMaterial(1, 0.5, 1.5, 0.5);
  double limits[3];
  EXPECT_TRUE(dragged.Filter->GetMaterialLimits(1, limits) && limits[0] == 0.5 && limits[1] == 1.5);
  EXPECT_TRUE(!dragged.Filter->GetMaterialLimits(2, limits) &&
    !dragged.Filter->GetMaterialLimits(-1, limits));
  dragged.Filter->AddMaterialRange(0, 10, 7);
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "material 7 is not defined"));
  dragged.Filter->ClearMaterialRanges();
  dragged.Filter->SetMaterial(1.5, 0.5, 1.5, 0.5);
  EXPECT_TRUE(HasPart(dragged.Observer->GetErrorMessage(), "an integer"));
  dragged.Observer->Clear();
  dragged.Filter->SetMaterial(3.0, 0.5, 1.5, 0.5);
  EXPECT_EQ(dragged.Filter->GetNumberOfMaterials(), 2);
  for (const int index : { -1, 256 })
  {
    dragged.Filter->SetMaterial(index, 0.5, 1.5, 0.5);
    EXPECT_TRUE(HasPart(dragged.Observer->GetErrorMessage(), "from 0 to 255"));
    dragged.Observer->Clear();
    dragged.Filter->AddMaterialRange(0, 1, index);
    EXPECT_TRUE(HasPart(dragged.Observer->GetErrorMessage(), "from 0 to 255"));
    dragged.Observer->Clear();
  }
}

void CheckSettings(Dragged& dragged)
{
  EXPECT_GT(dragged.Filter->GetNumberOfMovedVoxels(), 0);
  dragged.Filter->SetDevice("no such device");
  EXPECT_TRUE(HasPart(dragged.TryUpdate(), "no such device"));
  EXPECT_EQ(dragged.Filter->GetNumberOfMovedVoxels(), 0);
  EXPECT_EQ(dragged.Filter->GetSummary(), "");
  dragged.Filter->SetDevice("");
  const vtkSmartPointer<vtkImageData> large = MakeVolume({ { 0, 30, 0, 30, 0, 30 } });
  vtkNew<vtkChainMailDeformation> other;
  other->AddObserver(vtkCommand::ErrorEvent, dragged.Observer);
  other->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, dragged.ExecutiveObserver);
  other->SetInputData(large);
  other->SetMemoryLimit(100000);
  other->Update();
  EXPECT_TRUE(HasPart(dragged.Observer->GetErrorMessage(), "Not enough memory"));
  dragged.Observer->Clear();
}

} // namespace

TEST(ChainMailMisuse, EmptyAndFlatVolumes)
{
  vtkNew<vtkImageData> none;
  Dragged empty(none);
  EXPECT_FALSE(empty.TryUpdate().empty());
  Dragged flat(MakeVolume({ { 0, 5, 3, 3, 0, 5 } }));
  EXPECT_FALSE(flat.TryUpdate().empty());
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, MakeVolume({ { 0, 5, 0, 5, 0, 5 } }));
  Dragged composite(blocks);
  EXPECT_TRUE(HasPart(composite.TryUpdate(), "input port 0 are a vtkMultiBlockDataSet"));
}

// The cases share one filter, so that each error follows a correction of another one.
TEST(ChainMailMisuse, ErrorsChangeNothing)
{
  const vtkSmartPointer<vtkImageData> volume = MakeVolume({ { 0, 12, 0, 12, 0, 12 } });
  const vtkSmartPointer<vtkImageData> other = MakeVolume({ { 0, 12, 0, 12, 0, 12 } });
  Dragged dragged(volume);
  Dragged undisturbed(other);
  std::vector<Handle> handles{ { glm::dvec3(4, 6, 6), glm::dvec3(6, 6, 5) } };
  EXPECT_TRUE(HaveEqualBits(dragged.Drag(handles), undisturbed.Drag(handles)));
  CheckSettings(dragged);
  CheckHandles(dragged, handles);
  CheckVolumeArrays(dragged, volume);
  CheckMaterials(dragged);
  // The errors have not changed the displacements of the first drag.
  handles = { { glm::dvec3(9, 6, 6), glm::dvec3(9.5, 9, 6) } };
  EXPECT_TRUE(HaveEqualBits(dragged.Drag(handles), undisturbed.Drag(handles)));
  EXPECT_EQ(undisturbed.Update()->GetComponent(4 + 13 * (6 + 13 * 6), 0), 2.0);
}
