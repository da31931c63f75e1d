// SPDX-License-Identifier: BSD-3-Clause
// A bowl that is carved out of whole tetrahedra, and beside it the same with a smooth boundary.
#include "FilterTesting.h"

#include "vtkCarveVolume.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkFlyingEdges3D.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRegressionTestImage.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSphere.h>

using namespace filterTesting;

namespace
{

void Show(vtkRenderWindow* window, int column, bool smooth)
{
  auto volume = MakeImage({ { 0, 30, 0, 30, 0, 16 } });
  AddScalars<float>(volume, "value", [](const glm::dvec3&) { return 100.0; });
  auto mesh = MakeMesh(volume, 2);
  SetDisplacements(mesh, Shift(0, 0, 0));
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(15, 15, 17);
  sphere->SetRadius(11);
  vtkNew<vtkCarveVolume> carve;
  carve->SetInputData(volume);
  carve->SetImplicitFunction(sphere);
  carve->SetSmoothBoundary(smooth);
  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputConnection(carve->GetOutputPort());
  deform->SetDeformationData(mesh);
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
  renderer->GetActiveCamera()->Zoom(1.3);
}

} // namespace

int TestSmoothBoundaryPicture(int argc, char* argv[])
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
