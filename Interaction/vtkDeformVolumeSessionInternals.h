// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkDeformVolumeSessionInternals_h
#define vtkDeformVolumeSessionInternals_h

#include "SessionEvents.h"
#include "SessionPipeline.h"
#include "vtkDeformVolumeSession.h"

#include "vtkImageData.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

// The events that wait, the thread that makes them, and what it has made.
class vtkDeformVolumeSession::vtkInternals
{
public:
  // What the caller may ask for while a step is made.
  struct PublishedState
  {
    int Model = vtkDeformVolumeSession::NONE;
    std::size_t Actions = 0;
    std::size_t UndoneActions = 0;
    vtkIdType Steps = 0;
    vtkIdType MovedVoxels = 0;
    double RelativeResidual = 0.0;
    double SimulationTime = 0.0;
    double ResamplingTime = 0.0;
    std::vector<deformvolume::SessionPipeline::Handle> Handles;
  };

  // The pipeline and the record: for a whole step.
  std::mutex PipelineMutex;
  deformvolume::SessionPipeline Pipeline;
  deformvolume::SessionEvents Record;
  bool IsMoving = false;
  std::string InputHash; // "" until it is wanted
  vtkIdType Steps = 0;

  // The rest: for moments only. It is locked after PipelineMutex where both are.
  std::mutex QueueMutex;
  std::condition_variable Wake;
  deformvolume::SessionEvents Queue;
  std::vector<std::string> Errors;
  std::vector<std::string> Warnings;
  vtkSmartPointer<vtkImageData> NewOutput;
  PublishedState State;
  bool IsBusy = false; // something moves, or events are being made
  bool IsToStop = false;
  int Waiting = 0;                                  // callers that wait for the pipeline
  deformvolume::SessionPipeline::Sampling Sampling; // where something moves
  std::thread Worker;
  int LastHandle = -1;

  // Where nothing moves.
  deformvolume::SessionPipeline::Sampling GetFullSampling();

  // For files only: all of the volume is read.
  const std::string& GetInputHash();

  void Enqueue(deformvolume::SessionEvent::KindType kind, std::vector<double> numbers);

  // The events that wait and one step. PipelineMutex is locked.
  bool RunOnce();

  // What fails is recorded, too: a step that has failed has put handles back, and all fails again
  // in a replay.
  void Make(deformvolume::SessionEvent event, std::vector<std::string>& errors);

  void Begin(vtkImageData* volume, vtkUnstructuredGrid* mesh);

  template <typename ProgressT>
  void Replay(const deformvolume::SessionEvents& events, const ProgressT& progress)
  {
    this->Begin(this->Inputs.first, this->Inputs.second);
    this->Record.clear();
    std::vector<std::string> errors; // they were reported when the events were made first
    for (std::size_t i = 0; i < events.size(); ++i)
    {
      this->Make(events[i], errors);
      progress(static_cast<double>(i + 1) / static_cast<double>(events.size()));
    }
  }

  // What the thread does until it is to stop.
  void Work();

  // Holds the pipeline between two steps of the thread, which would otherwise take it at once
  // again.
  class Access
  {
  public:
    explicit Access(vtkInternals& internals)
      : Internals(internals)
    {
      this->Count(1);
      this->Internals.PipelineMutex.lock();
    }
    ~Access()
    {
      this->Internals.PipelineMutex.unlock();
      this->Count(-1);
    }
    Access(const Access&) = delete;
    void operator=(const Access&) = delete;

  private:
    void Count(int change)
    {
      const std::lock_guard<std::mutex> lock(this->Internals.QueueMutex);
      this->Internals.Waiting += change;
      this->Internals.Wake.notify_all();
    }
    vtkInternals& Internals;
  };

  std::pair<vtkSmartPointer<vtkImageData>, vtkSmartPointer<vtkUnstructuredGrid>> Inputs;
};

#endif
