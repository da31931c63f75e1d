// SPDX-License-Identifier: BSD-3-Clause
// A deformation that varies in time. The first update reads one time step. The whole extent of the
// output contains the deformed volume at the time steps so far, and each requested time gives its
// step.
#include "TimedDeformation.h"

#include "vtkCutVolume.h"
#include "vtkDeformGeometryFilter.h"

#include <vtkAppendFilter.h>
#include <vtkExtractTimeSteps.h>
#include <vtkForceTime.h>
#include <vtkImageShiftScale.h>
#include <vtkInformation.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkTemporalShiftScale.h>
#include <vtkTrivialProducer.h>

#include <numeric>

using namespace filterTesting;

namespace
{

int FindCoveredStart(Deformed& deformed)
{
  vtkImageData* output = deformed.Filter->GetOutput();
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    if (deformed.IsCovered(id))
    {
      return static_cast<int>(GetPoint(output, id).x);
    }
  }
  return -1;
}

} // namespace

TEST(DeformTime, Series)
{
  double speed = 10.0; // voxels in each of a hundred time steps
  TimedDeformation deformed([&](double time) { return speed * time; }, 99.0);
  vtkImageData* volume = deformed.Volume;
  TimedMesh* lattice = deformed.Lattice;
  lattice->Steps.resize(100);
  std::iota(lattice->Steps.begin(), lattice->Steps.end(), 0.0);
  deformed.Filter->UpdateInformation();
  vtkInformation* info = deformed.Filter->GetOutputInformation(0);
  EXPECT_EQ(info->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()), 100);
  EXPECT_EQ(info->Get(vtkStreamingDemandDrivenPipeline::TIME_RANGE())[1], 99.0);
  EXPECT_EQ(GetWholeExtent(deformed.Filter), (Extent{ { 0, 9, 0, 8, 0, 7 } }));

  const auto check = [&](double time, int last, int first = 0)
  {
    vtkImageData* output = deformed.Filter->GetOutput();
    EXPECT_EQ(GetExtent(output), (Extent{ { first, last, 0, 8, 0, 7 } }));
    EXPECT_EQ(FindCoveredStart(deformed), static_cast<int>(speed * time));
    EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
    EXPECT_EQ(output->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), time);
  };
  deformed.Filter->UpdateTimeStep(0.0);
  EXPECT_EQ(lattice->Executions, 1); // for both the extent and the output
  check(0.0, 9);
  // The extent grows in the update that requests another time.
  deformed.Filter->UpdateTimeStep(3.0);
  check(3.0, 39);
  deformed.Filter->UpdateTimeStep(1.0);
  check(1.0, 39);
  deformed.Filter->UpdateTimeStep(4.0);
  check(4.0, 49);
  EXPECT_EQ(deformed.TakeWarning(), "");
  EXPECT_EQ(deformed.TakeErrors(), 0);
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 1);
  EXPECT_EQ(GetReported(deformed.Filter, "Volumes sent"), 1);
  EXPECT_EQ(lattice->Executions, 4); // one execution for each change of the time

  // For another deformation the extent is computed again, at the requested time.
  speed = 2.0;
  lattice->Modified();
  deformed.Filter->UpdateTimeStep(4.0);
  check(4.0, 17, 8);

  // A consumer requests the previous extent first: then a warning says that the deformed volume
  // extends beyond it. The next update has the new extent.
  vtkNew<vtkImageShiftScale> consumer;
  consumer->SetInputConnection(deformed.Filter->GetOutputPort());
  consumer->UpdateTimeStep(4.0);
  EXPECT_EQ(deformed.TakeWarning(), "");
  for (const double time : { 20.0, 40.0 })
  {
    const int last = static_cast<int>(speed * time) + 9;
    consumer->UpdateTimeStep(time);
    EXPECT_LT(GetExtent(consumer->GetOutput())[1], last);
    const std::string warning = deformed.TakeWarning();
    EXPECT_TRUE(HasPart(warning, "extends beyond the extent"));
    EXPECT_TRUE(HasPart(warning, "CUSTOM_BOUNDS"));
    consumer->UpdateTimeStep(time);
    EXPECT_EQ(GetExtent(consumer->GetOutput())[1], last);
    EXPECT_EQ(deformed.TakeWarning(), "");
    check(time, last, 8);
  }

  // VOLUME_BOUNDS need no execution for the extent.
  lattice->Executions = 0;
  lattice->Modified();
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  deformed.Filter->UpdateTimeStep(1.0);
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), GetExtent(volume));
  EXPECT_EQ(lattice->Executions, 1);
}

// Without times of the inputs, the output has no time, whatever time is requested.
TEST(DeformTime, NoTimes)
{
  const auto volume = MakeVolume({ { 0, 5, 0, 5, 0, 5 } });
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->UpdateTimeStep(1.0);
  EXPECT_EQ(deformed.TakeErrors(), 0);
  EXPECT_FALSE(
    deformed.Filter->GetOutput()->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()));
}

// The mesh at rest is another time of the source that gives the deformation. Of a source of two
// inputs VTK requests the time of the last input only.
TEST(DeformTime, RestFromSameSource)
{
  TimedDeformation deformed([](double) { return 0.0; });
  deformed.Lattice->Steps = { 0.0, 1.0, 2.0, 3.0, 4.0 };
  deformed.Lattice->GetMesh = [&](double time)
  {
    auto mesh = MakeMesh(deformed.Volume, 3, 50.0);
    MovePoints(mesh, Shift(10.0 * time, 0.0, 0.0));
    return mesh;
  };
  const auto check = [&](double time, int shift, int first, int last)
  {
    deformed.Filter->UpdateTimeStep(time);
    EXPECT_EQ(deformed.TakeErrors(), 0) << deformed.LastError;
    EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), (Extent{ { first, last, 0, 8, 0, 7 } }));
    EXPECT_EQ(FindCoveredStart(deformed), shift);
  };

  // vtkForceTime keeps the data of its time.
  vtkNew<vtkForceTime> start;
  start->SetInputConnection(deformed.Lattice->GetOutputPort());
  start->SetForcedTime(0.0);
  start->IgnorePipelineTimeOn();
  deformed.Filter->SetRestConnection(start->GetOutputPort());
  check(0.0, 0, 0, 9);
  check(2.0, 20, 0, 29);
  check(1.0, 10, 0, 29);
  check(1.5, 15, 0, 29); // between two time steps

  // vtkTemporalShiftScale requests another time in each update.
  vtkNew<vtkTemporalShiftScale> later;
  later->SetInputConnection(deformed.Lattice->GetOutputPort());
  later->SetPreShift(1.0);
  deformed.Filter->SetRestConnection(later->GetOutputPort());
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  deformed.Filter->UpdateTimeStep(3.0);
  EXPECT_EQ(deformed.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(deformed.LastError,
    "The source on input port 1 was asked for the time 3, but another filter has asked it for the "
    "time 2."));
  EXPECT_TRUE(HasPart(deformed.LastError, "vtkForceTime"));
  EXPECT_EQ(deformed.Filter->GetOutput()->GetNumberOfPoints(), 0);

  // The same error if there are filters between the source and the ports.
  vtkNew<vtkAppendFilter> between;
  between->SetInputConnection(deformed.Lattice->GetOutputPort());
  vtkNew<vtkExtractTimeSteps> first;
  first->SetInputConnection(deformed.Lattice->GetOutputPort());
  first->AddTimeStepIndex(0);
  deformed.Filter->SetDeformationConnection(between->GetOutputPort());
  deformed.Filter->SetRestConnection(first->GetOutputPort());
  deformed.Filter->UpdateTimeStep(3.0);
  EXPECT_EQ(deformed.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(deformed.LastError,
    "The source upstream of input port 1 was asked for the time 3, but another filter has asked it "
    "for the time 0."));
  // The filter in between keeps its wrong data until another time is requested.
  deformed.Filter->SetRestConnection(start->GetOutputPort());
  deformed.Filter->SetOutputBoundsModeToDeformedBounds();
  deformed.Filter->UpdateTimeStep(2.0);
  EXPECT_EQ(deformed.TakeErrors(), 0) << deformed.LastError;
  EXPECT_EQ(FindCoveredStart(deformed), 20);
  deformed.Filter->SetDeformationConnection(deformed.Lattice->GetOutputPort());
  deformed.Filter->SetRestConnection(later->GetOutputPort());

  // The extent follows from the right times.
  deformed.Filter->UpdateTimeStep(4.0);
  EXPECT_EQ(GetWholeExtent(deformed.Filter), (Extent{ { 10, 19, 0, 8, 0, 7 } }));
  deformed.TakeErrors();

  // Other times than those of the output are not an error in themselves: upstream of one input, or
  // of data that have no times.
  deformed.Filter->SetRestData(deformed.Lattice->GetMesh(0.0));
  deformed.Filter->SetDeformationConnection(later->GetOutputPort());
  check(4.0, 30, 30, 39);
  vtkNew<vtkTrivialProducer> still;
  still->SetOutput(deformed.Lattice->GetMesh(0.0));
  later->SetInputConnection(still->GetOutputPort());
  deformed.Filter->SetDeformationConnection(still->GetOutputPort());
  deformed.Filter->SetRestConnection(later->GetOutputPort());
  check(2.0, 0, 0, 9);
}

// Cuts and points have the same error.
TEST(DeformTime, OtherFiltersOfSameSource)
{
  TimedDeformation deformed([](double time) { return time; });
  const auto check = [&](auto& observed, vtkDataObject* input)
  {
    vtkNew<vtkTemporalShiftScale> later;
    later->SetInputConnection(deformed.Lattice->GetOutputPort());
    later->SetPreShift(1.0);
    observed.Filter->SetInputData(input);
    observed.Filter->SetDeformationConnection(deformed.Lattice->GetOutputPort());
    observed.Filter->SetRestConnection(later->GetOutputPort());
    observed.Filter->UpdateTimeStep(3.0);
    EXPECT_TRUE(HasPart(observed.Observer->GetErrorMessage(), "was asked for the time 3, but"));
  };
  Observed<vtkCutVolume> cut;
  check(cut, deformed.Volume);
  Observed<vtkDeformGeometryFilter> points;
  check(points, MakeMesh(deformed.Volume));
}
