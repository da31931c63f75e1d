// SPDX-License-Identifier: BSD-3-Clause
// Pulls a head by its nose: squished-head VOLUME.nii.gz PICTURE.png [SIZE]
// draws three pictures side by side: the head at rest, in equilibrium by finite elements, and after
// half a second of mass-spring dynamics. Each has SIZE x SIZE pixels (default: 700). The values of
// the voxels say where the head is stiff bone and where it is soft tissue. Written for ch2.nii.gz
// of the package mricron-data. Coordinates are in mm from the first voxel: x to the right, y to the
// front, z upwards.
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkConnectivityFilter.h>
#include <vtkDataArray.h>
#include <vtkDeformVolumeFilter.h>
#include <vtkDeformationHandleSource.h>
#include <vtkFiniteElementDeformation.h>
#include <vtkImageContinuousDilate3D.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkMassSpringDeformation.h>
#include <vtkMaterialFromVolume.h>
#include <vtkMath.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkSmartVolumeMapper.h>
#include <vtkThreshold.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

namespace
{
constexpr double Nose[3] = { 90.0, 207.0, 32.0 };
constexpr double NoseRadius = 18.0;
constexpr double Pull[3] = { 0.0, 30.0, 8.0 };
constexpr int NumberOfFrames = 30;

// Returns why the volume of a reader is not a head like ch2.nii.gz; "" if it is.
std::string FindFault(vtkNIFTIImageReader* reader)
{
  if (!reader->CanReadFile(reader->GetFileName()))
  {
    return "there is no such file, or it is not a NIfTI file";
  }
  reader->Update();
  vtkImageData* volume = reader->GetOutput();
  if (reader->GetErrorCode() != 0 || !volume->GetPointData()->GetScalars())
  {
    return "its data are damaged or not complete";
  }
  const vtkIdType voxel = volume->FindPoint(const_cast<double*>(Nose));
  if (voxel < 0 || !(volume->GetPointData()->GetScalars()->GetComponent(voxel, 0) >= 1.0))
  {
    return "it has no nose 90 mm to the right, 207 mm to the front and 32 mm above its first "
           "voxel, where ch2.nii.gz has it";
  }
  return "";
}

// Makes a mesh of cubes, each of five tetrahedra, which have the materials of their voxels. cells:
// number of cubes along x. Leaves out tetrahedra that hold air only, and noise in a corner of the
// volume.
vtkSmartPointer<vtkUnstructuredGrid> MakeMesh(vtkAlgorithmOutput* volume, int cells)
{
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputConnection(volume);
  lattice->SetNumberOfNodes(cells + 1, cells / 5 * 6 + 1, cells + 1);
  // The outermost voxels of the skin are as dark as bone. The dilation gives them the value of a
  // brighter neighbor. Bone is thick enough to remain.
  vtkNew<vtkImageContinuousDilate3D> brighter;
  brighter->SetInputConnection(volume);
  brighter->SetKernelSize(3, 3, 3);
  enum
  {
    AIR,
    SOFT,
    BONE
  };
  constexpr double airDensity = 100.0;
  vtkNew<vtkMaterialFromVolume> material;
  material->SetInputConnection(lattice->GetOutputPort());
  material->SetVolumeConnection(brighter->GetOutputPort());
  material->ClearMaterials();
  material->SetMaterial(AIR, 100.0, 0.25, airDensity); // in Pa and kg/m^3
  material->SetMaterial(SOFT, 1e4, 0.3, 1000.0);
  material->SetMaterial(BONE, 1e6, 0.3, 1900.0);
  material->AddMaterialRange(0.0, 1.0, AIR);
  material->AddMaterialRange(1.0, 30.0, BONE);
  material->AddMaterialRange(30.0, 256.0, SOFT);
  vtkNew<vtkThreshold> body;
  body->SetInputConnection(material->GetOutputPort());
  body->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "Density");
  body->SetThresholdFunction(vtkThreshold::THRESHOLD_UPPER);
  body->SetUpperThreshold(1.01 * airDensity);
  vtkNew<vtkConnectivityFilter> largest;
  largest->SetInputConnection(body->GetOutputPort());
  largest->SetExtractionModeToLargestRegion();
  largest->Update();

  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->ShallowCopy(largest->GetOutput());
  vtkNew<vtkUnsignedCharArray> fixed;
  fixed->SetName("Fixed");
  for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
  {
    // The lowest plane of the volume goes through the neck.
    fixed->InsertNextValue(mesh->GetPoint(node)[2] < 1.0 ? 1 : 0);
  }
  mesh->GetPointData()->AddArray(fixed);
  return mesh;
}

// Moves the handle in the nose by a fraction of Pull. part: 0 to 1.
void MoveHandle(vtkDeformationHandleSource* handle, double part)
{
  handle->SetRestPosition(Nose[0], Nose[1], Nose[2]);
  handle->SetPosition(Nose[0] + part * Pull[0], Nose[1] + part * Pull[1], Nose[2] + part * Pull[2]);
}

void Hold(vtkElasticDeformation* body, vtkUnstructuredGrid* mesh)
{
  body->SetInputData(mesh);
  body->SetHandleRadius(NoseRadius);
  body->SetLengthUnitToMillimetre();
}

vtkSmartPointer<vtkRenderer> MakeRenderer(vtkAlgorithmOutput* volume, int column)
{
  vtkNew<vtkSmartVolumeMapper> mapper;
  mapper->SetInputConnection(volume);
  mapper->AutoAdjustSampleDistancesOff(); // the same picture on slow machines
  mapper->SetSampleDistance(0.5);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(25.0, 0.0);
  opacity->AddPoint(55.0, 1.0);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(25.0, 0.87, 0.62, 0.51);
  color->AddRGBPoint(110.0, 0.96, 0.82, 0.72);
  color->AddRGBPoint(200.0, 1.0, 1.0, 0.98);
  vtkNew<vtkVolume> actor;
  actor->SetMapper(mapper);
  vtkVolumeProperty* property = actor->GetProperty();
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetScalarOpacityUnitDistance(1.0);
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

// Views the head from the right and the front.
void AimCamera(vtkCamera* camera)
{
  camera->SetFocalPoint(90.0, 133.0, 83.0);
  camera->SetPosition(472.0, 420.0, 121.0);
  camera->SetViewUp(0.0, 0.0, 1.0);
  camera->SetViewAngle(28.0);
}

// Returns the largest distance, in mm, between the displacements that two models give to a common
// node of their meshes.
double FindLargestDifference(vtkUnstructuredGrid* first, vtkUnstructuredGrid* second)
{
  constexpr double tolerance = 1e-6; // in mm^2
  double largest = 0.0;
  for (vtkIdType node = 0; node < first->GetNumberOfPoints(); ++node)
  {
    double point[3];
    double other[3];
    first->GetPoint(node, point);
    const vtkIdType nearest = second->FindPoint(point);
    second->GetPoint(nearest, other);
    if (vtkMath::Distance2BetweenPoints(point, other) < tolerance)
    {
      double a[3];
      double b[3];
      first->GetPointData()->GetArray("Displacement")->GetTuple(node, a);
      second->GetPointData()->GetArray("Displacement")->GetTuple(nearest, b);
      largest = std::max(largest, vtkMath::Distance2BetweenPoints(a, b));
    }
  }
  return std::sqrt(largest);
}
}

int main(int argc, char* argv[])
{
  const int size = argc > 3 ? std::atoi(argv[3]) : 700;
  if (argc < 3 || argc > 4 || size < 1)
  {
    std::cerr << "usage: squished-head VOLUME.nii.gz PICTURE.png [SIZE]\n";
    return 2;
  }
  vtkNew<vtkNIFTIImageReader> reader;
  reader->SetFileName(argv[1]);
  const std::string fault = FindFault(reader);
  if (!fault.empty())
  {
    std::cerr << "squished-head: cannot use " << argv[1] << ": " << fault << "\n";
    return 1;
  }
  // Cubes of 12 mm and 9 mm: the coarser mesh is for finite elements, which add mid-side nodes.
  const auto mesh = MakeMesh(reader->GetOutputPort(), 15);
  const auto fineMesh = MakeMesh(reader->GetOutputPort(), 20);

  vtkNew<vtkFiniteElementDeformation> elements;
  Hold(elements, mesh);
  elements->SetModeToConverged();
  vtkNew<vtkDeformationHandleSource> handle;
  MoveHandle(handle, 1.0);
  elements->SetHandlesConnection(handle->GetOutputPort());
  elements->Update();
  if (!elements->GetIsConverged())
  {
    std::cerr << "squished-head: no equilibrium was found for " << argv[1] << "\n";
    return 1;
  }

  vtkNew<vtkMassSpringDeformation> springs;
  Hold(springs, fineMesh);
  vtkNew<vtkDeformationHandleSource> slowHandle;
  springs->SetHandlesConnection(slowHandle->GetOutputPort());
  for (int frame = 1; frame <= NumberOfFrames; ++frame)
  {
    // The handle reaches its last position after half of the time.
    MoveHandle(slowHandle, std::min(1.0, 2.0 * frame / NumberOfFrames));
    springs->Modified(); // simulates one more frame, even if the handle rests
    springs->Update();
  }

  vtkNew<vtkDeformVolumeFilter> atRest;
  vtkNew<vtkDeformVolumeFilter> byElements;
  vtkNew<vtkDeformVolumeFilter> bySprings;
  atRest->SetDeformationConnection(elements->GetOutputPort());
  atRest->SetDisplacementScale(0.0);
  byElements->SetDeformationConnection(elements->GetOutputPort());
  bySprings->SetDeformationConnection(springs->GetOutputPort());

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(3 * size, size);
  int column = 0;
  vtkNew<vtkCamera> camera;
  AimCamera(camera);
  for (vtkDeformVolumeFilter* deform : { atRest.Get(), byElements.Get(), bySprings.Get() })
  {
    deform->SetInputConnection(reader->GetOutputPort());
    deform->SetInputArrayToProcess(
      0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Displacement");
    deform->SetPadding(2); // a border, so that the skin is closed at the bounds of the volume
    const auto renderer = MakeRenderer(deform->GetOutputPort(), column++);
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

  std::cout << mesh->GetNumberOfCells() << " tetrahedra in equilibrium after "
            << elements->GetNumberOfNewtonSteps()
            << " Newton steps. Displacements by springs differ by up to "
            << 0.1 *
      std::round(10.0 * FindLargestDifference(elements->GetOutput(), springs->GetOutput()))
            << " mm. "
            << byElements->GetNumberOfInvertedTetrahedra() +
      bySprings->GetNumberOfInvertedTetrahedra()
            << " tetrahedra inverted\n";
  return writer->GetErrorCode() == 0 ? 0 : 1;
}
