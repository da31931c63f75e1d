// SPDX-License-Identifier: BSD-3-Clause
// A deformation that varies in time: the output's whole extent holds all time steps, and each time
// that is asked for gives that step.
#include "FilterTesting.h"

#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnstructuredGridAlgorithm.h>

#include <algorithm>

using namespace filterTesting;

namespace
{

/// A lattice that moves along x by 10 voxels in each of five time steps.
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
    const double times[5] = { 0.0, 1.0, 2.0, 3.0, 4.0 };
    const double range[2] = { 0.0, 4.0 };
    vtkInformation* info = output->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), times, 5);
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
    SetDisplacements(grid, Shift(this->Speed * std::clamp(time, 0.0, 4.0), 0.0, 0.0));
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

int TestDeformTime(int, char*[])
{
  auto volume = MakeVolume();
  vtkNew<MovingLattice> lattice;
  lattice->Mesh = MakeMesh(volume);
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationConnection(lattice->GetOutputPort());
  deformed.Filter->UpdateInformation();
  vtkInformation* info = deformed.Filter->GetOutputInformation(0);
  VERIFY_EQUAL(info->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()), 5);
  VERIFY_EQUAL(info->Get(vtkStreamingDemandDrivenPipeline::TIME_RANGE())[1], 4.0);
  Extent whole;
  info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
  const Extent expected{ { 0, 49, 0, 8, 0, 7 } };
  VERIFY_EQUAL(whole, expected);

  for (const double time : { 0.0, 3.0, 1.0, 4.0, 4.0 })
  {
    deformed.Filter->UpdateTimeStep(time);
    VERIFY_EQUAL(deformed.TakeErrors(), 0);
    vtkImageData* output = deformed.Filter->GetOutput();
    VERIFY_EQUAL(GetExtent(output), expected);
    VERIFY_EQUAL(FindCoveredStart(deformed), static_cast<int>(10.0 * time));
    VERIFY_EQUAL(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
    VERIFY_EQUAL(output->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), time);
  }
  VERIFY_EQUAL(deformed.Filter->GetNumberOfMappingBuilds(), 1);
  VERIFY_EQUAL(deformed.Filter->GetNumberOfVolumeUploads(), 1);
  // Once a step for the bounds, and at most once more for each change of the time asked for.
  VERIFY(lattice->Executions <= 5 + 5);

  // Slower: the union shrinks.
  lattice->Speed = 2.0;
  lattice->Modified();
  deformed.Filter->UpdateTimeStep(2.0);
  VERIFY_EQUAL(GetExtent(deformed.Filter->GetOutput()), (Extent{ { 0, 17, 0, 8, 0, 7 } }));
  VERIFY_EQUAL(FindCoveredStart(deformed), 4);

  // The volume's bounds need no look at the time steps.
  lattice->Executions = 0;
  lattice->Modified();
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  deformed.Filter->UpdateTimeStep(1.0);
  VERIFY_EQUAL(GetExtent(deformed.Filter->GetOutput()), GetExtent(volume));
  VERIFY_EQUAL(lattice->Executions, 1);
  return GetExitCode();
}
