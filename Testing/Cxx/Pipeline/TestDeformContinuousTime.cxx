// SPDX-License-Identifier: BSD-3-Clause
// Deformations with a time range but no time steps, and times between steps. The extent of the
// output contains the deformed volume at all times that were requested so far, or a warning says
// that it does not.
#include "TimedDeformation.h"

#include <vtkImageShiftScale.h>
#include <vtkInformation.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkTemporalInterpolator.h>

using namespace filterTesting;
using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{

// Updates to a time, and checks that the extent ends at last on x and contains the deformed volume.
void CheckTime(TimedDeformation& deformed, double time, int last)
{
  deformed.Filter->UpdateTimeStep(time);
  const std::string warning = deformed.TakeWarning();
  EXPECT_EQ(deformed.TakeErrors(), 0);
  EXPECT_TRUE(warning.empty());
  const Extent extent{ { 0, last, 0, 8, 0, 7 } };
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), extent);
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), deformed.Volume->GetNumberOfPoints());
}

// A series with time steps, passed through vtkTemporalInterpolator, which announces only a range.
TEST(DeformContinuousTime, InterpolatedSeries)
{
  TimedDeformation deformed([](double time) { return time == 1.1 ? 11.0 : 0.0; });
  deformed.Lattice->Steps = { 0.0, 1.1, 2.0, 4.0 };
  vtkNew<vtkTemporalInterpolator> interpolator;
  interpolator->SetInputConnection(deformed.Lattice->GetOutputPort());
  interpolator->UpdateInformation();
  EXPECT_FALSE(interpolator->GetOutputInformation(0)->Has(Pipeline::TIME_STEPS()));
  deformed.Filter->SetDeformationConnection(interpolator->GetOutputPort());
  deformed.Filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "displacement");
  CheckTime(deformed, 0.0, 9);
  for (const double time : { 1.1, 0.5, 0.1, 2.0, 4.0 })
  {
    CheckTime(deformed, time, 20);
  }
  vtkInformation* info = deformed.Filter->GetOutputInformation(0);
  EXPECT_FALSE(info->Has(Pipeline::TIME_STEPS()));
  EXPECT_EQ(info->Get(Pipeline::TIME_RANGE())[1], 4.0);

  // The interpolator can announce time steps of its own.
  interpolator->SetDiscreteTimeStepInterval(0.5);
  deformed.Filter->UpdateTimeStep(2.0);
  EXPECT_EQ(deformed.TakeErrors(), 0);
  EXPECT_TRUE(deformed.Filter->GetOutputInformation(0)->Has(Pipeline::TIME_STEPS()));
}

TEST(DeformContinuousTime, ContinuousSource)
{
  TimedDeformation deformed([](double time) { return std::abs(time - 1.0) < 0.15 ? 10.0 : 0.0; });
  CheckTime(deformed, 3.0, 9);
  // One execution for the extent, at the beginning of the range, and one for the requested time.
  EXPECT_LE(deformed.Lattice->Executions, 2);

  CheckTime(deformed, 1.0, 19);
  CheckTime(deformed, 1.05, 19);
  CheckTime(deformed, 3.5, 19);

  // VOLUME_BOUNDS need no execution for the extent.
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  deformed.Lattice->Executions = 0;
  deformed.Lattice->Modified();
  deformed.Filter->UpdateTimeStep(3.0);
  EXPECT_EQ(deformed.TakeWarning(), "");
  EXPECT_EQ(deformed.Lattice->Executions, 1);
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), GetExtent(deformed.Volume));
}

// With BoundsGranularity the deformed volume at all times is inside the extent, without warnings.
TEST(DeformContinuousTime, KeptExtent)
{
  TimedDeformation deformed(
    [](double time) {
      return std::abs(time - 1.0) < 0.15 ? 5.0 : std::abs(time - 3.0) < 0.15 ? 10.0 : 0.0;
    });
  deformed.Filter->SetBoundsGranularity(16);
  const auto check = [&](double time, int last)
  {
    deformed.Filter->UpdateTimeStep(time);
    EXPECT_EQ(deformed.TakeWarning(), "");
    EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), (Extent{ { 0, last, 0, 16, 0, 16 } }));
    EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), deformed.Volume->GetNumberOfPoints());
  };
  check(2.0, 16);
  check(1.0, 16);
  check(3.0, 32);
  check(0.0, 32);
}

// A request between two time steps, at which the source has another displacement than at the steps.
TEST(DeformContinuousTime, TimesBetweenSteps)
{
  TimedDeformation deformed([](double time) { return time == 1.0 ? 5.0 : 0.0; });
  deformed.Lattice->Steps = { 0.0, 2.0, 4.0 };
  CheckTime(deformed, 2.0, 9);
  CheckTime(deformed, 1.0, 14);
}

// Updates without a requested time: the source may give data of another time than before.
TEST(DeformContinuousTime, NoTime)
{
  TimedDeformation deformed([](double time) { return time == 4.0 ? 5.0 : 0.0; });
  deformed.Lattice->Steps = { 0.0, 2.0, 4.0 };
  deformed.Update();
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), (Extent{ { 0, 9, 0, 8, 0, 7 } }));
  deformed.Lattice->UpdateTimeStep(4.0);
  deformed.Filter->SetBackgroundValue(1.0);
  deformed.Filter->Update();
  EXPECT_TRUE(HasPart(deformed.TakeWarning(), "extends beyond the extent"));
  deformed.Update();
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), (Extent{ { 0, 14, 0, 8, 0, 7 } }));
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), deformed.Volume->GetNumberOfPoints());
}

// vtkTemporalInterpolator, behind the filter or another one, collects two time steps in one update.
// The extent grows between them. Both steps then have the previous extent, and the next update has
// the new one.
TEST(DeformContinuousTime, InterpolatedOutput)
{
  for (const bool isDirect : { true, false })
  {
    TimedDeformation deformed([](double time) { return 10.0 * time; });
    vtkNew<vtkImageShiftScale> behind;
    deformed.Lattice->Steps = { 0.0, 1.0, 2.0, 3.0, 4.0 };
    vtkNew<vtkImageShiftScale> between;
    between->SetInputConnection(deformed.Filter->GetOutputPort());
    vtkNew<vtkTemporalInterpolator> interpolator;
    interpolator->SetInputConnection(
      isDirect ? deformed.Filter->GetOutputPort() : between->GetOutputPort());
    vtkNew<vtkTemporalInterpolator> idle; // must not keep the others from the new extent
    idle->SetInputConnection(deformed.Filter->GetOutputPort());
    behind->SetInputConnection(interpolator->GetOutputPort());
    vtkAlgorithm* const updated[] = { interpolator, behind };
    int last = 9;
    // The first step of the second update is already there.
    for (const int before : { 0, 1, 3, 2 })
    {
      for (int repeat = 0; repeat < 2; ++repeat)
      {
        updated[isDirect]->UpdateTimeStep(before + 0.5);
        const int needed = 9 + 10 * (before + 1);
        const std::string warning = deformed.TakeWarning();
        EXPECT_EQ(HasPart(warning, "extends beyond the extent"), needed > last && repeat == 0);
        EXPECT_EQ(deformed.TakeErrors(), 0);
        last = repeat == 0 ? last : std::max(last, needed);
        auto* output = vtkImageData::SafeDownCast(interpolator->GetOutputDataObject(0));
        EXPECT_EQ(GetExtent(output), (Extent{ { 0, last, 0, 8, 0, 7 } }));
        for (int x = 0; x <= last; ++x)
        {
          const auto get = [&](int atRest)
          {
            return atRest < 0 || atRest > 9
              ? 0.0
              : deformed.Volume->GetScalarComponentAsDouble(atRest, 3, 4, 0);
          };
          // The interpolator rounds to integers.
          EXPECT_NEAR(output->GetScalarComponentAsDouble(x, 3, 4, 0),
            0.5 * (get(x - 10 * before) + get(x - 10 * (before + 1))), 1.0);
        }
      }
    }
  }
}

// A consumer that was deleted between two updates.
TEST(DeformContinuousTime, DeletedConsumer)
{
  TimedDeformation deformed([](double time) { return 10.0 * time; });
  for (int time = 0; time < 4; ++time)
  {
    vtkNew<vtkImageShiftScale> view;
    for (int repeat = 0; repeat < 2; ++repeat)
    {
      vtkNew<vtkImageShiftScale> consumer;
      consumer->SetInputConnection(deformed.Filter->GetOutputPort());
      view->SetInputConnection(consumer->GetOutputPort());
      view->UpdateTimeStep(time);
      EXPECT_EQ(HasPart(deformed.TakeWarning(), "extends beyond"), time > 0 && repeat == 0);
      EXPECT_EQ(view->GetOutput()->GetExtent()[1], 9 + 10 * std::max(0, time - 1 + repeat));
    }
  }
}

} // namespace
