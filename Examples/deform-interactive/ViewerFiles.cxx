// SPDX-License-Identifier: BSD-3-Clause
// Opens and saves files: volumes, sessions, pictures and recordings.
#include "Viewer.h"

#include "Failure.h"
#include "Messages.h"
#include "Picture.h"
#include "VolumeReading.h"

#include <vtkCamera.h>
#include <vtkDataArray.h>
#include <vtkDeformVolumeInteractorStyle.h>
#include <vtkDeformVolumeSession.h>
#include <vtkInteractorEventRecorder.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkWindowToImageFilter.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace
{
const char* const RecordPath = "deform-interactive.log";

constexpr float BeforeObservers = 20.0F; // priority of the recorder
constexpr vtkIdType ManyVoxels = 1000000;

std::string GetEnding(const std::string& path)
{
  return vtksys::SystemTools::LowerCase(vtksys::SystemTools::GetFilenameLastExtension(path));
}
}

void Viewer::OpenVolume(const std::string& path)
{
  this->Announce("Reading " + path);
  const Volume volume = ReadVolume(path, this->Asked.Reading, this->Reports, true);
  ChooseScalars(volume.Image, path);
  this->Style->StopSession();
  if (!this->Session->SetInputs(volume.Image))
  {
    throw Failure(this->Session->GetErrorMessage());
  }
  this->Session->SetMovingSamplingFactor(volume.Image->GetNumberOfPoints() > ManyVoxels ? 2 : 1);
  this->Style->Forget();
  this->Values = std::make_unique<Histogram>(volume.Image);
  this->FileName = vtksys::SystemTools::GetFilenameWithoutExtension(path);
  this->ChoosePreset(Transfer::AUTOMATIC);
  double bounds[6];
  volume.Image->GetBounds(bounds);
  this->Diagonal = volume.Image->GetLength();
  this->Session->ChangeHandleRadius(this->HandleRadiusPart * this->Diagonal);
  this->AimCamera(GetFaceView(volume.Axes).data());
  this->Renderer->ResetCamera(bounds);
  this->Renderer->GetActiveCamera()->Zoom(1.15);
  this->Style->ShowMessage("2 chooses ChainMail, g grabs, h shows all keys");
  this->Style->Poll(); // draws the volume
}

void Viewer::LoadSession(const std::string& path)
{
  if (!this->Values)
  {
    throw Failure("Cannot load " + path + ": there is no volume. Open the volume of the session.");
  }
  this->Announce("Replaying " + path);
  if (this->Session->LoadSession(path))
  {
    this->Style->Forget();
    this->Style->ShowMessage("The session " + path + " is loaded.");
  }
}

// Errors are shown in the window, and the volume that was open before stays open.
void Viewer::Open(const std::string& path)
{
  try
  {
    const std::string ending = GetEnding(path);
    if (ending == ".xml")
    {
      this->LoadSession(path);
    }
    else if (ending == ".log")
    {
      this->Replay(path);
    }
    else
    {
      this->OpenVolume(path);
    }
    this->Reports.Check("cannot open " + path);
  }
  catch (const Failure& failure)
  {
    this->Style->ShowMessage(failure.what());
  }
  if (this->Values && !this->IsReplaying)
  {
    this->Style->StartSession();
  }
}

void Viewer::Save(const std::string& path)
{
  if (!this->Values)
  {
    throw Failure("There is no volume. Open one first.");
  }
  const std::string ending = GetEnding(path);
  bool isSaved = true;
  if (ending == ".vti")
  {
    isSaved = this->Session->SaveVolume(path);
  }
  else if (ending == ".vtu")
  {
    isSaved = this->Session->SaveMesh(path);
  }
  else if (ending == ".xml")
  {
    isSaved = this->Session->SaveSession(path);
  }
  else if (ending == ".png")
  {
    this->Interactor->Render();
    this->SavePicture(path);
  }
  else
  {
    throw Failure("The name " + path + " must end in .vti, .vtu, .xml or .png.");
  }
  if (!isSaved)
  {
    throw Failure(this->Session->GetErrorMessage());
  }
}

void Viewer::SaveAll()
{
  std::vector<std::string> endings{ ".vti", ".xml", ".png" };
  if (this->Session->GetModel() >= vtkDeformVolumeSession::MASS_SPRING)
  {
    endings.emplace_back(".vtu");
  }
  std::string name;
  const auto exists = [&name](const std::string& ending)
  { return vtksys::SystemTools::FileExists(name + ending); };
  int number = 0;
  do
  {
    ++number;
    name = this->FileName + "-deformed-" + std::to_string(number);
  } while (std::any_of(endings.begin(), endings.end(), exists));
  try
  {
    this->Announce("Saving " + name);
    std::string saved;
    for (const std::string& ending : endings)
    {
      this->Save(name + ending);
      saved += " " + ending;
    }
    this->Style->ShowMessage(name + " is saved:" + saved);
  }
  catch (const Failure& failure)
  {
    this->Style->ShowMessage(failure.what());
  }
}

void Viewer::SavePicture(const std::string& path)
{
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(this->Window);
  grab->SetInputBufferTypeToRGB();
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  grab->Update();
  WritePNG(grab->GetOutput(), path, this->Reports);
}

void Viewer::StartRecording(const std::string& path)
{
  this->Recorder = vtkSmartPointer<vtkInteractorEventRecorder>::New();
  this->Recorder->SetPriority(BeforeObservers);
  this->Recorder->SetKeyPressActivation(0);
  this->Recorder->SetInteractor(this->Interactor);
  this->Recorder->SetFileName(path.c_str());
  this->Recorder->EnabledOn();
  this->Recorder->Record();
  this->Style->ShowMessage("Recording events to " + path + ". Press j to stop.");
}

void Viewer::ToggleRecording()
{
  if (!this->Recorder)
  {
    this->StartRecording(RecordPath);
    return;
  }
  this->Recorder->Stop();
  this->Recorder->EnabledOff();
  this->Style->ShowMessage(std::string("Events were recorded to ") + this->Recorder->GetFileName() +
    ". Drop it onto the window to replay it.");
  this->Recorder = nullptr;
}

// Does not use the thread of the session. Each timer event of the recording is one step of the
// session, so that a recording always gives the same volume.
void Viewer::Replay(const std::string& path)
{
  if (!vtksys::SystemTools::FileExists(path, true))
  {
    throw Failure("cannot replay " + path + ": there is no such file");
  }
  if (this->Recorder) // it may be writing this file: the replay would never end
  {
    this->ToggleRecording();
  }
  std::string line;
  std::getline(std::ifstream(path), line);
  if (line.rfind("# StreamVersion", 0) != 0)
  {
    throw Failure("cannot replay " + path + ": it is not a recording of --record or of the key j");
  }
  if (this->IsReplaying)
  {
    return;
  }
  this->Style->StopSession();
  this->IsReplaying = true;
  vtkNew<vtkInteractorEventRecorder> recorder;
  recorder->SetKeyPressActivation(0);
  recorder->SetInteractor(this->Interactor);
  recorder->SetFileName(path.c_str());
  recorder->EnabledOn();
  recorder->Play();
  recorder->EnabledOff();
  this->IsReplaying = false;
  this->Interactor->Render();
}
