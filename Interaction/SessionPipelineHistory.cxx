// SPDX-License-Identifier: BSD-3-Clause
// Undo and redo.
#include "SessionPipeline.h"

#include "vtkDeformVolumeSession.h"

#include "vtkCarveVolume.h"
#include "vtkChainMailDeformation.h"
#include "vtkCutVolume.h"
#include "vtkElasticDeformation.h"
#include "vtkImageData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <utility>

using Session = vtkDeformVolumeSession;

namespace deformvolume
{

// Saves the state of the model: must be called before the action changes it.
void SessionPipeline::AddActionWithState(Action action)
{
  action.Before = this->SaveState();
  this->AddAction(std::move(action));
}

// Adds an action that cannot fail any more: the undone actions are lost.
void SessionPipeline::AddAction(Action action)
{
  for (Action& undone : this->Undone)
  {
    this->ForgetStates(undone);
  }
  this->Undone.clear();
  this->Done.push_back(std::move(action));
  this->LimitStates();
}

vtkIdType SessionPipeline::SaveState()
{
  return this->Model == Session::CHAIN_MAIL && !this->NeedsRebuild ? this->ChainMail->SaveState()
                                                                   : -1;
}

// Restores the positions of all voxels. Without a saved state, the body is rebuilt from rest with
// the current handles.
void SessionPipeline::RestoreState(vtkIdType state)
{
  this->Connect();
  this->NeedsRebuild = this->Model != Session::CHAIN_MAIL || !this->ChainMail->RestoreState(state);
}

void SessionPipeline::ForgetStates(Action& action)
{
  for (vtkIdType* state : { &action.Before, &action.After })
  {
    this->ChainMail->RemoveState(*state);
    *state = -1;
  }
}

// Removes saved states while they need more than UndoMemory. Begins with the states that need the
// most undo or redo steps to return to.
void SessionPipeline::LimitStates()
{
  for (Actions* actions : { &this->Done, &this->Undone })
  {
    for (auto action = actions->begin(); action != actions->end() &&
         static_cast<double>(this->ChainMail->GetStateMemory()) > this->UndoMemory;
         ++action)
    {
      this->ForgetStates(*action);
    }
  }
}

void SessionPipeline::EndGrabs()
{
  for (Action& action : this->Done)
  {
    if (action.IsGrabbed)
    {
      action.IsGrabbed = action.IsHeld = false;
    }
  }
}

void SessionPipeline::Undo()
{
  if (this->Done.empty())
  {
    return;
  }
  Action action = this->Done.back();
  this->Done.pop_back();
  action.After = action.After < 0 ? this->SaveState() : action.After;
  this->Undone.push_back(action);
  this->LimitStates();
  vtkElasticDeformation* elastic = this->GetElastic();
  switch (action.Kind)
  {
    case Action::CUT:
      this->CutFilter->Undo();
      this->Update(this->CutFilter);
      if (elastic && action.HasSplit && !this->NeedsRebuild)
      {
        const Actions held = this->GetHeld();
        // After a rebuild, handles may hold nodes that this cut has made.
        this->NeedsRebuild = std::any_of(held.begin(), held.end(),
          [&](const Action& drag)
          {
            return std::any_of(drag.Nodes.begin(), drag.Nodes.end(),
              [&](const NodeOfHandle& node) { return node.Id >= action.NodesBeforeCut; });
          });
        if (!this->NeedsRebuild)
        {
          elastic->UndoCut();
          this->NeedsRebuild = true; // if the update fails
          this->UpdateModel(held);
          this->NeedsRebuild = false;
        }
      }
      break;
    case Action::CARVE:
      this->CarveFilter->ClearToolPositions();
      for (int edit = 0; edit < action.NumberOfEdits; ++edit)
      {
        this->CarveFilter->Undo();
      }
      this->Update(this->CarveFilter);
      break;
    case Action::MODEL:
      this->Model = action.FormerModel;
      this->RestoreState(action.Before);
      return;
    default:
      break;
  }
  // Meshes move by themselves to where the remaining handles hold them.
  if (!elastic)
  {
    this->RestoreState(action.Before);
  }
}

void SessionPipeline::Redo()
{
  if (this->Undone.empty())
  {
    return;
  }
  const Action action = this->Undone.back();
  this->Undone.pop_back();
  this->Done.push_back(action);
  switch (action.Kind)
  {
    case Action::CUT:
      this->CutFilter->Redo();
      this->Update(this->CutFilter);
      break;
    case Action::CARVE:
      for (int edit = 0; edit < action.NumberOfEdits; ++edit)
      {
        this->CarveFilter->Redo();
      }
      this->Update(this->CarveFilter);
      break;
    case Action::MODEL:
      this->Model = action.Model;
      break;
    default:
      break;
  }
  // A cut that is redone splits the mesh at rest, so that the body must be rebuilt.
  if (!this->GetElastic() || action.Kind == Action::CUT || action.Kind == Action::MODEL)
  {
    this->RestoreState(action.After);
  }
}

void SessionPipeline::Reset()
{
  this->EndGrabs();
  while (!this->Done.empty())
  {
    this->Undo();
  }
}

} // namespace deformvolume
