// SPDX-License-Identifier: BSD-3-Clause
#include "Picture.h"

#include "Failure.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "OutputFile.h"

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkDataArray.h>
#include <vtkErrorCode.h>
#include <vtkImageData.h>
#include <vtkImageExtractComponents.h>
#include <vtkImageShiftScale.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRenderingOpenGLConfigure.h>
#include <vtkSmartVolumeMapper.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#if defined(VTK_USE_X) && defined(DEFORMVOLUME_HAVE_X11)
#include <X11/Xlib.h>
#endif

#include <algorithm>
#include <cmath>
#include <vector>

namespace
{
constexpr int PictureSize = 700;

vtkDataArray* GetShownArray(vtkImageData* image)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  return scalars ? scalars : image->GetPointData()->GetArray(0);
}

// Adds the world positions of a sample of the visible voxels, which is sufficient to aim a camera,
// or of the corners of the image if no voxel is visible.
void AddShownPoints(
  vtkImageData* image, double threshold, std::vector<std::array<double, 3>>& points)
{
  int extent[6];
  image->GetExtent(extent);
  int steps[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    constexpr int samplesPerAxis = 64;
    steps[axis] = 1 + (extent[2 * axis + 1] - extent[2 * axis]) / samplesPerAxis;
  }
  const auto add = [&](int x, int y, int z)
  {
    std::array<double, 3> point;
    image->TransformIndexToPhysicalPoint(x, y, z, point.data());
    points.push_back(point);
  };
  vtkDataArray* values = GetShownArray(image);
  const std::size_t before = points.size();
  for (int z = extent[4]; z <= extent[5]; z += steps[2])
  {
    for (int y = extent[2]; y <= extent[3]; y += steps[1])
    {
      for (int x = extent[0]; x <= extent[1]; x += steps[0])
      {
        int index[3] = { x, y, z };
        if (values->GetComponent(image->ComputePointId(index), 0) >= threshold)
        {
          add(x, y, z);
        }
      }
    }
  }
  const bool isAny = points.size() > before;
  for (int corner = 0; corner < 8 && !isAny; ++corner)
  {
    add(extent[corner & 1], extent[2 + (corner >> 1 & 1)], extent[4 + (corner >> 2)]);
  }
}

// Returns an image without direction and origin, with one component of a type that all mappers
// support: mappers differ in the directions and types that they support. The matrix of the actor
// applies direction and origin.
vtkSmartPointer<vtkImageData> MakeDrawable(vtkImageData* image)
{
  vtkNew<vtkImageData> plain;
  int dimensions[3];
  image->GetDimensions(dimensions);
  plain->SetDimensions(dimensions);
  plain->SetSpacing(image->GetSpacing());
  plain->GetPointData()->SetScalars(GetShownArray(image));
  vtkNew<vtkImageExtractComponents> component;
  component->SetInputData(plain);
  component->SetComponents(0);
  component->Update();
  const int type = component->GetOutput()->GetScalarType();
  if (type == VTK_UNSIGNED_CHAR || type == VTK_UNSIGNED_SHORT || type == VTK_SHORT ||
    type == VTK_FLOAT)
  {
    return component->GetOutput();
  }
  vtkNew<vtkImageShiftScale> cast;
  cast->SetInputConnection(component->GetOutputPort());
  cast->SetOutputScalarTypeToFloat();
  cast->Update();
  return cast->GetOutput();
}

vtkSmartPointer<vtkVolumeProperty> MakeProperty(double threshold, double maximum, double spacing)
{
  vtkNew<vtkPiecewiseFunction> opacity;
  const double step = 0.25 * (maximum > threshold ? maximum - threshold : 1.0);
  opacity->AddPoint(threshold - step, 0.0);
  opacity->AddPoint(threshold - 0.5 * step, 0.0);
  opacity->AddPoint(threshold + 0.5 * step, 1.0);
  opacity->AddPoint(maximum + step, 1.0);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(threshold, 0.87, 0.62, 0.51);
  color->AddRGBPoint(0.5 * (threshold + maximum), 0.96, 0.82, 0.72);
  color->AddRGBPoint(maximum, 1.0, 1.0, 0.98);
  auto property = vtkSmartPointer<vtkVolumeProperty>::New();
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetScalarOpacityUnitDistance(spacing);
  property->SetInterpolationTypeToLinear();
  property->ShadeOn();
  property->SetAmbient(0.15);
  property->SetDiffuse(0.8);
  property->SetSpecular(0.15);
  property->SetSpecularPower(15.0);
  return property;
}

// Moves the camera as close as possible while all points stay visible.
void AimCamera(vtkCamera* camera, const std::array<double, 3>& view,
  const std::vector<std::array<double, 3>>& points)
{
  // The axes of the camera: to the right, upwards and to the viewer.
  double axes[3][3];
  double* right = axes[0];
  double* up = axes[1];
  double* back = axes[2];
  std::copy(view.begin(), view.end(), back);
  vtkMath::Normalize(back);
  const bool fromAbove = std::abs(back[2]) > 0.99;
  const double head[3] = { 0.0, fromAbove ? 1.0 : 0.0, fromAbove ? 0.0 : 1.0 };
  vtkMath::Cross(head, back, right);
  vtkMath::Normalize(right);
  vtkMath::Cross(back, right, up);

  double center[3] = { 0.0, 0.0, 0.0 };
  for (const double* axis : axes)
  {
    double minimum = VTK_DOUBLE_MAX;
    double maximum = -VTK_DOUBLE_MAX;
    for (const auto& point : points)
    {
      minimum = std::min(minimum, vtkMath::Dot(point.data(), axis));
      maximum = std::max(maximum, vtkMath::Dot(point.data(), axis));
    }
    for (int i = 0; i < 3; ++i)
    {
      center[i] += 0.5 * (minimum + maximum) * axis[i];
    }
  }

  constexpr double viewAngle = 30.0;
  constexpr double border = 1.12;
  const double tangent = std::tan(vtkMath::RadiansFromDegrees(0.5 * viewAngle)) / border;
  double distance = 0.0;
  for (const auto& point : points)
  {
    double offset[3];
    vtkMath::Subtract(point.data(), center, offset);
    const double aside =
      std::max(std::abs(vtkMath::Dot(offset, right)), std::abs(vtkMath::Dot(offset, up)));
    distance = std::max(distance, vtkMath::Dot(offset, back) + aside / tangent);
  }
  camera->SetViewAngle(viewAngle);
  camera->SetFocalPoint(center);
  camera->SetPosition(
    center[0] + distance * back[0], center[1] + distance * back[1], center[2] + distance * back[2]);
  camera->SetViewUp(up);
}

vtkSmartPointer<vtkRenderer> MakeRenderer(
  vtkImageData* image, vtkVolumeProperty* property, const char* title)
{
  vtkNew<vtkSmartVolumeMapper> mapper;
  mapper->SetInputData(MakeDrawable(image));
  vtkNew<vtkVolume> actor;
  actor->SetMapper(mapper);
  actor->SetProperty(property);
  actor->SetUserMatrix(GetAxes(image));
  vtkNew<vtkTextActor> text;
  text->SetInput(title);
  text->SetPosition(16, 12);
  text->GetTextProperty()->SetFontSize(22);
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetBackground(0.10, 0.12, 0.15);
  renderer->AddVolume(actor);
  renderer->AddViewProp(text);
  return renderer;
}
}

double FindThreshold(vtkImageData* image)
{
  double range[2];
  GetShownArray(image)->GetFiniteRange(range, 0);
  return range[0] + 0.2 * (range[1] - range[0]);
}

std::array<double, 3> GetFaceView(WorldAxes axes)
{
  const double front = axes == WorldAxes::LeftPosteriorSuperior ? -1.0 : 1.0;
  return { { -0.55 * front, front, 0.10 } };
}

void CheckDisplay()
{
#if defined(VTK_USE_X) && defined(DEFORMVOLUME_HAVE_X11)
  Display* display = XOpenDisplay(nullptr);
  if (!display)
  {
    throw Failure("cannot draw a picture: there is no X display. Set DISPLAY, or start the program "
                  "with xvfb-run -a -s \"-noreset -screen 0 1400x1024x24\" in front");
  }
  // The connection stays open: when its last client leaves, an X server starts again, and refuses
  // the connection of the window meanwhile.
#endif
}

Picture::Picture(vtkImageData* before, const PictureOptions& options)
  : Options(options)
  , Before(before)
  , Window(vtkSmartPointer<vtkRenderWindow>::New())
  , Grab(vtkSmartPointer<vtkWindowToImageFilter>::New())
{
  double range[2];
  GetShownArray(before)->GetFiniteRange(range, 0);
  const double* spacing = before->GetSpacing();
  this->Property =
    MakeProperty(options.Threshold, range[1], std::min({ spacing[0], spacing[1], spacing[2] }));
  this->Left = MakeRenderer(before, this->Property, "before");
  this->Left->SetViewport(0.0, 0.0, 0.5, 1.0);
  this->Window->SetOffScreenRendering(1);
  this->Window->SetMultiSamples(0);
  this->Window->SetSize(2 * PictureSize, PictureSize);
  this->Window->AddRenderer(this->Left);
  this->Grab->SetInput(this->Window);
  this->Grab->ReadFrontBufferOff();
  this->Grab->SetInputBufferTypeToRGB();
}

vtkImageData* Picture::Draw(vtkImageData* after, Aim aim, Messages& messages)
{
  const bool isFirst = !this->Right;
  if (!isFirst)
  {
    this->Window->RemoveRenderer(this->Right);
  }
  this->Right = MakeRenderer(after, this->Property, "after");
  this->Right->SetViewport(0.5, 0.0, 1.0, 1.0);
  this->Window->AddRenderer(this->Right);

  vtkCamera* camera = this->Left->GetActiveCamera();
  if (isFirst || aim == Aim::Tight)
  {
    std::vector<std::array<double, 3>> points;
    AddShownPoints(this->Before, this->Options.Threshold, points);
    if (aim == Aim::Tight)
    {
      AddShownPoints(after, this->Options.Threshold, points);
    }
    AimCamera(camera, this->Options.View, points);
    if (aim == Aim::Fixed)
    {
      constexpr double room = 0.8;
      camera->Dolly(room);
    }
  }
  this->Right->SetActiveCamera(camera);
  this->Left->ResetCameraClippingRange();
  double clipping[2];
  camera->GetClippingRange(clipping);
  this->Right->ResetCameraClippingRange();
  const double* other = camera->GetClippingRange();
  camera->SetClippingRange(std::min(clipping[0], other[0]), std::max(clipping[1], other[1]));
  this->Window->Render();
  messages.Check("cannot draw the picture");
  this->Grab->Modified();
  this->Grab->Update();
  return this->Grab->GetOutput();
}

void WritePNG(vtkImageData* image, const std::string& path, Messages& messages)
{
  OutputFile file(path);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(file.GetPath().c_str());
  writer->Write();
  file.Finish(messages, writer->GetErrorCode() == vtkErrorCode::NoError);
}
