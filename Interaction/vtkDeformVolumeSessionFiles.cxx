// SPDX-License-Identifier: BSD-3-Clause
// Files of vtkDeformVolumeSession: sessions, volumes and meshes.
#include "vtkDeformVolumeSessionInternals.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLImageDataWriter.h"
#include "vtkXMLUnstructuredGridWriter.h"
#include "vtksys/SystemTools.hxx"

#include <algorithm>
#include <exception>
#include <mutex>
#include <stdexcept>

using deformvolume::SessionEvent;
using deformvolume::SessionEvents;

namespace
{

template <typename WriterT>
void WriteData(vtkDataObject* data, const std::string& fileName)
{
  deformvolume::WriteAndRename(fileName,
    [&](const std::string& name)
    {
      bool hasFailed = false;
      vtkNew<vtkCallbackCommand> observer;
      observer->SetClientData(&hasFailed);
      observer->SetCallback(
        [](vtkObject*, unsigned long, void* failed, void*) { *static_cast<bool*>(failed) = true; });
      vtkNew<WriterT> writer;
      writer->AddObserver(vtkCommand::ErrorEvent, observer);
      writer->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
      writer->SetFileName(name.c_str());
      writer->SetDataModeToBinary(); // some versions of VTK cannot read raw appended data
      writer->SetInputData(data);
      if (writer->Write() == 0 || hasFailed || writer->GetErrorCode() != 0)
      {
        throw std::runtime_error("The file " + fileName +
          " cannot be written. Choose a folder that can be written and has space.");
      }
    });
}

} // namespace

bool vtkDeformVolumeSession::SaveSession(const std::string& fileName)
{
  return this->CheckInputs() &&
    this->UsePipeline(
      [&]
      {
        if (!this->Internals->Queue.empty())
        {
          this->Internals->RunOnce();
        }
        deformvolume::WriteEvents(
          fileName, this->Internals->GetInputHash(), this->Internals->Record);
        return true;
      });
}

bool vtkDeformVolumeSession::LoadSession(const std::string& fileName)
{
  if (!this->CheckInputs())
  {
    return false;
  }
  vtkInternals& internals = *this->Internals;
  SessionEvents events;
  try
  {
    events = deformvolume::ReadEvents(fileName, internals.GetInputHash());
  }
  catch (const std::exception& error)
  {
    this->Report(error.what());
    return false;
  }
  const bool wasRunning = this->GetIsRunning();
  this->Stop();
  const SessionEvents record = internals.Record;
  bool isLoaded = true;
  try
  {
    internals.Replay(
      events, [this](double part) { this->InvokeEvent(vtkCommand::ProgressEvent, &part); });
    for (const SessionEvent& event : events)
    {
      if (event.Kind == SessionEvent::BEGIN_GRAB)
      {
        internals.LastHandle = std::max(internals.LastHandle, static_cast<int>(event.Numbers[0]));
      }
    }
  }
  catch (const std::exception& error) // for example std::bad_alloc
  {
    const std::string fault = internals.Restore(record);
    this->Report("The session " + fileName + " cannot be replayed: " + error.what());
    if (!fault.empty())
    {
      this->Report(fault);
    }
    isLoaded = false;
  }
  {
    const std::lock_guard<std::mutex> lock(internals.QueueMutex);
    internals.IsBusy = true; // until the next output
    internals.Queue.clear(); // its events belong to the previous session
  }
  if (wasRunning)
  {
    this->Start();
  }
  return isLoaded;
}

bool vtkDeformVolumeSession::Save(
  const std::string& fileName, const char* suffix, const std::function<bool()>& write)
{
  if (!this->CheckInputs())
  {
    return false;
  }
  if (vtksys::SystemTools::LowerCase(vtksys::SystemTools::GetFilenameLastExtension(fileName)) !=
    suffix)
  {
    this->Report("Cannot write " + fileName + ": the name must end in " + suffix + ".");
    return false;
  }
  return this->UsePipeline(write);
}

bool vtkDeformVolumeSession::SaveVolume(const std::string& fileName)
{
  return this->Save(fileName, ".vti",
    [&]
    {
      WriteData<vtkXMLImageDataWriter>(
        this->Internals->Pipeline.Resample(this->Internals->GetFullSampling()), fileName);
      return true;
    });
}

bool vtkDeformVolumeSession::SaveMesh(const std::string& fileName)
{
  return this->Save(fileName, ".vtu",
    [&]
    {
      deformvolume::SessionPipeline& pipeline = this->Internals->Pipeline;
      auto* mesh = vtkUnstructuredGrid::SafeDownCast(pipeline.GetDeformation());
      if (!mesh || pipeline.GetModel() == NONE)
      {
        throw std::runtime_error(
          "The model has no mesh. Choose MASS_SPRING or FINITE_ELEMENTS, or save the volume.");
      }
      vtkNew<vtkUnstructuredGrid> deformed;
      deformed->DeepCopy(mesh);
      vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
      for (vtkIdType id = 0; id < deformed->GetNumberOfPoints(); ++id)
      {
        double position[3];
        double by[3];
        mesh->GetPoint(id, position);
        vectors->GetTuple(id, by);
        deformed->GetPoints()->SetPoint(
          id, position[0] + by[0], position[1] + by[1], position[2] + by[2]);
      }
      WriteData<vtkXMLUnstructuredGridWriter>(deformed, fileName);
      return true;
    });
}
