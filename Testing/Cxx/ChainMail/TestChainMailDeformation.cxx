// SPDX-License-Identifier: BSD-3-Clause
// vtkChainMailDeformation: closed forms in world coordinates, materials, pinned voxels and cuts by
// arrays, states between executions, and a vtkDeformVolumeFilter downstream.
#include "ArrayMaking.h"
#include "ChainMailTesting.h"
#include "Extent.h"

#include "../../Sources.h"

#include <vtkDataObject.h>
#include <vtkDataSetAttributes.h>
#include <vtkInformation.h>
#include <vtkInformationDoubleVectorKey.h>
#include <vtkInformationIntegerKey.h>
#include <vtkInformationStringKey.h>
#include <vtkLongLongArray.h>
#include <vtkShortArray.h>
#include <vtkUnsignedCharArray.h>

#include <glm/glm.hpp>

#include <algorithm>
#include <functional>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

vtkIdType GetId(vtkImageData* volume, int i, int j, int k)
{
  const int ijk[3] = { i, j, k };
  return volume->ComputePointId(const_cast<int*>(ijk));
}

glm::dvec3 GetTuple(vtkDataArray* array, vtkIdType id)
{
  glm::dvec3 tuple;
  array->GetTuple(id, &tuple.x);
  return tuple;
}

// Displacements decrease by half of the distance in world units along each axis of the volume.
TEST(ChainMailDeformation, WorldForm)
{
  const auto volume = MakeImage({ { -4, 20, 3, 30, 0, 18 } }, { 0.5, 1.0, 2.0 }, { 10, -5, 2 });
  SetObliqueDirection(volume);
  Dragged dragged(volume);
  const glm::dvec3 held(8, 16, 9);
  const glm::dvec3 voxels(-3.5, 4, 1.25);
  const glm::dvec3 rest = GetWorld(volume, held);
  vtkFloatArray* found = dragged.Drag({ { rest, GetWorld(volume, held + voxels) } });
  EXPECT_EQ(found->GetNumberOfTuples(), volume->GetNumberOfPoints());
  vtkImageData* output = dragged.Filter->GetOutput();
  EXPECT_EQ(GetExtent(output), GetExtent(volume));
  EXPECT_EQ(output->GetPointData()->GetVectors(), dragged.GetArray());
  const glm::dvec3 origin = GetWorld(volume, glm::dvec3(0.0));
  double largest = 0.0;
  for (int k = 0; k <= 18; ++k)
  {
    for (int j = 3; j <= 30; ++j)
    {
      for (int i = -4; i <= 20; ++i)
      {
        const vtkIdType id = GetId(volume, i, j, k);
        EXPECT_EQ(GetPoint(output, id), GetPoint(volume, id));
        const glm::dvec3 spacing(0.5, 1.0, 2.0);
        const glm::dvec3 steps = glm::abs(glm::dvec3(i, j, k) - held) * spacing;
        const double less = 0.5 * (steps.x + steps.y + steps.z);
        const glm::dvec3 drag = voxels * spacing;
        const glm::dvec3 length = glm::max(glm::abs(drag) - less, glm::dvec3(0.0));
        const glm::dvec3 expected = GetWorld(volume, glm::sign(drag) * length / spacing) - origin;
        const glm::dvec3 difference = glm::abs(GetTuple(found, id) - expected);
        largest = std::max({ largest, difference.x, difference.y, difference.z });
      }
    }
  }
  // Half a unit, which is 1/65536 of the largest spacing, 2; and rounding of six floats of less
  // than 8.
  EXPECT_LE(largest, 2.0 / 131072.0 + 8.0 * 6.0 / 16777216.0);
  EXPECT_EQ(dragged.Filter->GetLargestViolation(), 0.0);
  EXPECT_GT(dragged.Filter->GetNumberOfSweeps(), 0);
  EXPECT_FALSE(dragged.Filter->GetSummary().empty());
}

// RequestInformation() announces the arrays of the output, not those of the volume.
TEST(ChainMailDeformation, Announcement)
{
  const auto volume = MakeVolume({ { 0, 4, 0, 4, 0, 4 } });
  SetObliqueDirection(volume);
  Dragged dragged(volume);
  dragged.Filter->UpdateInformation();
  vtkInformation* announced = dragged.Filter->GetOutputInformation(0);
  const auto find = [&](int attribute)
  {
    return vtkDataObject::GetActiveFieldInformation(
      announced, vtkDataObject::FIELD_ASSOCIATION_POINTS, attribute);
  };
  EXPECT_FALSE(find(vtkDataSetAttributes::SCALARS));
  vtkInformation* vectors = find(vtkDataSetAttributes::VECTORS);
  EXPECT_TRUE(vectors && std::string(vectors->Get(vtkDataObject::FIELD_NAME())) == "Displacement");
  EXPECT_TRUE(vectors && vectors->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()) == 3);
  EXPECT_TRUE(announced->Has(vtkDataObject::DIRECTION()) &&
    announced->Get(vtkDataObject::DIRECTION())[1] ==
      volume->GetDirectionMatrix()->GetElement(0, 1));
  dragged.Filter->Update();
  EXPECT_FALSE(dragged.Filter->GetOutput()->GetPointData()->GetScalars());
}

TEST(ChainMailDeformation, Kept)
{
  const auto volume = MakeVolume({ { 0, 40, 0, 24, 0, 24 } });
  Dragged dragged(volume);
  const glm::dvec3 rest(8, 12, 12);
  vtkFloatArray* found = dragged.Drag({ { rest, rest + glm::dvec3(2, 0, 0) } });
  vtkDataArray* const array = dragged.GetArray();
  const bool isOnHost = array == found;
  const float* memory = found->GetPointer(0);
  const vtkMTimeType time = array->GetMTime();
  // The moved voxels are an octahedron whose vertices are 3 voxels from its center.
  EXPECT_EQ(dragged.Filter->GetNumberOfMovedVoxels(), 63);
  EXPECT_EQ(GetExtent(dragged.Filter->GetOutput()), GetExtent(volume));
  const auto getChanges = [&]
  {
    Extent extent;
    dragged.Filter->GetChangedExtent(extent.data());
    return extent;
  };
  EXPECT_EQ(getChanges(), (Extent{ { 0, 15, 8, 15, 8, 15 } }));
  // Another update without changes.
  dragged.Update();
  EXPECT_TRUE(dragged.GetArray() == array && array->GetMTime() == time);
  EXPECT_EQ(dragged.Filter->GetNumberOfMovedVoxels(), 0);
  EXPECT_EQ(getChanges(), deformvolume::EmptyExtent);
  // A drag of other voxels: the voxels of the first drag stay displaced.
  const glm::dvec3 other(34, 12, 12);
  found = dragged.Drag({ { other, other + glm::dvec3(0, -1, 0) } });
  EXPECT_TRUE(dragged.GetArray() == array && array->GetMTime() > time);
  EXPECT_TRUE(!isOnHost || found->GetPointer(0) == memory);
  EXPECT_EQ(GetTuple(found, GetId(volume, 8, 12, 12)), glm::dvec3(2, 0, 0));
  EXPECT_EQ(GetTuple(found, GetId(volume, 34, 12, 12)), glm::dvec3(0, -1, 0));
  EXPECT_EQ(getChanges(), (Extent{ { 32, 39, 8, 15, 8, 15 } }));
  // Relaxation moves back the voxels that no handle holds.
  dragged.Filter->SetHandlesData(nullptr);
  dragged.Filter->SetRelaxationSweeps(50);
  dragged.Update();
  EXPECT_LT(GetTuple(found, GetId(volume, 8, 12, 12)).x, 0.5);
  EXPECT_GT(dragged.Filter->GetNumberOfMovedVoxels(), 0);
  dragged.Filter->SetRelaxationSweeps(0);
  dragged.Filter->Reset();
  dragged.Update();
  double range[2];
  found->GetRange(range, -1);
  EXPECT_EQ(range[1], 0.0);
  EXPECT_EQ(getChanges()[0], 0);
  // A volume of another extent gets another array.
  const auto larger = MakeVolume({ { 0, 41, 0, 24, 0, 24 } });
  dragged.Filter->SetInputData(larger);
  EXPECT_NE(dragged.Update(), nullptr);
  EXPECT_EQ(dragged.Filter->GetOutput()->GetNumberOfPoints(), larger->GetNumberOfPoints());
}

// Another piece, or another time at which handles have the same positions, is no other step.
TEST(ChainMailDeformation, SameInputs)
{
  const auto volume = MakeVolume({ { 0, 20, 0, 20, 0, 20 } });
  vtkNew<TimedMesh> handles;
  handles->LastTime = 2.0;
  handles->GetMesh = [](double time)
  {
    const glm::dvec3 rest(8, 12, 12);
    const auto points = MakeHandles({ { rest, rest + glm::dvec3(time < 2.0 ? 2 : 3, 0, 0) } });
    auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
    mesh->SetPoints(points->GetPoints());
    mesh->GetPointData()->ShallowCopy(points->GetPointData());
    return mesh;
  };
  Dragged dragged(volume);
  dragged.Filter->SetHandlesConnection(handles->GetOutputPort());
  dragged.Filter->SetRelaxationSweeps(1);
  dragged.Filter->UpdateTimeStep(0.0);
  const auto first = Copy(dragged.GetArray());
  const vtkIdType moved = dragged.Filter->GetNumberOfMovedVoxels();
  EXPECT_GT(moved, 0);
  const std::function<void()> updates[] = { [&] { dragged.Filter->UpdatePiece(0, 2, 0); },
    [&] { dragged.Filter->UpdatePiece(1, 2, 0); }, [&] { dragged.Filter->UpdateTimeStep(1.0); } };
  for (const auto& update : updates)
  {
    update();
    EXPECT_TRUE(HaveEqualBits(dragged.GetFloats(), first));
    EXPECT_EQ(dragged.Filter->GetNumberOfMovedVoxels(), moved);
  }
  dragged.Filter->Modified();
  EXPECT_FALSE(HaveEqualBits(dragged.Update(), first));
  dragged.Filter->UpdateTimeStep(2.0);
  EXPECT_EQ(GetTuple(dragged.GetFloats(), GetId(volume, 8, 12, 12)), glm::dvec3(3, 0, 0));
}

// A column of stiff voxels moves like a rigid body.
template <typename Array>
void CheckLabels(bool byRanges)
{
  const auto volume = MakeImage({ { 0, 12, 0, 12, 0, 12 } });
  const vtkSmartPointer<Array> labels = vtkSmartPointer<Array>::New();
  labels->SetName("label");
  labels->SetNumberOfTuples(volume->GetNumberOfPoints());
  for (vtkIdType id = 0; id < labels->GetNumberOfTuples(); ++id)
  {
    const bool isStiff = GetPoint(volume, id).x == 6 && GetPoint(volume, id).y == 6;
    labels->SetTuple1(id, byRanges ? (isStiff ? 100 : 20) : isStiff ? 9 : 0);
  }
  volume->GetPointData()->SetScalars(labels);
  Dragged dragged(volume);
  dragged.Filter->SetMaterial(0, 0.5, 1.5, 0.5);
  dragged.Filter->SetMaterial(9, 1.0, 1.0, 0.0);
  if (byRanges)
  {
    dragged.Filter->SetDefaultMaterial(0);
    dragged.Filter->AddMaterialRange(100, 101, 9);
    dragged.Filter->AddMaterialRange(0, 1000, 0);
  }
  else
  {
    dragged.Filter->SetMaterialArrayName("label");
  }
  const glm::dvec3 rest(6, 6, 2);
  vtkFloatArray* found = dragged.Drag({ { rest, rest + glm::dvec3(1, -2, 0.5) } });
  for (int k = 0; k <= 12; ++k)
  {
    EXPECT_EQ(GetTuple(found, GetId(volume, 6, 6, k)), glm::dvec3(1, -2, 0.5));
  }
  // A link between a stiff and a soft voxel yields half as much as a link between soft voxels.
  EXPECT_EQ(GetTuple(found, GetId(volume, 7, 6, 11)), glm::dvec3(0.75, -1.75, 0.25));
}

TEST(ChainMailDeformation, PinsAndCuts)
{
  const auto volume = MakeVolume({ { 0, 20, 0, 10, 0, 10 } });
  const auto pinned = MakeArray<vtkLongLongArray>("Pinned", volume->GetNumberOfPoints());
  pinned->SetValue(GetId(volume, 10, 5, 5), -3);
  volume->GetPointData()->AddArray(pinned);
  Dragged dragged(volume);
  const glm::dvec3 rest(6, 5, 5);
  const std::vector<Handle> handles{ { rest, rest + glm::dvec3(5, 0, 0) } };
  vtkFloatArray* found = dragged.Drag(handles);
  EXPECT_EQ(dragged.Filter->GetNumberOfReducedHandles(), 1);
  EXPECT_EQ(dragged.Filter->GetNumberOfReleasedHandles(), 0);
  EXPECT_EQ(GetTuple(found, GetId(volume, 6, 5, 5)), glm::dvec3(2, 0, 0));
  EXPECT_EQ(GetTuple(found, GetId(volume, 10, 5, 5)), glm::dvec3(0, 0, 0));
  // With a cut between handle and pinned voxels the drag is possible, and does not move voxels
  // beyond the cut.
  const auto active =
    MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", volume->GetNumberOfCells());
  for (vtkIdType cell = 0; cell < active->GetNumberOfTuples(); ++cell)
  {
    active->SetValue(cell, cell % 20 == 8 ? 0 : 31);
  }
  volume->GetCellData()->AddArray(active);
  vtkDataArray* const array = dragged.GetArray();
  found = dragged.Update();
  EXPECT_EQ(dragged.GetArray(), array);
  EXPECT_EQ(dragged.Filter->GetNumberOfReducedHandles(), 0);
  EXPECT_EQ(GetTuple(found, GetId(volume, 6, 5, 5)), glm::dvec3(5, 0, 0));
  EXPECT_EQ(GetTuple(found, GetId(volume, 8, 5, 5)), glm::dvec3(4, 0, 0));
  EXPECT_LT(GetTuple(found, GetId(volume, 9, 5, 5)).x, 1.0);
  // When the cut is closed, the displacements violate the limits of links: all voxels return to
  // rest.
  active->Fill(31);
  active->Modified();
  dragged.Filter->SetHandlesData(nullptr);
  dragged.Update();
  double range[2];
  found->GetRange(range, -1);
  EXPECT_EQ(range[1], 0.0);

  // SetArray() replaces the values of an array without changing its modification time.
  std::vector<long long> noPins(static_cast<std::size_t>(volume->GetNumberOfPoints()), 0);
  pinned->SetArray(noPins.data(), volume->GetNumberOfPoints(), 1);
  dragged.Filter->Modified();
  found = dragged.Drag(handles);
  EXPECT_EQ(GetTuple(found, GetId(volume, 6, 5, 5)), glm::dvec3(5, 0, 0));
  std::vector<unsigned char> inactive(static_cast<std::size_t>(volume->GetNumberOfCells()), 0);
  active->SetArray(inactive.data(), volume->GetNumberOfCells(), 1);
  dragged.Filter->Reset();
  found = dragged.Update();
  EXPECT_EQ(GetTuple(found, GetId(volume, 6, 5, 5)), glm::dvec3(0, 0, 0)); // there is no tissue
}

// Handles that hold no voxel that can move: on a pinned voxel, and on a voxel of another handle.
TEST(ChainMailDeformation, HandlesWithoutVoxels)
{
  const auto volume = MakeVolume({ { 0, 10, 0, 10, 0, 10 } });
  const auto pinned = MakeArray<vtkUnsignedCharArray>("Pinned", volume->GetNumberOfPoints());
  pinned->SetValue(GetId(volume, 8, 5, 5), 1);
  volume->GetPointData()->AddArray(pinned);
  Dragged dragged(volume);
  const glm::dvec3 move(1.0, 0.0, 0.0);
  const glm::dvec3 first(3, 5, 5);
  const glm::dvec3 same(3.2, 5, 5);
  const glm::dvec3 onPin(8, 5, 5);
  dragged.Filter->SetHandlesData(
    MakeHandles({ { first, first + move }, { same, same - move }, { onPin, onPin + move } }));
  for (const bool isAgain : { false, true })
  {
    dragged.Filter->Modified();
    dragged.Filter->Update();
    const std::string warning = dragged.Observer->GetWarningMessage();
    dragged.Observer->Clear();
    EXPECT_EQ(HasPart(warning, "2 handles hold no voxel that can move"), !isAgain);
    EXPECT_EQ(HasPart(warning, "is point 1 on input port 1"), !isAgain);
    EXPECT_EQ(dragged.Filter->GetNumberOfReleasedHandles(), 2);
    EXPECT_EQ(GetTuple(dragged.Update(), GetId(volume, 3, 5, 5)), move);
  }
}

TEST(ChainMailDeformation, Aborted)
{
  const auto volume = MakeVolume({ { 0, 40, 0, 40, 0, 40 } });
  Dragged dragged(volume);
  const glm::dvec3 rest(20, 20, 20);
  vtkFloatArray* found = dragged.Drag({ { rest, rest + glm::dvec3(3, 0, 0) } });
  const vtkSmartPointer<vtkDataArray> array = dragged.GetArray();
  const vtkSmartPointer<vtkFloatArray> before = Copy(array);
  dragged.Filter->SetHandlesData(MakeHandles({ { rest, rest + glm::dvec3(9, 0, 0) } }));
  dragged.Abort();
  EXPECT_TRUE(
    HaveEqualBits(Copy(array), before)); // the array is not in the output of an aborted update
  dragged.Filter->Update();              // executes again after the abort
  found = dragged.GetFloats();
  EXPECT_EQ(GetTuple(found, GetId(volume, 20, 20, 20)), glm::dvec3(9, 0, 0));
}

// A vtkDeformVolumeFilter that deforms the volume by the displacements of each step.
void CheckDeformed(const Extent& extent)
{
  const auto volume = MakeVolume(extent);
  Dragged dragged(volume);
  dragged.Filter->SetRelaxationSweeps(2);
  dragged.Filter->SetHandleRadius(3.0);
  Deformed chain;
  chain.Filter->SetInputData(volume);
  chain.Filter->SetDeformationConnection(dragged.Filter->GetOutputPort());
  const glm::dvec3 rest(20, 16, 15);
  for (int step = 1; step <= 3; ++step)
  {
    const glm::dvec3 drag(1.0 * step, -1.0, 2.0 - step);
    dragged.Filter->SetHandlesData(MakeHandles({ { rest, rest + drag } }));
    vtkImageData* found = chain.Update();
    // The voxels of the handle are moved by whole voxels.
    for (int i = 19; i <= 21; ++i)
    {
      const auto to = glm::ivec3(glm::dvec3(i, 16, 15) + drag);
      const double expected =
        volume->GetPointData()->GetScalars()->GetTuple1(GetId(volume, i, 16, 15));
      EXPECT_EQ(
        found->GetPointData()->GetScalars()->GetTuple1(GetId(found, to.x, to.y, to.z)), expected);
    }
  }
}

bool IsSame(vtkFloatArray* one, vtkFloatArray* other)
{
  return one->GetNumberOfValues() == other->GetNumberOfValues() &&
    std::equal(one->Begin(), one->End(), other->Begin());
}

// Saved states undo drags, also after a cut.
TEST(ChainMailDeformation, States)
{
  const auto volume = MakeVolume({ { 0, 30, 0, 20, 0, 20 } });
  Dragged dragged(volume);
  EXPECT_TRUE(!dragged.Filter->RestoreState(0) && !dragged.Filter->RemoveState(0));
  const vtkIdType rest = dragged.Filter->SaveState(); // before the first execution
  const auto first = Copy(dragged.Drag({ { { 10, 10, 10 }, { 15, 10, 10 } } }));
  const vtkIdType one = dragged.Filter->SaveState();
  const auto second = Copy(dragged.Drag({ { { 20, 10, 10 }, { 20, 14, 12 } } }));
  EXPECT_TRUE(rest != one && !IsSame(first, second));
  dragged.Filter->SetHandlesData(nullptr);
  EXPECT_TRUE(dragged.Filter->RestoreState(one));
  const vtkIdType again = dragged.Filter->SaveState(); // of the restored state, before an update
  EXPECT_TRUE(IsSame(dragged.Update(), first));
  EXPECT_LE(dragged.Filter->GetChangedExtent()[0], dragged.Filter->GetChangedExtent()[1]);
  EXPECT_TRUE(dragged.Filter->RestoreState(rest));
  dragged.Update();
  EXPECT_EQ(dragged.Filter->GetOutput()->GetPointData()->GetArray(0)->GetMaxNorm(), 0.0);
  EXPECT_TRUE(dragged.Filter->RestoreState(again));
  EXPECT_TRUE(IsSame(dragged.Update(), first));
  EXPECT_EQ(dragged.Filter->GetNumberOfStates(), 3);
  const vtkTypeInt64 memory = dragged.Filter->GetStateMemory();
  EXPECT_TRUE(memory > 6144 && memory < 2 * 60 * 6200); // states share blocks
  EXPECT_TRUE(dragged.Filter->RemoveState(again) && !dragged.Filter->RestoreState(again));
  EXPECT_TRUE(dragged.Filter->RemoveState(one));
  EXPECT_LT(dragged.Filter->GetStateMemory(), 100);

  const vtkIdType whole = dragged.Filter->SaveState();
  vtkNew<vtkImageData> cut;
  cut->ShallowCopy(volume);
  const auto active =
    MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", volume->GetNumberOfCells());
  for (vtkIdType cell = 0; cell < volume->GetNumberOfCells(); ++cell)
  {
    active->SetValue(cell, cell % 30 == 12 ? 0 : 31);
  }
  cut->GetCellData()->AddArray(active);
  dragged.Filter->SetInputData(cut);
  dragged.Drag({ { { 25, 10, 10 }, { 29, 10, 10 } } });
  const vtkIdType apart = dragged.Filter->SaveState();
  const auto parted = Copy(dragged.Update());
  dragged.Filter->SetHandlesData(nullptr);
  // Restore a state from before the cut in the volume without the cut, and a state with the open
  // cut in the cut volume.
  dragged.Filter->SetInputData(volume);
  EXPECT_TRUE(dragged.Filter->RestoreState(whole));
  EXPECT_TRUE(IsSame(dragged.Update(), first));
  dragged.Filter->SetInputData(cut);
  EXPECT_TRUE(dragged.Filter->RestoreState(apart));
  EXPECT_TRUE(IsSame(dragged.Update(), parted));

  // In another volume only the state at rest can be restored.
  dragged.Filter->SetInputData(MakeVolume({ { 0, 20, 0, 20, 0, 20 } }));
  dragged.Update();
  EXPECT_FALSE(dragged.Filter->RestoreState(apart));
  EXPECT_TRUE(dragged.Filter->RestoreState(rest));
}

} // namespace

TEST(ChainMailDeformation, Labels)
{
  CheckLabels<vtkUnsignedCharArray>(false);
  CheckLabels<vtkLongLongArray>(false);
  CheckLabels<vtkFloatArray>(false);
  CheckLabels<vtkShortArray>(true);
  CheckLabels<vtkDoubleArray>(true);
}

TEST(ChainMailDeformation, Deformed)
{
  CheckDeformed({ { 0, 40, 0, 30, 0, 30 } });
  CheckDeformed({ { 0, 70, 0, 70, 0, 70 } }); // displacements are read in place
}
