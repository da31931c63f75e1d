// SPDX-License-Identifier: BSD-3-Clause
#include "Evaluation.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

#include <chrono>

namespace
{

// A filter whose output is copied to the host in the update, and two filters whose outputs stay on
// the device.
struct ReadbackStage
{
  vtkSmartPointer<vtkImageData> Volume = MakeVolume(BenchmarkVolume);
  BenchmarkCase AtOnce{ Volume, CoarseNodes };
  BenchmarkCase Unread{ Volume, CoarseNodes };
  BenchmarkCase ReadLater{ Volume, CoarseNodes };
};

// Copies all arrays of an output to the host. Returns the seconds that this takes.
double Read(vtkImageData* image)
{
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < image->GetPointData()->GetNumberOfArrays(); ++i)
  {
    image->GetPointData()->GetArray(i)->GetVoidPointer(0);
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

} // namespace

void RegisterReadback(const EvaluationSize& size)
{
  for (const Pose pose : { Pose::NearIdentity, Pose::LocalEdit })
  {
    RegisterRounds<ReadbackStage>(std::string("Readback/") + GetName(pose), size.GetRounds(),
      []()
      {
        auto stage = std::make_shared<ReadbackStage>();
        stage->Unread.GetFilter()->OutputOnDeviceOn();
        stage->ReadLater.GetFilter()->OutputOnDeviceOn();
        return stage;
      },
      { { "at-once", [pose](ReadbackStage& stage) { return Measure(stage.AtOnce, pose); } },
        { "unread", [pose](ReadbackStage& stage) { return Measure(stage.Unread, pose); } },
        { "later",
          [pose](ReadbackStage& stage)
          {
            Measurement measurement = Measure(stage.ReadLater, pose);
            const double seconds = Read(stage.ReadLater.GetFilter()->GetOutput());
            measurement.Counters["reading"] = seconds;
            measurement.Seconds += seconds;
            return measurement;
          } } });
  }
}
