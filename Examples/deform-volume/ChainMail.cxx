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
#include <vtkPolyData.h>

#include <sstream>

void PullByChainMail(
  const Options& options, const Volume& volume, Messages& messages, Deformation& deformation)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  for (const Pull& pull : options.Pulls)
  {
    points->InsertNextPoint(pull.Point[0] + pull.Displacement[0],
      pull.Point[1] + pull.Displacement[1], pull.Point[2] + pull.Displacement[2]);
    rest->InsertNextTuple(pull.Point.data());
  }
  vtkNew<vtkPolyData> handles;
  handles->SetPoints(points);
  handles->GetPointData()->AddArray(rest);
  vtkNew<vtkChainMailDeformation> chainMail;
  chainMail->SetInputData(volume.Image);
  chainMail->SetHandlesData(handles);
  chainMail->SetHandleRadius(options.Pulls.front().Radius);
  const ProgressBar bar(chainMail, "pulling", !options.Quiet);
  chainMail->Update();
  messages.Check("cannot pull the volume");
  deformation.Data = chainMail->GetOutput();
  deformation.Displacement = "Displacement";
  std::ostringstream text;
  text << chainMail->GetNumberOfMovedVoxels() << " voxels moved in "
       << chainMail->GetNumberOfSweeps() << " sweeps";
  deformation.Motion = text.str();
}
