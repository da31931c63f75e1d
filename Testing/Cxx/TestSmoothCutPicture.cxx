// SPDX-License-Identifier: BSD-3-Clause
// A block that is cut along a curved sheet and pulled apart: whole tetrahedra left out, and beside
// it divided.
#include "FilterTesting.h"

#include "vtkCutVolume.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRegressionTestImage.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <cmath>

using namespace filterTesting;

namespace
{

void Show(vtkRenderWindow* window, int column, bool smooth)
{
  auto volume = MakeImage({ { 0, 30, 0, 24, 0, 12 } });
  AddScalars<float>(volume, "value", [](const glm::dvec3&) { return 100.0; });
  const auto sheet = [](double y) { return 15.2 + 3.0 * std::sin(0.25 * y); };
  vtkNew<vtkPolyData> line;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell(61);
  for (vtkIdType i = 0; i < 61; ++i)
  {
    const double y = -3.0 + 0.5 * static_cast<double>(i);
    points->InsertNextPoint(sheet(y), y, -5.0);
    lines->InsertCellPoint(i);
  }
  line->SetPoints(points);
  line->SetLines(lines);
  vtkNew<vtkCutVolume> cut;
  cut->SetInputData(volume);
  cut->SetSheetData(line);
  cut->SetSweepVector(0.0, 0.0, 30.0);
  cut->SetSmoothCut(smooth);
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  SetDisplacements(field,
    [&](const glm::dvec3& p) { return p + glm::dvec3(p.x < sheet(p.y) ? -2.0 : 2.0, 0.0, 0.0); });
  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputConnection(cut->GetOutputPort());
  deform->SetDeformationData(field);
  deform->SetOutputSpacingModeToCustomSpacing();
  deform->SetCustomSpacing(0.25, 0.25, 0.25);
  deform->SetPadding(1);
  vtkNew<vtkFlyingEdges3D> surface;
  surface->SetInputConnection(deform->GetOutputPort());
  surface->SetValue(0, 50.0);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(surface->GetOutputPort());
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.9, 0.75, 0.6);
  vtkNew<vtkRenderer> renderer;
  renderer->SetViewport(0.5 * column, 0.0, 0.5 * (column + 1), 1.0);
  renderer->SetBackground(0.15, 0.2, 0.3);
  renderer->AddViewProp(actor);
  window->AddRenderer(renderer);
  renderer->ResetCamera();
  renderer->GetActiveCamera()->Elevation(-35.0);
  renderer->GetActiveCamera()->Zoom(1.0);
}

} // namespace

int TestSmoothCutPicture(int argc, char* argv[])
{
  vtkNew<vtkRenderWindow> window;
  window->SetSize(500, 250);
  window->SetMultiSamples(0);
  Show(window, 0, false);
  Show(window, 1, true);
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetRenderWindow(window);
  window->Render();
  const int image = vtkRegressionTestImage(window);
  if (image == vtkRegressionTester::DO_INTERACTOR)
  {
    interactor->Start();
  }
  VERIFY(image != vtkRegressionTester::FAILED);
  return GetExitCode();
}
