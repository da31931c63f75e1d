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
#include <vtkBoundingBox.h>
#include <vtkFiniteElementDeformation.h>
#include <vtkMassSpringDeformation.h>
#include <vtkMaterialFromVolume.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStaticCellLocator.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <set>

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
    return vtkBoundingBox(fixation.Bounds.data()).ContainsPoint(point) != 0;
  }
  const vtkIdType voxel = volume->FindPoint(const_cast<double*>(point));
  return voxel >= 0 &&
    volume->GetPointData()->GetScalars()->GetComponent(voxel, 0) == fixation.Value;
}

void AddFixedNodes(
  const Options& options, vtkImageData* volume, vtkUnstructuredGrid* mesh, Messages& messages)
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
  // With --pull this is an error of the model.
  if (options.Pulls.empty() && fixed->GetRange()[0] > 0.0)
  {
    messages.Warn("--fix fixes all nodes of the mesh, so nothing moves. Positions are "
                  "world coordinates of the volume.");
  }
}

void WarnOfUnusedMaterials(const Options& options, vtkDataArray* values, Messages& messages)
{
  for (const MaterialOfValues& material : options.Materials)
  {
    bool isUsed = false;
    for (vtkIdType voxel = 0; voxel < values->GetNumberOfTuples() && !isUsed; ++voxel)
    {
      const double value = values->GetComponent(voxel, 0);
      isUsed = value >= material.Minimum && value < material.Maximum;
    }
    if (!isUsed)
    {
      double range[2];
      values->GetFiniteRange(range, 0);
      messages.Warn(
        MakeText("No voxel has a value of the range ", material.Minimum, ":", material.Maximum,
          " of --material. Values of the volume are ", range[0], " to ", range[1], "."));
    }
  }
}

// Gives the tetrahedra the materials of their voxels, by --material.
void AddMaterials(
  const Options& options, vtkImageData* volume, vtkUnstructuredGrid* mesh, Messages& messages)
{
  if (options.Materials.empty())
  {
    return;
  }
  WarnOfUnusedMaterials(options, volume->GetPointData()->GetScalars(), messages);
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

// Returns one surface of all sheets of --cut.
vtkSmartPointer<vtkPolyData> ReadSheets(
  const Options& options, const Volume& volume, Messages& messages)
{
  vtkNew<vtkAppendPolyData> sheets;
  for (const std::string& path : options.Cuts)
  {
    sheets->AddInputData(ReadSheet(path, options, volume, messages));
  }
  sheets->Update();
  return sheets->GetOutput();
}

// Returns how far split faces of a mesh at rest are from the sheet at most. Their nodes have copies
// at the same position.
double FindDistance(vtkPointSet* mesh, vtkPolyData* sheet)
{
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(sheet);
  locator->BuildLocator();
  std::set<std::array<double, 3>> positions;
  double farthest = 0.0;
  for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
  {
    std::array<double, 3> position;
    mesh->GetPoint(node, position.data());
    if (!positions.insert(position).second)
    {
      double closest[3];
      vtkIdType cell = -1;
      int part = 0;
      double square = 0.0;
      locator->FindClosestPoint(position.data(), closest, cell, part, square);
      farthest = std::max(farthest, square);
    }
  }
  return std::sqrt(farthest);
}

// Describes the cuts in the mesh of a model.
std::string DescribeCut(vtkElasticDeformation* model, vtkPolyData* sheet, Messages& messages)
{
  const vtkIdType faces = model->GetNumberOfSplitFaces();
  if (faces == 0)
  {
    messages.Warn(
      "No sheet of --cut crosses the mesh. Are they in the world coordinates of the volume?");
  }
  const std::string split = MakeText(faces, " faces of tetrahedra of the mesh split");
  return faces == 0 ? split
                    : MakeText(split, std::setprecision(3), ", at most ",
                        FindDistance(model->GetOutput(), sheet), " mm from the sheet");
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
  AddFixedNodes(options, volume.Image, mesh, messages);
  AddMaterials(options, volume.Image, mesh, messages);
  // update(part): moves the handles by this fraction of their displacements, or simulates this
  // fraction of --duration.
  const auto run = [&](vtkElasticDeformation* model, const auto& update)
  {
    SetUp(model, options, mesh);
    const bool cuts = !options.Cuts.empty();
    const auto sheet = cuts ? ReadSheets(options, volume, messages) : nullptr;
    model->SetSheetData(sheet);
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
    if (cuts)
    {
      deformation.Cut = DescribeCut(model, sheet, messages);
    }
  };
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
    if (!model->GetIsConverged())
    {
      throw Failure("cannot simulate the body: no equilibrium was found. Reduce --gravity or the "
                    "displacements of --pull, or increase --young");
    }
    deformation.Motion = MakeText(model->GetNumberOfNewtonSteps(),
      " steps to equilibrium, strain energy ", model->GetStrainEnergy(), " J");
  }
  else
  {
    vtkNew<vtkMassSpringDeformation> model;
    model->SetDevice(options.Device);
    model->SetEndTime(options.Duration); // without a time range, VTK ignores all but the first time
    model->SetHandlesData(MakeHandles(options.Pulls));
    run(model, [&](double part) { model->UpdateTimeStep(part * options.Duration); });
    deformation.Motion =
      MakeText(options.Duration, " s, in steps of ", 1e3 * model->GetTimeStepInUse(), " ms");
  }
}
