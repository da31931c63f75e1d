// SPDX-License-Identifier: BSD-3-Clause
// The log of changes of an array: logged ranges, and changes that are not logged.
// vtkDeformVolumeFilter reads only the logged tuples. Testing/Fuzz tests random edits with logs.
#include "ArrayMaking.h"
#include "FilterTesting.h"
#include "vtkArrayChanges.h"

#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkIdTypeArray.h>
#include <vtkInformation.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <limits>
#include <vector>

using namespace filterTesting;

namespace
{

// The first and last tuples of all logged ranges, or {-1} if the log does not contain all changes.
std::vector<vtkIdType> GetTuples(vtkArrayChanges* log, vtkMTimeType time)
{
  vtkNew<vtkIdTypeArray> ranges;
  if (!log->GetTuplesSince(time, ranges))
  {
    EXPECT_EQ(ranges->GetNumberOfTuples(), 0);
    return { -1 };
  }
  return std::vector<vtkIdType>(
    ranges->GetPointer(0), ranges->GetPointer(0) + ranges->GetNumberOfValues());
}

TEST(ArrayChanges, Misuse)
{
  EXPECT_FALSE(vtkArrayChanges::FindLog(nullptr));
  vtkNew<vtkFloatArray> array;
  array->SetNumberOfTuples(10);
  EXPECT_FALSE(vtkArrayChanges::FindLog(array));
  EXPECT_FALSE(array->HasInformation());
  vtkNew<vtkArrayChanges> log;
  log->AddTuples(1, 2);
  EXPECT_FALSE(log->GetArray());
  EXPECT_EQ(GetTuples(log, 0), std::vector<vtkIdType>{ -1 });

  log->SetArray(array);
  EXPECT_EQ(vtkArrayChanges::FindLog(array), log.Get());
  EXPECT_EQ(log->GetArray(), array.Get());
  const vtkMTimeType begin = array->GetMTime();
  log->AddTuples(5, 4);
  EXPECT_EQ(array->GetMTime(), begin);
  EXPECT_TRUE(GetTuples(log, begin).empty());
  EXPECT_EQ(GetTuples(log, begin - 1), std::vector<vtkIdType>{ -1 });

  // A copy of an array has no log. An array has at most one log, and a log has one array.
  vtkNew<vtkFloatArray> copy;
  copy->DeepCopy(array);
  EXPECT_FALSE(vtkArrayChanges::FindLog(copy));
  vtkNew<vtkArrayChanges> other;
  other->SetArray(array);
  EXPECT_EQ(vtkArrayChanges::FindLog(array), other.Get());
  log->SetArray(copy);
  EXPECT_EQ(vtkArrayChanges::FindLog(array), other.Get());
  EXPECT_EQ(vtkArrayChanges::FindLog(copy), log.Get());
  other->SetArray(nullptr);
  EXPECT_FALSE(vtkArrayChanges::FindLog(array));

  // The array holds a reference to the log, but the log holds none to the array.
  vtkSmartPointer<vtkFloatArray> shortLived = vtkSmartPointer<vtkFloatArray>::New();
  log->SetArray(shortLived);
  shortLived = nullptr;
  EXPECT_FALSE(log->GetArray());
  EXPECT_EQ(GetTuples(log, 0), std::vector<vtkIdType>{ -1 });
  {
    vtkNew<vtkArrayChanges> held;
    held->SetArray(array);
  }
  EXPECT_NE(vtkArrayChanges::FindLog(array), nullptr);
}

TEST(ArrayChanges, Log)
{
  vtkNew<vtkFloatArray> array;
  vtkNew<vtkArrayChanges> log;
  log->SetArray(array);
  const vtkMTimeType first = array->GetMTime();
  log->AddTuples(3, 3);
  const vtkMTimeType second = array->GetMTime();
  EXPECT_GT(second, first);
  log->AddTuples(7, 9);
  log->AddTuples(-5, 0);
  EXPECT_EQ(GetTuples(log, first), (std::vector<vtkIdType>{ 3, 3, 7, 9, 0, 0 }));
  EXPECT_EQ(GetTuples(log, second), (std::vector<vtkIdType>{ 7, 9, 0, 0 }));
  EXPECT_TRUE(GetTuples(log, array->GetMTime()).empty());

  // After a change that is not logged, any tuple may have changed.
  const vtkMTimeType third = array->GetMTime();
  array->Modified();
  EXPECT_EQ(GetTuples(log, third), std::vector<vtkIdType>{ -1 });
  const vtkMTimeType seen = array->GetMTime();
  log->AddTuples(4, 4);
  EXPECT_EQ(GetTuples(log, third), std::vector<vtkIdType>{ -1 });
  EXPECT_EQ(GetTuples(log, seen), (std::vector<vtkIdType>{ 4, 4 }));

  // Old entries of a long log are dropped.
  constexpr vtkIdType many = 100000;
  const vtkMTimeType before = array->GetMTime();
  for (vtkIdType i = 0; i < many; ++i)
  {
    log->AddTuples(i, i);
  }
  EXPECT_EQ(GetTuples(log, before), std::vector<vtkIdType>{ -1 });
  const vtkMTimeType late = array->GetMTime();
  log->AddTuples(1, 2);
  EXPECT_EQ(GetTuples(log, late), (std::vector<vtkIdType>{ 1, 2 }));
}

// The filter does not read changes that are missing in the log. After Modified() without a log it
// reads all tuples.
TEST(ArrayChanges, Filter)
{
  const auto volume = MakeImage({ { 0, 30, 0, 30, 0, 30 } });
  AddScalars<short>(
    volume, "value", [](const glm::dvec3& p) { return p.x + 40.0 * p.y + 9.0 * p.z; });
  const auto mesh = MakeMesh(volume, 12, 1.0);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  const auto active =
    MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", volume->GetNumberOfCells());
  active->FillValue(31);
  active->SetValue(0, 1); // a mask in which all tetrahedra are active would not be stored
  volume->GetCellData()->AddArray(active);
  Deformed logged(volume, mesh);
  logged.Filter->SetResamplerToExact();
  logged.Filter->SetOutputBoundsModeToVolumeBounds();
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  vtkNew<vtkArrayChanges> vectorLog;
  vectorLog->SetArray(vectors);
  vtkNew<vtkArrayChanges> maskLog;
  maskLog->SetArray(active);
  const auto update = [&]()
  {
    vtkNew<vtkImageData> copy;
    copy->DeepCopy(logged.Update());
    return vtkSmartPointer<vtkImageData>(copy);
  };
  const auto fresh = [&]()
  {
    Deformed other(volume, mesh);
    other.Filter->SetResamplerToExact();
    other.Filter->SetOutputBoundsModeToVolumeBounds();
    vtkNew<vtkImageData> copy;
    copy->DeepCopy(other.Update());
    return vtkSmartPointer<vtkImageData>(copy);
  };
  const auto start = update();
  EXPECT_TRUE(AreEqual(start, fresh()));

  // The filter compares blocks of 512 nodes. These two nodes are in different blocks.
  const vtkIdType here = 12 * 12 * 2 + 12 * 5 + 5;
  const vtkIdType there = 12 * 12 * 9 + 12 * 5 + 5;
  vectors->SetTuple3(here, 0.75, 0.5, 0.0);
  vectors->SetTuple3(there, 0.75, 0.5, 0.0);
  vectorLog->AddTuples(here, here);
  const auto half = update();
  EXPECT_FALSE(AreEqual(half, start));
  EXPECT_FALSE(AreEqual(half, fresh()));
  vectorLog->AddTuples(there, there);
  EXPECT_TRUE(AreEqual(update(), fresh()));

  const auto cutOff = [&](int z)
  {
    for (int i = 0; i < 12; ++i)
    {
      active->SetValue((z + i / 4) * 900 + (13 + i % 2) * 30 + 13 + i / 2 % 2, 0);
    }
  };
  cutOff(4);
  cutOff(23);
  maskLog->AddTuples(4 * 900, 7 * 900 - 1);
  const auto masked = update();
  EXPECT_FALSE(AreEqual(masked, start));
  EXPECT_FALSE(AreEqual(masked, fresh()));
  active->Modified();
  EXPECT_TRUE(AreEqual(update(), fresh()));

  // The log of the mask does not contain cells that the ghost array hides.
  maskLog->AddTuples(0, 0);
  const auto ghosts = MakeArray<vtkUnsignedCharArray>(
    vtkDataSetAttributes::GhostArrayName(), volume->GetNumberOfCells());
  for (int i = 0; i < 8; ++i)
  {
    ghosts->SetValue(
      (20 + i / 4) * 900 + (15 + i / 2 % 2) * 30 + 15 + i % 2, vtkDataSetAttributes::HIDDENCELL);
  }
  const auto shown = update();
  volume->GetCellData()->AddArray(ghosts);
  const auto hidden = update();
  EXPECT_FALSE(AreEqual(hidden, shown));
  EXPECT_TRUE(AreEqual(hidden, fresh()));
  volume->GetCellData()->RemoveArray(ghosts->GetName());
  EXPECT_TRUE(AreEqual(update(), fresh()));
}

// Values that were written before the log was attached are not in the log.
TEST(ArrayChanges, LateLog)
{
  const auto volume = MakeImage({ { 0, 12, 0, 12, 0, 12 } });
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return p.x; });
  const auto mesh = MakeMesh(volume, 4, 1.0);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed logged(volume, mesh);
  logged.Update();
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  vectors->FillComponent(0, 2.0);
  mesh->Modified();
  vtkNew<vtkArrayChanges> log;
  log->SetArray(vectors);
  vtkNew<vtkImageData> copy;
  copy->DeepCopy(logged.Update());
  Deformed fresh(volume, mesh);
  EXPECT_TRUE(AreEqual(copy, fresh.Update()));
}

// A log of the deformed points does not contain the points at rest. They move in an update that
// fails.
TEST(ArrayChanges, RestPointsOfAFailedUpdate)
{
  const auto volume = MakeImage({ { 0, 12, 0, 12, 0, 12 } });
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return p.x + 40.0 * p.y; });
  const auto rest = MakeMesh(volume, 4, 12.0);
  const auto move = [](vtkPointSet* mesh, double distance)
  {
    for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
    {
      double point[3];
      mesh->GetPoint(i, point);
      mesh->GetPoints()->SetPoint(i, point[0] + distance, point[1], point[2]);
    }
    mesh->GetPoints()->Modified();
  };
  vtkNew<vtkUnstructuredGrid> mesh;
  mesh->DeepCopy(rest);
  move(mesh, 2.0);
  vtkNew<vtkArrayChanges> log;
  log->SetArray(mesh->GetPoints()->GetData());
  const auto hidden = MakeArray<vtkUnsignedCharArray>(
    vtkDataSetAttributes::GhostArrayName(), rest->GetNumberOfCells());
  vtkNew<vtkIdList> cells;
  rest->GetPointCells(0, cells);
  for (vtkIdType i = 0; i < cells->GetNumberOfIds(); ++i)
  {
    hidden->SetValue(cells->GetId(i), vtkDataSetAttributes::HIDDENCELL);
  }
  const auto prepare = [&](Deformed& deformed)
  {
    deformed.Filter->SetInputData(2, rest);
    deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  };
  Deformed deformed(volume, mesh);
  prepare(deformed);
  deformed.Update();
  move(rest, 1.0);
  rest->GetPoints()->SetPoint(0, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeErrors(), 1);
  for (vtkDataSet* one : { static_cast<vtkDataSet*>(rest), static_cast<vtkDataSet*>(mesh) })
  {
    one->GetCellData()->AddArray(hidden);
    one->Modified();
  }
  Deformed fresh(volume, mesh);
  prepare(fresh);
  EXPECT_TRUE(AreEqual(deformed.Update(), fresh.Update()));
}

} // namespace
