// SPDX-License-Identifier: BSD-3-Clause
#include "StyleActions.h"

#include <algorithm>

namespace deformvolume
{

void StyleActions::Do(Action::KindType kind, int handle)
{
  Action action;
  action.Kind = kind;
  action.Handle = handle;
  this->Done.push_back(action);
  this->Undone.clear();
}

void StyleActions::BeginDrag(int handle, const glm::dvec3& place)
{
  this->Do(Action::DRAG, handle);
  this->Handles[handle].Place = place;
}

void StyleActions::MoveDrag(int handle, const glm::dvec3& place)
{
  this->Handles[handle].Place = place;
}

void StyleActions::EndDrag(int handle, bool isHeld)
{
  this->Handles[handle].IsHeld = isHeld;
}

void StyleActions::Release(int handle)
{
  this->Do(Action::RELEASE, handle);
}

void StyleActions::DoOther()
{
  this->Do(Action::OTHER, -1);
}

void StyleActions::Undo()
{
  if (!this->Done.empty())
  {
    this->Undone.push_back(this->Done.back());
    this->Done.pop_back();
  }
}

void StyleActions::Redo()
{
  if (!this->Undone.empty())
  {
    this->Done.push_back(this->Undone.back());
    this->Undone.pop_back();
  }
}

void StyleActions::Reset()
{
  while (!this->Done.empty())
  {
    this->Undo();
  }
}

void StyleActions::Clear()
{
  this->Handles.clear();
  this->Done.clear();
  this->Undone.clear();
}

void StyleActions::Compare(std::size_t done, std::size_t undone)
{
  this->Done.resize(done);
  this->Undone.resize(undone);
}

std::vector<StyleActions::Handle> StyleActions::GetHeld() const
{
  std::vector<Handle> held;
  for (const Action& action : this->Done)
  {
    if (action.Kind == Action::DRAG)
    {
      const State& state = this->Handles.at(action.Handle);
      if (state.IsHeld)
      {
        held.push_back({ action.Handle, state.Place });
      }
    }
    else if (action.Kind == Action::RELEASE)
    {
      held.erase(std::remove_if(held.begin(), held.end(),
                   [&](const Handle& one) { return one.Number == action.Handle; }),
        held.end());
    }
  }
  return held;
}

} // namespace deformvolume
