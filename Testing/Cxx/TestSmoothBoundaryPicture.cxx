// SPDX-License-Identifier: BSD-3-Clause
// A bowl that is carved out of whole tetrahedra, and beside it the same with a smooth boundary.
#include "SmoothPictures.h"

#include "vtkCarveVolume.h"

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
  smoothPictures::ShowSurface(window, column, carve->GetOutputPort(), mesh, 1.3);
}

} // namespace

int TestSmoothBoundaryPicture(int argc, char* argv[])
{
  return smoothPictures::ComparePicture(argc, argv, Show);
}
