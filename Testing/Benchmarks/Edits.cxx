// SPDX-License-Identifier: BSD-3-Clause
// Measures cutting and carving.
#include "Evaluation.h"
#include "Timing.h"

#include "vtkCarveVolume.h"
#include "vtkCutVolume.h"

#include <vtkCellArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkSphere.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace
{

constexpr int SheetColumns = 10; // 200 triangles
constexpr double SphereRadius = 20.0;

// Returns a wavy sheet of 200 triangles through the whole volume, at a given height.
vtkSmartPointer<vtkPolyData> MakeSheet(vtkImageData* volume, double height)
{
  double bounds[6];
  volume->GetBounds(bounds);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  for (int v = 0; v <= SheetColumns; ++v)
  {
    for (int u = 0; u <= SheetColumns; ++u)
    {
      const double x = -0.05 + 1.1 * u / SheetColumns;
      const double z = -0.05 + 1.1 * v / SheetColumns;
      const double y = height + 0.07 * std::sin(0.9 * u) * std::cos(0.7 * v);
      points->InsertNextPoint(bounds[0] + x * (bounds[1] - bounds[0]),
        bounds[2] + y * (bounds[3] - bounds[2]), bounds[4] + z * (bounds[5] - bounds[4]));
      if (u < SheetColumns && v < SheetColumns)
      {
        const vtkIdType p = v * (SheetColumns + 1) + u;
        const vtkIdType q = p + SheetColumns + 1;
        const vtkIdType lower[3] = { p, p + 1, q };
        const vtkIdType upper[3] = { p + 1, q + 1, q };
        triangles->InsertNextCell(3, lower);
        triangles->InsertNextCell(3, upper);
      }
    }
  }
  auto sheet = vtkSmartPointer<vtkPolyData>::New();
  sheet->SetPoints(points);
  sheet->SetPolys(triangles);
  return sheet;
}

// A volume with both filters, and the positions of their tools.
struct Editing
{
  explicit Editing(vtkImageData* volume)
    : Volume(volume)
  {
    this->Cut->SetInputData(volume);
    this->Carve->SetInputData(volume);
    this->Carve->SetImplicitFunction(this->Sphere);
    this->Sphere->SetRadius(SphereRadius * volume->GetSpacing()[0]);
    this->Cut->Update();
    this->Carve->Update();
  }

  // Moves the edge of the tool to and fro over 44 % of the height and of the width of the volume.
  // The tool touches 1 % of the bricks in each step.
  void StepTool()
  {
    double bounds[6];
    this->Volume->GetBounds(bounds);
    const auto place = [&](int axis, double share)
    { return bounds[2 * axis] + share * (bounds[2 * axis + 1] - bounds[2 * axis]); };
    const double y = place(1, this->Step % 2 == 0 ? 0.2 : 0.64);
    const double x = place(0, 0.3 + 0.002 * this->Step);
    this->Cut->AddToolPosition(x, y, place(2, 0.2), x, y, place(2, 0.64));
    ++this->Step;
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkNew<vtkCutVolume> Cut;
  vtkNew<vtkCarveVolume> Carve;
  vtkNew<vtkSphere> Sphere;
  int Step = 0;
};

// Returns a contestant that makes a change, which is not measured, and measures the next update.
Contestant<Editing> MakeEdit(
  const std::string& name, const std::function<vtkImageAlgorithm*(Editing&)>& edit)
{
  return { name,
    [=](Editing& editing)
    {
      vtkImageAlgorithm* filter = edit(editing);
      Measurement measurement;
      measurement.Seconds = Time([&] { filter->Update(); });
      return measurement;
    } };
}

} // namespace

void RegisterEdits(const EvaluationSize& size)
{
  const std::vector<Contestant<Editing>> edits{
    MakeEdit("sheet",
      [](Editing& editing)
      {
        editing.Cut->SetSheetData(MakeSheet(editing.Volume, 0.4 + 0.003 * ++editing.Step));
        return editing.Cut.Get();
      }),
    MakeEdit("tool",
      [](Editing& editing)
      {
        editing.StepTool();
        editing.Cut->Update();
        editing.StepTool();
        return editing.Cut.Get();
      }),
    MakeEdit("nothing",
      [](Editing& editing)
      {
        editing.Cut->Modified();
        return editing.Cut.Get();
      }),
    MakeEdit("sphere",
      [](Editing& editing)
      {
        double center[3];
        editing.Volume->GetCenter(center);
        editing.Sphere->SetCenter(
          center[0] + 0.1 * ++editing.Step * editing.Volume->GetSpacing()[0], center[1], center[2]);
        return editing.Carve.Get();
      })
  };
  for (const auto& dimensions : { HalfVolume, BenchmarkVolume })
  {
    RegisterRounds<Editing>(
      "Edit/" + GetName(dimensions), size.GetRounds(),
      [dimensions]() { return std::make_shared<Editing>(MakeVolume(dimensions)); }, edits);
  }
}
