// SPDX-License-Identifier: BSD-3-Clause
// Functions that several scenes use: deformations, cameras, colors, slices and surfaces.
#include "SceneTesting.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageProperty.h>
#include <vtkImageSlice.h>
#include <vtkImageSliceMapper.h>
#include <vtkLookupTable.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

namespace sceneTesting
{

vtkSmartPointer<vtkDataSet> Shifted(vtkDataSet* deformation, Version version)
{
  auto shifted = vtkSmartPointer<vtkDataSet>::Take(deformation->NewInstance());
  shifted->DeepCopy(deformation);
  vtkDataArray* vectors = shifted->GetPointData()->GetVectors();
  for (vtkIdType i = 0; version == Version::SHIFTED && i < vectors->GetNumberOfTuples(); ++i)
  {
    vectors->SetComponent(i, 0, vectors->GetComponent(i, 0) + 1.0);
  }
  return shifted;
}

vtkRenderer* AddRenderer(vtkRenderWindow* window, const glm::dvec3& center,
  const glm::dvec3& direction, double height, int column, int columns)
{
  vtkNew<vtkRenderer> renderer;
  renderer->SetViewport(static_cast<double>(column) / columns, 0.0, (column + 1.0) / columns, 1.0);
  renderer->SetBackground(0.15, 0.2, 0.3);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetParallelScale(0.5 * height);
  camera->SetFocalPoint(&center.x);
  const glm::dvec3 position = center + direction;
  camera->SetPosition(&position.x);
  if (direction.x == 0.0 && direction.y == 0.0)
  {
    camera->SetViewUp(0.0, 1.0, 0.0);
  }
  else
  {
    camera->SetViewUp(0.0, 0.0, 1.0);
  }
  window->AddRenderer(renderer);
  return renderer;
}

vtkSmartPointer<vtkLookupTable> MakeColors(
  double lowest, double highest, const std::vector<glm::dvec3>& colors, int number)
{
  vtkNew<vtkColorTransferFunction> ramp;
  for (std::size_t i = 0; i < colors.size(); ++i)
  {
    ramp->AddRGBPoint(static_cast<double>(i) / static_cast<double>(colors.size() - 1), colors[i].x,
      colors[i].y, colors[i].z);
  }
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(number);
  table->SetTableRange(lowest, highest);
  for (int i = 0; i < number; ++i)
  {
    double color[3];
    ramp->GetColor(i / (number - 1.0), color);
    table->SetTableValue(i, color[0], color[1], color[2]);
  }
  table->SetBelowRangeColor(0.0, 0.0, 0.0, 0.0);
  table->UseBelowRangeColorOn();
  return table;
}

void AddSlice(
  vtkRenderer* renderer, vtkImageData* volume, const char* array, vtkLookupTable* colors)
{
  vtkNew<vtkImageData> image;
  image->ShallowCopy(volume);
  image->GetPointData()->SetActiveScalars(array);
  vtkNew<vtkImageSliceMapper> mapper;
  mapper->SetInputData(image);
  mapper->SetOrientationToZ();
  mapper->SliceAtFocalPointOn();
  vtkNew<vtkImageSlice> slice;
  slice->SetMapper(mapper);
  slice->GetProperty()->SetLookupTable(colors);
  slice->GetProperty()->UseLookupTableScalarRangeOn();
  slice->GetProperty()->SetInterpolationTypeToNearest();
  renderer->AddViewProp(slice);
}

void AddSurface(
  vtkRenderer* renderer, vtkAlgorithmOutput* volume, const char* array, vtkLookupTable* colors)
{
  vtkNew<vtkFlyingEdges3D> surface;
  surface->SetInputConnection(volume);
  surface->SetValue(0, 50.0);
  surface->InterpolateAttributesOn();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(surface->GetOutputPort());
  mapper->SetScalarVisibility(array != nullptr);
  if (array)
  {
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray(array);
    mapper->SetLookupTable(colors);
    mapper->UseLookupTableScalarRangeOn();
  }
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->ForceOpaqueOn(); // the table has a transparent color, which slices use
  actor->GetProperty()->SetColor(0.9, 0.75, 0.6);
  renderer->AddViewProp(actor);
}

void SetSampling(vtkDeformVolumeFilter* filter, double spacing, double background)
{
  filter->SetOutputSpacingModeToCustomSpacing();
  filter->SetCustomSpacing(spacing, spacing, spacing);
  filter->SetPadding(1);
  filter->SetBackgroundValue(background);
}

} // namespace sceneTesting
