// SPDX-License-Identifier: BSD-3-Clause
// The model of the tissue, and its steps.
#include "SessionPipeline.h"

#include "VoxelSize.h"
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
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkLatticeTetrahedraSource.h"
#include "vtkMassSpringDeformation.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTetra.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
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
void SessionPipeline::MakeUndeformedMesh()
{
  this->UndeformedMesh = MakeLattice(this->Volume, 2);
  vtkNew<vtkFloatArray> none;
  none->SetName("Displacement");
  none->SetNumberOfComponents(3);
  none->SetNumberOfTuples(this->UndeformedMesh->GetNumberOfPoints());
  none->Fill(0.0);
  this->UndeformedMesh->GetPointData()->SetVectors(none);
}

void SessionPipeline::MakeRestMesh()
{
  this->IsMeshOfElements = this->Model == Session::FINITE_ELEMENTS;
  // Finite elements add nodes in the middle of edges, so that half of the nodes are sufficient.
  this->RestMesh = this->Mesh
    ? this->Mesh
    : MakeLattice(this->Volume,
        this->IsMeshOfElements ? std::max(2, (this->NodesPerAxis + 1) / 2) : this->NodesPerAxis);
  this->MassSpring->SetInputData(this->RestMesh);
  this->Elements->SetInputData(this->RestMesh);
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
  return filter ? vtkDataSet::SafeDownCast(filter->GetOutputDataObject(0))
                : this->UndeformedMesh.Get();
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
  change.Before = this->SaveState();
  this->Model = model;
  try
  {
    this->Rebuild();
  }
  catch (...)
  {
    this->Model = change.FormerModel;
    this->RestoreState(change.Before);
    this->ForgetStates(change);
    this->Done = done;
    this->Undone = undone;
    throw;
  }
  this->AddAction(change);
}

void SessionPipeline::SetLattice(int nodes)
{
  if (nodes == this->NodesPerAxis)
  {
    return;
  }
  const int former = this->NodesPerAxis;
  this->NodesPerAxis = nodes;
  this->MakeRestMesh();
  try
  {
    if (this->GetElastic())
    {
      this->Rebuild();
    }
  }
  catch (...) // for example, a handle holds no node of this lattice
  {
    this->NodesPerAxis = former;
    this->MakeRestMesh();
    this->Rebuild();
    throw;
  }
}

void SessionPipeline::Connect()
{
  if (this->IsMeshOfElements != (this->Model == Session::FINITE_ELEMENTS))
  {
    this->MakeRestMesh();
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
    this->Resampler->SetDeformationData(this->UndeformedMesh);
  }
}

void SessionPipeline::Rebuild()
{
  this->NeedsRebuild = false;
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
    for (Actions* actions : { &this->Done, &this->Undone })
    {
      for (Action& action : *actions)
      {
        action.Nodes = action.Kind == Action::DRAG && action.IsHeld ? this->FindNodes(action.Rest)
                                                                    : std::vector<NodeOfHandle>();
      }
    }
    this->UpdateModel(this->GetHeld());
  }
  else
  {
    this->Update(this->CarveFilter);
  }
}

std::vector<SessionPipeline::NodeOfHandle> SessionPipeline::FindNodes(const glm::dvec3& rest)
{
  auto* mesh = vtkUnstructuredGrid::SafeDownCast(this->GetDeformation());
  vtkDataArray* fixed = mesh->GetPointData()->GetArray("Fixed");
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  const auto getPosition = [&](vtkIdType id)
  {
    glm::dvec3 position;
    mesh->GetPoint(id, &position.x);
    return position;
  };
  std::vector<bool> canMove(static_cast<std::size_t>(mesh->GetNumberOfPoints()));
  std::vector<vtkIdType> ofCell;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    const int type = mesh->GetCellType(cell);
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA)
    {
      continue;
    }
    mesh->GetCellPoints(cell, ids);
    glm::dvec3 corners[4];
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
    {
      const vtkIdType id = ids->GetId(i);
      canMove[static_cast<std::size_t>(id)] = !fixed || fixed->GetComponent(id, 0) == 0.0;
      if (i < 4)
      {
        corners[i] = getPosition(id);
      }
    }
    // Positions on the surface, such as those at the border of the volume, are subject to rounding.
    constexpr double tolerance = 1e-6;
    double weights[4];
    glm::dvec3 position = rest; // VTK 9.1 takes no constants
    if (ofCell.empty() &&
      vtkTetra::BarycentricCoords(
        &position.x, &corners[0].x, &corners[1].x, &corners[2].x, &corners[3].x, weights) != 0 &&
      *std::min_element(weights, weights + 4) >= -tolerance)
    {
      std::copy_if(ids->begin(), ids->end(), std::back_inserter(ofCell),
        [&](vtkIdType id) { return canMove[static_cast<std::size_t>(id)]; });
    }
  }
  std::vector<vtkIdType> found;
  vtkIdType nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    const double distance = glm::distance(getPosition(id), rest);
    if (canMove[static_cast<std::size_t>(id)])
    {
      nearest = distance < least ? id : nearest;
      least = std::min(least, distance);
      if (distance <= this->HandleRadius)
      {
        found.push_back(id);
      }
    }
  }
  if (found.empty())
  {
    found = ofCell;
  }
  if (found.empty() && nearest >= 0)
  {
    found.push_back(nearest);
  }
  const glm::dvec3 handle = this->Positions.FindDeformedPosition(mesh, rest);
  std::vector<NodeOfHandle> nodes;
  for (const vtkIdType id : found)
  {
    glm::dvec3 displacement;
    vectors->GetTuple(id, &displacement.x);
    nodes.push_back({ id, getPosition(id), getPosition(id) + displacement - handle });
  }
  return nodes;
}

void SessionPipeline::UpdateModel(const Actions& held)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  vtkNew<vtkIdTypeArray> nodes;
  nodes->SetName("HeldNode");
  const auto insert = [&](const glm::dvec3& now, const glm::dvec3& at, vtkIdType node)
  {
    points->InsertNextPoint(&now.x);
    rest->InsertNextTuple(&at.x);
    nodes->InsertNextValue(node);
  };
  for (const Action& action : held)
  {
    if (!this->GetElastic())
    {
      insert(action.Now, action.Rest, -1);
      continue;
    }
    for (const NodeOfHandle& node : action.Nodes)
    {
      insert(action.Now + node.Offset, node.Rest, node.Id);
    }
  }
  vtkNew<vtkPolyData> handles;
  handles->SetPoints(points);
  handles->GetPointData()->AddArray(rest);
  handles->GetPointData()->AddArray(nodes);
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
    elastic->SetHandlesData(handles);
    elastic->Modified();
    this->Update(elastic);
    this->CheckDisplacements();
  }
}

// Throws if the resampler would refuse the displacements of the mesh. The simulation does not
// recover from such displacements either, so that the body must be rebuilt.
void SessionPipeline::CheckDisplacements()
{
  constexpr double largest = 16383.0; // voxels; the limit of vtkDeformVolumeFilter
  vtkDataArray* vectors = this->GetDeformation()->GetPointData()->GetVectors();
  for (vtkIdType id = 0; id < vectors->GetNumberOfTuples(); ++id)
  {
    double vector[4] = { 0.0, 0.0, 0.0, 0.0 };
    vectors->GetTuple(id, vector);
    this->Volume->GetPhysicalToIndexMatrix()->MultiplyPoint(vector, vector);
    // False for not-a-number, too.
    if (!std::all_of(vector, vector + 3, [](double part) { return std::abs(part) <= largest; }))
    {
      this->NeedsRebuild = true;
      throw std::runtime_error("The deformation moves node " + std::to_string(id) +
        " of the mesh by more than 16,383 voxels. Move the handles less far.");
    }
  }
}

// Restores a possible state after a step has failed.
void SessionPipeline::RestoreLastPossible()
{
  for (Action& action : this->Done)
  {
    action.Now = action.LastPossible;
  }
  try
  {
    if (!this->NeedsRebuild)
    {
      this->UpdateModel(this->GetHeld());
      return;
    }
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
  if (this->NeedsRebuild)
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
    this->RestoreLastPossible();
    throw;
  }
  for (Action& action : this->Done)
  {
    action.LastPossible = action.Now;
  }
  return this->UpdateMotion();
}

// Returns whether the body still moves. A body with inertia stops for a moment when it changes its
// direction. With MASS_SPRING, the body is therefore at rest only after several steps without
// motion.
bool SessionPipeline::UpdateMotion()
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
  const double most = 1e-3 * GetSmallestVoxelSize(this->Volume);
  const bool isQuiet = now.size() == this->LastVectors.size() &&
    std::equal(now.begin(), now.end(), this->LastVectors.begin(),
      [=](double one, double other) { return std::abs(one - other) <= most; });
  this->LastVectors = now;
  this->QuietSteps = isQuiet ? this->QuietSteps + 1 : 0;
  return this->QuietSteps < (this->Model == Session::MASS_SPRING ? 10 : 1);
}

vtkImageData* SessionPipeline::Resample(const Sampling& sampling, bool hasRestPositions)
{
  int factor = sampling.Factor;
  const int* dimensions = this->Volume->GetDimensions();
  // On each axis, at least two voxels of the coarse volume remain, whatever the first index is.
  while (factor > 1 && *std::min_element(dimensions, dimensions + 3) < 2 * factor)
  {
    factor /= 2;
  }
  this->Resampler->SetSamplingFactor(factor);
  if (this->CategoricalArrays != sampling.CategoricalArrays)
  {
    this->CategoricalArrays = sampling.CategoricalArrays;
    this->Resampler->ClearCategoricalArrays();
    for (const std::string& name : this->CategoricalArrays)
    {
      this->Resampler->AddCategoricalArray(name.c_str());
    }
  }
  this->Resampler->SetPadding(sampling.Padding);
  this->Resampler->SetBackgroundValue(sampling.BackgroundValue);
  this->Resampler->SetGenerateRestPositions(hasRestPositions);
  this->Update(this->Resampler);
  return this->Resampler->GetOutput();
}

vtkImageData* SessionPipeline::Resample(const Sampling& sampling)
{
  vtkImageData* output = this->Resample(sampling, false);
  this->CheckHandles();
  return output;
}

// Not in each step, because rest positions take longer than the voxels.
vtkImageData* SessionPipeline::ResampleForSearch(const Sampling& sampling)
{
  return this->Resample(sampling, this->MayOverlap());
}

bool SessionPipeline::MayOverlap() const
{
  // The filter cannot make rest positions of a volume with such arrays.
  for (const char* name : { "RestPosition", "RestPosition x", "RestPosition y", "RestPosition z" })
  {
    if (this->Volume->GetPointData()->HasArray(name))
    {
      return false;
    }
  }
  return this->Model != Session::NONE &&
    std::any_of(this->Done.begin(), this->Done.end(),
      [](const Action& action) { return action.Kind == Action::CUT; });
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
