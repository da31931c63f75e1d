// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMail.h"

#include "MeshMaking.h"
#include "Messages.h"
#include "Options.h"
#include "ProgressBar.h"
#include "Volume.h"

#include <vtkChainMailDeformation.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>

vtkSmartPointer<vtkPolyData> MakeHandles(const std::vector<Pull>& pulls, double part)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  for (const Pull& pull : pulls)
  {
    points->InsertNextPoint(pull.Point[0] + part * pull.Displacement[0],
      pull.Point[1] + part * pull.Displacement[1], pull.Point[2] + part * pull.Displacement[2]);
    rest->InsertNextTuple(pull.Point.data());
  }
  auto handles = vtkSmartPointer<vtkPolyData>::New();
  handles->SetPoints(points);
  handles->GetPointData()->AddArray(rest);
  return handles;
}

void PullByChainMail(const Options& options, const Volume& volume, Messages& messages,
  Deformation& deformation, const FrameTaker& takeFrame)
{
  vtkNew<vtkChainMailDeformation> chainMail;
  chainMail->SetInputData(volume.Image);
  chainMail->SetHandleRadius(options.Pulls.front().Radius);
  const int frames = std::max(options.Frames, 1);
  for (int frame = 1; frame <= frames; ++frame)
  {
    chainMail->SetHandlesData(MakeHandles(options.Pulls, double(frame) / frames));
    {
      const ProgressBar bar(chainMail, "pulling", !options.Quiet);
      chainMail->Update();
    }
    messages.Check("cannot pull the volume");
    deformation.Data = chainMail->GetOutput();
    deformation.Displacement = "Displacement";
    takeFrame(deformation);
  }
  deformation.Motion = MakeText(chainMail->GetNumberOfMovedVoxels(), " voxels moved in ",
    chainMail->GetNumberOfSweeps(), " sweeps");
}
