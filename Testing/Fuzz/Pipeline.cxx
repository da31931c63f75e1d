// SPDX-License-Identifier: BSD-3-Clause
#include "Pipeline.h"

#include "RandomDisplacements.h"
#include "RandomMesh.h"
#include "TetrahedronEdits.h"

#include <vtkCallbackCommand.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>

namespace fuzz
{

namespace
{

std::vector<vtkDataSet*> GetLeaves(vtkDataObject* data)
{
  if (auto* one = vtkDataSet::SafeDownCast(data))
  {
    return { one };
  }
  std::vector<vtkDataSet*> leaves;
  if (auto* composite = vtkCompositeDataSet::SafeDownCast(data))
  {
    const auto next = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
    for (next->InitTraversal(); !next->IsDoneWithTraversal(); next->GoToNextItem())
    {
      if (auto* leaf = vtkUnstructuredGrid::SafeDownCast(next->GetCurrentDataObject()))
      {
        leaves.push_back(leaf);
      }
    }
  }
  return leaves;
}

vtkSmartPointer<vtkDataObject> Copy(vtkDataObject* data)
{
  const auto copy = vtkSmartPointer<vtkDataObject>::Take(data->NewInstance());
  copy->DeepCopy(data);
  return copy;
}

bool IsFinite(vtkDataArray* array)
{
  for (vtkIdType i = 0; array && i < array->GetNumberOfTuples(); ++i)
  {
    for (int component = 0; component < array->GetNumberOfComponents(); ++component)
    {
      if (!(std::abs(array->GetComponent(i, component)) < 1e6))
      {
        return false;
      }
    }
  }
  return array != nullptr;
}

// Moves the points of a mesh by its displacements.
void MovePoints(vtkDataObject* data)
{
  auto* mesh = vtkUnstructuredGrid::SafeDownCast(data);
  vtkDataArray* vectors = mesh ? mesh->GetPointData()->GetArray(DISPLACEMENTS) : nullptr;
  if (!mesh || !mesh->GetPoints() || !IsFinite(vectors) ||
    vectors->GetNumberOfTuples() != mesh->GetNumberOfPoints())
  {
    return;
  }
  for (vtkIdType point = 0; point < mesh->GetNumberOfPoints(); ++point)
  {
    double position[3];
    mesh->GetPoint(point, position);
    for (int axis = 0; axis < 3; ++axis)
    {
      position[axis] += vectors->GetComponent(point, axis);
    }
    mesh->GetPoints()->SetPoint(point, position);
  }
  mesh->GetPoints()->Modified();
}

void AbortLater(vtkObject* caller, unsigned long, void* left, void*)
{
  if (--*static_cast<int*>(left) <= 0)
  {
    static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1);
  }
}

} // namespace

Pipeline::Pipeline(std::uint64_t seed, std::ostream& log)
  : Random(seed)
  , Log(log)
  , IsLive(seed % 8 == 0)
  , Geometry(!IsLive && Random.Chance(0.3) ? fuzz::Geometry::Exact : fuzz::Geometry::Any)
{
  this->Parts->AnnouncesArrays = false;
  this->Times->GetMesh = [this](double time)
  { return this->Steps[static_cast<std::size_t>(time)]; };
  this->Volume = MakeVolume(this->Random, this->Geometry, this->IsLive, log);
  if (this->IsLive)
  {
    // A part of the output can be updated only if its extent stays the same.
    this->Settings.OutputBoundsMode = this->Random.Chance(0.8)
      ? vtkDeformVolumeFilter::VOLUME_BOUNDS
      : vtkDeformVolumeFilter::DEFORMED_BOUNDS;
    this->Settings.Resampler =
      this->Random.Chance(0.9) ? vtkDeformVolumeFilter::EXACT : vtkDeformVolumeFilter::AUTOMATIC;
    this->Settings.OpenSplits = this->Random.Chance(0.4);
    if (this->Random.Chance(0.3))
    {
      this->Settings.OpenSplits = false; // an error with KEEP
      this->Settings.OutsideMode = vtkDeformVolumeFilter::KEEP;
      this->Settings.FadeDistance = this->Volume->GetLength() / 8.0;
    }
  }
  for (int edits = !this->IsLive && this->Random.Chance(0.6) ? this->Random.Int(1, 4) : 0;
       edits > 0; --edits)
  {
    EditSettings(this->Settings, this->Volume, this->Random, this->Geometry, log);
  }
  this->StartSettings = this->Settings;
  this->MakeDeformation();
  this->VolumeInParts = !this->IsLive && this->Random.Chance(0.15);
  this->Parts->SetVolume(this->Volume);
  log << (this->VolumeInParts ? "volume from a source of parts\n" : "");
  this->Connect(this->Tested, false);
  this->ApplySettings();
}

void Pipeline::ApplySettings()
{
  this->Settings.PointsAreDeformed = this->Given == Form::DeformedPoints;
  if (this->VariesInTime &&
    this->Settings.OutputBoundsMode == vtkDeformVolumeFilter::DEFORMED_BOUNDS)
  {
    // Deformed bounds depend on the times seen so far, so those of a new filter may differ.
    this->Settings.OutputBoundsMode = vtkDeformVolumeFilter::VOLUME_BOUNDS;
  }
  Apply(this->Settings, this->Tested.GetFilter());
}

void Pipeline::MakeDeformation()
{
  this->Given = Form::Displacements;
  this->VariesInTime = false;
  this->MakeShape();
  if (this->IsLive && this->Random.Chance(0.95))
  {
    // Most large volumes start without folds.
    vtkDataArray* vectors =
      GetLeaves(this->Deformation)[0]->GetPointData()->GetArray(DISPLACEMENTS);
    vectors->Fill(0.25);
    vectors->Modified();
  }
  this->Before = { Copy(this->Deformation) };
}

void Pipeline::MakeShape()
{
  const bool exact = this->Geometry == fuzz::Geometry::Exact;
  if (this->Random.Chance(exact ? 0.6 : this->IsLive ? 0.35 : 0.2))
  {
    // Most fields of large volumes have a point at each voxel.
    const bool isOfVoxels = this->IsLive && this->Random.Chance(0.7);
    this->Deformation = MakeField(
      this->Volume, this->Random, isOfVoxels ? Geometry::Exact : this->Geometry, this->Log);
    return;
  }
  const int* dimensions = this->Volume->GetDimensions();
  const bool simple = this->Volume->GetNumberOfPoints() < 3000 &&
    *std::min_element(dimensions, dimensions + 3) > 1 && this->Volume->GetSpacing()[1] != 0.0 &&
    std::isfinite(this->Volume->GetOrigin()[1]);
  vtkSmartPointer<vtkUnstructuredGrid> mesh = exact && simple ? MakeVoxelMesh(this->Volume)
    : this->IsLive ? MakeFineLattice(this->Volume, this->Random, this->Log)
                   : MakeMesh(this->Volume, this->Random, this->Log);
  SetDisplacements(mesh, this->Volume, this->Random, this->Geometry, this->Log);
  this->Deformation = mesh;
  if (exact)
  {
    return;
  }
  if (!this->IsLive && this->Random.Chance(0.1))
  {
    this->Deformation = MakeBlocks(mesh, this->Random);
    this->Log << "in blocks\n";
  }
  else if (!this->IsLive && this->Random.Chance(0.12))
  {
    this->VariesInTime = true;
    this->Steps = { mesh };
    this->Times->Steps = { 0.0 };
    for (int steps = this->Random.Int(1, 3); steps > 0; --steps)
    {
      const auto step = vtkSmartPointer<vtkUnstructuredGrid>::New();
      step->ShallowCopy(mesh);
      SetDisplacements(step, this->Volume, this->Random, this->Geometry, this->Log);
      this->Times->Steps.push_back(static_cast<double>(this->Steps.size()));
      this->Steps.push_back(step);
    }
    this->Times->LastTime = this->Times->Steps.back();
    this->Times->Modified();
    this->Time = this->Random.Int(0, 3);
    this->Log << "in time\n";
  }
  if (!this->VariesInTime && this->Random.Chance(0.2))
  {
    this->EditForm();
  }
}

void Pipeline::EditForm()
{
  this->Given =
    this->Random.Pick({ Form::Displacements, Form::TwoConfigurations, Form::DeformedPoints });
  this->Log << "mesh given in form " << static_cast<int>(this->Given) << '\n';
}

void Pipeline::Connect(Subject& subject, bool copies)
{
  vtkDeformVolumeFilter* filter = subject.GetFilter();
  const auto give = [&](int port, vtkDataObject* data)
  {
    if (data && copies)
    {
      filter->SetInputDataObject(port, Copy(data));
    }
    else if (filter->GetInputDataObject(port, 0) != data)
    {
      filter->SetInputDataObject(port, data);
    }
  };
  if (this->VolumeInParts && !copies)
  {
    filter->SetInputConnection(0, this->Parts->GetOutputPort());
  }
  else
  {
    give(0, this->Volume);
  }
  if (this->VariesInTime)
  {
    filter->SetInputConnection(1, this->Times->GetOutputPort());
  }
  else if (this->Given == Form::Displacements)
  {
    give(1, this->Deformation);
  }
  else
  {
    const auto moved = Copy(this->Deformation);
    for (vtkDataSet* leaf : GetLeaves(moved))
    {
      MovePoints(leaf);
    }
    give(1, moved);
  }
  if (this->Given == Form::TwoConfigurations)
  {
    give(2, this->Deformation);
  }
  else
  {
    filter->SetInputConnection(2, nullptr);
  }
}

std::vector<vtkDataSet*> Pipeline::GetDeformed() const
{
  if (!this->VariesInTime)
  {
    return GetLeaves(this->Deformation);
  }
  std::vector<vtkDataSet*> steps;
  for (const auto& step : this->Steps)
  {
    steps.push_back(step);
  }
  return steps;
}

void Pipeline::TouchSources()
{
  this->Parts->SetVolume(this->Volume);
  this->Times->Modified();
  // The modification time of a composite dataset does not include those of its blocks.
  if (vtkCompositeDataSet::SafeDownCast(this->Deformation))
  {
    this->Deformation->Modified();
  }
}

void Pipeline::EditDeformation()
{
  const std::vector<vtkDataSet*> leaves = this->GetDeformed();
  vtkDataSet* leaf = leaves.empty() ? nullptr : this->Random.Pick(leaves);
  auto* mesh = vtkUnstructuredGrid::SafeDownCast(leaf);
  const bool any = this->Geometry == fuzz::Geometry::Any;
  const int kind = this->Random.Int(0, 15);
  if (!leaf || kind == 0)
  {
    this->MakeDeformation();
  }
  else if (kind < 6 && any && mesh)
  {
    EditCells(mesh, this->Random, this->Log);
    if (kind == 1)
    {
      this->Before.push_back(Copy(this->Deformation));
    }
  }
  else if (kind == 6 && any && mesh && !this->VariesInTime)
  {
    this->EditForm();
  }
  else if (kind == 7 && !this->VariesInTime)
  {
    this->Deformation = Copy(this->Deformation);
    this->Log << "an equal deformation\n";
  }
  else if (kind == 8 && !this->VariesInTime)
  {
    this->Deformation->DeepCopy(this->Random.Pick(this->Before));
    this->Log << "an earlier deformation\n";
  }
  else
  {
    this->Repair = EditDisplacements(leaf, this->Volume, this->Random, this->Geometry, this->Log);
  }
}

void Pipeline::Edit()
{
  if (this->Repair)
  {
    this->Log << "the error is corrected\n";
    this->Repair();
    this->Repair = nullptr;
  }
  const int kind = this->Random.Int(0, 19);
  if (kind < 9)
  {
    this->EditDeformation();
  }
  else if (kind < 13)
  {
    EditVolume(this->Volume, this->Random, this->Geometry, this->Log);
  }
  else if (kind < 15)
  {
    this->Log << "initial settings\n";
    this->Settings = this->StartSettings;
  }
  else if (kind < 17)
  {
    EditSettings(this->Settings, this->Volume, this->Random, this->Geometry, this->Log);
  }
  else if (kind == 17)
  {
    this->Abort();
  }
  else if (kind == 18)
  {
    this->Log << "device memory released\n";
    this->Tested.GetFilter()->ReleaseDeviceMemory();
  }
  else
  {
    this->Volume = MakeVolume(this->Random, this->Geometry, this->IsLive, this->Log);
    this->MakeDeformation();
  }
  this->Time = this->Random.Int(0, 3);
  this->TouchSources();
  this->Connect(this->Tested, false);
  this->ApplySettings();
}

void Pipeline::Abort()
{
  this->EditDeformation();
  this->TouchSources();
  this->Connect(this->Tested, false);
  int left = this->Random.Int(1, 6);
  this->Log << "aborted at progress event " << left << '\n';
  vtkNew<vtkCallbackCommand> callback;
  callback->SetCallback(AbortLater);
  callback->SetClientData(&left);
  vtkDeformVolumeFilter* filter = this->Tested.GetFilter();
  const unsigned long observer = filter->AddObserver(vtkCommand::ProgressEvent, callback);
  const Outcome outcome = this->Tested.Update(nullptr, this->VariesInTime ? &this->Time : nullptr);
  filter->RemoveObserver(observer);
  filter->SetAbortExecute(0);
  if (outcome.Output->GetNumberOfPoints() == 0)
  {
    this->Shown = nullptr;
  }
  else
  {
    this->CheckChangedExtent(outcome.Output); // the update had fewer progress events
  }
}

std::string Pipeline::Run()
{
  std::string wrong = this->Check();
  for (int edits = this->IsLive ? 24 : this->Random.Int(0, 6); edits > 0 && wrong.empty(); --edits)
  {
    this->Edit();
    wrong = this->Check();
  }
  return wrong;
}

} // namespace fuzz
