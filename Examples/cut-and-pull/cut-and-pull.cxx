// SPDX-License-Identifier: BSD-3-Clause
// Cuts a brain and pulls the cut open: cut-and-pull VOLUME.nii.gz PICTURE.png [SIZE]
// draws three pictures side by side: the volume at rest, cut along a sheet, and opened by
// ChainMail. Each has SIZE x SIZE pixels (default: 700). Written for ch2better.nii.gz of the
// package mricron-data.
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkChainMailDeformation.h>
#include <vtkColorTransferFunction.h>
#include <vtkCutVolume.h>
#include <vtkDeformVolumeFilter.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkMath.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkSmartVolumeMapper.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

namespace
{
// Position of the cut, in mm from the first voxel: x to the right, y to the front, z upwards.
constexpr double SheetX = 99.0;

// Makes a vertical sheet along y, from above the brain down into it.
vtkSmartPointer<vtkPlaneSource> MakeSheet()
{
  auto sheet = vtkSmartPointer<vtkPlaneSource>::New();
  sheet->SetOrigin(SheetX, 35.0, 75.0);
  sheet->SetPoint1(SheetX, 150.0, 75.0);
  sheet->SetPoint2(SheetX, 35.0, 165.0);
  sheet->SetResolution(10, 10);
  return sheet;
}

// Makes handles on both sides of the cut, with their positions at rest and after the pull.
vtkSmartPointer<vtkPolyData> MakeHandles()
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  constexpr int handlesPerSide = 21;
  for (int handle = 0; handle < handlesPerSide; ++handle)
  {
    const double along = handle / (handlesPerSide - 1.0);
    const double pull = 13.0 * std::sin(vtkMath::Pi() * (0.08 + 0.84 * along));
    for (const double side : { -1.0, 1.0 })
    {
      const double from[3] = { SheetX + side * 4.0, 48.0 + 90.0 * along, 128.0 };
      rest->InsertNextTuple(from);
      points->InsertNextPoint(from[0] + side * pull, from[1], from[2]);
    }
  }
  auto handles = vtkSmartPointer<vtkPolyData>::New();
  handles->SetPoints(points);
  handles->GetPointData()->AddArray(rest);
  return handles;
}

vtkSmartPointer<vtkRenderer> MakeRenderer(vtkAlgorithmOutput* volume, int column)
{
  vtkNew<vtkSmartVolumeMapper> mapper;
  mapper->SetInputConnection(volume);
  mapper->AutoAdjustSampleDistancesOff(); // the same picture on slow machines
  mapper->SetSampleDistance(0.25);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(45.0, 0.0);
  opacity->AddPoint(75.0, 1.0);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(45.0, 0.65, 0.45, 0.42);
  color->AddRGBPoint(110.0, 0.90, 0.72, 0.66);
  color->AddRGBPoint(150.0, 1.0, 0.97, 0.92);
  vtkNew<vtkVolume> actor;
  actor->SetMapper(mapper);
  vtkVolumeProperty* property = actor->GetProperty();
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetScalarOpacityUnitDistance(0.5);
  property->SetInterpolationTypeToLinear();
  property->ShadeOn();
  property->SetAmbient(0.15);
  property->SetDiffuse(0.8);
  property->SetSpecular(0.0); // highlights differ between versions of VTK
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetViewport(column / 3.0, 0.0, (column + 1) / 3.0, 1.0);
  renderer->SetBackground(0.10, 0.12, 0.15);
  renderer->AddVolume(actor);
  return renderer;
}

vtkSmartPointer<vtkActor> MakeActor(vtkAlgorithmOutput* surface)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(surface);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.75, 0.85, 0.95);
  actor->GetProperty()->SetAmbient(0.4);
  return actor;
}

// Views the brain from the front and from above.
void AimCamera(vtkCamera* camera)
{
  camera->SetFocalPoint(75.0, 92.0, 78.0);
  camera->SetPosition(190.0, 250.0, 395.0);
  camera->SetViewUp(0.0, -1.0, 0.5);
  camera->SetViewAngle(29.0);
}
}

int main(int argc, char* argv[])
{
  const int size = argc > 3 ? std::atoi(argv[3]) : 700;
  if (argc < 3 || argc > 4 || size < 1)
  {
    std::cerr << "usage: cut-and-pull VOLUME.nii.gz PICTURE.png [SIZE]\n";
    return 2;
  }
  vtkNew<vtkNIFTIImageReader> reader;
  reader->SetFileName(argv[1]);

  vtkNew<vtkCutVolume> cut;
  cut->SetInputConnection(reader->GetOutputPort());
  const auto sheet = MakeSheet();
  cut->SetSheetConnection(sheet->GetOutputPort());

  vtkNew<vtkChainMailDeformation> chainMail;
  chainMail->SetInputConnection(cut->GetOutputPort());
  chainMail->SetHandlesData(MakeHandles());
  chainMail->SetHandleRadius(3.0);
  chainMail->SetRelaxationSweeps(20);

  vtkNew<vtkDeformVolumeFilter> opened;
  vtkNew<vtkDeformVolumeFilter> closed;
  for (vtkDeformVolumeFilter* deform : { opened.Get(), closed.Get() })
  {
    deform->SetInputConnection(cut->GetOutputPort());
    deform->SetDeformationConnection(chainMail->GetOutputPort());
    deform->SetInputArrayToProcess(
      0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Displacement");
  }
  closed->SetDisplacementScale(0.0); // the volume is cut but not pulled

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(3 * size, size);
  int column = 0;
  vtkNew<vtkCamera> camera;
  AimCamera(camera);
  for (vtkAlgorithm* shown : { static_cast<vtkAlgorithm*>(reader),
         static_cast<vtkAlgorithm*>(closed), static_cast<vtkAlgorithm*>(opened) })
  {
    const auto renderer = MakeRenderer(shown->GetOutputPort(), column++);
    if (shown == closed)
    {
      renderer->AddActor(MakeActor(sheet->GetOutputPort()));
    }
    renderer->SetActiveCamera(camera);
    renderer->ResetCameraClippingRange();
    window->AddRenderer(renderer);
  }
  vtkNew<vtkWindowToImageFilter> picture;
  picture->SetInput(window);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(picture->GetOutputPort());
  writer->SetFileName(argv[2]);
  writer->Write();

  std::cout << cut->GetNumberOfSwitchedOffTetrahedra() << " tetrahedra cut, "
            << chainMail->GetNumberOfMovedVoxels() << " voxels pulled, "
            << opened->GetNumberOfInvertedTetrahedra() << " tetrahedra inverted\n";
  return writer->GetErrorCode() == 0 && opened->GetNumberOfCoveredVoxels() > 0 ? 0 : 1;
}
