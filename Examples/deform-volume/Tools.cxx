// SPDX-License-Identifier: BSD-3-Clause
#include "Tools.h"

#include "MeshReading.h"
#include "Messages.h"
#include "Options.h"
#include "ProgressBar.h"
#include "Volume.h"

#include <vtkCarveVolume.h>
#include <vtkCutVolume.h>
#include <vtkNew.h>
#include <vtkSphere.h>

namespace
{
std::string Describe(const std::string& tool, vtkIdType switchedOff, vtkIdType divided = 0)
{
  return MakeText(tool, ": ", switchedOff, " tetrahedra of the volume are off",
    divided > 0 ? MakeText(", ", divided, " divided") : "");
}
}

std::vector<std::string> CutAndCarve(const Options& options, Volume& volume, Messages& messages)
{
  std::vector<std::string> done;
  for (const std::string& path : options.CutsMesh() ? std::vector<std::string>() : options.Cuts)
  {
    vtkNew<vtkCutVolume> cut;
    cut->SetInputData(volume.Image);
    cut->SetSheetData(ReadSheet(path, options, volume, messages));
    cut->SetSmoothCut(options.SmoothCut);
    const ProgressBar bar(cut, "cutting", !options.Quiet);
    cut->Update();
    messages.Check("cannot cut the volume with " + path);
    volume.Image = cut->GetOutput();
    const vtkIdType off = cut->GetNumberOfSwitchedOffTetrahedra();
    const vtkIdType divided = cut->GetNumberOfDividedTetrahedra();
    if (off == 0 && divided == 0)
    {
      messages.Warn("The sheet " + path +
        " changes nothing: it does not cross the volume, or crosses only what is cut or carved "
        "already. Is it in the world coordinates of the volume?");
    }
    done.push_back(Describe(path, off, divided));
  }
  for (const Carving& carving : options.Carvings)
  {
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(carving.Center[0], carving.Center[1], carving.Center[2]);
    sphere->SetRadius(carving.Radius);
    vtkNew<vtkCarveVolume> carve;
    carve->SetInputData(volume.Image);
    carve->SetImplicitFunction(sphere);
    const ProgressBar bar(carve, "carving", !options.Quiet);
    carve->Update();
    messages.Check("cannot carve the volume");
    volume.Image = carve->GetOutput();
    const vtkIdType off = carve->GetNumberOfSwitchedOffTetrahedra();
    if (off == 0)
    {
      messages.Warn(MakeText("The sphere of --carve at ", carving.Center[0], ", ",
        carving.Center[1], ", ", carving.Center[2], " with the radius ", carving.Radius,
        " changes nothing: it contains no part of the volume, or only what is cut or carved "
        "already. Is it in the world coordinates of the volume?"));
    }
    done.push_back(Describe("sphere", off));
  }
  return done;
}
