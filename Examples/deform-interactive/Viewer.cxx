// SPDX-License-Identifier: BSD-3-Clause
#include "Viewer.h"

#include "Failure.h"

#include <vtkCamera.h>
#include <vtkCommand.h>
#include <vtkDeformVolumeInteractorStyle.h>
#include <vtkDeformVolumeSession.h>
#include <vtkInteractorEventRecorder.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkStringArray.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cstdio>

namespace
{
const char* const HeadPath = "/usr/share/mricron/templates/ch2.nii.gz";

constexpr float BeforeStyle = 10.0F; // priority of observers that get events before the style

constexpr const char* ProgramKeys =
  "d volume, isosurface, slices    PageUp PageDown move the slice\n"
  "f opacity and colors: automatic, CT bone, CT soft tissue, MR\n"
  "arrows: level and width of the opacity\n"
  "s save volume, mesh, session and picture\n"
  "j start or stop recording    i numbers\n"
  ", . radius in which a handle holds tissue\n"
  "Drop a volume, session .xml or recording .log to open it.";

void SetUpNumbers(vtkTextActor* actor)
{
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(0.99, 0.99);
  vtkTextProperty* property = actor->GetTextProperty();
  property->SetFontFamilyToCourier();
  property->SetFontSize(14);
  property->SetBold(1);
  property->SetShadow(1);
  property->SetColor(0.8, 0.9, 1.0);
  property->SetJustificationToRight();
  property->SetVerticalJustificationToTop();
}
}

Viewer::Viewer(const Arguments& arguments, Messages& messages)
  : Asked(arguments)
  , Reports(messages)
  , View(this->Style)
{
  this->Window->SetMultiSamples(0);
  this->Window->SetSize(arguments.Size[0], arguments.Size[1]);
  this->Window->SetWindowName("deform-interactive");
  this->Window->AddRenderer(this->Renderer);
  this->Renderer->SetBackground(0.10, 0.12, 0.15);
  this->Interactor->SetRenderWindow(this->Window);
  this->Interactor->SetInteractorStyle(this->Style);
  this->Interactor->SetDesiredUpdateRate(15.0);
  this->Style->SetSession(this->Session);
  this->Style->SetAdditionalHelp(ProgramKeys);
  this->View.AddTo(this->Renderer);
  SetUpNumbers(this->Numbers);
  this->Renderer->AddViewProp(this->Numbers);

  this->Interactor->AddObserver(vtkCommand::KeyPressEvent, this, &Viewer::OnKeyPress, BeforeStyle);
  this->Interactor->AddObserver(vtkCommand::CharEvent, this, &Viewer::OnChar, BeforeStyle);
  this->Interactor->AddObserver(vtkCommand::DropFilesEvent, this, &Viewer::OnDrop);
  this->Interactor->AddObserver(vtkCommand::TimerEvent, this, &Viewer::OnTimer, -BeforeStyle);
  this->Style->AddObserver(vtkCommand::UpdateDataEvent, this, &Viewer::OnOutput);
  this->Style->AddObserver(vtkCommand::StartInteractionEvent, this, &Viewer::OnInteraction);
  this->Style->AddObserver(vtkCommand::EndInteractionEvent, this, &Viewer::OnInteraction);
  this->Renderer->AddObserver(vtkCommand::StartEvent, this, &Viewer::OnFrame);
  this->Window->AddObserver(vtkCommand::EndEvent, this, &Viewer::OnFrame);
}

Viewer::~Viewer()
{
  this->Style->StopSession();
  this->Interactor->SetInteractorStyle(nullptr);
}

void Viewer::Run()
{
  this->Interactor->Initialize();
  const std::string path = this->Asked.Volume.empty() ? HeadPath : this->Asked.Volume;
  if (this->Asked.Volume.empty() && !vtksys::SystemTools::FileExists(path))
  {
    this->Announce("Drop a volume here. (Install mricron-data for the MRI of a head.)");
  }
  else
  {
    this->OpenVolume(path);
  }
  if (!this->Asked.Session.empty())
  {
    if (!this->Values)
    {
      throw Failure("cannot load " + this->Asked.Session +
        ": there is no volume. Give the volume of the session as an argument");
    }
    if (!this->Session->LoadSession(this->Asked.Session))
    {
      throw Failure(this->Session->GetErrorMessage());
    }
    this->Style->Forget();
  }
  if (!this->Asked.Replay.empty())
  {
    this->Replay(this->Asked.Replay);
    for (const std::string& output : this->Asked.Outputs)
    {
      this->Save(output);
    }
    if (!this->Asked.Screenshot.empty())
    {
      this->SavePicture(this->Asked.Screenshot);
    }
    return;
  }
  if (!this->Asked.Record.empty())
  {
    this->StartRecording(this->Asked.Record);
  }
  if (this->Values)
  {
    this->Style->StartSession();
  }
  constexpr int milliseconds = 30;
  this->Interactor->CreateRepeatingTimer(milliseconds); // the style has no timer without a volume
  this->Interactor->Start();
  if (this->Recorder)
  {
    this->ToggleRecording();
  }
}

void Viewer::Announce(const std::string& message)
{
  this->Style->ShowMessage(message);
  this->Style->Poll();
  this->Interactor->Render();
}

void Viewer::AimCamera(const double view[3])
{
  vtkCamera* camera = this->Renderer->GetActiveCamera();
  camera->SetFocalPoint(0.0, 0.0, 0.0);
  camera->SetPosition(view);
  camera->SetViewUp(0.0, 0.0, 1.0);
}

void Viewer::OnKeyPress(vtkObject*, unsigned long, void*)
{
  const char* symbol = this->Interactor->GetKeySym();
  if (!symbol || !this->Values)
  {
    return;
  }
  const double step = 0.01 * (this->Values->Range[1] - this->Values->Range[0]);
  const std::string key = symbol;
  if (key == "Left" || key == "Right")
  {
    this->Shown.Level += key == "Left" ? -step : step;
  }
  else if (key == "Up" || key == "Down")
  {
    this->Shown.Width = std::max(step, this->Shown.Width * (key == "Up" ? 1.1 : 1.0 / 1.1));
  }
  else if (key == "Prior" || key == "Next")
  {
    this->View.MoveSlice(this->Renderer, key == "Prior" ? 0.01 : -0.01);
    this->IsChanged = true;
    return;
  }
  else
  {
    return;
  }
  this->ShowTransfer();
}

bool Viewer::OnChar(vtkObject*, unsigned long, void*)
{
  const char key = this->Interactor->GetKeyCode();
  switch (key)
  {
    case 'd':
      this->View.SetDisplay(static_cast<VolumeView::Display>(
        (this->View.GetDisplay() + 1) % VolumeView::NUMBER_OF_DISPLAYS));
      break;
    case 'f':
      this->ChoosePreset(
        static_cast<Transfer::Preset>((this->Shown.Chosen + 1) % Transfer::NUMBER_OF_PRESETS));
      break;
    case 'i':
      this->ShowNumbers = !this->ShowNumbers;
      break;
    case 's':
      this->SaveAll();
      break;
    case ',':
    case '.':
      this->ChangeHandleRadius(key == '.' ? 1 : -1);
      break;
    case 'j':
      if (!this->IsReplaying)
      {
        this->ToggleRecording();
      }
      break;
    default:
      return false;
  }
  this->ShowTexts();
  this->IsChanged = true;
  return true;
}

// A timer opens the file later, because the file manager waits until this function returns, and VTK
// exits if the file manager has ended by then. The timer of the style cannot be used: Open()
// destroys it, and no timer may be destroyed in its own event.
void Viewer::OnDrop(vtkObject*, unsigned long, void* files)
{
  auto* const paths = static_cast<vtkStringArray*>(files);
  if (paths && paths->GetNumberOfValues() > 0)
  {
    this->Dropped = paths->GetValue(0);
    this->DropTimer = this->Interactor->CreateOneShotTimer(1);
  }
}

void Viewer::OnOutput(vtkObject*, unsigned long, void*)
{
  this->UploadTime = this->View.Update(this->Renderer);
}

// Also called for rotations of the camera.
void Viewer::OnInteraction(vtkObject*, unsigned long event, void*)
{
  this->IsInteracting = event == vtkCommand::StartInteractionEvent;
  this->IsChanged = true;
}

void Viewer::OnTimer(vtkObject*, unsigned long, void* timer)
{
  if (timer && *static_cast<int*>(timer) == this->DropTimer)
  {
    this->DropTimer = -1;
    this->Open(this->Dropped);
  }
  if (this->IsChanged)
  {
    this->ShowTexts();
    this->Interactor->Render();
  }
  if (this->IsReplaying && !this->Asked.Frames.empty())
  {
    char name[32];
    std::snprintf(name, sizeof(name), "/frame%04d.png", this->Frame++);
    this->SavePicture(this->Asked.Frames + name);
  }
}

void Viewer::OnFrame(vtkObject* caller, unsigned long, void*)
{
  const auto now = Clock::now();
  if (caller == this->Renderer.Get())
  {
    this->FrameBegin = now;
    this->IsChanged = false;
    this->View.SetCoarse(this->Session->GetIsBusy() || this->IsInteracting);
    if (now - this->LastTexts > std::chrono::milliseconds(250))
    {
      this->LastTexts = now;
      this->ShowTexts();
    }
    return;
  }
  this->RenderTime = std::chrono::duration<double>(now - this->FrameBegin).count();
  this->Frames.push_back(now);
  while (now - this->Frames.front() > std::chrono::seconds(1))
  {
    this->Frames.pop_front();
  }
}

void Viewer::ChoosePreset(Transfer::Preset preset)
{
  if (this->Values)
  {
    this->Shown = Transfer(preset, *this->Values);
    this->ShowTransfer();
    this->Style->ShowMessage("opacity and colors: " + this->Shown.GetName());
  }
}

void Viewer::ChangeHandleRadius(int steps)
{
  if (!this->Values)
  {
    return;
  }
  constexpr double most = 0.05; // of the diagonal
  const double step = 0.01;
  this->HandleRadiusPart = std::clamp(this->HandleRadiusPart + steps * step, 0.0, most);
  this->Session->ChangeHandleRadius(this->HandleRadiusPart * this->Diagonal);
}

void Viewer::ShowTransfer()
{
  this->View.SetTransfer(this->Shown, this->Values->Range);
  this->IsChanged = true;
}

void Viewer::ShowTexts()
{
  constexpr double milliseconds = 1000.0;
  char text[256];
  std::snprintf(text, sizeof(text),
    "%zu frames/s\nsimulation %.0f ms\nresampling %.0f ms\nupload %.0f ms\nrendering %.0f ms\n"
    "level %.4g width %.4g\n%s\nhandle radius %.3g",
    this->Frames.size(), milliseconds * this->Session->GetSimulationTime(),
    milliseconds * this->Session->GetResamplingTime(), milliseconds * this->UploadTime,
    milliseconds * this->RenderTime, this->Shown.Level, this->Shown.Width,
    this->Shown.GetName().c_str(), this->HandleRadiusPart * this->Diagonal);
  this->Numbers->SetInput(text);
  this->Numbers->SetVisibility(this->ShowNumbers && this->Values ? 1 : 0);
}
