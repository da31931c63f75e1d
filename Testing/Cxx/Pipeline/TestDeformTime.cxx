// SPDX-License-Identifier: BSD-3-Clause
// A deformation that varies in time. The first update reads one time step. The whole extent of the
// output contains the deformed volume at the time steps so far, and each requested time gives its
// step.
#include "FilterTesting.h"

#include <vtkImageShiftScale.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnstructuredGridAlgorithm.h>

#include <array>
#include <numeric>

using namespace filterTesting;

namespace
{

/// A lattice that moves along x by 10 voxels in each of a hundred time steps.
class MovingLattice : public vtkUnstructuredGridAlgorithm
{
public:
  static MovingLattice* New();
  vtkTypeMacro(MovingLattice, vtkUnstructuredGridAlgorithm);

  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  int Executions = 0;
  double Speed = 10.0;

protected:
  MovingLattice() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    std::array<double, 100> times;
    std::iota(times.begin(), times.end(), 0.0);
    const double range[2] = { 0.0, 99.0 };
    vtkInformation* info = output->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), times.data(), 100);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    ++this->Executions;
    vtkInformation* info = output->GetInformationObject(0);
    const double time = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      ? std::floor(info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
      : 0.0;
    auto* grid = vtkUnstructuredGrid::GetData(output);
    grid->ShallowCopy(this->Mesh);
    SetDisplacements(grid, Shift(this->Speed * time, 0.0, 0.0));
    grid->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    return 1;
  }
};
vtkStandardNewMacro(MovingLattice);

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
  auto volume = MakeVolume();
  vtkNew<MovingLattice> lattice;
  lattice->Mesh = MakeMesh(volume);
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationConnection(lattice->GetOutputPort());
  deformed.Filter->UpdateInformation();
  vtkInformation* info = deformed.Filter->GetOutputInformation(0);
  EXPECT_EQ(info->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()), 100);
  EXPECT_EQ(info->Get(vtkStreamingDemandDrivenPipeline::TIME_RANGE())[1], 99.0);
  Extent whole;
  info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
  EXPECT_EQ(whole, (Extent{ { 0, 9, 0, 8, 0, 7 } }));

  const auto check = [&](double time, int last, int first = 0)
  {
    vtkImageData* output = deformed.Filter->GetOutput();
    EXPECT_EQ(GetExtent(output), (Extent{ { first, last, 0, 8, 0, 7 } }));
    EXPECT_EQ(FindCoveredStart(deformed), static_cast<int>(lattice->Speed * time));
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
  lattice->Speed = 2.0;
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
    const int last = static_cast<int>(lattice->Speed * time) + 9;
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
