// SPDX-License-Identifier: BSD-3-Clause
// Time of a frame while tissue is dragged by ChainMail: a step, and the volume deformed.
#include "Evaluation.h"
#include "Timing.h"

#include "../Reported.h"
#include "vtkChainMailDeformation.h"
#include "vtkDeformationHandleSource.h"

#include <vtkImageData.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace
{

constexpr double HandleRadius = 3.0; // voxels
constexpr double DragLength = 14.5;  // voxels, so that about 100,000 voxels move
constexpr double StepAngle = 0.3;

// A drag whose steps alone are measured.
struct StepDrag
{
  int Voxels; // about the number of voxels that move
  double HandleRadius;
  double Length;
};
constexpr StepDrag StepDrags[] = { { 1000, 1.0, 0.5 }, { 100000, HandleRadius, DragLength },
  { 1000000, HandleRadius, 41.0 } };

// A volume of soft tissue, in whose middle a handle moves along a circle.
struct DraggedVolume
{
  DraggedVolume(vtkImageData* volume, double handleRadius, double dragLength)
    : Spacing(volume->GetSpacing()[0])
    , DragLength(dragLength)
  {
    volume->GetCenter(this->Center);
    this->Handle->SetRestPosition(this->Center);
    this->Handle->SetPosition(this->Center);
    this->ChainMail->SetInputData(volume);
    this->ChainMail->SetHandlesConnection(this->Handle->GetOutputPort());
    this->ChainMail->SetHandleRadius(handleRadius * this->Spacing);
    this->Filter->SetInputData(volume);
    this->Filter->SetDeformationConnection(this->ChainMail->GetOutputPort());
  }

  void MoveHandle()
  {
    const double angle = StepAngle * ++this->Step;
    const double length = this->DragLength * this->Spacing;
    this->Handle->SetPosition(this->Center[0] + length * std::cos(angle),
      this->Center[1] + length / 3.0, this->Center[2] + length * std::sin(angle));
  }

  double Spacing;
  double DragLength;
  double Center[3];
  int Step = 0;
  vtkNew<vtkDeformationHandleSource> Handle;
  vtkNew<vtkChainMailDeformation> ChainMail;
  vtkNew<vtkDeformVolumeFilter> Filter;
};

// Measures a step of the drag, and an update of the part of the output that moves, or of the whole
// output.
Measurement MeasureFrame(DraggedVolume& dragged, bool whole)
{
  dragged.MoveHandle();
  dragged.Filter->SetIncremental(!whole);
  Measurement measurement;
  const double step = Time([&] { dragged.ChainMail->Update(); });
  measurement.Seconds = step + Time([&] { dragged.Filter->Update(); });
  if (dragged.Filter->GetNumberOfCoveredVoxels() == 0)
  {
    throw std::runtime_error("nothing was deformed");
  }
  measurement.Counters["step"] = step;
  measurement.Counters["mapping"] = GetReportedSeconds(dragged.Filter, "Seconds for mapping");
  measurement.Counters["resampling"] = GetReportedSeconds(dragged.Filter, "Seconds for resampling");
  measurement.Counters["moved"] = static_cast<double>(dragged.ChainMail->GetNumberOfMovedVoxels());
  return measurement;
}

// Measures a step alone.
Measurement MeasureStep(DraggedVolume& dragged)
{
  dragged.MoveHandle();
  Measurement measurement;
  measurement.Seconds = Time([&] { dragged.ChainMail->Update(); });
  measurement.Counters["moved"] = static_cast<double>(dragged.ChainMail->GetNumberOfMovedVoxels());
  return measurement;
}

} // namespace

void RegisterChainMail(const EvaluationSize& size)
{
  for (const auto& dimensions : { HalfVolume, BenchmarkVolume })
  {
    RegisterRounds<DraggedVolume>("ChainMail/" + GetName(dimensions), size.GetRounds(),
      [dimensions]()
      { return std::make_shared<DraggedVolume>(MakeVolume(dimensions), HandleRadius, DragLength); },
      { { "part", [](DraggedVolume& dragged) { return MeasureFrame(dragged, false); } },
        { "whole", [](DraggedVolume& dragged) { return MeasureFrame(dragged, true); } } });
  }
  for (const StepDrag& drag : StepDrags)
  {
    RegisterRounds<DraggedVolume>("ChainMailStep/" + std::to_string(drag.Voxels), size.GetRounds(),
      [drag]()
      {
        return std::make_shared<DraggedVolume>(
          MakeVolume(BenchmarkVolume), drag.HandleRadius, drag.Length);
      },
      { { "step", MeasureStep } });
  }
}
