// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeView.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkDeformVolumeInteractorStyle.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkImageProperty.h>
#include <vtkImageSlice.h>
#include <vtkImageSliceMapper.h>
#include <vtkMath.h>
#include <vtkMatrix4x4.h>
#include <vtkOpenGLGPUVolumeRayCastMapper.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkReverseSense.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <chrono>
#include <cmath>

VolumeView::VolumeView(vtkDeformVolumeInteractorStyle* style)
  : Style(style)
{
  this->Mapper->SetUseJittering(0);
  // The automatic sample distances are so large that surfaces break up.
  this->Mapper->SetAutoAdjustSampleDistances(0);
  this->Volume->SetMapper(this->Mapper);
  this->Style->SetVolume(this->Volume);
  this->ReversedSurface->SetInputConnection(this->Surface->GetOutputPort());
  this->SurfaceMapper->ScalarVisibilityOff();
  this->SurfaceActor->SetMapper(this->SurfaceMapper);
  this->SurfaceActor->GetProperty()->SetColor(0.93, 0.80, 0.68);
  this->SurfaceActor->GetProperty()->SetSpecular(0.15);
  this->Surface->ComputeScalarsOff();
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    this->SliceMappers[axis]->SetOrientation(static_cast<int>(axis));
    this->Slices[axis]->SetMapper(this->SliceMappers[axis]);
    this->Slices[axis]->GetProperty()->SetInterpolationTypeToLinear();
  }
}

VolumeView::~VolumeView() = default;

void VolumeView::AddTo(vtkRenderer* renderer)
{
  renderer->AddVolume(this->Volume);
  renderer->AddViewProp(this->SurfaceActor);
  for (const auto& slice : this->Slices)
  {
    renderer->AddViewProp(slice);
  }
  this->Choose();
}

// Shows only the chosen display, because VTK updates only visible props.
void VolumeView::Choose()
{
  const bool isThere = this->Style->GetShownImage() != nullptr;
  this->Volume->SetVisibility(isThere && this->Chosen == VOLUME ? 1 : 0);
  this->SurfaceActor->SetVisibility(isThere && this->Chosen == SURFACE ? 1 : 0);
  for (const auto& slice : this->Slices)
  {
    slice->SetVisibility(isThere && this->Chosen == SLICES ? 1 : 0);
  }
  this->Style->SetPickMode(this->Chosen == VOLUME ? vtkDeformVolumeInteractorStyle::OPACITY
      : this->Chosen == SURFACE                   ? vtkDeformVolumeInteractorStyle::ISOSURFACE
                                                  : vtkDeformVolumeInteractorStyle::SLICES);
}

void VolumeView::SetDisplay(Display display)
{
  this->Chosen = display;
  this->Update(nullptr);
}

void VolumeView::SetTransfer(const Transfer& transfer, const double range[2])
{
  transfer.Apply(this->Volume->GetProperty(), range);
  this->Isovalue = transfer.Level;
  this->Surface->SetValue(0, this->Isovalue);
  this->Style->SetIsovalue(this->Isovalue);
  for (const auto& slice : this->Slices)
  {
    // The gray scale includes the values over which the opacity rises, and is wider.
    slice->GetProperty()->SetColorLevel(transfer.Level + transfer.Width);
    slice->GetProperty()->SetColorWindow(4.0 * transfer.Width);
  }
}

double VolumeView::Update(vtkRenderer* renderer)
{
  this->Choose();
  vtkImageData* image = this->Style->GetShownImage();
  if (!image)
  {
    return 0.0;
  }
  vtkMatrix4x4* axes = this->Volume->GetUserMatrix();
  if (this->Chosen == SURFACE)
  {
    this->Surface->SetInputData(image);
    // The fronts of mirrored triangles are inside, where VTK draws them black.
    this->SurfaceMapper->SetInputConnection(axes->Determinant() < 0.0
        ? this->ReversedSurface->GetOutputPort()
        : this->Surface->GetOutputPort());
    this->SurfaceActor->SetUserMatrix(axes);
  }
  this->Style->ClearSlicePlanes();
  for (std::size_t axis = 0; axis < 3 && this->Chosen == SLICES; ++axis)
  {
    const int last = image->GetDimensions()[axis] - 1;
    const int slice = static_cast<int>(std::lround(this->SliceParts[axis] * last));
    this->SliceMappers[axis]->SetInputData(image);
    this->SliceMappers[axis]->SetSliceNumber(slice);
    this->Slices[axis]->SetUserMatrix(axes);
    double point[4] = { 0.0, 0.0, 0.0, 1.0 };
    double normal[4] = { 0.0, 0.0, 0.0, 0.0 };
    point[axis] = slice * image->GetSpacing()[axis];
    normal[axis] = 1.0;
    axes->MultiplyPoint(point, point);
    axes->MultiplyPoint(normal, normal);
    this->Style->AddSlicePlane(point[0], point[1], point[2], normal[0], normal[1], normal[2]);
  }
  if (this->Chosen != VOLUME || !renderer || !renderer->GetRenderWindow())
  {
    return 0.0;
  }
  if (!this->IsDrawn) // the first frame creates the OpenGL resources that an upload needs
  {
    this->IsDrawn = true;
    return 0.0;
  }
  const auto begin = std::chrono::steady_clock::now();
  renderer->GetRenderWindow()->MakeCurrent();
  this->Mapper->PreLoadData(renderer, this->Volume);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void VolumeView::SetCoarse(bool isCoarse)
{
  vtkImageData* image = this->Style->GetShownImage();
  if (image)
  {
    const double* spacing = image->GetSpacing();
    const double least = std::min({ spacing[0], spacing[1], spacing[2] });
    this->Mapper->SetSampleDistance(static_cast<float>(isCoarse ? least : 0.5 * least));
    this->Mapper->SetImageSampleDistance(isCoarse ? 2.0F : 1.0F);
  }
}

void VolumeView::MoveSlice(vtkRenderer* renderer, double part)
{
  const double* view = renderer->GetActiveCamera()->GetDirectionOfProjection();
  vtkMatrix4x4* axes = this->Volume->GetUserMatrix();
  std::size_t facing = 0;
  double most = -1.0;
  for (int axis = 0; axes && axis < 3; ++axis)
  {
    const double column[3] = { axes->GetElement(0, axis), axes->GetElement(1, axis),
      axes->GetElement(2, axis) };
    const double along = std::abs(vtkMath::Dot(column, view));
    if (along > most)
    {
      most = along;
      facing = static_cast<std::size_t>(axis);
    }
  }
  this->SliceParts[facing] = std::clamp(this->SliceParts[facing] + part, 0.0, 1.0);
  this->Update(nullptr);
}
