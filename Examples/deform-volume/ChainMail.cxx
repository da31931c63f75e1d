// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMail.h"

#include "Failure.h"
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
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>

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

namespace
{
std::string GetText(const Pull& pull)
{
  return MakeText(pull.Point[0], ",", pull.Point[1], ",", pull.Point[2]);
}

// Without a radius, each pull holds the nearest voxel. Two pulls cannot hold the same one.
void CheckHeldVoxels(const std::vector<Pull>& pulls, vtkImageData* volume)
{
  std::map<std::array<double, 3>, const Pull*> held;
  for (const Pull& pull : pulls)
  {
    std::array<double, 3> index;
    volume->TransformPhysicalPointToContinuousIndex(pull.Point.data(), index.data());
    for (double& number : index)
    {
      number = std::round(number);
    }
    const auto [found, isFirst] = held.emplace(index, &pull);
    if (!isFirst)
    {
      throw Failure("cannot pull the volume: the --pull at " + GetText(*found->second) +
        " and the one at " + GetText(pull) +
        " hold the same voxel, the nearest one to both. Remove one of them, or move it");
    }
  }
}

void WarnOfPulls(int reduced, int released, std::size_t pulls, Messages& messages)
{
  if (reduced + released > 0)
  {
    messages.Warn(MakeText("The --pull contradict one another: the links between voxels do not "
                           "stretch that far. Of ",
      pulls, ", ", reduced, " moved less than given, and ", released,
      " had no effect. Reduce their displacements, or the differences between them."));
  }
}
}

void PullByChainMail(const Options& options, const Volume& volume, Messages& messages,
  Deformation& deformation, const FrameTaker& takeFrame)
{
  CheckHeldVoxels(options.Pulls, volume.Image);
  vtkNew<vtkChainMailDeformation> chainMail;
  chainMail->SetDevice(options.Device);
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
  // Pulls that contradict one another in a step do so in the last one, where they are longest.
  WarnOfPulls(chainMail->GetNumberOfReducedHandles(), chainMail->GetNumberOfReleasedHandles(),
    options.Pulls.size(), messages);
  deformation.Motion = MakeText(chainMail->GetNumberOfMovedVoxels(), " voxels moved in ",
    chainMail->GetNumberOfSweeps(), " sweeps");
}
