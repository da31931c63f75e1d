// SPDX-License-Identifier: BSD-3-Clause
#include "ElasticModel.h"

#include "ChainMail.h"
#include "Failure.h"
#include "MeshMaking.h"
#include "MeshReading.h"
#include "Messages.h"
#include "Options.h"
#include "ProgressBar.h"
#include "Volume.h"

#include <vtkAppendPolyData.h>
#include <vtkFiniteElementDeformation.h>
#include <vtkMassSpringDeformation.h>
#include <vtkMaterialFromVolume.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <sstream>

namespace
{
bool Fixes(const Fixation& fixation, const double point[3], vtkImageData* volume)
{
  if (fixation.Which == Fixation::Kind::Below)
  {
    return point[2] <= fixation.Value;
  }
  if (fixation.Which == Fixation::Kind::Box)
  {
    bool isInside = true;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      isInside = isInside && point[axis] >= fixation.Bounds[2 * axis] &&
        point[axis] <= fixation.Bounds[2 * axis + 1];
    }
    return isInside;
  }
  const vtkIdType voxel = volume->FindPoint(const_cast<double*>(point));
  return voxel >= 0 &&
    volume->GetPointData()->GetScalars()->GetComponent(voxel, 0) == fixation.Value;
}

void AddFixedNodes(const Options& options, vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  vtkNew<vtkUnsignedCharArray> fixed;
  fixed->SetName("Fixed");
  fixed->SetNumberOfTuples(mesh->GetNumberOfPoints());
  fixed->Fill(0.0);
  for (const Fixation& fixation : options.Fixations)
  {
    bool isAny = false;
    for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
    {
      double point[3];
      mesh->GetPoint(node, point);
      if (Fixes(fixation, point, volume))
      {
        fixed->SetValue(node, 1);
        isAny = true;
      }
    }
    if (!isAny)
    {
      throw Failure("--fix " + fixation.Text +
        " fixes no node of the mesh. Positions are world coordinates of the volume");
    }
  }
  mesh->GetPointData()->AddArray(fixed);
}

// Gives the tetrahedra the materials of their voxels, by --material.
void AddMaterials(
  const Options& options, vtkImageData* volume, vtkUnstructuredGrid* mesh, Messages& messages)
{
  if (options.Materials.empty())
  {
    return;
  }
  constexpr int defaultMaterial = 255;
  vtkNew<vtkMaterialFromVolume> filter;
  filter->SetInputData(mesh);
  filter->SetVolumeData(volume);
  filter->ClearMaterials();
  filter->SetMaterial(defaultMaterial, options.YoungModulus, options.PoissonRatio, options.Density);
  filter->SetDefaultMaterial(defaultMaterial);
  const char* name = volume->GetPointData()->GetScalars()->GetName();
  filter->SetMaterialArrayName(name ? name : "");
  int index = 0;
  for (const MaterialOfValues& material : options.Materials)
  {
    filter->SetMaterial(index, material.YoungModulus,
      material.PoissonRatio.value_or(options.PoissonRatio),
      material.Density.value_or(options.Density));
    filter->AddMaterialRange(material.Minimum, material.Maximum, index);
    ++index;
  }
  const ProgressBar bar(filter, "materials", !options.Quiet);
  filter->Update();
  messages.Check("cannot find the materials of the mesh");
  mesh->ShallowCopy(filter->GetOutput());
}

// Gives the model one surface of all sheets of --cut, which cuts the mesh at rest.
void AddSheets(
  const Options& options, const Volume& volume, vtkElasticDeformation* model, Messages& messages)
{
  if (options.Cuts.empty())
  {
    return;
  }
  vtkNew<vtkAppendPolyData> sheets;
  for (const std::string& path : options.Cuts)
  {
    sheets->AddInputData(ReadSheet(path, options, volume, messages));
  }
  sheets->Update();
  model->SetSheetData(sheets->GetOutput());
}

void SetUp(vtkElasticDeformation* model, const Options& options, vtkUnstructuredGrid* mesh)
{
  model->SetInputData(mesh);
  model->SetHandleRadius(options.Pulls.empty() ? 0.0 : options.Pulls.front().Radius);
  model->SetGravity(options.Gravity.data());
  model->SetYoungModulus(options.YoungModulus);
  model->SetPoissonRatio(options.PoissonRatio);
  model->SetDensity(options.Density);
  model->SetLengthUnitToMillimetre();
}
}

void DeformByElasticModel(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  Messages& messages, Deformation& deformation, const FrameTaker& takeFrame)
{
  AddFixedNodes(options, volume.Image, mesh);
  AddMaterials(options, volume.Image, mesh, messages);
  // update(part): moves the handles by this fraction of their displacements, or simulates this
  // fraction of --duration.
  const auto run = [&](vtkElasticDeformation* model, const auto& update)
  {
    SetUp(model, options, mesh);
    AddSheets(options, volume, model, messages);
    const int frames = std::max(options.Frames, 1);
    for (int frame = 1; frame <= frames; ++frame)
    {
      {
        const ProgressBar bar(model, "simulating", !options.Quiet);
        update(double(frame) / frames);
      }
      messages.Check("cannot simulate the body");
      deformation.Data = model->GetOutput();
      deformation.Displacement = "Displacement";
      takeFrame(deformation);
    }
    if (!options.Cuts.empty())
    {
      deformation.Cut =
        std::to_string(model->GetNumberOfSplitFaces()) + " faces of tetrahedra of the mesh split";
      if (model->GetNumberOfSplitFaces() == 0)
      {
        messages.DisplayWarningText(
          "No sheet of --cut crosses the mesh. Are they in the world coordinates of the volume?");
      }
    }
  };
  std::ostringstream text;
  if (options.Model == "fem")
  {
    vtkNew<vtkFiniteElementDeformation> model;
    model->SetModeToConverged();
    run(model,
      [&](double part)
      {
        model->SetHandlesData(MakeHandles(options.Pulls, part));
        model->Update();
      });
    text << model->GetNumberOfNewtonSteps() << " steps to "
         << (model->GetIsConverged() ? "equilibrium" : "a state that is not yet in equilibrium")
         << ", strain energy " << model->GetStrainEnergy() << " J";
  }
  else
  {
    vtkNew<vtkMassSpringDeformation> model;
    model->SetDevice(options.Device);
    model->SetEndTime(options.Duration); // without a time range, VTK ignores all but the first time
    model->SetHandlesData(MakeHandles(options.Pulls));
    run(model, [&](double part) { model->UpdateTimeStep(part * options.Duration); });
    text << options.Duration << " s, in steps of " << 1e3 * model->GetTimeStepInUse() << " ms";
  }
  deformation.Motion = text.str();
}
