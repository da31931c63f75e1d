// SPDX-License-Identifier: BSD-3-Clause
// Cuts and carvings of the interface for C are equal, bit by bit, to those of vtkCutVolume and
// vtkCarveVolume. Testing/C/TestEdits.c tests misuse.
#include "CTesting.h"
#include "FilterTesting.h"

#include "vtkCarveVolume.h"
#include "vtkCutVolume.h"

#include <vtkBox.h>
#include <vtkIdList.h>
#include <vtkImplicitFunction.h>
#include <vtkPlaneSource.h>
#include <vtkPolyData.h>
#include <vtkSphere.h>
#include <vtkSphereSource.h>
#include <vtkTriangleFilter.h>

#include <cstring>
#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

/// The triangles of a vtkPolyData as dv_surface.
struct Surface
{
  explicit Surface(vtkAlgorithmOutput* output)
  {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputConnection(output);
    triangles->Update();
    this->Data = triangles->GetOutput();
    for (vtkIdType cell = 0; cell < this->Data->GetNumberOfCells(); ++cell)
    {
      vtkNew<vtkIdList> ids;
      this->Data->GetCellPoints(cell, ids);
      this->Triangles.insert(this->Triangles.end(), ids->begin(), ids->end());
    }
    this->InC.struct_size = sizeof(this->InC);
    this->InC.number_of_points = this->Data->GetNumberOfPoints();
    this->InC.points = this->Data->GetPoints()->GetVoidPointer(0);
    this->InC.point_type = Types.at(this->Data->GetPoints()->GetDataType());
    this->InC.number_of_triangles = static_cast<std::int64_t>(this->Triangles.size() / 3);
    this->InC.triangles = this->Triangles.data();
  }

  vtkSmartPointer<vtkPolyData> Data;
  std::vector<std::int64_t> Triangles;
  dv_surface InC = {};
};

dv_edit MakeEdit(bool isSmooth, int rule = 0)
{
  dv_edit edit = {};
  edit.struct_size = sizeof(edit);
  edit.smooth = isSmooth ? 1 : 0;
  edit.rule = rule;
  return edit;
}

dv_masks GetMasks(dv_deformer* deformer)
{
  dv_masks masks = {};
  masks.struct_size = sizeof(masks);
  Check(dv_get_masks(deformer, &masks));
  return masks;
}

/// Whether a mask is equal to an array of an image, or both are null.
bool AreSame(const void* mask, vtkDataArray* array)
{
  if (!mask || !array)
  {
    return !mask && !array;
  }
  return std::memcmp(mask, array->GetVoidPointer(0),
           static_cast<std::size_t>(array->GetNumberOfValues()) *
             static_cast<std::size_t>(array->GetDataTypeSize())) == 0;
}

/// Compares the masks of a dv_deformer with the arrays of a volume that filters have edited.
/// atLeast: the least number of switched off and divided tetrahedra.
void Compare(const InC& inC, vtkImageData* edited, std::int64_t atLeast = 1)
{
  const dv_masks masks = GetMasks(inC.Deformer);
  vtkCellData* cells = edited->GetCellData();
  vtkPointData* points = edited->GetPointData();
  EXPECT_TRUE(AreSame(masks.active, cells->GetArray("ActiveTetrahedra")));
  EXPECT_TRUE(AreSame(masks.boundary_distances, points->GetArray("BoundaryDistance")));
  EXPECT_TRUE(AreSame(masks.crossed, cells->GetArray("CutTetrahedra")));
  EXPECT_TRUE(AreSame(masks.cut_distances, points->GetArray("CutDistance")));
  // Make sure that there were edits.
  EXPECT_GE(masks.number_of_switched_off_tetrahedra + masks.number_of_divided_tetrahedra, atLeast);
}

vtkSmartPointer<vtkPlaneSource> MakeSheet(vtkImageData* volume, double along)
{
  double center[3];
  volume->GetCenter(center);
  auto sheet = vtkSmartPointer<vtkPlaneSource>::New();
  sheet->SetOrigin(center[0] - 20.0, center[1] - 20.0, center[2] - 9.0 + along);
  sheet->SetPoint1(center[0] + 20.0, center[1] - 20.0, center[2] + 9.0 + along);
  sheet->SetPoint2(center[0] - 20.0, center[1] + 1.0, center[2] - 9.0 + along);
  return sheet;
}

vtkSmartPointer<vtkSphereSource> MakeBall(vtkImageData* volume)
{
  auto ball = vtkSmartPointer<vtkSphereSource>::New();
  ball->SetCenter(volume->GetCenter());
  ball->SetRadius(5.3);
  ball->SetThetaResolution(12);
  ball->SetPhiResolution(9);
  return ball;
}

TEST(CEdits, Cuts)
{
  const auto volume = MakeTwoArrays();
  const auto source = MakeSheet(volume, 0.0);
  const Surface sheet(source->GetOutputPort());
  for (const bool isSmooth : { false, true })
  {
    vtkNew<vtkCutVolume> cut;
    cut->SetInputData(volume);
    cut->SetSheetData(sheet.Data);
    cut->SetSmoothCut(isSmooth);
    cut->Update();
    InC inC;
    inC.SetVolume(volume, 0.0);
    const dv_edit edit = MakeEdit(isSmooth);
    Check(dv_cut(inC.Deformer, &sheet.InC, &edit));
    Compare(inC, cut->GetOutput(), 100);
    EXPECT_EQ(GetMasks(inC.Deformer).number_of_switched_off_tetrahedra,
      std::int64_t{ cut->GetNumberOfSwitchedOffTetrahedra() });
    EXPECT_EQ(GetMasks(inC.Deformer).number_of_divided_tetrahedra,
      std::int64_t{ cut->GetNumberOfDividedTetrahedra() });
    // Compare the deformed volume.
    auto mesh = MakeMesh(volume, 4);
    SetDisplacements(mesh, Bend);
    Deformed deformed(cut->GetOutput(), mesh);
    inC.SetMesh(mesh);
    inC.Compare(deformed);
    // Another sheet, which crosses the first one, and is undone.
    const auto second = MakeSheet(volume, 2.0);
    second->SetPoint2(second->GetPoint2()[0], second->GetPoint2()[1] + 9.0, 4.0);
    const Surface other(second->GetOutputPort());
    cut->AccumulateOn();
    cut->SetSheetData(other.Data);
    cut->Update();
    Check(dv_cut(inC.Deformer, &other.InC, &edit));
    Compare(inC, cut->GetOutput(), 200);
    inC.Compare(deformed);
    cut->Undo();
    cut->Update();
    Check(dv_undo_edit(inC.Deformer));
    Compare(inC, cut->GetOutput(), 100);
    inC.Compare(deformed);
    cut->Redo();
    cut->Update();
    Check(dv_redo_edit(inC.Deformer));
    Compare(inC, cut->GetOutput(), 200);
  }
}

void FindValues(std::int64_t count, const double* points, double* values, void* user)
{
  auto* function = static_cast<vtkImplicitFunction*>(user);
  for (std::int64_t i = 0; i < count; ++i)
  {
    double point[3] = { points[3 * i], points[3 * i + 1], points[3 * i + 2] };
    values[i] = function->FunctionValue(point);
  }
}

void FindGradients(std::int64_t count, const double* points, double* values, void* user)
{
  auto* function = static_cast<vtkImplicitFunction*>(user);
  for (std::int64_t i = 0; i < count; ++i)
  {
    double point[3] = { points[3 * i], points[3 * i + 1], points[3 * i + 2] };
    function->FunctionGradient(point, values + 3 * i);
  }
}

TEST(CEdits, Bodies)
{
  const auto volume = MakeTwoArrays();
  AddLabels(volume);
  double center[3];
  volume->GetCenter(center);
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(center[0] + 3.0, center[1] + 4.0, center[2]);
  sphere->SetRadius(3.3);
  vtkNew<vtkBox> box;
  box->SetXMin(center[0] - 4.0, center[1] - 3.0, center[2] - 5.0);
  box->SetXMax(center[0] + 1.0, center[1] + 4.0, center[2] + 2.0);
  const auto ball = MakeBall(volume);
  const Surface surface(ball->GetOutputPort());
  const std::vector<double> path{ center[0], center[1], center[2], center[0] + 4.0, center[1] + 1.0,
    center[2] - 2.0, center[0] + 4.0, center[1] - 3.0, center[2] };
  for (const bool isSmooth : { false, true })
  {
    for (int rule = 0; rule < (isSmooth ? 1 : 3); ++rule)
    {
      const dv_edit edit = MakeEdit(isSmooth, rule);
      const auto carve = [&]
      {
        auto filter = vtkSmartPointer<vtkCarveVolume>::New();
        filter->SetInputData(volume);
        filter->SetRule(rule);
        filter->SetSmoothBoundary(isSmooth);
        return filter;
      };
      InC inC;
      inC.SetVolume(volume, 0.0);
      // Functions with and without bounds, in one thread and in several threads.
      for (vtkImplicitFunction* function :
        { static_cast<vtkImplicitFunction*>(sphere), static_cast<vtkImplicitFunction*>(box) })
      {
        const auto filter = carve();
        filter->SetImplicitFunction(function);
        filter->Update();
        dv_body body = {};
        body.struct_size = sizeof(body);
        body.values = FindValues;
        body.gradients = FindGradients;
        body.user = function;
        for (const bool isThreadSafe : { true, false })
        {
          body.is_thread_safe = isThreadSafe ? 1 : 0;
          Check(dv_carve_function(inC.Deformer, &body, &edit));
          Compare(inC, filter->GetOutput(), 100);
          Check(dv_reset_edits(inC.Deformer));
        }
        if (function == box)
        {
          box->GetBounds(body.bounds);
          Check(dv_carve_function(inC.Deformer, &body, &edit));
          Compare(inC, filter->GetOutput(), 100);
          Check(dv_reset_edits(inC.Deformer));
        }
      }
      // A surface, then the path of a sphere, then a label.
      const auto filter = carve();
      filter->SetSurfaceData(surface.Data);
      filter->Update();
      Check(dv_carve_surface(inC.Deformer, &surface.InC, &edit));
      Compare(inC, filter->GetOutput(), 100);
      for (std::size_t i = 0; i < path.size(); i += 3)
      {
        filter->AddToolPosition(path[i], path[i + 1], path[i + 2]);
      }
      filter->SetToolRadius(2.2);
      filter->Update();
      Check(dv_carve_sphere(inC.Deformer, 3, path.data(), 2.2, &edit));
      Compare(inC, filter->GetOutput(), 300);
      vtkDataArray* labels = volume->GetPointData()->GetArray("labels");
      filter->SetLabelArrayName("labels");
      filter->SetLabel(3.0);
      filter->Update();
      dv_array array = {};
      array.struct_size = sizeof(array);
      array.data = labels->GetVoidPointer(0);
      array.type = Types.at(labels->GetDataType());
      array.components = 1;
      Check(dv_carve_label(inC.Deformer, &array, 3.0, &edit));
      Compare(inC, filter->GetOutput(), 400);
      auto mesh = MakeMesh(volume, 4);
      SetDisplacements(mesh, Bend);
      Deformed deformed(filter->GetOutput(), mesh);
      inC.SetMesh(mesh);
      inC.Compare(deformed);
    }
  }
}

// Edits of a volume that has masks of all kinds.
TEST(CEdits, Base)
{
  const auto volume = MakeTwoArrays();
  const auto first = MakeSheet(volume, -3.0);
  const auto second = MakeSheet(volume, 3.0);
  second->SetPoint2(second->GetPoint2()[0], second->GetPoint2()[1] + 9.0, 4.0);
  const Surface firstSheet(first->GetOutputPort());
  const Surface secondSheet(second->GetOutputPort());
  double center[3];
  volume->GetCenter(center);
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(center[0] + 3.0, center[1] + 4.0, center[2]);
  sphere->SetRadius(3.3);
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh, Bend);
  for (const bool isSmooth : { false, true })
  {
    vtkNew<vtkCutVolume> cut;
    cut->SetInputData(volume);
    cut->SetSheetData(firstSheet.Data);
    cut->SetSmoothCut(isSmooth);
    vtkNew<vtkCarveVolume> carve;
    carve->SetInputConnection(cut->GetOutputPort());
    carve->SetImplicitFunction(sphere);
    carve->SetSmoothBoundary(isSmooth);
    carve->Update();
    auto base = vtkSmartPointer<vtkImageData>::New();
    base->DeepCopy(carve->GetOutput());
    // Set the masks before the edits, or after them.
    for (const bool isBaseFirst : { true, false })
    {
      InC inC;
      inC.SetVolume(isBaseFirst ? base : volume, 0.0);
      for (const bool isSmoothEdit : { true, false })
      {
        const dv_edit edit = MakeEdit(isSmoothEdit);
        Check(dv_cut(inC.Deformer, &secondSheet.InC, &edit));
        Check(dv_carve_sphere(inC.Deformer, 1, center, 4.1, &edit));
        if (!isBaseFirst)
        {
          inC.SetVolume(base, 0.0);
        }
        vtkNew<vtkCutVolume> otherCut;
        otherCut->SetInputData(base);
        otherCut->SetSheetData(secondSheet.Data);
        otherCut->SetSmoothCut(isSmoothEdit);
        vtkNew<vtkCarveVolume> otherCarve;
        otherCarve->SetInputConnection(otherCut->GetOutputPort());
        otherCarve->AddToolPosition(center[0], center[1], center[2]);
        otherCarve->SetToolRadius(4.1);
        otherCarve->SetSmoothBoundary(isSmoothEdit);
        otherCarve->Update();
        Compare(inC, otherCarve->GetOutput(), 200);
        // After undo the masks are those of the volume.
        Check(dv_undo_edit(inC.Deformer));
        Check(dv_undo_edit(inC.Deformer));
        Compare(inC, base, 0);
        Deformed deformed(base, mesh);
        inC.SetMesh(mesh);
        inC.Compare(deformed);
        if (!isBaseFirst)
        {
          inC.SetVolume(volume, 0.0);
        }
      }
    }
  }
}

} // namespace
