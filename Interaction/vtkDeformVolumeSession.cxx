// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeSession.h"

#include "vtkDeformVolumeSessionInternals.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

using deformvolume::SessionEvent;
using deformvolume::SessionEvents;
using Sampling = deformvolume::SessionPipeline::Sampling;

namespace
{

// Returns an error message, or "".
std::string CheckVolume(vtkImageData* volume)
{
  if (!volume)
  {
    return "The volume is null. Set a vtkImageData.";
  }
  if (!volume->GetPointData()->GetScalars())
  {
    return "The volume has no active point scalars. Call SetScalars() of its point data.";
  }
  if (volume->GetPointData()->GetScalars()->GetDataType() == VTK_BIT)
  {
    return "The active point scalars of the volume are a vtkBitArray, which cannot be deformed. "
           "Convert them to numeric scalars, such as a vtkUnsignedCharArray.";
  }
  if (volume->GetDataDimension() != 3)
  {
    const int* dimensions = volume->GetDimensions();
    return "The volume has " + std::to_string(dimensions[0]) + " x " +
      std::to_string(dimensions[1]) + " x " + std::to_string(dimensions[2]) +
      " voxels. It must have at least two voxels on each axis.";
  }
  return "";
}

bool IsSetting(const SessionEvent& event)
{
  return event.Kind == SessionEvent::HANDLE_RADIUS ||
    event.Kind == SessionEvent::RELAXATION_SWEEPS || event.Kind == SessionEvent::NUMBER_OF_NODES ||
    event.Kind == SessionEvent::UNDO_MEMORY;
}

bool HasBits(vtkDataArray* array, int bits)
{
  for (vtkIdType i = 0; array && i < array->GetNumberOfTuples(); ++i)
  {
    if ((static_cast<int>(array->GetComponent(i, 0)) & bits) != 0)
    {
      return true;
    }
  }
  return false;
}

// Returns a text if a mesh has cells that the models would leave out.
std::string CheckMesh(vtkUnstructuredGrid* mesh)
{
  const char* ghosts = vtkDataSetAttributes::GhostArrayName();
  vtkDataArray* valid = mesh->GetPointData()->GetArray("vtkValidPointMask");
  const bool isInvalid = valid && valid->GetNumberOfTuples() > 0 && valid->GetRange(0)[0] <= 0.0 &&
    valid->GetRange(0)[1] >= 0.0;
  return isInvalid ||
      HasBits(mesh->GetPointData()->GetArray(ghosts), vtkDataSetAttributes::HIDDENPOINT) ||
      HasBits(mesh->GetCellData()->GetArray(ghosts),
        vtkDataSetAttributes::HIDDENCELL | vtkDataSetAttributes::DUPLICATECELL)
    ? "The mesh has hidden points, or hidden or duplicate cells. Remove them, for example with "
      "vtkThreshold."
    : "";
}

} // namespace

vtkStandardNewMacro(vtkDeformVolumeSession);

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
  std::string fault = CheckVolume(volume);
  if (fault.empty() && mesh)
  {
    fault = CheckMesh(mesh);
  }
  if (!fault.empty())
  {
    this->Report(fault);
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
    SessionEvents& queue = internals.Queue;
    queue.erase(
      std::remove_if(queue.begin(), queue.end(), [](const auto& one) { return !IsSetting(one); }),
      queue.end());
    internals.NewOutput = nullptr;
    internals.State = vtkInternals::PublishedState();
    internals.Sampling.BackgroundValue =
      std::min(volume->GetPointData()->GetScalars()->GetRange(0)[0], 0.0);
    internals.IsBusy = true; // until the first output
  }
  catch (const std::exception& error)
  {
    fault = internals.Inputs.first ? internals.Restore(record) : "";
    this->Report(error.what());
    if (!fault.empty())
    {
      this->Report(fault);
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
    this->Report("An argument is not finite. Use finite numbers.");
  }
  return areFinite;
}

// Calls body between two steps of the thread, and returns its result; false after an error, which
// is reported.
bool vtkDeformVolumeSession::UsePipeline(const std::function<bool()>& body)
{
  try // access ends before the error is reported, as its observers may call the session
  {
    const vtkInternals::Access access(*this->Internals);
    return body();
  }
  catch (const std::exception& error)
  {
    this->Report(error.what());
    return false;
  }
}

// kind: a SessionEvent::KindType.
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
  this->Enqueue(SessionEvent::HOLD_GRAB, { static_cast<double>(handle) });
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
  this->Enqueue(SessionEvent::RELAXATION_SWEEPS, { static_cast<double>(sweeps) });
}

void vtkDeformVolumeSession::ChangeNumberOfNodes(int nodes)
{
  this->Enqueue(SessionEvent::NUMBER_OF_NODES, { static_cast<double>(nodes) });
}

void vtkDeformVolumeSession::ChangeUndoMemory(double bytes)
{
  this->Enqueue(SessionEvent::UNDO_MEMORY, { bytes });
}

void vtkDeformVolumeSession::SetMovingSamplingFactor(int factor)
{
  if (factor != 1 && factor != 2 && factor != 4)
  {
    this->Report("MovingSamplingFactor is " + std::to_string(factor) + ". Set 1, 2 or 4.");
    return;
  }
  if (this->Internals->ChangeSampling(&Sampling::Factor, factor))
  {
    this->Modified();
  }
}

int vtkDeformVolumeSession::GetMovingSamplingFactor()
{
  return this->Internals->GetMovingSampling().Factor;
}

void vtkDeformVolumeSession::SetPadding(int voxels)
{
  constexpr int most = 1000;
  const int padding = std::clamp(voxels, 0, most);
  if (this->Internals->ChangeSampling(&Sampling::Padding, padding))
  {
    this->Modified();
  }
}

int vtkDeformVolumeSession::GetPadding()
{
  return this->Internals->GetMovingSampling().Padding;
}

void vtkDeformVolumeSession::SetBackgroundValue(double value)
{
  if (this->Internals->ChangeSampling(&Sampling::BackgroundValue, value))
  {
    this->Modified();
  }
}

double vtkDeformVolumeSession::GetBackgroundValue()
{
  return this->Internals->GetMovingSampling().BackgroundValue;
}

void vtkDeformVolumeSession::AddCategoricalArray(const std::string& name)
{
  bool isNew = false;
  {
    const std::lock_guard<std::mutex> lock(this->Internals->QueueMutex);
    isNew = this->Internals->Sampling.CategoricalArrays.insert(name).second;
  }
  if (isNew) // not while the mutex is locked, as observers may call the session
  {
    this->Modified();
  }
}

void vtkDeformVolumeSession::ClearCategoricalArrays()
{
  if (this->Internals->ChangeSampling(&Sampling::CategoricalArrays, {}))
  {
    this->Modified();
  }
}

bool vtkDeformVolumeSession::Update()
{
  if (!this->CheckInputs())
  {
    return false;
  }
  if (this->GetIsRunning())
  {
    this->Report("The thread of the session is active. Call Stop() before Update().");
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

vtkDataSet* vtkDeformVolumeSession::CopyDeformation()
{
  vtkSmartPointer<vtkDataSet> copy;
  const auto make = [&]
  {
    vtkDataSet* deformation = this->Internals->Pipeline.GetDeformation();
    const auto made = vtk::TakeSmartPointer(deformation->NewInstance());
    made->DeepCopy(deformation);
    copy = made;
    return true;
  };
  if (this->CheckInputs() && this->UsePipeline(make))
  {
    copy->Register(nullptr); // for the caller
  }
  return copy;
}

bool vtkDeformVolumeSession::Probe(double x, double y, double z)
{
  const auto probe = [&]
  {
    deformvolume::SessionPipeline& pipeline = this->Internals->Pipeline;
    const auto sampling = this->Internals->GetFullSampling();
    vtkImageData* output = pipeline.ResampleForSearch(sampling);
    const vtkIdType voxel = output->FindPoint(x, y, z);
    vtkDataArray* covered = output->GetPointData()->GetArray("vtkValidPointMask");
    if (voxel < 0 || !covered || covered->GetComponent(voxel, 0) == 0.0)
    {
      return false;
    }
    vtkDataArray* scalars = output->GetPointData()->GetScalars();
    this->ProbedValue = scalars ? scalars->GetComponent(voxel, 0) : 0.0;
    const glm::dvec3 rest = pipeline.FindRestPosition({ x, y, z }, sampling);
    std::copy(&rest.x, &rest.x + 3, this->ProbedRestPosition);
    return true;
  };
  return this->CheckInputs() && this->CheckFinite({ x, y, z }) && this->UsePipeline(probe);
}

void vtkDeformVolumeSession::GetHandles(vtkPolyData* handles)
{
  if (!handles)
  {
    this->Report("The argument of GetHandles() is null. Give a vtkPolyData to write to.");
    return;
  }
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
