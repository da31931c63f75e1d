// SPDX-License-Identifier: BSD-3-Clause
// Processing and recording of the events and steps of vtkDeformVolumeSession, and its thread.
#include "vtkDeformVolumeSessionInternals.h"

#include <chrono>
#include <exception>

using deformvolume::SessionEvent;
using deformvolume::SessionEvents;

namespace
{

double GetSeconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

deformvolume::SessionPipeline::Sampling vtkDeformVolumeSession::vtkInternals::GetMovingSampling()
{
  const std::lock_guard<std::mutex> lock(this->QueueMutex);
  return this->Sampling;
}

deformvolume::SessionPipeline::Sampling vtkDeformVolumeSession::vtkInternals::GetFullSampling()
{
  deformvolume::SessionPipeline::Sampling sampling = this->GetMovingSampling();
  sampling.Factor = 1;
  return sampling;
}

const std::string& vtkDeformVolumeSession::vtkInternals::GetInputHash()
{
  if (this->InputHash.empty())
  {
    this->InputHash = deformvolume::HashInputs(this->Inputs.first, this->Inputs.second);
  }
  return this->InputHash;
}

void vtkDeformVolumeSession::vtkInternals::Enqueue(
  SessionEvent::KindType kind, std::vector<double> numbers)
{
  const std::lock_guard<std::mutex> lock(this->QueueMutex);
  // Of successive moves of a handle, only the last one is kept.
  if (kind == SessionEvent::MOVE_GRAB && !this->Queue.empty() && this->Queue.back().Kind == kind &&
    this->Queue.back().Numbers[0] == numbers[0])
  {
    this->Queue.back().Numbers = std::move(numbers);
  }
  else
  {
    this->Queue.push_back({ kind, std::move(numbers) });
  }
  this->Wake.notify_all();
}

bool vtkDeformVolumeSession::vtkInternals::RunOnce()
{
  SessionEvents events;
  deformvolume::SessionPipeline::Sampling sampling;
  {
    const std::lock_guard<std::mutex> lock(this->QueueMutex);
    events.swap(this->Queue);
    this->IsBusy = true;
    sampling = this->Sampling;
  }
  PublishedState state;
  std::vector<std::string> errors;
  double begin = GetSeconds();
  for (SessionEvent& event : events)
  {
    this->ProcessAndRecord(std::move(event), errors);
  }
  this->ProcessAndRecord({ SessionEvent::STEP, {} }, errors);
  sampling.Factor = this->IsMoving ? sampling.Factor : 1;
  state.SimulationTime = GetSeconds() - begin;

  vtkSmartPointer<vtkImageData> output;
  try
  {
    begin = GetSeconds();
    vtkImageData* resampled = this->Pipeline.Resample(sampling);
    state.ResamplingTime = GetSeconds() - begin;
    // A shallow copy is sufficient: the filter does not write to arrays that others hold.
    output = vtkSmartPointer<vtkImageData>::New();
    output->ShallowCopy(resampled);
  }
  catch (const std::exception& error)
  {
    output = nullptr;
    errors.emplace_back(error.what());
  }
  state.Model = this->Pipeline.GetModel();
  state.Actions = this->Pipeline.GetNumberOfActions();
  state.UndoneActions = this->Pipeline.GetNumberOfUndoneActions();
  state.Steps = this->Steps;
  state.MovedVoxels = this->Pipeline.GetNumberOfMovedVoxels();
  state.RelativeResidual = this->Pipeline.GetRelativeResidual();
  state.Handles = this->Pipeline.GetHandles();
  const std::lock_guard<std::mutex> lock(this->QueueMutex);
  this->Errors.insert(this->Errors.end(), errors.begin(), errors.end());
  const std::vector<std::string> warnings = this->Pipeline.TakeWarnings();
  this->Warnings.insert(this->Warnings.end(), warnings.begin(), warnings.end());
  this->NewOutput = output ? output : this->NewOutput;
  this->State = state;
  this->IsBusy = this->IsMoving;
  return this->IsMoving;
}

void vtkDeformVolumeSession::vtkInternals::ProcessAndRecord(
  SessionEvent event, std::vector<std::string>& errors)
{
  try
  {
    if (event.Kind == SessionEvent::STEP)
    {
      ++this->Steps;
      // After a failure the simulation continues, because the body may still move. After a second
      // one without an event in between it stops.
      const bool hadFailed = std::exchange(this->HasFailed, true);
      this->IsMoving = !hadFailed;
      this->IsMoving = this->Pipeline.Step();
      this->HasFailed = hadFailed;
    }
    else
    {
      this->HasFailed = false;
      this->Pipeline.Apply(event);
    }
  }
  catch (const std::exception& error)
  {
    errors.emplace_back(error.what());
  }
  this->Record.push_back(std::move(event));
}

void vtkDeformVolumeSession::vtkInternals::Begin(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  this->Pipeline.SetInputs(volume, mesh);
  this->Record = this->Pipeline.GetSettings();
  this->Steps = 0;
  this->IsMoving = this->HasFailed = false;
}

std::string vtkDeformVolumeSession::vtkInternals::Restore(const SessionEvents& events)
{
  try
  {
    this->Replay(events, [](double) {});
    return "";
  }
  catch (const std::exception& error) // for example std::bad_alloc
  {
    return std::string(
             "Call SetInputs() again. The last state of the session cannot be restored: ") +
      error.what();
  }
}

void vtkDeformVolumeSession::vtkInternals::Work()
{
  for (;;)
  {
    {
      std::unique_lock<std::mutex> lock(this->QueueMutex);
      this->Wake.wait(lock,
        [this] {
          return this->IsToStop || (this->Waiting == 0 && (!this->Queue.empty() || this->IsBusy));
        });
      if (this->IsToStop)
      {
        return;
      }
    }
    const std::lock_guard<std::mutex> lock(this->PipelineMutex);
    this->RunOnce();
  }
}
