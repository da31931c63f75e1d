// SPDX-License-Identifier: BSD-3-Clause
// The model of the tissue, and its steps.
#include "SessionPipeline.h"

#include "vtkDeformVolumeSession.h"

#include "vtkCarveVolume.h"
#include "vtkCellType.h"
#include "vtkChainMailDeformation.h"
#include "vtkCutVolume.h"
#include "vtkDeformVolumeFilter.h"
#include "vtkDoubleArray.h"
#include "vtkFiniteElementDeformation.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkLatticeTetrahedraSource.h"
#include "vtkMassSpringDeformation.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTetra.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

using Session = vtkDeformVolumeSession;

namespace
{

// Makes a lattice of cubes over a volume. The first layer of nodes on the last axis is fixed.
vtkSmartPointer<vtkUnstructuredGrid> MakeLattice(vtkImageData* volume, int nodes)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  source->SetInputData(volume);
  source->SetNumberOfNodes(nodes, nodes, nodes);
  source->Update();
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->ShallowCopy(source->GetOutput());
  const int* dimensions = source->GetDimensions();
  const vtkIdType layer = static_cast<vtkIdType>(dimensions[0]) * dimensions[1];
  vtkNew<vtkUnsignedCharArray> fixed;
  fixed->SetName("Fixed");
  fixed->SetNumberOfTuples(mesh->GetNumberOfPoints());
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    fixed->SetValue(id, id < layer ? 1 : 0);
  }
  mesh->GetPointData()->AddArray(fixed);
  return mesh;
}

} // namespace

namespace deformvolume
{

// Makes the mesh of the model NONE, whose displacements are 0.
void SessionPipeline::MakeStill()
{
  this->Still = MakeLattice(this->Volume, 2);
  vtkNew<vtkFloatArray> none;
  none->SetName("Displacement");
  none->SetNumberOfComponents(3);
  none->SetNumberOfTuples(this->Still->GetNumberOfPoints());
  none->Fill(0.0);
  this->Still->GetPointData()->SetVectors(none);
}

void SessionPipeline::TakeRestMesh()
{
  this->IsMeshOfElements = this->Model == Session::FINITE_ELEMENTS;
  // Finite elements add nodes in the middle of edges, so that half of the nodes are sufficient.
  this->RestMesh = this->Mesh
    ? this->Mesh
    : MakeLattice(this->Volume,
        this->IsMeshOfElements ? std::max(2, (this->NumberOfNodes + 1) / 2) : this->NumberOfNodes);
  this->MassSpring->SetInputData(this->RestMesh);
  this->Elements->SetInputData(this->RestMesh);
  for (Actions* actions : { &this->Done, &this->Undone })
  {
    for (Action& action : *actions)
    {
      action.ToNode = this->FindWayToNode(action.Rest);
    }
  }
}

vtkElasticDeformation* SessionPipeline::GetElastic()
{
  switch (this->Model)
  {
    case Session::MASS_SPRING:
      return this->MassSpring;
    case Session::FINITE_ELEMENTS:
      return this->Elements;
    default:
      return nullptr;
  }
}

vtkAlgorithm* SessionPipeline::GetModelFilter()
{
  return this->Model == Session::CHAIN_MAIL ? static_cast<vtkAlgorithm*>(this->ChainMail)
                                            : static_cast<vtkAlgorithm*>(this->GetElastic());
}

vtkDataSet* SessionPipeline::GetDeformation()
{
  vtkAlgorithm* filter = this->GetModelFilter();
  return filter ? vtkDataSet::SafeDownCast(filter->GetOutputDataObject(0)) : this->Still.Get();
}

vtkIdType SessionPipeline::GetNumberOfMovedVoxels()
{
  return this->Model == Session::CHAIN_MAIL ? this->ChainMail->GetNumberOfMovedVoxels() : 0;
}

double SessionPipeline::GetRelativeResidual()
{
  return this->Model == Session::FINITE_ELEMENTS ? this->Elements->GetRelativeResidual() : 0.0;
}

void SessionPipeline::SetModel(int model)
{
  if (model == this->Model)
  {
    return;
  }
  const Actions done = this->Done;
  const Actions undone = this->Undone;
  this->EndGrabs();
  Action change;
  change.Kind = Action::MODEL;
  change.Model = model;
  change.FormerModel = this->Model;
  this->Do(change);
  this->Model = model;
  try
  {
    this->Rebuild();
  }
  catch (...)
  {
    this->Model = change.FormerModel;
    this->RestoreState(this->Done.back().Before);
    this->ForgetStates(this->Done.back());
    this->Done = done;
    this->Undone = undone;
    throw;
  }
}

void SessionPipeline::SetLattice(int nodes)
{
  if (nodes == this->NumberOfNodes)
  {
    return;
  }
  const int former = this->NumberOfNodes;
  this->NumberOfNodes = nodes;
  this->TakeRestMesh();
  try
  {
    if (this->GetElastic())
    {
      this->Rebuild();
    }
  }
  catch (...) // for example, a handle holds no node of this lattice
  {
    this->NumberOfNodes = former;
    this->TakeRestMesh();
    this->Rebuild();
    throw;
  }
}

void SessionPipeline::Connect()
{
  if (this->IsMeshOfElements != (this->Model == Session::FINITE_ELEMENTS))
  {
    this->TakeRestMesh();
  }
  vtkElasticDeformation* elastic = this->GetElastic();
  this->Resampler->SetOpenSplits(elastic != nullptr);
  // With an elastic model, the volume opens where the mesh is split. The mask of the cut filter
  // would add a second gap along the sheet.
  if (elastic)
  {
    this->CarveFilter->SetInputData(this->Volume);
  }
  else
  {
    this->CarveFilter->SetInputConnection(this->CutFilter->GetOutputPort());
  }
  if (vtkAlgorithm* filter = this->GetModelFilter())
  {
    this->Resampler->SetDeformationConnection(filter->GetOutputPort());
  }
  else
  {
    this->Resampler->SetDeformationData(this->Still);
  }
}

void SessionPipeline::Rebuild()
{
  this->IsToRebuild = false;
  this->Connect();
  this->LastVectors.clear();
  this->QuietSteps = 0;
  if (this->Model == Session::CHAIN_MAIL)
  {
    this->ChainMail->Reset();
    this->UpdateModel(this->GetHeld());
  }
  else if (vtkElasticDeformation* elastic = this->GetElastic())
  {
    elastic->Reset();
    elastic->ClearCuts();
    elastic->SetSheetData(nullptr);
    this->UpdateModel({});
    for (Action& action : this->Done)
    {
      if (action.Kind == Action::CUT)
      {
        this->CutMesh(elastic, action.RestSheet, {}, action);
      }
    }
    elastic->Reset();
    this->UpdateModel(this->GetHeld());
  }
  else
  {
    this->Update(this->CarveFilter);
  }
}

bool SessionPipeline::IsUsed(vtkIdType point)
{
  vtkNew<vtkIdList> cells;
  this->RestMesh->GetPointCells(point, cells); // builds the table of cells at points once
  return cells->GetNumberOfIds() > 0;
}

glm::dvec3 SessionPipeline::FindWayToNode(const glm::dvec3& rest)
{
  vtkDataArray* fixed = this->RestMesh->GetPointData()->GetArray("Fixed");
  glm::dvec3 nearest(0.0); // if no node can move
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](const glm::dvec3& position)
  {
    const glm::dvec3 way = position - rest;
    const double square = glm::dot(way, way);
    if (square < least)
    {
      least = square;
      nearest = way;
    }
  };
  const auto getPosition = [&](vtkIdType id)
  {
    glm::dvec3 position;
    this->RestMesh->GetPoint(id, &position.x);
    return position;
  };
  const auto isFixed = [&](vtkIdType id) { return fixed && fixed->GetComponent(id, 0) != 0.0; };
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < this->RestMesh->GetNumberOfCells(); ++cell)
  {
    const int type = this->RestMesh->GetCellType(cell);
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA)
    {
      continue;
    }
    this->RestMesh->GetCellPoints(cell, ids);
    glm::dvec3 corners[4];
    bool isHeld = true;
    for (int i = 0; i < 4; ++i)
    {
      corners[i] = getPosition(ids->GetId(i));
      isHeld = isHeld && isFixed(ids->GetId(i));
    }
    double weights[4];
    glm::dvec3 position = rest; // VTK 9.1 takes no constants
    if (!isHeld &&
      vtkTetra::BarycentricCoords(
        &position.x, &corners[0].x, &corners[1].x, &corners[2].x, &corners[3].x, weights) != 0 &&
      *std::min_element(weights, weights + 4) >= 0.0)
    {
      return glm::dvec3(0.0);
    }
  }
  for (vtkIdType id = 0; id < this->RestMesh->GetNumberOfPoints(); ++id)
  {
    // Points without cells are not nodes.
    if (!isFixed(id) && this->IsUsed(id))
    {
      take(getPosition(id));
    }
  }
  // The mid-side nodes that finite elements add.
  for (vtkIdType cell = 0; this->IsMeshOfElements && cell < this->RestMesh->GetNumberOfCells();
       ++cell)
  {
    this->RestMesh->GetCellPoints(cell, ids);
    const vtkIdType corners = this->RestMesh->GetCellType(cell) == VTK_TETRA ? 4 : 0;
    for (vtkIdType i = 0; i < corners; ++i)
    {
      for (vtkIdType k = 0; k < i; ++k)
      {
        if (!(isFixed(ids->GetId(i)) && isFixed(ids->GetId(k))))
        {
          take(0.5 * (getPosition(ids->GetId(i)) + getPosition(ids->GetId(k))));
        }
      }
    }
  }
  return nearest;
}

// The vector by which a handle is moved to the nearest node that can move, if no such node lies
// within the handle radius, and no tetrahedron with such a node contains the handle.
glm::dvec3 SessionPipeline::GetShift(const Action& drag)
{
  return this->GetElastic() && glm::length(drag.ToNode) > this->HandleRadius ? drag.ToNode
                                                                             : glm::dvec3(0.0);
}

void SessionPipeline::UpdateModel(const Actions& held)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  for (const Action& action : held)
  {
    const glm::dvec3 shift = this->GetShift(action);
    points->InsertNextPoint(action.Now.x + shift.x, action.Now.y + shift.y, action.Now.z + shift.z);
    rest->InsertNextTuple3(
      action.Rest.x + shift.x, action.Rest.y + shift.y, action.Rest.z + shift.z);
  }
  vtkNew<vtkPolyData> handles;
  handles->SetPoints(points);
  handles->GetPointData()->AddArray(rest);
  if (this->Model == Session::CHAIN_MAIL)
  {
    this->ChainMail->SetHandleRadius(this->HandleRadius);
    this->ChainMail->SetRelaxationSweeps(this->RelaxationSweeps);
    this->ChainMail->SetHandlesData(handles);
    this->ChainMail->Modified();
    this->Update(this->ChainMail);
  }
  else if (vtkElasticDeformation* elastic = this->GetElastic())
  {
    // With a radius of 0 the filter would hold the nearest node, so that the tissue at the handle
    // would lag behind.
    elastic->SetHandleRadius(std::max(this->HandleRadius, std::numeric_limits<double>::min()));
    elastic->SetHandlesData(handles);
    elastic->Modified();
    this->Update(elastic);
  }
}

// Restores a possible state after a step has failed.
void SessionPipeline::StepBack()
{
  for (Action& action : this->Done)
  {
    action.Now = action.LastPossible;
  }
  try
  {
    this->UpdateModel(this->GetHeld());
    return;
  }
  catch (const std::runtime_error&)
  {
    // A body that moves too fast does not recover. It is rebuilt from rest.
  }
  try
  {
    this->Rebuild();
  }
  catch (const std::runtime_error&)
  {
    // The positions of the handles are not possible even from rest: release all handles.
    for (Action& action : this->Done)
    {
      action.IsGrabbed = action.IsHeld = false;
    }
    this->Rebuild();
  }
}

bool SessionPipeline::Step()
{
  if (this->IsToRebuild)
  {
    this->Rebuild();
  }
  if (this->Model == Session::NONE)
  {
    return false;
  }
  try
  {
    this->UpdateModel(this->GetHeld());
  }
  catch (...)
  {
    this->StepBack();
    throw;
  }
  for (Action& action : this->Done)
  {
    action.LastPossible = action.Now;
  }
  return this->FindMotion();
}

// Returns whether the body still moves. A body with inertia stops for a moment when it changes its
// direction. With MASS_SPRING, the body is therefore at rest only after several steps without
// motion.
bool SessionPipeline::FindMotion()
{
  if (this->Model == Session::CHAIN_MAIL)
  {
    const int* changed = this->ChainMail->GetChangedExtent();
    return changed[0] <= changed[1];
  }
  vtkDataArray* vectors = this->GetDeformation()->GetPointData()->GetVectors();
  std::vector<double> now(static_cast<std::size_t>(vectors->GetNumberOfValues()));
  for (vtkIdType id = 0; id < vectors->GetNumberOfTuples(); ++id)
  {
    vectors->GetTuple(id, &now[3 * static_cast<std::size_t>(id)]);
  }
  const double* spacing = this->Volume->GetSpacing();
  const double most = 1e-3 * std::min({ spacing[0], spacing[1], spacing[2] });
  const bool isQuiet = now.size() == this->LastVectors.size() &&
    std::equal(now.begin(), now.end(), this->LastVectors.begin(),
      [=](double one, double other) { return std::abs(one - other) <= most; });
  this->LastVectors = now;
  this->QuietSteps = isQuiet ? this->QuietSteps + 1 : 0;
  return this->QuietSteps < (this->Model == Session::MASS_SPRING ? 10 : 1);
}

vtkImageData* SessionPipeline::Resample(const Sampling& sampling)
{
  this->Resampler->SetSamplingFactor(sampling.Factor);
  this->Resampler->SetPadding(sampling.Padding);
  this->Resampler->SetBackgroundValue(sampling.BackgroundValue);
  this->Update(this->Resampler);
  this->CheckHandles();
  return this->Resampler->GetOutput();
}

void SessionPipeline::CheckHandles()
{
  if (this->Model == Session::NONE || this->HasWarnedOfPadding)
  {
    return;
  }
  vtkImageData* output = this->Resampler->GetOutput();
  const int* extent = output->GetExtent();
  for (const Handle& handle : this->GetHandles())
  {
    double index[3];
    output->TransformPhysicalPointToContinuousIndex(&handle.Now.x, index);
    for (int axis = 0; axis < 3; ++axis)
    {
      if (index[axis] < extent[2 * axis] - 0.5 || index[axis] > extent[2 * axis + 1] + 0.5)
      {
        this->HasWarnedOfPadding = true;
        this->Warnings.emplace_back("Handle " + std::to_string(handle.Number) +
          " lies outside the output, where tissue is cut off. Set a larger Padding.");
        return;
      }
    }
  }
}

} // namespace deformvolume
