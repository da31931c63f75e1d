// SPDX-License-Identifier: BSD-3-Clause
// Deformations with a time range but no time steps, and times between steps. The extent of the
// output contains the deformed volume at all times that were requested so far, or a warning says
// that it does not.
#include "FilterTesting.h"

#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkTemporalInterpolator.h>
#include <vtkUnstructuredGridAlgorithm.h>

#include <vector>

using namespace filterTesting;
using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{

/// A lattice that is moved along x by a number of voxels that depends on the time, from 0 to 4. It
/// announces time steps only if Steps is not empty.
class TimedLattice : public vtkUnstructuredGridAlgorithm
{
public:
  static TimedLattice* New();
  vtkTypeMacro(TimedLattice, vtkUnstructuredGridAlgorithm);

  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  std::function<double(double)> Way;
  std::vector<double> Steps;
  int Executions = 0;

protected:
  TimedLattice() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    const double range[2] = { 0.0, 4.0 };
    vtkInformation* info = output->GetInformationObject(0);
    info->Set(Pipeline::TIME_RANGE(), range, 2);
    info->Remove(Pipeline::TIME_STEPS());
    if (!this->Steps.empty())
    {
      info->Set(Pipeline::TIME_STEPS(), this->Steps.data(), static_cast<int>(this->Steps.size()));
    }
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    ++this->Executions;
    vtkInformation* info = output->GetInformationObject(0);
    const double time =
      info->Has(Pipeline::UPDATE_TIME_STEP()) ? info->Get(Pipeline::UPDATE_TIME_STEP()) : 0.0;
    auto* grid = vtkUnstructuredGrid::GetData(output);
    grid->ShallowCopy(this->Mesh);
    SetDisplacements(grid, Shift(this->Way(time), 0.0, 0.0));
    grid->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    return 1;
  }
};
vtkStandardNewMacro(TimedLattice);

// Updates to a time, and checks that the extent ends at last on x and contains the deformed volume.
void CheckTime(Deformed& deformed, vtkImageData* volume, double time, int last)
{
  deformed.Filter->UpdateTimeStep(time);
  const std::string warning = deformed.TakeWarning();
  EXPECT_EQ(deformed.TakeErrors(), 0);
  EXPECT_TRUE(warning.empty());
  const Extent extent{ { 0, last, 0, 8, 0, 7 } };
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), extent);
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
}

// A series with time steps, passed through vtkTemporalInterpolator, which announces only a range.
TEST(DeformContinuousTime, InterpolatedSeries)
{
  auto volume = MakeVolume();
  vtkNew<TimedLattice> lattice;
  lattice->Mesh = MakeMesh(volume);
  lattice->Steps = { 0.0, 1.1, 2.0, 4.0 };
  lattice->Way = [](double time) { return time == 1.1 ? 11.0 : 0.0; };
  vtkNew<vtkTemporalInterpolator> interpolator;
  interpolator->SetInputConnection(lattice->GetOutputPort());
  interpolator->UpdateInformation();
  EXPECT_FALSE(interpolator->GetOutputInformation(0)->Has(Pipeline::TIME_STEPS()));
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationConnection(interpolator->GetOutputPort());
  deformed.Filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "displacement");
  CheckTime(deformed, volume, 0.0, 9);
  for (const double time : { 1.1, 0.5, 0.1, 2.0, 4.0 })
  {
    CheckTime(deformed, volume, time, 20);
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
  auto volume = MakeVolume();
  vtkNew<TimedLattice> lattice;
  lattice->Mesh = MakeMesh(volume);
  lattice->Way = [](double time) { return std::abs(time - 1.0) < 0.15 ? 10.0 : 0.0; };
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationConnection(lattice->GetOutputPort());
  CheckTime(deformed, volume, 3.0, 9);
  // One execution for the extent, at the beginning of the range, and one for the requested time.
  EXPECT_LE(lattice->Executions, 2);

  CheckTime(deformed, volume, 1.0, 19);
  CheckTime(deformed, volume, 1.05, 19);
  CheckTime(deformed, volume, 3.5, 19);

  // VOLUME_BOUNDS need no execution for the extent.
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  lattice->Executions = 0;
  lattice->Modified();
  deformed.Filter->UpdateTimeStep(3.0);
  EXPECT_EQ(deformed.TakeWarning(), "");
  EXPECT_EQ(lattice->Executions, 1);
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), GetExtent(volume));
}

// With BoundsGranularity the deformed volume at all times is inside the extent, without warnings.
TEST(DeformContinuousTime, KeptExtent)
{
  auto volume = MakeVolume();
  vtkNew<TimedLattice> lattice;
  lattice->Mesh = MakeMesh(volume);
  lattice->Way = [](double time) {
    return std::abs(time - 1.0) < 0.15 ? 5.0 : std::abs(time - 3.0) < 0.15 ? 10.0 : 0.0;
  };
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationConnection(lattice->GetOutputPort());
  deformed.Filter->SetBoundsGranularity(16);
  const auto check = [&](double time, int last)
  {
    deformed.Filter->UpdateTimeStep(time);
    EXPECT_EQ(deformed.TakeWarning(), "");
    EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), (Extent{ { 0, last, 0, 16, 0, 16 } }));
    EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
  };
  check(2.0, 16);
  check(1.0, 16);
  check(3.0, 32);
  check(0.0, 32);
}

// A request between two time steps, at which the source has another displacement than at the steps.
TEST(DeformContinuousTime, TimesBetweenSteps)
{
  auto volume = MakeVolume();
  vtkNew<TimedLattice> lattice;
  lattice->Mesh = MakeMesh(volume);
  lattice->Steps = { 0.0, 2.0, 4.0 };
  lattice->Way = [](double time) { return time == 1.0 ? 5.0 : 0.0; };
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationConnection(lattice->GetOutputPort());
  CheckTime(deformed, volume, 2.0, 9);
  CheckTime(deformed, volume, 1.0, 14);
}

// Updates without a requested time: the source may give data of another time than before.
TEST(DeformContinuousTime, NoTime)
{
  auto volume = MakeVolume();
  vtkNew<TimedLattice> lattice;
  lattice->Mesh = MakeMesh(volume);
  lattice->Steps = { 0.0, 2.0, 4.0 };
  lattice->Way = [](double time) { return time == 4.0 ? 5.0 : 0.0; };
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationConnection(lattice->GetOutputPort());
  deformed.Update();
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), (Extent{ { 0, 9, 0, 8, 0, 7 } }));
  lattice->UpdateTimeStep(4.0);
  deformed.Filter->SetBackgroundValue(1.0);
  deformed.Filter->Update();
  EXPECT_TRUE(HasPart(deformed.TakeWarning(), "extends beyond the extent"));
  deformed.Update();
  EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), (Extent{ { 0, 14, 0, 8, 0, 7 } }));
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
}

} // namespace
