// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeInteractorStyle.h"

#include "StyleOverlay.h"
#include "VisiblePlaces.h"
#include "vtkDeformVolumeSession.h"

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"
#include "vtkVolumeProperty.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

using deformvolume::LineOfSight;
using deformvolume::StyleOverlay;
using Session = vtkDeformVolumeSession;

vtkStandardNewMacro(vtkDeformVolumeInteractorStyle);

namespace
{

constexpr StyleOverlay::Colour HeldColour = { { 90, 230, 120 } };
constexpr StyleOverlay::Colour GrabbedColour = { { 255, 220, 80 } };
constexpr StyleOverlay::Colour StrokeColour = { { 255, 110, 90 } };
constexpr StyleOverlay::Colour MeasureColour = { { 120, 200, 255 } };

constexpr int PixelsOfStroke = 4;   // between the points of a stroke
constexpr int PixelsOfHandle = 20;  // from the cursor to a handle
constexpr double WheelFactor = 1.1; // of a depth or a radius
constexpr int TimerMilliseconds = 15;

struct Choice
{
  char Key;
  const char* Name;
};
// In the order of the enumerations.
constexpr std::array<Choice, 6> ToolChoices = { { { 't', "turn" }, { 'g', "grab" }, { 'c', "cut" },
  { 'v', "carve" }, { 'b', "probe" }, { 'm', "measure" } } };
constexpr std::array<Choice, 4> ModelChoices = { { { '1', "none" }, { '2', "ChainMail" },
  { '3', "mass-spring" }, { '4', "finite elements" } } };

constexpr const char* KeyHelp =
  "left button   the tool            right button  turn the camera\n"
  "wheel         depth, radius       middle button move the camera\n"
  "t turn   g grab: drag what is under the cursor; the wheel moves it in depth;\n"
  "         with Shift the handle stays where it is left\n"
  "c cut:   draw a stroke; the wheel changes how deep it cuts\n"
  "v carve: sweep a sphere; the wheel changes its radius\n"
  "b probe  m measure: press on two places\n"
  "p pin what is under the cursor   x release the handle under the cursor\n"
  "1 2 3 4 the model   u undo   y redo   z undo all   + - like the wheel\n"
  "r reset the camera   h this help   q quit";

template <std::size_t Count>
std::string ListChoices(const std::array<Choice, Count>& choices, int chosen)
{
  std::string text;
  for (std::size_t i = 0; i < Count; ++i)
  {
    const bool isChosen = static_cast<int>(i) == chosen;
    text += text.empty() ? "" : " ";
    text += isChosen ? '[' : ' ';
    text += choices[i].Key;
    text += ' ';
    text += choices[i].Name;
    text += isChosen ? ']' : ' ';
  }
  return text;
}

template <std::size_t Count>
int FindChoice(const std::array<Choice, Count>& choices, char key)
{
  for (std::size_t i = 0; i < Count; ++i)
  {
    if (choices[i].Key == key)
    {
      return static_cast<int>(i);
    }
  }
  return -1;
}

std::string Format(double number)
{
  char digits[32];
  std::snprintf(digits, sizeof(digits), "%.4g", number);
  return digits;
}

std::string Format(const double place[3])
{
  return "(" + Format(place[0]) + ", " + Format(place[1]) + ", " + Format(place[2]) + ")";
}

// Where the grid along the axes of an image lies in the world.
vtkSmartPointer<vtkMatrix4x4> MakeAxes(vtkImageData* image)
{
  auto axes = vtkSmartPointer<vtkMatrix4x4>::New();
  const int* extent = image->GetExtent();
  double first[3];
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], first);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      axes->SetElement(row, column, image->GetDirectionMatrix()->GetElement(row, column));
    }
    axes->SetElement(row, 3, first[row]);
  }
  return axes;
}

glm::dvec3 GetWorld(vtkRenderer* renderer, double x, double y, double z)
{
  double world[4];
  vtkInteractorObserver::ComputeDisplayToWorld(renderer, x, y, z, world);
  return { world[0], world[1], world[2] };
}

glm::dvec3 GetDisplay(vtkRenderer* renderer, const glm::dvec3& place)
{
  double display[3];
  vtkInteractorObserver::ComputeWorldToDisplay(renderer, place.x, place.y, place.z, display);
  return { display[0], display[1], display[2] };
}

LineOfSight GetLineOfSight(vtkRenderer* renderer, int x, int y)
{
  return { GetWorld(renderer, x, y, 0.0), GetWorld(renderer, x, y, 1.0) };
}

// A strip of triangles between two rows of points.
vtkSmartPointer<vtkPolyData> MakeStrip(
  const std::vector<glm::dvec3>& upper, const std::vector<glm::dvec3>& lower)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> triangles;
  for (std::size_t i = 0; i < upper.size(); ++i)
  {
    points->InsertNextPoint(&upper[i].x);
    points->InsertNextPoint(&lower[i].x);
    if (i > 0)
    {
      const vtkIdType last = 2 * static_cast<vtkIdType>(i);
      const vtkIdType first[3] = { last - 2, last - 1, last };
      const vtkIdType second[3] = { last - 1, last + 1, last };
      triangles->InsertNextCell(3, first);
      triangles->InsertNextCell(3, second);
    }
  }
  auto strip = vtkSmartPointer<vtkPolyData>::New();
  strip->SetPoints(points);
  strip->SetPolys(triangles);
  return strip;
}

} // namespace

class vtkDeformVolumeInteractorStyle::vtkInternals
{
public:
  vtkSmartPointer<vtkDeformVolumeSession> Session;
  vtkSmartPointer<vtkVolume> Volume;
  vtkNew<vtkCallbackCommand> SessionObserver;
  vtkSmartPointer<vtkImageData> Output;
  vtkSmartPointer<vtkImageData> Shown;
  std::vector<deformvolume::SlicePlane> Planes;
  StyleOverlay Overlay;
  int TimerId = -1;
  bool IsChanged = true; // since it was drawn
  bool WasBusy = false;
  int WantedModel = -1; // -1: the session's

  // The tool while the button is pressed.
  bool IsPressed = false;
  int Handle = -1; // that is dragged
  glm::dvec3 Held{ 0.0 };
  std::array<int, 2> Cursor{ { 0, 0 } }; // where it was held last
  std::vector<std::array<int, 2>> Stroke;
  vtkSmartPointer<vtkImageData> CarvedImage; // as it was when the stroke began
  glm::dvec3 Carved{ 0.0 };

  std::vector<glm::dvec3> Measured;
  std::vector<glm::dvec3> Sphere; // under the cursor: none or its centre

  int GetModel() const
  {
    return this->WantedModel >= 0 ? this->WantedModel : this->Session->GetModel();
  }

  bool IsHandleHeld() const
  {
    vtkNew<vtkPolyData> handles;
    this->Session->GetHandles(handles);
    vtkDataArray* numbers = handles->GetPointData()->GetArray("Handle");
    for (vtkIdType id = 0; id < handles->GetNumberOfPoints(); ++id)
    {
      if (numbers->GetComponent(id, 0) == this->Handle)
      {
        return true;
      }
    }
    return false;
  }

  // Numbers and places of all handles but the one that is dragged.
  std::vector<std::pair<int, glm::dvec3>> FindOtherHandles() const
  {
    std::vector<std::pair<int, glm::dvec3>> found;
    vtkNew<vtkPolyData> handles;
    this->Session->GetHandles(handles);
    vtkDataArray* numbers = handles->GetPointData()->GetArray("Handle");
    for (vtkIdType id = 0; id < handles->GetNumberOfPoints(); ++id)
    {
      const int number = static_cast<int>(numbers->GetComponent(id, 0));
      glm::dvec3 place(0.0);
      handles->GetPoint(id, &place.x);
      if (number != this->Handle)
      {
        found.emplace_back(number, place);
      }
    }
    return found;
  }

  void EndPress()
  {
    this->Handle = -1;
    this->Stroke.clear();
    this->CarvedImage = nullptr;
    this->IsPressed = false;
    this->IsChanged = true;
  }

  // -1 where nothing is visible.
  vtkIdType FindVoxel(
    const vtkDeformVolumeInteractorStyle* style, vtkImageData* image, const LineOfSight& line) const
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
};

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
      style->ShowMessage("The session is replayed: " + std::to_string(percent) + " %");
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
  internals.EndPress();
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
    vtkErrorMacro("There is no interactor with a window. Call SetInteractorStyle() of one.");
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

bool vtkDeformVolumeInteractorStyle::FindUsedRenderer()
{
  const int* position = this->Interactor->GetEventPosition();
  this->FindPokedRenderer(position[0], position[1]);
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

void vtkDeformVolumeInteractorStyle::SetShowStatus(bool show)
{
  if (show != this->ShowStatus)
  {
    this->ShowStatus = show;
    this->Modified();
  }
}

void vtkDeformVolumeInteractorStyle::SetShowHelp(bool show)
{
  if (show != this->ShowHelp)
  {
    this->ShowHelp = show;
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
  return this->Internals->Shown;
}

void vtkDeformVolumeInteractorStyle::Forget()
{
  vtkInternals& internals = *this->Internals;
  internals.EndPress();
  internals.Output = nullptr;
  internals.Shown = nullptr;
  internals.WantedModel = -1;
  internals.Measured.clear();
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
    text += "  depth " + Format(this->GetUsedCutDepth());
  }
  if (this->Tool == CARVE && internals.Output)
  {
    text += "  radius " + Format(this->GetUsedCarveRadius());
  }
  text += '\n';
  if (internals.Session)
  {
    text += ListChoices(ModelChoices, internals.GetModel()) + "  " +
      std::to_string(internals.Session->GetNumberOfActions()) + " done, " +
      std::to_string(internals.Session->GetNumberOfUndoneActions()) + " undone" +
      (internals.Session->GetIsBusy() ? ", moving" : "") + '\n';
  }
  return text + (this->Message.empty() ? "h help" : this->Message);
}

bool vtkDeformVolumeInteractorStyle::Poll()
{
  vtkInternals& internals = *this->Internals;
  if (!internals.Session || !this->Interactor || !this->Interactor->GetRenderWindow())
  {
    return false;
  }
  Session* session = internals.Session;
  if (!session->GetIsRunning() && session->GetIsBusy())
  {
    session->Update();
  }
  const bool isBusy = session->GetIsBusy(); // before the output that it may have left
  if (auto output = vtkSmartPointer<vtkImageData>::Take(session->TakeOutput()))
  {
    internals.Output = output;
    this->ShowOutput();
    internals.IsChanged = true;
    this->InvokeEvent(vtkCommand::UpdateDataEvent);
  }
  if (!isBusy)
  {
    internals.WantedModel = -1;
    if (internals.Handle >= 0 && !internals.IsHandleHeld())
    {
      internals.EndPress(); // there was nothing to hold
    }
  }
  if (isBusy != internals.WasBusy)
  {
    internals.IsChanged = true; // at rest in full quality
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
  this->UpdateOverlay();
  if (!internals.IsChanged)
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
  internals.Shown = vtkSmartPointer<vtkImageData>::New();
  int dimensions[3];
  internals.Output->GetDimensions(dimensions);
  internals.Shown->SetDimensions(dimensions);
  internals.Shown->SetSpacing(internals.Output->GetSpacing());
  internals.Shown->GetPointData()->SetScalars(internals.Output->GetPointData()->GetScalars());
  if (!internals.Volume)
  {
    return;
  }
  internals.Volume->SetUserMatrix(MakeAxes(internals.Output));
  if (auto* mapper = vtkVolumeMapper::SafeDownCast(internals.Volume->GetMapper()))
  {
    mapper->SetInputData(internals.Shown);
  }
  else
  {
    this->ShowMessage("The volume has no vtkVolumeMapper. Call SetMapper() of the volume.");
  }
}

void vtkDeformVolumeInteractorStyle::UpdateOverlay()
{
  vtkInternals& internals = *this->Internals;
  if (!this->CurrentRenderer)
  {
    const int* position = this->Interactor->GetEventPosition();
    this->FindPokedRenderer(position[0], position[1]);
  }
  if (!this->CurrentRenderer)
  {
    return;
  }
  StyleOverlay& overlay = internals.Overlay;
  overlay.SetRenderer(this->CurrentRenderer);
  if (overlay.SetStatus(this->ShowStatus ? this->GetStatus() : ""))
  {
    internals.IsChanged = true;
    this->InvokeEvent(vtkCommand::UpdateInformationEvent);
  }
  std::string help = KeyHelp;
  help += this->AdditionalHelp.empty() ? "" : '\n' + this->AdditionalHelp;
  internals.IsChanged = overlay.SetHelp(this->ShowHelp ? help : "") || internals.IsChanged;
  if (!internals.IsChanged)
  {
    return;
  }

  overlay.ClearMarks();
  for (const auto& handle : internals.FindOtherHandles())
  {
    overlay.AddPoint(handle.second, HeldColour);
  }
  if (internals.Handle >= 0)
  {
    overlay.AddPoint(internals.Held, GrabbedColour); // which the session does not have there yet
  }
  std::vector<glm::dvec3> stroke;
  for (const auto& point : internals.Stroke)
  {
    stroke.push_back(GetWorld(this->CurrentRenderer, point[0], point[1], 0.5));
  }
  overlay.AddLine(stroke, StrokeColour);
  for (const glm::dvec3& place : internals.Measured)
  {
    overlay.AddPoint(place, MeasureColour);
  }
  overlay.AddLine(internals.Measured, MeasureColour);
  for (const glm::dvec3& centre : internals.Sphere)
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
      circle.push_back(
        centre + this->GetUsedCarveRadius() * (std::cos(angle) * right + std::sin(angle) * up));
    }
    overlay.AddLine(circle, StrokeColour);
  }
}

bool vtkDeformVolumeInteractorStyle::FindPlace(int x, int y, double place[3])
{
  if (!this->CheckInteractor() || !this->FindUsedRenderer() || !this->Internals->Output)
  {
    return false;
  }
  vtkImageData* output = this->Internals->Output;
  const vtkIdType voxel =
    this->Internals->FindVoxel(this, output, GetLineOfSight(this->CurrentRenderer, x, y));
  if (voxel >= 0)
  {
    output->GetPoint(voxel, place);
  }
  return voxel >= 0;
}

double vtkDeformVolumeInteractorStyle::GetDiagonal()
{
  return this->Internals->Output ? this->Internals->Output->GetLength() : 0.0;
}

double vtkDeformVolumeInteractorStyle::GetUsedCutDepth()
{
  return this->CutDepth > 0.0 ? this->CutDepth : 0.1 * this->GetDiagonal();
}

double vtkDeformVolumeInteractorStyle::GetUsedCarveRadius()
{
  return this->CarveRadius > 0.0 ? this->CarveRadius : 0.025 * this->GetDiagonal();
}

void vtkDeformVolumeInteractorStyle::OnLeftButtonDown()
{
  if (!this->CheckInteractor() || !this->FindUsedRenderer())
  {
    return;
  }
  if (this->Tool == TURN)
  {
    this->Superclass::OnLeftButtonDown();
  }
  else if (this->CheckSession())
  {
    this->GrabFocus(this->EventCallbackCommand);
    this->InvokeEvent(vtkCommand::StartInteractionEvent);
    this->BeginTool();
  }
}

void vtkDeformVolumeInteractorStyle::OnLeftButtonUp()
{
  if (!this->Interactor)
  {
    return;
  }
  if (this->State == VTKIS_NONE)
  {
    this->EndTool(this->Interactor->GetShiftKey() != 0);
    this->InvokeEvent(vtkCommand::EndInteractionEvent);
    this->ReleaseFocus();
  }
  else
  {
    this->Superclass::OnLeftButtonUp();
  }
}

void vtkDeformVolumeInteractorStyle::OnRightButtonDown()
{
  if (this->CheckInteractor() && this->FindUsedRenderer())
  {
    this->GrabFocus(this->EventCallbackCommand);
    this->StartRotate();
  }
}

void vtkDeformVolumeInteractorStyle::OnRightButtonUp()
{
  if (this->Interactor && this->State == VTKIS_ROTATE)
  {
    this->EndRotate();
    this->ReleaseFocus();
  }
}

void vtkDeformVolumeInteractorStyle::OnMouseMove()
{
  if (!this->Interactor)
  {
    return;
  }
  if (this->State != VTKIS_NONE)
  {
    this->Superclass::OnMouseMove();
    return;
  }
  vtkInternals& internals = *this->Internals;
  if (internals.IsPressed)
  {
    this->MoveTool();
  }
  if (!internals.Output || !internals.Session || (this->Tool != PROBE && this->Tool != CARVE))
  {
    return;
  }
  const int x = this->Interactor->GetEventPosition()[0];
  const int y = this->Interactor->GetEventPosition()[1];
  if (this->Tool == PROBE)
  {
    this->ProbeAt(x, y);
    return;
  }
  glm::dvec3 place(0.0);
  const bool wasThere = !internals.Sphere.empty();
  internals.Sphere.clear();
  if (internals.IsPressed)
  {
    internals.Sphere.push_back(internals.Carved);
  }
  else if (this->FindPlace(x, y, &place.x))
  {
    internals.Sphere.push_back(place);
  }
  internals.IsChanged = internals.IsChanged || wasThere || !internals.Sphere.empty();
}

void vtkDeformVolumeInteractorStyle::OnMouseWheelForward()
{
  this->Turn(1);
}

void vtkDeformVolumeInteractorStyle::OnMouseWheelBackward()
{
  this->Turn(-1);
}

void vtkDeformVolumeInteractorStyle::Turn(int notches)
{
  if (!this->CheckInteractor() || !this->FindUsedRenderer() || this->ResizeTool(notches))
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  if (internals.Handle >= 0)
  {
    const glm::dvec3 display = GetDisplay(this->CurrentRenderer, internals.Held);
    const glm::dvec3 near = GetWorld(this->CurrentRenderer, display.x, display.y, 0.0);
    const glm::dvec3 away = glm::normalize(internals.Held - near);
    internals.Held += 0.01 * notches * this->GetDiagonal() * away;
    internals.Session->MoveGrab(
      internals.Handle, internals.Held.x, internals.Held.y, internals.Held.z);
    internals.IsChanged = true;
  }
  else if (notches > 0)
  {
    this->Superclass::OnMouseWheelForward();
  }
  else
  {
    this->Superclass::OnMouseWheelBackward();
  }
}

bool vtkDeformVolumeInteractorStyle::ResizeTool(int notches)
{
  const double factor = std::pow(WheelFactor, notches);
  if (this->Tool == CUT)
  {
    this->SetCutDepth(factor * this->GetUsedCutDepth());
  }
  else if (this->Tool == CARVE)
  {
    this->SetCarveRadius(factor * this->GetUsedCarveRadius());
  }
  else
  {
    return false;
  }
  this->Internals->IsChanged = true;
  return true;
}

void vtkDeformVolumeInteractorStyle::OnTimer()
{
  this->Poll();
}

void vtkDeformVolumeInteractorStyle::OnChar()
{
  if (!this->CheckInteractor())
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  internals.IsChanged = true;
  const char key = this->Interactor->GetKeyCode();
  const int x = this->Interactor->GetEventPosition()[0];
  const int y = this->Interactor->GetEventPosition()[1];
  const int tool = FindChoice(ToolChoices, key);
  const int model = FindChoice(ModelChoices, key);
  if (tool >= 0)
  {
    this->SetTool(tool);
    this->ShowMessage("");
    return;
  }
  switch (key)
  {
    case 'h':
      this->SetShowHelp(!this->ShowHelp);
      return;
    case '+':
    case '=':
      this->ResizeTool(1);
      return;
    case '-':
      this->ResizeTool(-1);
      return;
    case 'r':
    case 'q':
      this->Superclass::OnChar();
      return;
    default:
      break;
  }
  const bool isOfSession =
    model >= 0 || key == 'p' || key == 'x' || key == 'u' || key == 'y' || key == 'z';
  if (!isOfSession || !this->CheckSession())
  {
    return;
  }
  this->ShowMessage("");
  if (key == 'p')
  {
    this->PinAt(x, y);
    return;
  }
  if (key == 'x')
  {
    this->ReleaseAt(x, y);
    return;
  }
  internals.EndPress();
  if (model >= 0)
  {
    internals.Session->ChangeModel(model);
    internals.WantedModel = model;
    return;
  }
  internals.WantedModel = -1;
  switch (key)
  {
    case 'u':
      internals.Session->Undo();
      break;
    case 'y':
      internals.Session->Redo();
      break;
    default:
      internals.Session->Reset();
  }
}

void vtkDeformVolumeInteractorStyle::BeginTool()
{
  vtkInternals& internals = *this->Internals;
  const int x = this->Interactor->GetEventPosition()[0];
  const int y = this->Interactor->GetEventPosition()[1];
  internals.EndPress();
  this->ShowMessage("");
  if (!internals.Output)
  {
    this->ShowMessage("There is no volume yet. Wait until it is shown.");
    return;
  }
  if (this->Tool == CUT) // a stroke may begin beside the body
  {
    internals.IsPressed = true;
    internals.Stroke.push_back({ { x, y } });
    return;
  }
  glm::dvec3 place(0.0);
  if (!this->FindPlace(x, y, &place.x))
  {
    this->ShowMessage("There is nothing here. Press on the body.");
    return;
  }
  switch (this->Tool)
  {
    case GRAB:
      internals.Handle = internals.Session->BeginGrab(place.x, place.y, place.z);
      if (internals.Handle >= 0)
      {
        internals.IsPressed = true;
        internals.Held = place;
        internals.Cursor = { { x, y } };
        if (internals.GetModel() == Session::NONE)
        {
          this->ShowMessage("Nothing follows without a model. Press 2, 3 or 4 for one.");
        }
      }
      break;
    case CARVE:
      internals.IsPressed = true;
      internals.CarvedImage = internals.Output;
      internals.Carved = place;
      internals.Session->CarveSphere(place.x, place.y, place.z, this->GetUsedCarveRadius());
      break;
    case PROBE:
      this->ProbeAt(x, y);
      break;
    default:
      this->MeasureAt(x, y);
  }
}

void vtkDeformVolumeInteractorStyle::MoveTool()
{
  vtkInternals& internals = *this->Internals;
  const int x = this->Interactor->GetEventPosition()[0];
  const int y = this->Interactor->GetEventPosition()[1];
  switch (this->Tool)
  {
    case GRAB:
      this->DragTo(x, y);
      break;
    case CUT:
    {
      const auto& last = internals.Stroke.back();
      if (std::abs(x - last[0]) + std::abs(y - last[1]) >= PixelsOfStroke)
      {
        internals.Stroke.push_back({ { x, y } });
      }
      break;
    }
    default:
      this->CarveAt(x, y, false);
  }
  internals.IsChanged = true;
}

void vtkDeformVolumeInteractorStyle::DragTo(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  // The handle is where its voxel was, which is not just under the cursor.
  const double depth = GetDisplay(this->CurrentRenderer, internals.Held).z;
  internals.Held += GetWorld(this->CurrentRenderer, x, y, depth) -
    GetWorld(this->CurrentRenderer, internals.Cursor[0], internals.Cursor[1], depth);
  internals.Cursor = { { x, y } };
  internals.Session->MoveGrab(
    internals.Handle, internals.Held.x, internals.Held.y, internals.Held.z);
}

// Each event of a carving looks at the whole sphere: those that are near the last one wait.
void vtkDeformVolumeInteractorStyle::CarveAt(int x, int y, bool isLast)
{
  vtkInternals& internals = *this->Internals;
  // On the body as it was: otherwise the sphere would sink into the hole that it makes.
  const vtkIdType voxel =
    internals.FindVoxel(this, internals.CarvedImage, GetLineOfSight(this->CurrentRenderer, x, y));
  if (voxel < 0)
  {
    return;
  }
  glm::dvec3 place(0.0);
  internals.CarvedImage->GetPoint(voxel, &place.x);
  const double way = glm::length(place - internals.Carved);
  if (way >= 0.25 * this->GetUsedCarveRadius() || (isLast && way > 0.0))
  {
    internals.Carved = place;
    internals.Session->CarveTo(place.x, place.y, place.z, this->GetUsedCarveRadius());
  }
}

void vtkDeformVolumeInteractorStyle::EndTool(bool isHeld)
{
  vtkInternals& internals = *this->Internals;
  if (!internals.IsPressed)
  {
    return;
  }
  if (this->Tool == GRAB)
  {
    const int handle = internals.Handle;
    internals.EndPress();
    if (isHeld)
    {
      internals.Session->HoldGrab(handle);
    }
    else
    {
      internals.Session->EndGrab(handle);
    }
    return;
  }
  if (this->Tool == CUT)
  {
    this->FinishCut();
  }
  else if (this->Tool == CARVE)
  {
    const int* position = this->Interactor->GetEventPosition();
    this->CarveAt(position[0], position[1], true);
  }
  internals.EndPress();
}

void vtkDeformVolumeInteractorStyle::FinishCut()
{
  vtkInternals& internals = *this->Internals;
  const std::size_t count = internals.Stroke.size();
  std::vector<glm::dvec3> places(count, glm::dvec3(0.0));
  std::vector<bool> isFound(count, false);
  for (std::size_t i = 0; i < count; ++i)
  {
    isFound[i] = this->FindPlace(internals.Stroke[i][0], internals.Stroke[i][1], &places[i].x);
  }
  if (count < 2 || std::find(isFound.begin(), isFound.end(), true) == isFound.end())
  {
    this->ShowMessage("The stroke misses the body. Draw it over the body.");
    return;
  }
  // Beside the body the sheet is as deep as where the stroke is on the body nearest.
  std::vector<glm::dvec3> upper;
  std::vector<glm::dvec3> lower;
  const double* spacing = internals.Output->GetSpacing();
  const double above = 2.0 * std::max({ spacing[0], spacing[1], spacing[2] });
  for (std::size_t i = 0; i < count; ++i)
  {
    std::size_t way = 0;
    const auto isThere = [&](std::size_t at) { return at < count && isFound[at]; };
    while (!isThere(i + way) && !isThere(i - way)) // i - way wraps round beyond the first one
    {
      ++way;
    }
    const glm::dvec3 nearest = places[isThere(i + way) ? i + way : i - way];
    const double x = internals.Stroke[i][0];
    const double y = internals.Stroke[i][1];
    const double depth = GetDisplay(this->CurrentRenderer, nearest).z;
    const glm::dvec3 place = GetWorld(this->CurrentRenderer, x, y, depth);
    const glm::dvec3 away = glm::normalize(
      GetWorld(this->CurrentRenderer, x, y, 1.0) - GetWorld(this->CurrentRenderer, x, y, 0.0));
    upper.push_back(place - above * away);
    lower.push_back(place + this->GetUsedCutDepth() * away);
  }
  internals.Session->Cut(MakeStrip(upper, lower));
}

// The session is asked only where it need not be waited for.
void vtkDeformVolumeInteractorStyle::ProbeAt(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  double place[3];
  if (!this->FindPlace(x, y, place))
  {
    this->ShowMessage("There is nothing here.");
    return;
  }
  if (internals.Session->GetIsBusy())
  {
    vtkImageData* output = internals.Output;
    vtkDataArray* scalars = output->GetPointData()->GetScalars();
    const vtkIdType voxel = output->FindPoint(place);
    this->ShowMessage("value " + Format(scalars ? scalars->GetComponent(voxel, 0) : 0.0) + " at " +
      Format(place) + ", moving");
  }
  else if (internals.Session->Probe(place[0], place[1], place[2]))
  {
    this->ShowMessage("value " + Format(internals.Session->GetProbedValue()) + " at " +
      Format(place) + ", at rest " + Format(internals.Session->GetProbedRestPosition()));
  }
}

void vtkDeformVolumeInteractorStyle::MeasureAt(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  glm::dvec3 place(0.0);
  this->FindPlace(x, y, &place.x);
  if (internals.Measured.size() > 1)
  {
    internals.Measured.clear();
  }
  internals.Measured.push_back(place);
  if (internals.Measured.size() == 1)
  {
    this->ShowMessage("Press on the other place.");
    return;
  }
  this->MeasuredDistance = glm::length(internals.Measured[1] - internals.Measured[0]);
  this->ShowMessage("distance " + Format(this->MeasuredDistance));
}

void vtkDeformVolumeInteractorStyle::PinAt(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  glm::dvec3 place(0.0);
  if (!this->FindPlace(x, y, &place.x))
  {
    this->ShowMessage("There is nothing here. Pin a place on the body.");
    return;
  }
  internals.Session->Pin(place.x, place.y, place.z);
}

void vtkDeformVolumeInteractorStyle::ReleaseAt(int x, int y)
{
  if (!this->FindUsedRenderer())
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  int nearest = -1;
  double least = PixelsOfHandle;
  for (const auto& handle : internals.FindOtherHandles())
  {
    const glm::dvec3 at = GetDisplay(this->CurrentRenderer, handle.second);
    const double distance = std::hypot(at.x - x, at.y - y);
    if (distance <= least)
    {
      least = distance;
      nearest = handle.first;
    }
  }
  if (nearest < 0)
  {
    this->ShowMessage("There is no handle under the cursor. Move it to a green point.");
    return;
  }
  internals.Session->Release(nearest);
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
