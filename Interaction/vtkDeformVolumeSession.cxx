// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeSession.h"

#include "SessionEvents.h"
#include "SessionPipeline.h"
#include "SessionPlaces.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLImageDataWriter.h"
#include "vtkXMLUnstructuredGridWriter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

using deformvolume::SessionEvent;
using deformvolume::SessionEvents;

vtkStandardNewMacro(vtkDeformVolumeSession);

namespace
{

double GetSeconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

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

} // namespace

class vtkDeformVolumeSession::vtkInternals
{
public:
  // The pipeline and the record: for a whole step.
  std::mutex PipelineMutex;
  deformvolume::SessionPipeline Pipeline;
  SessionEvents Record;
  bool IsMoving = false;
  std::string InputHash; // "" until it is wanted
  vtkIdType Steps = 0;

  // The rest: for moments only. It is locked after PipelineMutex where both are.
  std::mutex QueueMutex;
  std::condition_variable Wake;
  SessionEvents Queue;
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

  deformvolume::SessionPipeline::Sampling GetFullSampling()
  {
    const std::lock_guard<std::mutex> lock(this->QueueMutex);
    deformvolume::SessionPipeline::Sampling sampling = this->Sampling;
    sampling.Factor = 1;
    return sampling;
  }

  // For files only: all of the volume is read.
  const std::string& GetInputHash()
  {
    if (this->InputHash.empty())
    {
      this->InputHash = deformvolume::HashInputs(this->Inputs.first, this->Inputs.second);
    }
    return this->InputHash;
  }

  void Enqueue(SessionEvent::KindType kind, std::vector<double> numbers)
  {
    const std::lock_guard<std::mutex> lock(this->QueueMutex);
    // A handle goes to where it was moved last; what lies between is not seen.
    if (kind == SessionEvent::MOVE_GRAB && !this->Queue.empty() &&
      this->Queue.back().Kind == kind && this->Queue.back().Numbers[0] == numbers[0])
    {
      this->Queue.back().Numbers = std::move(numbers);
    }
    else
    {
      this->Queue.push_back({ kind, std::move(numbers) });
    }
    this->Wake.notify_all();
  }

  // The events that wait and one step. PipelineMutex is locked.
  bool RunOnce()
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
      this->Make(std::move(event), errors);
    }
    this->Make({ SessionEvent::STEP, {} }, errors);
    if (sampling.Factor != 1 && sampling.Factor != 2 && sampling.Factor != 4)
    {
      errors.emplace_back("MovingSamplingFactor is not 1, 2 or 4. Set one of these.");
      sampling.Factor = 1;
    }
    sampling.Factor = this->IsMoving ? sampling.Factor : 1;
    state.SimulationTime = GetSeconds() - begin;

    vtkSmartPointer<vtkImageData> output;
    try
    {
      begin = GetSeconds();
      vtkImageData* resampled = this->Pipeline.Resample(sampling);
      state.ResamplingTime = GetSeconds() - begin;
      // The filter writes to no array that somebody else holds.
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

  // What fails is recorded, too: a step that has failed has put handles back, and all fails again
  // in a replay.
  void Make(SessionEvent event, std::vector<std::string>& errors)
  {
    try
    {
      if (event.Kind == SessionEvent::STEP)
      {
        ++this->Steps;
        this->IsMoving = false;
        this->IsMoving = this->Pipeline.Step();
      }
      else
      {
        this->Pipeline.Apply(event);
      }
    }
    catch (const std::exception& error)
    {
      errors.emplace_back(error.what());
    }
    this->Record.push_back(std::move(event));
  }

  void Begin(vtkImageData* volume, vtkUnstructuredGrid* mesh)
  {
    this->Pipeline.SetInputs(volume, mesh);
    this->Record = this->Pipeline.GetSettings();
    this->Steps = 0;
    this->IsMoving = false;
  }

  template <typename ProgressT>
  void Replay(const SessionEvents& events, const ProgressT& progress)
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

  void Work()
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

vtkDeformVolumeSession::vtkDeformVolumeSession()
  : Internals(new vtkInternals)
{
}

vtkDeformVolumeSession::~vtkDeformVolumeSession()
{
  this->Stop();
}

void vtkDeformVolumeSession::Report(const std::string& message)
{
  this->ErrorMessage = message;
  vtkErrorMacro(<< message);
}

void vtkDeformVolumeSession::ReportErrors()
{
  std::vector<std::string> errors;
  std::vector<std::string> warnings;
  {
    const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
    errors.swap(this->Internals->Errors);
    warnings.swap(this->Internals->Warnings);
  }
  for (const std::string& warning : warnings)
  {
    vtkWarningMacro(<< warning);
  }
  for (const std::string& error : errors)
  {
    this->Report(error);
  }
}

bool vtkDeformVolumeSession::SetInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  if (!volume || !volume->GetPointData()->GetScalars() || volume->GetDataDimension() != 3)
  {
    this->Report("There is no volume of at least two voxels on each axis with scalars. Give one.");
    return false;
  }
  const bool wasRunning = this->GetIsRunning();
  this->Stop();
  vtkInternals& internals = *this->Internals;
  const SessionEvents record = internals.Record;
  auto inputs = std::make_pair(vtkSmartPointer<vtkImageData>::New(),
    mesh ? vtkSmartPointer<vtkUnstructuredGrid>::New() : nullptr);
  inputs.first->ShallowCopy(volume);
  if (mesh)
  {
    inputs.second->DeepCopy(mesh);
  }
  bool isDone = false;
  try
  {
    internals.Begin(inputs.first, inputs.second);
    internals.Inputs = inputs;
    internals.InputHash.clear();
    isDone = true;
    const std::lock_guard<std::mutex> lock(internals.QueueMutex);
    internals.Queue.clear();
    internals.NewOutput = nullptr;
    internals.State = PublishedState();
    internals.Sampling.BackgroundValue =
      std::min(volume->GetPointData()->GetScalars()->GetRange(0)[0], 0.0);
    internals.IsBusy = true; // for the first output
  }
  catch (const std::exception& error)
  {
    this->Report(error.what());
    if (internals.Inputs.first)
    {
      internals.Replay(record, [](double) {});
    }
  }
  if (wasRunning)
  {
    this->Start();
  }
  return isDone;
}

bool vtkDeformVolumeSession::CheckInputs()
{
  if (!this->Internals->Inputs.first)
  {
    this->Report("There is no volume. Call SetInputs() first.");
    return false;
  }
  return true;
}

bool vtkDeformVolumeSession::CheckFinite(const std::vector<double>& numbers)
{
  const bool areFinite = std::all_of(
    numbers.begin(), numbers.end(), [](double number) { return std::isfinite(number); });
  if (!areFinite)
  {
    this->Report("A number is not finite. Set finite ones.");
  }
  return areFinite;
}

// kind: of a SessionEvent.
bool vtkDeformVolumeSession::Enqueue(int kind, const std::vector<double>& numbers)
{
  if (!this->CheckInputs() || !this->CheckFinite(numbers))
  {
    return false;
  }
  this->Internals->Enqueue(static_cast<SessionEvent::KindType>(kind), numbers);
  return true;
}

void vtkDeformVolumeSession::ChangeModel(int model)
{
  this->Enqueue(SessionEvent::MODEL, { static_cast<double>(model) });
}

int vtkDeformVolumeSession::BeginGrab(double x, double y, double z)
{
  const int handle = this->Internals->LastHandle + 1;
  if (!this->Enqueue(SessionEvent::BEGIN_GRAB, { static_cast<double>(handle), x, y, z }))
  {
    return -1;
  }
  this->Internals->LastHandle = handle;
  return handle;
}

void vtkDeformVolumeSession::MoveGrab(int handle, double x, double y, double z)
{
  this->Enqueue(SessionEvent::MOVE_GRAB, { static_cast<double>(handle), x, y, z });
}

void vtkDeformVolumeSession::EndGrab(int handle)
{
  this->Enqueue(SessionEvent::END_GRAB, { static_cast<double>(handle) });
}

void vtkDeformVolumeSession::HoldGrab(int handle)
{
  this->Enqueue(SessionEvent::HOLD, { static_cast<double>(handle) });
}

void vtkDeformVolumeSession::Release(int handle)
{
  this->Enqueue(SessionEvent::RELEASE, { static_cast<double>(handle) });
}

int vtkDeformVolumeSession::Pin(double x, double y, double z)
{
  const int handle = this->BeginGrab(x, y, z);
  if (handle >= 0)
  {
    this->HoldGrab(handle);
  }
  return handle;
}

void vtkDeformVolumeSession::Cut(vtkPolyData* sheet)
{
  if (!this->CheckInputs())
  {
    return;
  }
  try
  {
    const SessionEvent event = deformvolume::MakeCutEvent(sheet);
    this->Enqueue(event.Kind, event.Numbers);
  }
  catch (const std::exception& error)
  {
    this->Report(error.what());
  }
}

void vtkDeformVolumeSession::CarveSphere(double x, double y, double z, double radius)
{
  this->Enqueue(SessionEvent::CARVE, { 1.0, x, y, z, radius });
}

void vtkDeformVolumeSession::CarveTo(double x, double y, double z, double radius)
{
  this->Enqueue(SessionEvent::CARVE, { 0.0, x, y, z, radius });
}

void vtkDeformVolumeSession::Undo()
{
  this->Enqueue(SessionEvent::UNDO);
}

void vtkDeformVolumeSession::Redo()
{
  this->Enqueue(SessionEvent::REDO);
}

void vtkDeformVolumeSession::Reset()
{
  this->Enqueue(SessionEvent::RESET);
}

void vtkDeformVolumeSession::ChangeHandleRadius(double radius)
{
  this->Enqueue(SessionEvent::HANDLE_RADIUS, { radius });
}

void vtkDeformVolumeSession::ChangeRelaxationSweeps(int sweeps)
{
  this->Enqueue(SessionEvent::RELAXATION, { static_cast<double>(sweeps) });
}

void vtkDeformVolumeSession::ChangeNumberOfNodes(int nodes)
{
  this->Enqueue(SessionEvent::LATTICE, { static_cast<double>(nodes) });
}

void vtkDeformVolumeSession::ChangeUndoMemory(double bytes)
{
  this->Enqueue(SessionEvent::UNDO_MEMORY, { bytes });
}

void vtkDeformVolumeSession::SetMovingSamplingFactor(int factor)
{
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  if (factor != this->Internals->Sampling.Factor)
  {
    this->Internals->Sampling.Factor = factor;
    this->Modified();
  }
}

int vtkDeformVolumeSession::GetMovingSamplingFactor()
{
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  return this->Internals->Sampling.Factor;
}

void vtkDeformVolumeSession::SetPadding(int voxels)
{
  constexpr int most = 1000;
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  const int padding = std::clamp(voxels, 0, most);
  if (padding != this->Internals->Sampling.Padding)
  {
    this->Internals->Sampling.Padding = padding;
    this->Modified();
  }
}

int vtkDeformVolumeSession::GetPadding()
{
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  return this->Internals->Sampling.Padding;
}

void vtkDeformVolumeSession::SetBackgroundValue(double value)
{
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  if (value != this->Internals->Sampling.BackgroundValue)
  {
    this->Internals->Sampling.BackgroundValue = value;
    this->Modified();
  }
}

double vtkDeformVolumeSession::GetBackgroundValue()
{
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  return this->Internals->Sampling.BackgroundValue;
}

bool vtkDeformVolumeSession::Update()
{
  if (!this->CheckInputs())
  {
    return false;
  }
  if (this->GetIsRunning())
  {
    this->Report("The thread of the session runs. Call Stop() before Update().");
    return false;
  }
  bool isMoving = false;
  {
    const vtkInternals::Access access(*this->Internals);
    isMoving = this->Internals->RunOnce();
  }
  this->ReportErrors();
  return isMoving;
}

void vtkDeformVolumeSession::Start()
{
  if (!this->CheckInputs() || this->GetIsRunning())
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  internals.IsToStop = false;
  internals.Worker = std::thread([&internals] { internals.Work(); });
}

void vtkDeformVolumeSession::Stop()
{
  vtkInternals& internals = *this->Internals;
  if (!internals.Worker.joinable())
  {
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(internals.QueueMutex);
    internals.IsToStop = true;
    internals.Wake.notify_all();
  }
  internals.Worker.join();
}

bool vtkDeformVolumeSession::GetIsRunning()
{
  return this->Internals->Worker.joinable();
}

bool vtkDeformVolumeSession::GetIsBusy()
{
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  return this->Internals->IsBusy || !this->Internals->Queue.empty();
}

vtkImageData* vtkDeformVolumeSession::TakeOutput()
{
  this->ReportErrors();
  vtkSmartPointer<vtkImageData> output;
  const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
  output = this->Internals->NewOutput;
  this->Internals->NewOutput = nullptr;
  if (output)
  {
    output->Register(nullptr);
  }
  return output;
}

bool vtkDeformVolumeSession::Probe(double x, double y, double z)
{
  if (!this->CheckInputs() || !this->CheckFinite({ x, y, z }))
  {
    return false;
  }
  const vtkInternals::Access access(*this->Internals);
  try
  {
    deformvolume::SessionPipeline& pipeline = this->Internals->Pipeline;
    vtkImageData* output = pipeline.Resample(this->Internals->GetFullSampling());
    const vtkIdType voxel = output->FindPoint(x, y, z);
    vtkDataArray* covered = output->GetPointData()->GetArray("vtkValidPointMask");
    if (voxel < 0 || !covered || covered->GetComponent(voxel, 0) == 0.0)
    {
      return false;
    }
    vtkDataArray* scalars = output->GetPointData()->GetScalars();
    this->ProbedValue = scalars ? scalars->GetComponent(voxel, 0) : 0.0;
    const glm::dvec3 rest = deformvolume::FindRestPlace(pipeline.GetDeformation(), { x, y, z });
    std::copy(&rest.x, &rest.x + 3, this->ProbedRestPosition);
    return true;
  }
  catch (const std::exception& error)
  {
    this->Report(error.what());
    return false;
  }
}

bool vtkDeformVolumeSession::SaveSession(const std::string& fileName)
{
  if (!this->CheckInputs())
  {
    return false;
  }
  const vtkInternals::Access access(*this->Internals);
  try
  {
    if (!this->Internals->Queue.empty())
    {
      this->Internals->RunOnce();
    }
    deformvolume::WriteEvents(fileName, this->Internals->GetInputHash(), this->Internals->Record);
    return true;
  }
  catch (const std::exception& error)
  {
    this->Report(error.what());
    return false;
  }
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
  catch (const std::exception& error) // too little memory
  {
    this->Report("The session " + fileName + " cannot be replayed: " + error.what());
    internals.Replay(record, [](double) {});
    isLoaded = false;
  }
  {
    const std::lock_guard<std::mutex> lock(internals.QueueMutex);
    internals.IsBusy = true; // for an output
    internals.Queue.clear(); // of the session that was before
  }
  if (wasRunning)
  {
    this->Start();
  }
  return isLoaded;
}

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
      writer->SetDataModeToBinary(); // raw appended data confuse the parser of some versions
      writer->SetInputData(data);
      if (writer->Write() == 0 || hasFailed || writer->GetErrorCode() != 0)
      {
        throw std::runtime_error("The file " + fileName +
          " cannot be written. Choose a folder that can be written and has space.");
      }
    });
}

} // namespace

bool vtkDeformVolumeSession::Save(const std::string& fileName, bool isMesh)
{
  if (!this->CheckInputs())
  {
    return false;
  }
  const vtkInternals::Access access(*this->Internals);
  try
  {
    deformvolume::SessionPipeline& pipeline = this->Internals->Pipeline;
    if (!isMesh)
    {
      WriteData<vtkXMLImageDataWriter>(
        pipeline.Resample(this->Internals->GetFullSampling()), fileName);
      return true;
    }
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
      double place[3];
      double by[3];
      mesh->GetPoint(id, place);
      vectors->GetTuple(id, by);
      deformed->GetPoints()->SetPoint(id, place[0] + by[0], place[1] + by[1], place[2] + by[2]);
    }
    WriteData<vtkXMLUnstructuredGridWriter>(deformed, fileName);
    return true;
  }
  catch (const std::exception& error)
  {
    this->Report(error.what());
    return false;
  }
}

bool vtkDeformVolumeSession::SaveVolume(const std::string& fileName)
{
  return this->Save(fileName, false);
}

bool vtkDeformVolumeSession::SaveMesh(const std::string& fileName)
{
  return this->Save(fileName, true);
}

void vtkDeformVolumeSession::GetHandles(vtkPolyData* handles)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkIntArray> numbers;
  numbers->SetName("Handle");
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  vtkNew<vtkUnsignedCharArray> grabbed;
  grabbed->SetName("Grabbed");
  {
    const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
    for (const auto& handle : this->Internals->State.Handles)
    {
      points->InsertNextPoint(&handle.Now.x);
      numbers->InsertNextValue(handle.Number);
      rest->InsertNextTuple(&handle.Rest.x);
      grabbed->InsertNextValue(handle.IsGrabbed ? 1 : 0);
    }
  }
  handles->Initialize();
  handles->SetPoints(points);
  handles->GetPointData()->AddArray(numbers);
  handles->GetPointData()->AddArray(rest);
  handles->GetPointData()->AddArray(grabbed);
}

#define GET_STATE(Type, Name, Member)                                                              \
  Type vtkDeformVolumeSession::Get##Name()                                                         \
  {                                                                                                \
    const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);                           \
    return static_cast<Type>(this->Internals->State.Member);                                       \
  }
GET_STATE(int, Model, Model)
GET_STATE(vtkIdType, NumberOfActions, Actions)
GET_STATE(vtkIdType, NumberOfUndoneActions, UndoneActions)
GET_STATE(vtkIdType, NumberOfSteps, Steps)
GET_STATE(vtkIdType, NumberOfMovedVoxels, MovedVoxels)
GET_STATE(double, RelativeResidual, RelativeResidual)
GET_STATE(double, SimulationTime, SimulationTime)
GET_STATE(double, ResamplingTime, ResamplingTime)
#undef GET_STATE

void vtkDeformVolumeSession::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Model: " << this->GetModel() << "\n"
     << indent << "Actions: " << this->GetNumberOfActions() << "\n"
     << indent << "Undone Actions: " << this->GetNumberOfUndoneActions() << "\n"
     << indent << "MovingSamplingFactor: " << this->GetMovingSamplingFactor() << "\n"
     << indent << "Padding: " << this->GetPadding() << "\n"
     << indent << "BackgroundValue: " << this->GetBackgroundValue() << "\n"
     << indent << "Running: " << (this->GetIsRunning() ? "on" : "off") << "\n"
     << indent << "Error Message: " << this->ErrorMessage << "\n";
}
