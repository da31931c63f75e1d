// SPDX-License-Identifier: BSD-3-Clause
#include "ElasticModel.h"

#include "ChainMail.h"
#include "Failure.h"
#include "MeshMaking.h"
#include "Messages.h"
#include "Options.h"
#include "ProgressBar.h"
#include "Volume.h"

#include <vtkCorotationalDeformation.h>
#include <vtkMassSpringDeformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

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
    volume->GetPointData()->GetArray(0)->GetComponent(voxel, 0) == fixation.Value;
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
      throw Failure("--fix " + fixation.Text + " fixes no node of the mesh");
    }
  }
  mesh->GetPointData()->AddArray(fixed);
}

void SetUp(vtkElasticDeformation* model, const Options& options, vtkUnstructuredGrid* mesh)
{
  model->SetInputData(mesh);
  model->SetHandlesData(MakeHandles(options.Pulls));
  model->SetHandleRadius(options.Pulls.empty() ? 0.0 : options.Pulls.front().Radius);
  model->SetGravity(options.Gravity.data());
  model->SetYoungModulus(options.YoungModulus);
  model->SetPoissonRatio(options.PoissonRatio);
  model->SetDensity(options.Density);
  model->SetLengthUnitToMillimetre();
}
}

void DeformByElasticModel(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  Messages& messages, Deformation& deformation)
{
  AddFixedNodes(options, volume.Image, mesh);
  const auto run = [&](vtkElasticDeformation* model, const auto& update)
  {
    SetUp(model, options, mesh);
    {
      const ProgressBar bar(model, "simulating", !options.Quiet);
      update();
    }
    messages.Check("cannot simulate the body");
    deformation.Data = model->GetOutput();
    deformation.Displacement = "Displacement";
  };
  std::ostringstream text;
  if (options.Model == "fem")
  {
    vtkNew<vtkCorotationalDeformation> model;
    model->SetModeToConverged();
    run(model, [&] { model->Update(); });
    text << model->GetNumberOfNewtonSteps() << " steps to "
         << (model->GetIsConverged() ? "equilibrium" : "a state that is not yet in equilibrium")
         << ", strain energy " << model->GetStrainEnergy() << " J";
  }
  else
  {
    vtkNew<vtkMassSpringDeformation> model;
    model->SetDevice(options.Device);
    run(model, [&] { model->UpdateTimeStep(options.Duration); });
    text << options.Duration << " s, in steps of " << 1e3 * model->GetTimeStepInUse() << " ms";
  }
  deformation.Motion = text.str();
}
