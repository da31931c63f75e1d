// SPDX-License-Identifier: BSD-3-Clause
// Mouse buttons, the wheel and keys.
#include "vtkDeformVolumeInteractorStyleInternals.h"

#include "StyleText.h"

#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"

#include <glm/geometric.hpp>

#include <cmath>

using deformvolume::DisplayToWorld;
using deformvolume::FindChoice;
using deformvolume::ModelChoices;
using deformvolume::ToolChoices;
using deformvolume::WorldToDisplay;

namespace
{
constexpr double WheelFactor = 1.1; // of a depth or a radius
}

void vtkDeformVolumeInteractorStyle::OnLeftButtonDown()
{
  if (!this->CheckInteractor() || !this->SelectRenderer())
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
  // A tool also ends while the right button rotates the camera.
  if (this->State == VTKIS_NONE || this->Internals->IsPressed)
  {
    this->EndTool(this->Interactor->GetShiftKey() != 0);
    this->InvokeEvent(vtkCommand::EndInteractionEvent);
    if (this->State == VTKIS_NONE)
    {
      this->ReleaseFocus();
    }
  }
  else
  {
    this->Superclass::OnLeftButtonUp();
  }
}

void vtkDeformVolumeInteractorStyle::OnRightButtonDown()
{
  if (this->CheckInteractor() && this->SelectRenderer())
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
  vtkInternals& internals = *this->Internals;
  if (this->State != VTKIS_NONE)
  {
    this->Superclass::OnMouseMove();
    const int* position = this->Interactor->GetEventPosition();
    internals.Cursor = { { position[0], position[1] } }; // a drag moves on from here
    return;
  }
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
  glm::dvec3 position(0.0);
  const bool wasThere = !internals.Sphere.empty();
  internals.Sphere.clear();
  if (internals.IsPressed)
  {
    internals.Sphere.push_back(internals.CarvePosition);
  }
  else if (this->FindPosition(x, y, &position.x))
  {
    internals.Sphere.push_back(position);
  }
  internals.IsChanged = internals.IsChanged || wasThere || !internals.Sphere.empty();
}

void vtkDeformVolumeInteractorStyle::OnMouseWheelForward()
{
  this->TurnWheel(1);
}

void vtkDeformVolumeInteractorStyle::OnMouseWheelBackward()
{
  this->TurnWheel(-1);
}

void vtkDeformVolumeInteractorStyle::TurnWheel(int notches)
{
  if (!this->CheckInteractor() || !this->SelectRenderer() || this->ResizeTool(notches))
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  if (internals.Handle >= 0)
  {
    const glm::dvec3 display = WorldToDisplay(this->CurrentRenderer, internals.GrabbedPosition);
    const glm::dvec3 near = DisplayToWorld(this->CurrentRenderer, display.x, display.y, 0.0);
    const glm::dvec3 far = DisplayToWorld(this->CurrentRenderer, display.x, display.y, 1.0);
    const glm::dvec3 away = glm::normalize(far - near); // the handle may be in front of near
    internals.GrabbedPosition += 0.01 * notches * this->GetDiagonal() * away;
    internals.Session->MoveGrab(internals.Handle, internals.GrabbedPosition.x,
      internals.GrabbedPosition.y, internals.GrabbedPosition.z);
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
    this->SetCutDepth(factor * this->GetEffectiveCutDepth());
  }
  else if (this->Tool == CARVE)
  {
    this->SetCarveRadius(factor * this->GetEffectiveCarveRadius());
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
  // The session does not end the grab if the model is in use already or cannot be changed.
  internals.CancelPress();
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
