// SPDX-License-Identifier: BSD-3-Clause
// Pictures of what is left of a volume: of whole tetrahedra, and beside it with smooth faces.
#ifndef SmoothPictures_h
#define SmoothPictures_h

#include "FilterTesting.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkFlyingEdges3D.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRegressionTestImage.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

namespace smoothPictures
{

/// Shows the surface of an edited volume that is deformed, in the left column (0) or the right one,
/// drawn with four samples to a voxel on each axis.
inline void ShowSurface(vtkRenderWindow* window, int column, vtkAlgorithmOutput* edited,
  vtkDataSet* deformation, double zoom)
{
  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputConnection(edited);
  deform->SetDeformationData(deformation);
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
  renderer->GetActiveCamera()->Zoom(zoom);
}

/// Compares the picture of both with the baseline. show(window, column, smooth): shows one of them.
template <typename Show>
int ComparePicture(int argc, char* argv[], Show&& show)
{
  vtkNew<vtkRenderWindow> window;
  window->SetSize(500, 250);
  window->SetMultiSamples(0);
  show(window, 0, false);
  show(window, 1, true);
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetRenderWindow(window);
  window->Render();
  const int image = vtkRegressionTestImage(window);
  if (image == vtkRegressionTester::DO_INTERACTOR)
  {
    interactor->Start();
  }
  VERIFY(image != vtkRegressionTester::FAILED);
  return filterTesting::GetExitCode();
}

} // namespace smoothPictures

#endif
