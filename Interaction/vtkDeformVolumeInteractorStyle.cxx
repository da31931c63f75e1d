// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeInteractorStyleInternals.h"

#include "StyleText.h"
#include "VoxelSize.h"

#include "vtkCamera.h"
#include "vtkDataArray.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkVolumeMapper.h"
#include "vtkVolumeProperty.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

using deformvolume::DisplayToWorld;
using deformvolume::FormatShort;
using deformvolume::ListChoices;
using deformvolume::ModelChoices;
using deformvolume::StyleOverlay;
using deformvolume::ToolChoices;
using Session = vtkDeformVolumeSession;

vtkStandardNewMacro(vtkDeformVolumeInteractorStyle);

namespace
{

constexpr StyleOverlay::Color HeldColor = { { 90, 230, 120 } };
constexpr StyleOverlay::Color GrabbedColor = { { 255, 220, 80 } };
constexpr StyleOverlay::Color StrokeColor = { { 255, 110, 90 } };
constexpr StyleOverlay::Color MeasureColor = { { 120, 200, 255 } };

constexpr int TimerMilliseconds = 15;

constexpr const char* KeyHelp =
  "left button   the tool            right button  turn the camera\n"
  "wheel         depth, radius       middle button move the camera\n"
  "t turn   g grab: drag what is under the cursor; the wheel moves it in depth;\n"
  "         release the button with Shift to keep the handle there\n"
  "c cut:   draw a stroke; the wheel changes the depth\n"
  "v carve: sweep a sphere; the wheel changes the radius\n"
  "b probe  m measure: click two points\n"
  "p pin what is under the cursor   x release the handle under the cursor\n"
  "1 2 3 4 the model   u undo   y redo   z undo all   + - like the wheel\n"
  "r reset the camera   h this help   q quit";

// The matrix from the image that is shown, which has no direction, no origin and no negative
// spacing, to the world.
vtkSmartPointer<vtkMatrix4x4> MakeUserMatrix(vtkImageData* image)
{
  auto axes = vtkSmartPointer<vtkMatrix4x4>::New();
  const int* extent = image->GetExtent();
  double first[3];
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], first);
  const double* spacing = image->GetSpacing();
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      const double direction = image->GetDirectionMatrix()->GetElement(row, column);
      axes->SetElement(row, column, spacing[column] < 0.0 ? -direction : direction);
    }
    axes->SetElement(row, 3, first[row]);
  }
  return axes;
}

} // namespace

std::vector<std::pair<int, glm::dvec3>> vtkDeformVolumeInteractorStyle::vtkInternals::GetHandles()
  const
{
  vtkNew<vtkPolyData> handles;
  this->Session->GetHandles(handles);
  vtkDataArray* numbers = handles->GetPointData()->GetArray("Handle");
  std::vector<std::pair<int, glm::dvec3>> found;
  for (vtkIdType id = 0; id < handles->GetNumberOfPoints(); ++id)
  {
    glm::dvec3 worldPosition(0.0);
    handles->GetPoint(id, &worldPosition.x);
    found.emplace_back(static_cast<int>(numbers->GetComponent(id, 0)), worldPosition);
  }
  return found;
}

void vtkDeformVolumeInteractorStyle::vtkInternals::EndPress()
{
  this->Handle = -1;
  this->Stroke.clear();
  this->CarvedImage = nullptr;
  this->IsPressed = false;
  this->IsChanged = true;
}

void vtkDeformVolumeInteractorStyle::vtkInternals::CancelPress()
{
  const int handle = this->Handle;
  this->EndPress();
  if (handle >= 0)
  {
    this->Session->EndGrab(handle);
  }
}

vtkIdType vtkDeformVolumeInteractorStyle::vtkInternals::FindVoxel(
  const vtkDeformVolumeInteractorStyle* style, vtkImageData* image,
  const deformvolume::LineOfSight& line) const
{
  switch (style->PickMode)
  {
    case ISOSURFACE:
      return deformvolume::FindSurfaceVoxel(image, line, style->Isovalue);
    case SLICES:
      return deformvolume::FindSliceVoxel(image, line, this->Planes);
    default:
      break;
  }
  vtkVolumeProperty* property = this->Volume ? this->Volume->GetProperty() : nullptr;
  return deformvolume::FindAbsorbingVoxel(image, line,
    property ? property->GetScalarOpacity() : nullptr,
    property ? property->GetScalarOpacityUnitDistance() : 1.0);
}

vtkDeformVolumeInteractorStyle::vtkDeformVolumeInteractorStyle()
  : Internals(new vtkInternals)
{
  this->Internals->SessionObserver->SetClientData(this);
  this->Internals->SessionObserver->SetCallback(
    [](vtkObject*, unsigned long event, void* data, void* call)
    {
      auto* style = static_cast<vtkDeformVolumeInteractorStyle*>(data);
      if (event == vtkCommand::ErrorEvent)
      {
        style->ShowMessage(style->Internals->Session->GetErrorMessage());
        return;
      }
      const int percent = static_cast<int>(100.0 * *static_cast<double*>(call));
      style->ShowMessage("Replaying the session: " + std::to_string(percent) + " %");
    });
}

vtkDeformVolumeInteractorStyle::~vtkDeformVolumeInteractorStyle()
{
  this->SetSession(nullptr);
  this->SetInteractor(nullptr);
}

void vtkDeformVolumeInteractorStyle::SetSession(vtkDeformVolumeSession* session)
{
  vtkInternals& internals = *this->Internals;
  if (internals.Session == session)
  {
    return;
  }
  internals.CancelPress();
  if (internals.Session)
  {
    internals.Session->RemoveObserver(internals.SessionObserver);
  }
  internals.Session = session;
  if (session)
  {
    session->AddObserver(vtkCommand::ErrorEvent, internals.SessionObserver);
    session->AddObserver(vtkCommand::ProgressEvent, internals.SessionObserver);
  }
  this->Forget();
  this->Modified();
}

vtkDeformVolumeSession* vtkDeformVolumeInteractorStyle::GetSession()
{
  return this->Internals->Session;
}

void vtkDeformVolumeInteractorStyle::SetVolume(vtkVolume* volume)
{
  if (this->Internals->Volume != volume)
  {
    this->Internals->Volume = volume;
    this->Modified();
  }
}

vtkVolume* vtkDeformVolumeInteractorStyle::GetVolume()
{
  return this->Internals->Volume;
}

void vtkDeformVolumeInteractorStyle::SetInteractor(vtkRenderWindowInteractor* interactor)
{
  if (this->Interactor == interactor)
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  if (this->Interactor && internals.TimerId >= 0)
  {
    this->Interactor->DestroyTimer(internals.TimerId);
    internals.TimerId = -1;
  }
  internals.CancelPress();
  internals.Overlay.SetRenderer(nullptr);
  this->Superclass::SetInteractor(interactor);
}

void vtkDeformVolumeInteractorStyle::StartSession()
{
  if (!this->CheckInteractor() || !this->CheckSession())
  {
    return;
  }
  this->Internals->Session->Start();
  if (this->Internals->TimerId < 0)
  {
    this->Internals->TimerId = this->Interactor->CreateRepeatingTimer(TimerMilliseconds);
  }
}

void vtkDeformVolumeInteractorStyle::StopSession()
{
  if (this->Internals->Session)
  {
    this->Internals->Session->Stop();
  }
  if (this->Interactor && this->Internals->TimerId >= 0)
  {
    this->Interactor->DestroyTimer(this->Internals->TimerId);
    this->Internals->TimerId = -1;
  }
}

bool vtkDeformVolumeInteractorStyle::CheckInteractor()
{
  if (!this->Interactor || !this->Interactor->GetRenderWindow())
  {
    vtkErrorMacro(
      "There is no interactor with a window. Call SetInteractorStyle() of an interactor that has a "
      "render window.");
    return false;
  }
  return true;
}

bool vtkDeformVolumeInteractorStyle::CheckSession()
{
  if (!this->Internals->Session)
  {
    vtkErrorMacro("There is no session. Call SetSession() first.");
    return false;
  }
  return true;
}

void vtkDeformVolumeInteractorStyle::SetCurrentRenderer(vtkRenderer* renderer)
{
  if (!this->Internals->IsPressed || !this->CurrentRenderer || !renderer)
  {
    this->Superclass::SetCurrentRenderer(renderer);
  }
}

bool vtkDeformVolumeInteractorStyle::SelectRenderer()
{
  const int* position = this->Interactor->GetEventPosition();
  return this->SelectRenderer(position[0], position[1]);
}

bool vtkDeformVolumeInteractorStyle::SelectRenderer(int x, int y)
{
  this->FindPokedRenderer(x, y);
  if (!this->CurrentRenderer)
  {
    vtkErrorMacro("The window has no renderer. Call AddRenderer() of the window first.");
    return false;
  }
  this->Internals->Overlay.SetRenderer(this->CurrentRenderer);
  return true;
}

void vtkDeformVolumeInteractorStyle::SetTool(int tool)
{
  tool = std::clamp<int>(tool, TURN, MEASURE);
  if (tool != this->Tool)
  {
    this->EndTool(false);
    this->Internals->Sphere.clear();
    this->Tool = tool;
    this->Modified();
  }
}

void vtkDeformVolumeInteractorStyle::AddSlicePlane(
  double x, double y, double z, double nx, double ny, double nz)
{
  this->Internals->Planes.push_back({ { x, y, z }, { nx, ny, nz } });
  this->Modified();
}

void vtkDeformVolumeInteractorStyle::ClearSlicePlanes()
{
  this->Internals->Planes.clear();
  this->Modified();
}

vtkImageData* vtkDeformVolumeInteractorStyle::GetOutput()
{
  return this->Internals->Output;
}

vtkImageData* vtkDeformVolumeInteractorStyle::GetShownImage()
{
  return this->Internals->ShownImage;
}

void vtkDeformVolumeInteractorStyle::Forget()
{
  vtkInternals& internals = *this->Internals;
  internals.EndPress();
  internals.Output = nullptr;
  internals.ShownImage = nullptr;
  internals.WantedModel = -1;
  internals.MeasuredPositions.clear();
  internals.Sphere.clear();
  this->MeasuredDistance = 0.0;
}

void vtkDeformVolumeInteractorStyle::ShowMessage(const std::string& message)
{
  this->Message = message;
}

std::string vtkDeformVolumeInteractorStyle::GetStatus()
{
  vtkInternals& internals = *this->Internals;
  std::string text = ListChoices(ToolChoices, this->Tool);
  if (this->Tool == CUT && internals.Output)
  {
    text += "  depth " + FormatShort(this->GetEffectiveCutDepth());
  }
  if (this->Tool == CARVE && internals.Output)
  {
    text += "  radius " + FormatShort(this->GetEffectiveCarveRadius());
  }
  text += '\n';
  if (internals.Session)
  {
    text += ListChoices(ModelChoices, internals.GetModel()) + "  " +
      std::to_string(internals.Session->GetNumberOfActions()) + " actions, " +
      std::to_string(internals.Session->GetNumberOfUndoneActions()) + " undone" +
      (internals.Session->GetIsBusy() ? ", moving" : "");
    // Finite elements need several frames to reach equilibrium.
    constexpr double leastShown = 1e-3;
    const double residual = internals.Session->GetRelativeResidual();
    text += residual > leastShown ? ", residual " + FormatShort(100.0 * residual) + " %\n" : "\n";
  }
  return text + (this->Message.empty() ? "h help" : this->Message);
}

bool vtkDeformVolumeInteractorStyle::Poll()
{
  vtkInternals& internals = *this->Internals;
  const vtkSmartPointer<Session> session = internals.Session;
  // Observers of the events below may replace or remove the session and the interactor.
  const auto isConnected = [&]
  {
    return session && internals.Session == session && this->Interactor &&
      this->Interactor->GetRenderWindow();
  };
  if (!isConnected())
  {
    return false;
  }
  if (!session->GetIsRunning() && session->GetIsBusy())
  {
    session->Update();
    if (!isConnected())
    {
      return false;
    }
  }
  // Call GetIsBusy() before TakeOutput(): if the session is not busy, its last output is available.
  const bool isBusy = session->GetIsBusy();
  if (auto output = vtkSmartPointer<vtkImageData>::Take(session->TakeOutput()))
  {
    internals.Output = output;
    this->ShowOutput();
    internals.IsChanged = true;
    this->InvokeEvent(vtkCommand::UpdateDataEvent);
    if (!isConnected())
    {
      return false;
    }
  }
  if (!isBusy)
  {
    internals.WantedModel = -1;
    if (internals.Handle >= 0)
    {
      const auto handles = internals.GetHandles();
      if (std::none_of(handles.begin(), handles.end(),
            [&](const auto& handle) { return handle.first == internals.Handle; }))
      {
        internals.EndPress(); // the handle could not be grabbed
      }
    }
  }
  if (isBusy != internals.WasBusy)
  {
    internals.IsChanged = true; // draw the body at rest in full quality
    internals.WasBusy = isBusy;
    if (!isBusy && this->Tool == PROBE)
    {
      this->ProbeAt(
        this->Interactor->GetEventPosition()[0], this->Interactor->GetEventPosition()[1]);
    }
  }
  if (this->State == VTKIS_NONE)
  {
    this->Interactor->GetRenderWindow()->SetDesiredUpdateRate(
      isBusy ? this->Interactor->GetDesiredUpdateRate() : this->Interactor->GetStillUpdateRate());
  }
  if (this->UpdateOverlay())
  {
    this->InvokeEvent(vtkCommand::UpdateInformationEvent);
  }
  if (!internals.IsChanged || !isConnected())
  {
    return false;
  }
  internals.IsChanged = false;
  this->Interactor->Render();
  return true;
}

void vtkDeformVolumeInteractorStyle::ShowOutput()
{
  vtkInternals& internals = *this->Internals;
  internals.ShownImage = vtkSmartPointer<vtkImageData>::New();
  int dimensions[3];
  internals.Output->GetDimensions(dimensions);
  internals.ShownImage->SetDimensions(dimensions);
  // VTK's mapper shades volumes with a negative spacing wrongly.
  const glm::dvec3 voxel = deformvolume::GetVoxelSize(internals.Output);
  internals.ShownImage->SetSpacing(voxel.x, voxel.y, voxel.z);
  internals.ShownImage->GetPointData()->SetScalars(internals.Output->GetPointData()->GetScalars());
  if (!internals.Volume)
  {
    return;
  }
  internals.Volume->SetUserMatrix(MakeUserMatrix(internals.Output));
  if (auto* mapper = vtkVolumeMapper::SafeDownCast(internals.Volume->GetMapper()))
  {
    mapper->SetInputData(internals.ShownImage);
  }
  else
  {
    this->ShowMessage("The volume has no vtkVolumeMapper. Call SetMapper() of the volume.");
  }
}

bool vtkDeformVolumeInteractorStyle::UpdateOverlay()
{
  vtkInternals& internals = *this->Internals;
  if (!this->CurrentRenderer)
  {
    const int* position = this->Interactor->GetEventPosition();
    this->FindPokedRenderer(position[0], position[1]);
  }
  if (!this->CurrentRenderer)
  {
    return false;
  }
  StyleOverlay& overlay = internals.Overlay;
  overlay.SetRenderer(this->CurrentRenderer);
  const bool hasNewStatus = overlay.SetStatus(this->ShowStatus ? this->GetStatus() : "");
  std::string help = KeyHelp;
  help += this->AdditionalHelp.empty() ? "" : '\n' + this->AdditionalHelp;
  const bool hasNewHelp = overlay.SetHelp(this->ShowHelp ? help : "");
  internals.IsChanged = internals.IsChanged || hasNewStatus || hasNewHelp;
  if (!internals.IsChanged)
  {
    return false;
  }

  overlay.ClearMarks();
  for (const auto& handle : internals.GetHandles())
  {
    if (handle.first != internals.Handle)
    {
      overlay.AddPoint(handle.second, HeldColor);
    }
  }
  if (internals.Handle >= 0)
  {
    overlay.AddPoint(
      internals.GrabbedPosition, GrabbedColor); // the session may not have moved it yet
  }
  std::vector<glm::dvec3> stroke;
  for (const auto& point : internals.Stroke)
  {
    stroke.push_back(DisplayToWorld(this->CurrentRenderer, point[0], point[1], 0.5));
  }
  overlay.AddLine(stroke, StrokeColor);
  for (const glm::dvec3& worldPosition : internals.MeasuredPositions)
  {
    overlay.AddPoint(worldPosition, MeasureColor);
  }
  overlay.AddLine(internals.MeasuredPositions, MeasureColor);
  for (const glm::dvec3& center : internals.Sphere)
  {
    vtkCamera* camera = this->CurrentRenderer->GetActiveCamera();
    const double* view = camera->GetDirectionOfProjection();
    const glm::dvec3 back(-view[0], -view[1], -view[2]);
    const double* viewUp = camera->GetViewUp();
    const glm::dvec3 right =
      glm::normalize(glm::cross(glm::dvec3(viewUp[0], viewUp[1], viewUp[2]), back));
    const glm::dvec3 up = glm::cross(back, right);
    std::vector<glm::dvec3> circle;
    constexpr int corners = 48;
    for (int i = 0; i <= corners; ++i)
    {
      const double angle = 2.0 * vtkMath::Pi() * i / corners;
      circle.push_back(center +
        this->GetEffectiveCarveRadius() * (std::cos(angle) * right + std::sin(angle) * up));
    }
    overlay.AddLine(circle, StrokeColor);
  }
  return hasNewStatus;
}

bool vtkDeformVolumeInteractorStyle::FindPosition(int x, int y, double worldPosition[3])
{
  if (!this->CheckInteractor() || !this->SelectRenderer(x, y) || !this->Internals->Output)
  {
    return false;
  }
  vtkImageData* output = this->Internals->Output;
  const vtkIdType voxel = this->Internals->FindVoxel(
    this, output, deformvolume::GetLineOfSight(this->CurrentRenderer, x, y));
  if (voxel >= 0)
  {
    output->GetPoint(voxel, worldPosition);
  }
  return voxel >= 0;
}

double vtkDeformVolumeInteractorStyle::GetDiagonal()
{
  return this->Internals->Output ? this->Internals->Output->GetLength() : 0.0;
}

double vtkDeformVolumeInteractorStyle::GetEffectiveCutDepth()
{
  return this->CutDepth > 0.0 ? this->CutDepth : 0.1 * this->GetDiagonal();
}

double vtkDeformVolumeInteractorStyle::GetEffectiveCarveRadius()
{
  return this->CarveRadius > 0.0 ? this->CarveRadius : 0.025 * this->GetDiagonal();
}

void vtkDeformVolumeInteractorStyle::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkInternals& internals = *this->Internals;
  os << indent << "Session: " << internals.Session.Get() << "\n"
     << indent << "Volume: " << internals.Volume.Get() << "\n"
     << indent << "Tool: " << ToolChoices[static_cast<std::size_t>(this->Tool)].Name << "\n"
     << indent << "CutDepth: " << this->CutDepth << "\n"
     << indent << "CarveRadius: " << this->CarveRadius << "\n"
     << indent << "PickMode: " << this->PickMode << "\n"
     << indent << "Isovalue: " << this->Isovalue << "\n"
     << indent << "Slice Planes: " << internals.Planes.size() << "\n"
     << indent << "ShowStatus: " << this->ShowStatus << "\n"
     << indent << "ShowHelp: " << this->ShowHelp << "\n"
     << indent << "AdditionalHelp: " << this->AdditionalHelp << "\n"
     << indent << "Message: " << this->Message << "\n"
     << indent << "Measured Distance: " << this->MeasuredDistance << "\n";
}
