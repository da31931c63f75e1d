// SPDX-License-Identifier: BSD-3-Clause
#include "SessionPipeline.h"

#include "StyleText.h"
#include "VoxelSize.h"
#include "vtkDeformVolumeSession.h"

#include "vtkCallbackCommand.h"
#include "vtkCarveVolume.h"
#include "vtkCellData.h"
#include "vtkChainMailDeformation.h"
#include "vtkCutVolume.h"
#include "vtkDataArray.h"
#include "vtkDeformVolumeFilter.h"
#include "vtkExecutive.h"
#include "vtkFiniteElementDeformation.h"
#include "vtkImageData.h"
#include "vtkMassSpringDeformation.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStructuredData.h"
#include "vtkUnstructuredGrid.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

namespace
{

using deformvolume::SessionEvent;
using Session = vtkDeformVolumeSession;

// Removes the file, the line and the object that VTK puts before a message.
std::string StripMessage(const void* text)
{
  std::string message = static_cast<const char*>(text);
  const std::size_t end = message.find("): ");
  message = end == std::string::npos ? message : message.substr(end + 3);
  message.erase(message.find_last_not_of(" \n") + 1);
  return message;
}

void TakeError(vtkObject*, unsigned long, void* target, void* text)
{
  auto& message = *static_cast<std::string*>(target);
  message =
    message.empty() ? StripMessage(text) : message; // later errors result from the first one
}

void TakeWarning(vtkObject*, unsigned long, void* target, void* text)
{
  static_cast<std::vector<std::string>*>(target)->push_back(StripMessage(text));
}

glm::dvec3 GetPosition(const SessionEvent& event, std::size_t first)
{
  return { event.Numbers[first], event.Numbers[first + 1], event.Numbers[first + 2] };
}

// Whether a position is at most 2^31 voxels away from index 0, the limit of vtkCutVolume. False for
// not-a-number, too.
bool HasPossibleIndex(vtkImageData* volume, const glm::dvec3& position)
{
  constexpr double farthest = 2147483648.0;
  glm::dvec3 index;
  volume->TransformPhysicalPointToContinuousIndex(&position.x, &index.x);
  index = glm::abs(index);
  return index.x <= farthest && index.y <= farthest && index.z <= farthest;
}

int GetInteger(const SessionEvent& event, int least, int most, const char* name)
{
  const double number = event.Numbers[0];
  if (!(number >= least) || number > most || number != std::floor(number))
  {
    std::ostringstream text;
    text << name << " is " << number << ". It must be an integer from " << least << " to " << most
         << ".";
    throw std::runtime_error(text.str());
  }
  return static_cast<int>(number);
}

// Moves a rest position that is a little outside the volume to its border. Returns false if the
// position is farther outside.
bool MoveIntoVolume(vtkImageData* volume, glm::dvec3& rest)
{
  const int* extent = volume->GetExtent();
  // A visible position at the border can be outside by a fraction of a voxel.
  const glm::dvec3 margin = // in voxels
    deformvolume::GetLargestVoxelSize(volume) / deformvolume::GetVoxelSize(volume);
  glm::dvec3 index;
  volume->TransformPhysicalPointToContinuousIndex(&rest.x, &index.x);
  glm::dvec3 inside = index;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double first = extent[2 * axis];
    const double last = extent[2 * axis + 1];
    if (!(index[axis] >= first - margin[axis] && index[axis] <= last + margin[axis]))
    {
      return false;
    }
    inside[axis] = std::clamp(index[axis], first, last);
  }
  if (inside != index) // positions inside are not rounded
  {
    volume->TransformContinuousIndexToPhysicalPoint(&inside.x, &rest.x);
  }
  return true;
}

} // namespace

namespace deformvolume
{

SessionPipeline::SessionPipeline()
{
  this->ErrorObserver->SetCallback(TakeError);
  this->ErrorObserver->SetClientData(&this->Message);
  this->WarningObserver->SetCallback(TakeWarning);
  this->WarningObserver->SetClientData(&this->Warnings);
  for (vtkAlgorithm* filter :
    { static_cast<vtkAlgorithm*>(this->CutFilter), static_cast<vtkAlgorithm*>(this->CarveFilter),
      static_cast<vtkAlgorithm*>(this->ChainMail), static_cast<vtkAlgorithm*>(this->MassSpring),
      static_cast<vtkAlgorithm*>(this->Elements), static_cast<vtkAlgorithm*>(this->Resampler) })
  {
    filter->AddObserver(vtkCommand::ErrorEvent, this->ErrorObserver);
    filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, this->ErrorObserver);
    filter->AddObserver(vtkCommand::WarningEvent, this->WarningObserver);
  }
  this->CutFilter->AccumulateOn();
  this->CutFilter->SmoothCutOn();
  this->CarveFilter->AccumulateOn();
  this->CarveFilter->SmoothBoundaryOn();
  this->ChainMail->SetInputConnection(this->CarveFilter->GetOutputPort());
  this->Resampler->SetInputConnection(this->CarveFilter->GetOutputPort());
  // A constant extent allows partial updates of the output.
  this->Resampler->SetOutputBoundsModeToVolumeBounds();
  this->Elements->SetModeToInteractive();
}

SessionPipeline::~SessionPipeline() = default;

void SessionPipeline::SetInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  this->Volume = volume;
  this->HasWarnedOfPadding = false;
  this->Mesh = mesh;
  for (Actions* actions : { &this->Done, &this->Undone })
  {
    std::for_each(
      actions->begin(), actions->end(), [this](Action& action) { this->ForgetStates(action); });
    actions->clear();
  }
  this->MakeUndeformedMesh();
  this->Model = Session::NONE;
  this->MakeRestMesh();
  this->IsStroke = false;
  this->RejectedHandles.clear();
  this->CutFilter->SetInputData(this->Volume);
  this->CutFilter->SetSheetData(nullptr);
  this->CutFilter->SetDeformationData(nullptr);
  this->CarveFilter->SetDeformationData(nullptr);
  this->CarveFilter->ClearToolPositions();
  this->CutFilter->Reset();
  this->CarveFilter->Reset();
  this->Rebuild();
}

SessionEvents SessionPipeline::GetSettings() const
{
  return { { SessionEvent::HANDLE_RADIUS, { this->HandleRadius } },
    { SessionEvent::RELAXATION_SWEEPS, { static_cast<double>(this->RelaxationSweeps) } },
    { SessionEvent::NUMBER_OF_NODES, { static_cast<double>(this->NodesPerAxis) } },
    { SessionEvent::UNDO_MEMORY, { this->UndoMemory } } };
}

void SessionPipeline::Update(vtkAlgorithm* filter)
{
  this->Message.clear();
  const bool isUpdated = filter->GetExecutive()->Update(0) != 0;
  if (!isUpdated && this->Message.empty())
  {
    this->Message = std::string(filter->GetClassName()) +
      " failed. Call vtkObject::GlobalWarningDisplayOn() before, to see why.";
  }
  if (!this->Message.empty())
  {
    throw std::runtime_error(this->Message);
  }
}

void SessionPipeline::Apply(const SessionEvent& event)
{
  const bool isOfHistory = event.Kind == SessionEvent::UNDO || event.Kind == SessionEvent::REDO ||
    event.Kind == SessionEvent::RESET;
  if (this->NeedsRebuild && !isOfHistory) // one rebuild after several undo events
  {
    this->Rebuild();
  }
  this->IsStroke = this->IsStroke && event.Kind == SessionEvent::CARVE;
  const bool isOfGrab = event.Kind == SessionEvent::MOVE_GRAB ||
    event.Kind == SessionEvent::END_GRAB || event.Kind == SessionEvent::HOLD_GRAB;
  if (isOfGrab && this->RejectedHandles.count(event.Numbers[0]) > 0)
  {
    return; // the caller may not know yet that the handle could not be grabbed
  }
  switch (event.Kind)
  {
    case SessionEvent::BEGIN_GRAB:
      return this->BeginGrab(event.Numbers[0], GetPosition(event, 1));
    case SessionEvent::MOVE_GRAB:
      this->FindHandle(event.Numbers[0], true).Now = GetPosition(event, 1);
      return;
    case SessionEvent::END_GRAB:
    {
      Action& drag = this->FindHandle(event.Numbers[0], true);
      drag.IsGrabbed = drag.IsHeld = false;
      return;
    }
    case SessionEvent::HOLD_GRAB:
      this->FindHandle(event.Numbers[0], true).IsGrabbed = false;
      return;
    case SessionEvent::RELEASE:
      return this->Release(event.Numbers[0]);
    case SessionEvent::CUT:
      return this->Cut(event);
    case SessionEvent::CARVE:
      return this->Carve(event);
    case SessionEvent::UNDO:
      this->EndGrabs();
      this->Undo();
      return;
    case SessionEvent::REDO:
      this->EndGrabs();
      this->Redo();
      return;
    case SessionEvent::RESET:
      return this->Reset();
    case SessionEvent::MODEL:
      return this->SetModel(
        GetInteger(event, Session::NONE, Session::FINITE_ELEMENTS, "The model"));
    case SessionEvent::HANDLE_RADIUS:
      if (!(event.Numbers[0] >= 0.0))
      {
        throw std::runtime_error(
          "The handle radius is " + FormatShort(event.Numbers[0]) + ". Set 0 or more.");
      }
      this->HandleRadius = event.Numbers[0];
      return;
    case SessionEvent::RELAXATION_SWEEPS:
      this->RelaxationSweeps = GetInteger(event, 0, 10000, "The number of relaxation sweeps");
      return;
    case SessionEvent::NUMBER_OF_NODES:
      return this->SetLattice(GetInteger(event, 2, 100, "The number of nodes on an axis"));
    case SessionEvent::UNDO_MEMORY:
      if (!(event.Numbers[0] >= 0.0))
      {
        throw std::runtime_error(
          "The memory for undo is " + FormatShort(event.Numbers[0]) + " bytes. Set 0 or more.");
      }
      this->UndoMemory = event.Numbers[0];
      this->LimitStates();
      return;
    case SessionEvent::STEP:
      this->Step();
  }
}

glm::dvec3 SessionPipeline::FindRestPosition(const glm::dvec3& deformed, const Sampling& sampling)
{
  const glm::dvec3 found = this->Positions.FindRestPosition(this->GetDeformation(), deformed);
  if (!this->MayOverlap())
  {
    return found;
  }
  vtkImageData* output = this->ResampleForSearch(sampling);
  const vtkIdType voxel = output->FindPoint(deformed.x, deformed.y, deformed.z);
  if (voxel < 0 ||
    output->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(voxel, 0) == 0.0)
  {
    return found;
  }
  // The rest position of the visible voxel. `found` is more accurate, but may lie on the hidden
  // side of the cut.
  glm::dvec3 shown;
  output->GetPointData()->GetArray("RestPosition")->GetTuple(voxel, &shown.x);
  return glm::distance(found, shown) <= GetLargestVoxelSize(this->Volume) ? found : shown;
}

void SessionPipeline::BeginGrab(double handle, const glm::dvec3& position)
{
  try
  {
    this->TryBeginGrab(handle, position);
  }
  catch (...)
  {
    this->RejectedHandles.insert(handle);
    throw;
  }
}

bool SessionPipeline::HasTissue(const glm::dvec3& rest) const
{
  vtkImageData* volume = this->CarveFilter->GetOutput();
  vtkDataArray* active = volume->GetCellData()->GetArray("ActiveTetrahedra");
  if (!active)
  {
    return true;
  }
  glm::dvec3 index;
  volume->TransformPhysicalPointToContinuousIndex(&rest.x, &index.x);
  const int* extent = volume->GetExtent();
  // The cells that begin at most one voxel away.
  int first[3];
  int last[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const int lowest = extent[2 * axis];
    const int highest = extent[2 * axis + 1] - 1;
    first[axis] = std::clamp(static_cast<int>(std::floor(index[axis])) - 1, lowest, highest);
    last[axis] = std::clamp(static_cast<int>(std::floor(index[axis])) + 1, lowest, highest);
  }
  int cell[3];
  for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2])
  {
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
    {
      for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
      {
        if (active->GetComponent(vtkStructuredData::ComputeCellIdForExtent(extent, cell), 0) != 0.0)
        {
          return true;
        }
      }
    }
  }
  return false;
}

void SessionPipeline::TryBeginGrab(double handle, const glm::dvec3& position)
{
  for (const Action& action : this->Done)
  {
    if (action.Kind == Action::DRAG && action.Handle == handle)
    {
      throw std::runtime_error("Handle " + std::to_string(static_cast<int>(handle)) +
        " already exists. Use another number.");
    }
  }
  Action drag;
  drag.Handle = handle;
  drag.IsGrabbed = drag.IsHeld = true;
  bool isPossible = HasPossibleIndex(this->Volume, position);
  if (isPossible)
  {
    // Not the sampling of the caller: a replay must find the same position.
    Sampling sampling;
    sampling.CategoricalArrays = this->CategoricalArrays;
    drag.Rest = this->FindRestPosition(position, sampling);
    isPossible = MoveIntoVolume(this->Volume, drag.Rest) && this->HasTissue(drag.Rest);
  }
  if (isPossible)
  {
    // The handle begins at the deformed position of Rest, so that nothing moves before MoveGrab().
    drag.Now = drag.LastPossible =
      this->Positions.FindDeformedPosition(this->GetDeformation(), drag.Rest);
    // In a gap, the nearest tissue is farther away than the voxels of tissue that is visible.
    isPossible = glm::distance(drag.Now, position) <= 2.0 * GetLargestVoxelSize(this->Volume);
  }
  if (!isPossible)
  {
    throw std::runtime_error("The grabbed position " + FormatShort(&position.x) +
      " is outside the deformed volume, or in a gap of its tissue. Grab visible tissue.");
  }
  if (this->GetElastic())
  {
    drag.Nodes = this->FindNodes(drag.Rest);
    this->CheckNodes(drag);
  }
  this->AddActionWithState(drag);
}

void SessionPipeline::CheckNodes(const Action& drag) const
{
  std::set<vtkIdType> taken;
  for (const Action& action : this->GetHeld())
  {
    for (const NodeOfHandle& node : action.Nodes)
    {
      taken.insert(node.Id);
    }
  }
  if (std::all_of(drag.Nodes.begin(), drag.Nodes.end(),
        [&](const NodeOfHandle& node) { return taken.count(node.Id) > 0; }))
  {
    throw std::runtime_error("The handle holds no node that could move: all nodes at its position "
                             "are fixed or held by another handle. Grab another position.");
  }
}

SessionPipeline::Action& SessionPipeline::FindHandle(double handle, bool isGrabbed)
{
  for (Action& action : this->Done)
  {
    if (action.Kind == Action::DRAG && action.Handle == handle && action.IsHeld &&
      (action.IsGrabbed || !isGrabbed))
    {
      return action;
    }
  }
  std::ostringstream text;
  text << "Handle " << handle << (isGrabbed ? " is not grabbed" : " holds nothing")
       << ". Call BeginGrab() first, and use the number that it returns.";
  throw std::runtime_error(text.str());
}

void SessionPipeline::Release(double handle)
{
  this->FindHandle(handle, false).IsGrabbed = false;
  const Actions held = this->GetHeld();
  if (std::none_of(
        held.begin(), held.end(), [=](const Action& one) { return one.Handle == handle; }))
  {
    throw std::runtime_error(
      "Handle " + std::to_string(static_cast<int>(handle)) + " was released already.");
  }
  Action release;
  release.Kind = Action::RELEASE;
  release.Handle = handle;
  this->AddActionWithState(release);
}

void SessionPipeline::Cut(const SessionEvent& event)
{
  const auto sheet = MakeSheet(event);
  for (vtkIdType id = 0; id < sheet->GetNumberOfPoints(); ++id)
  {
    glm::dvec3 point;
    sheet->GetPoint(id, &point.x);
    if (!HasPossibleIndex(this->Volume, point)) // before the subdivision, which would not end
    {
      throw std::runtime_error("Point " + std::to_string(id) +
        " of the sheet is more than 2^31 voxels away from index 0 of the volume. Correct the "
        "point.");
    }
  }
  Action cut;
  cut.Kind = Action::CUT;
  cut.RestSheet = this->Model == Session::NONE
    ? sheet
    : this->Positions.MoveToRest(sheet, this->GetDeformation());
  vtkElasticDeformation* elastic = this->GetElastic();
  if (this->Model == Session::CHAIN_MAIL)
  {
    this->CutFilter->SetDeformationData(this->GetDeformation());
  }
  this->CutFilter->SetSheetData(elastic ? cut.RestSheet : sheet);
  const auto disconnect = [this]
  {
    this->CutFilter->SetDeformationData(nullptr);
    // Remove the sheet from the filter, so that the same sheet can cut again.
    this->CutFilter->SetSheetData(nullptr);
  };
  try
  {
    if (elastic) // first, because a new edit of the mask removes the undone edits
    {
      this->CutMesh(elastic, sheet, this->GetHeld(), cut);
    }
    this->Update(this->CutFilter);
  }
  catch (...)
  {
    disconnect();
    if (elastic)
    {
      elastic->SetSheetData(nullptr);
      if (cut.HasSplit)
      {
        elastic->UndoCut();
      }
      this->RestoreLastPossible(); // the output of the elastic filter is empty
    }
    throw;
  }
  disconnect();
  this->Update(this->CutFilter);
  this->AddActionWithState(cut);
}

void SessionPipeline::CutMesh(
  vtkElasticDeformation* elastic, vtkPolyData* sheet, const Actions& held, Action& cut)
{
  const vtkIdType before = elastic->GetNumberOfCuts();
  cut.NodesBeforeCut = this->GetDeformation()->GetNumberOfPoints();
  elastic->SetSheetData(sheet);
  this->UpdateModel(held);
  cut.HasSplit = elastic->GetNumberOfCuts() > before;
  // Remove the sheet from the filter, so that the same sheet can cut again.
  elastic->SetSheetData(nullptr);
}

void SessionPipeline::Carve(const SessionEvent& event)
{
  const glm::dvec3 position = GetPosition(event, 1);
  const bool isNew = event.Numbers[0] != 0.0 || !this->IsStroke;
  this->IsStroke = false; // an event that fails ends the stroke, too
  if (!(event.Numbers[4] > 0.0))
  {
    throw std::runtime_error(
      "The carving radius is " + FormatShort(event.Numbers[4]) + ". Set a radius greater than 0.");
  }
  if (isNew)
  {
    this->CarveFilter->ClearToolPositions();
  }
  if (this->Model != Session::NONE)
  {
    this->CarveFilter->SetDeformationData(this->GetDeformation());
  }
  this->CarveFilter->SetToolRadius(event.Numbers[4]);
  this->CarveFilter->AddToolPosition(position.x, position.y, position.z);
  try
  {
    this->Update(this->CarveFilter);
  }
  catch (...)
  {
    this->CarveFilter->ClearToolPositions();
    this->CarveFilter->SetDeformationData(nullptr);
    throw;
  }
  this->CarveFilter->SetDeformationData(nullptr);
  if (isNew)
  {
    Action carving;
    carving.Kind = Action::CARVE;
    this->AddActionWithState(carving);
  }
  else
  {
    ++this->Done.back().NumberOfEdits;
  }
  this->IsStroke = true;
}

SessionPipeline::Actions SessionPipeline::GetHeld() const
{
  Actions held;
  for (const Action& action : this->Done)
  {
    if (action.Kind == Action::DRAG && action.IsHeld)
    {
      held.push_back(action);
    }
    else if (action.Kind == Action::RELEASE)
    {
      held.erase(std::remove_if(held.begin(), held.end(),
                   [&](const Action& one) { return one.Handle == action.Handle; }),
        held.end());
    }
  }
  return held;
}

std::vector<SessionPipeline::Handle> SessionPipeline::GetHandles() const
{
  std::vector<Handle> handles;
  for (const Action& action : this->GetHeld())
  {
    handles.push_back(
      { static_cast<int>(action.Handle), action.Rest, action.Now, action.IsGrabbed });
  }
  return handles;
}

} // namespace deformvolume
