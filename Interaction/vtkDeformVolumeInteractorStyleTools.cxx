// SPDX-License-Identifier: BSD-3-Clause
// The tools.
#include "vtkDeformVolumeInteractorStyleInternals.h"

#include "StyleText.h"
#include "VoxelSize.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using deformvolume::DisplayToWorld;
using deformvolume::FormatShort;
using deformvolume::GetLineOfSight;
using deformvolume::WorldToDisplay;
using Session = vtkDeformVolumeSession;

namespace
{

constexpr int PixelsOfStroke = 4;  // between the points of a stroke
constexpr int PixelsOfHandle = 20; // from the cursor to a handle

// Makes a strip of triangles between two rows of points.
vtkSmartPointer<vtkPolyData> MakeStrip(
  const std::vector<glm::dvec3>& upper, const std::vector<glm::dvec3>& lower)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> triangles;
  for (std::size_t i = 0; i < upper.size(); ++i)
  {
    points->InsertNextPoint(&upper[i].x);
    points->InsertNextPoint(&lower[i].x);
    if (i > 0)
    {
      const vtkIdType last = 2 * static_cast<vtkIdType>(i);
      const vtkIdType first[3] = { last - 2, last - 1, last };
      const vtkIdType second[3] = { last - 1, last + 1, last };
      triangles->InsertNextCell(3, first);
      triangles->InsertNextCell(3, second);
    }
  }
  auto strip = vtkSmartPointer<vtkPolyData>::New();
  strip->SetPoints(points);
  strip->SetPolys(triangles);
  return strip;
}

} // namespace

void vtkDeformVolumeInteractorStyle::BeginTool()
{
  vtkInternals& internals = *this->Internals;
  const int x = this->Interactor->GetEventPosition()[0];
  const int y = this->Interactor->GetEventPosition()[1];
  internals.CancelPress(); // the release of the last press may have been lost
  this->ShowMessage("");
  if (!internals.Output)
  {
    this->ShowMessage("There is no volume yet. Wait until it is shown.");
    return;
  }
  if (this->Tool == CUT) // a stroke may begin beside the body
  {
    internals.IsPressed = true;
    internals.Stroke.push_back({ { x, y } });
    return;
  }
  glm::dvec3 worldPosition(0.0);
  if (!this->FindPosition(x, y, &worldPosition.x))
  {
    this->ShowMessage("There is nothing here. Press on the body.");
    return;
  }
  switch (this->Tool)
  {
    case GRAB:
      internals.Handle =
        internals.Session->BeginGrab(worldPosition.x, worldPosition.y, worldPosition.z);
      if (internals.Handle >= 0)
      {
        internals.IsPressed = true;
        internals.GrabbedPosition = worldPosition;
        internals.Cursor = { { x, y } };
        if (internals.GetModel() == Session::NONE)
        {
          this->ShowMessage("Without a model, no tissue follows. Press 2, 3 or 4 to choose one.");
        }
      }
      break;
    case CARVE:
      internals.IsPressed = true;
      internals.CarvedImage = internals.Output;
      internals.CarvePosition = worldPosition;
      internals.Session->CarveSphere(
        worldPosition.x, worldPosition.y, worldPosition.z, this->GetEffectiveCarveRadius());
      break;
    case PROBE:
      this->ProbeAt(x, y);
      break;
    default:
      this->MeasureAt(x, y);
  }
}

void vtkDeformVolumeInteractorStyle::MoveTool()
{
  vtkInternals& internals = *this->Internals;
  const int x = this->Interactor->GetEventPosition()[0];
  const int y = this->Interactor->GetEventPosition()[1];
  switch (this->Tool)
  {
    case GRAB:
      this->DragTo(x, y);
      break;
    case CUT:
    {
      const auto& last = internals.Stroke.back();
      if (std::abs(x - last[0]) + std::abs(y - last[1]) >= PixelsOfStroke)
      {
        internals.Stroke.push_back({ { x, y } });
      }
      break;
    }
    default:
      this->CarveAt(x, y, false);
  }
  internals.IsChanged = true;
}

void vtkDeformVolumeInteractorStyle::DragTo(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  // The handle is at the point of its voxel, not exactly under the cursor: move it by as much as
  // the cursor has moved.
  const double depth = WorldToDisplay(this->CurrentRenderer, internals.GrabbedPosition).z;
  internals.GrabbedPosition += DisplayToWorld(this->CurrentRenderer, x, y, depth) -
    DisplayToWorld(this->CurrentRenderer, internals.Cursor[0], internals.Cursor[1], depth);
  internals.Cursor = { { x, y } };
  internals.Session->MoveGrab(internals.Handle, internals.GrabbedPosition.x,
    internals.GrabbedPosition.y, internals.GrabbedPosition.z);
}

// Skips positions near the last one, because each event of a carving processes the whole sphere.
void vtkDeformVolumeInteractorStyle::CarveAt(int x, int y, bool isLast)
{
  vtkInternals& internals = *this->Internals;
  // Use the output before the stroke: otherwise the sphere would sink into the hole that it makes.
  const vtkIdType voxel =
    internals.FindVoxel(this, internals.CarvedImage, GetLineOfSight(this->CurrentRenderer, x, y));
  if (voxel < 0)
  {
    return;
  }
  glm::dvec3 worldPosition(0.0);
  internals.CarvedImage->GetPoint(voxel, &worldPosition.x);
  const double way = glm::length(worldPosition - internals.CarvePosition);
  if (way >= 0.25 * this->GetEffectiveCarveRadius() || (isLast && way > 0.0))
  {
    internals.CarvePosition = worldPosition;
    internals.Session->CarveTo(
      worldPosition.x, worldPosition.y, worldPosition.z, this->GetEffectiveCarveRadius());
  }
}

void vtkDeformVolumeInteractorStyle::EndTool(bool keepHandle)
{
  vtkInternals& internals = *this->Internals;
  if (!internals.IsPressed)
  {
    return;
  }
  if (this->Tool == GRAB)
  {
    const int handle = internals.Handle;
    internals.EndPress();
    if (keepHandle)
    {
      internals.Session->HoldGrab(handle);
    }
    else
    {
      internals.Session->EndGrab(handle);
    }
    return;
  }
  if (this->Tool == CUT)
  {
    this->FinishCut();
  }
  else if (this->Tool == CARVE)
  {
    const int* position = this->Interactor->GetEventPosition();
    this->CarveAt(position[0], position[1], true);
  }
  internals.EndPress();
}

void vtkDeformVolumeInteractorStyle::FinishCut()
{
  vtkInternals& internals = *this->Internals;
  const std::size_t count = internals.Stroke.size();
  std::vector<glm::dvec3> positions(count, glm::dvec3(0.0));
  std::vector<bool> isFound(count, false);
  for (std::size_t i = 0; i < count; ++i)
  {
    isFound[i] =
      this->FindPosition(internals.Stroke[i][0], internals.Stroke[i][1], &positions[i].x);
  }
  if (count < 2)
  {
    this->ShowMessage("The stroke is too short. Draw it over the body.");
    return;
  }
  if (std::find(isFound.begin(), isFound.end(), true) == isFound.end())
  {
    this->ShowMessage("The stroke misses the body. Draw it over the body.");
    return;
  }
  // Points of the stroke beside the body get the depth of the nearest point on the body.
  std::vector<glm::dvec3> upper;
  std::vector<glm::dvec3> lower;
  const double above = 2.0 * deformvolume::GetLargestVoxelSize(internals.Output);
  for (std::size_t i = 0; i < count; ++i)
  {
    std::size_t way = 0;
    const auto isThere = [&](std::size_t at) { return at < count && isFound[at]; };
    while (!isThere(i + way) && !isThere(i - way)) // i - way wraps around below 0
    {
      ++way;
    }
    const glm::dvec3 nearest = positions[isThere(i + way) ? i + way : i - way];
    const double x = internals.Stroke[i][0];
    const double y = internals.Stroke[i][1];
    const double depth = WorldToDisplay(this->CurrentRenderer, nearest).z;
    const glm::dvec3 worldPosition = DisplayToWorld(this->CurrentRenderer, x, y, depth);
    const glm::dvec3 away = glm::normalize(DisplayToWorld(this->CurrentRenderer, x, y, 1.0) -
      DisplayToWorld(this->CurrentRenderer, x, y, 0.0));
    upper.push_back(worldPosition - above * away);
    lower.push_back(worldPosition + this->GetEffectiveCutDepth() * away);
  }
  internals.Session->Cut(MakeStrip(upper, lower));
}

// Does not call Probe() of a busy session, because it would wait for the end of a step.
void vtkDeformVolumeInteractorStyle::ProbeAt(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  double worldPosition[3];
  if (!this->FindPosition(x, y, worldPosition))
  {
    this->ShowMessage("There is nothing here.");
    return;
  }
  if (internals.Session->GetIsBusy())
  {
    vtkImageData* output = internals.Output;
    vtkDataArray* scalars = output->GetPointData()->GetScalars();
    const vtkIdType voxel = output->FindPoint(worldPosition);
    this->ShowMessage("value " + FormatShort(scalars ? scalars->GetComponent(voxel, 0) : 0.0) +
      " at " + FormatShort(worldPosition) + ", moving");
  }
  else if (internals.Session->Probe(worldPosition[0], worldPosition[1], worldPosition[2]))
  {
    this->ShowMessage("value " + FormatShort(internals.Session->GetProbedValue()) + " at " +
      FormatShort(worldPosition) + ", at rest " +
      FormatShort(internals.Session->GetProbedRestPosition()));
  }
}

void vtkDeformVolumeInteractorStyle::MeasureAt(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  glm::dvec3 worldPosition(0.0);
  this->FindPosition(x, y, &worldPosition.x);
  if (internals.MeasuredPositions.size() > 1)
  {
    internals.MeasuredPositions.clear();
  }
  internals.MeasuredPositions.push_back(worldPosition);
  if (internals.MeasuredPositions.size() == 1)
  {
    this->ShowMessage("Click the second point.");
    return;
  }
  this->MeasuredDistance =
    glm::length(internals.MeasuredPositions[1] - internals.MeasuredPositions[0]);
  this->ShowMessage("distance " + FormatShort(this->MeasuredDistance));
}

void vtkDeformVolumeInteractorStyle::PinAt(int x, int y)
{
  vtkInternals& internals = *this->Internals;
  glm::dvec3 worldPosition(0.0);
  if (!this->FindPosition(x, y, &worldPosition.x))
  {
    this->ShowMessage("There is nothing here. Move the cursor to the body to pin it.");
    return;
  }
  internals.Session->Pin(worldPosition.x, worldPosition.y, worldPosition.z);
}

void vtkDeformVolumeInteractorStyle::ReleaseAt(int x, int y)
{
  if (!this->SelectRenderer())
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  int nearest = -1;
  double least = PixelsOfHandle;
  for (const auto& handle : internals.GetHandles())
  {
    const glm::dvec3 at = WorldToDisplay(this->CurrentRenderer, handle.second);
    const double distance = std::hypot(at.x - x, at.y - y);
    if (handle.first != internals.Handle && distance <= least)
    {
      least = distance;
      nearest = handle.first;
    }
  }
  if (nearest < 0)
  {
    this->ShowMessage("There is no handle under the cursor. Move it to a green point.");
    return;
  }
  internals.Session->Release(nearest);
}
