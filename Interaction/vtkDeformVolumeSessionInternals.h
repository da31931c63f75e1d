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

// The pending events, the thread that processes them, and its results.
class vtkDeformVolumeSession::vtkInternals
{
public:
  // Results that the caller can get while a step is computed.
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

  // Protects the following members. Locked for a whole step.
  std::mutex PipelineMutex;
  deformvolume::SessionPipeline Pipeline;
  deformvolume::SessionEvents Record;
  bool IsMoving = false;
  bool HasFailed = false; // whether a step has failed since the last event
  std::string InputHash;  // "": not computed yet
  vtkIdType Steps = 0;

  // Protects the following members. Locked for short times only, and after PipelineMutex if both
  // are locked.
  std::mutex QueueMutex;
  std::condition_variable Wake;
  deformvolume::SessionEvents Queue;
  std::vector<std::string> Errors;
  std::vector<std::string> Warnings;
  vtkSmartPointer<vtkImageData> NewOutput;
  PublishedState State;
  bool IsBusy = false; // the body moves, or events are processed
  bool IsToStop = false;
  int Waiting = 0; // number of callers that wait for the pipeline or use it
  deformvolume::SessionPipeline::Sampling Sampling; // while the body moves
  std::thread Worker;
  int LastHandle = -1;

  // Returns whether the value has changed.
  template <typename ValueT>
  bool ChangeSampling(ValueT deformvolume::SessionPipeline::Sampling::*member, ValueT value)
  {
    const std::lock_guard<std::mutex> lock(this->QueueMutex);
    return std::exchange(this->Sampling.*member, value) != value;
  }

  // The sampling while the body moves, and at rest.
  deformvolume::SessionPipeline::Sampling GetMovingSampling();
  deformvolume::SessionPipeline::Sampling GetFullSampling();

  // Computed only for files, because it reads the whole volume.
  const std::string& GetInputHash();

  void Enqueue(deformvolume::SessionEvent::KindType kind, std::vector<double> numbers);

  // Processes the pending events and one step. PipelineMutex must be locked.
  bool RunOnce();

  // Processes and records an event. Failed events are recorded, too, because a failed step moves
  // handles back. In a replay, the same events fail again.
  void ProcessAndRecord(deformvolume::SessionEvent event, std::vector<std::string>& errors);

  void Begin(vtkImageData* volume, vtkUnstructuredGrid* mesh);

  template <typename ProgressT>
  void Replay(const deformvolume::SessionEvents& events, const ProgressT& progress)
  {
    this->Begin(this->Inputs.first, this->Inputs.second);
    this->Record.clear();
    std::vector<std::string> errors; // not reported a second time
    for (std::size_t i = 0; i < events.size(); ++i)
    {
      this->ProcessAndRecord(events[i], errors);
      progress(static_cast<double>(i + 1) / static_cast<double>(events.size()));
    }
  }

  // Replays the events of the last valid state after a failure. Returns an error message, or "".
  std::string Restore(const deformvolume::SessionEvents& events);

  // The function of the thread.
  void Work();

  // Locks PipelineMutex between two steps of the thread. The thread does not begin a step while the
  // member Waiting is not 0.
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
