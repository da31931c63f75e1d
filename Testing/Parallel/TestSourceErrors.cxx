// SPDX-License-Identifier: BSD-3-Clause
// Tests sources that fail on one rank, such as a reader that cannot read its file there: all ranks
// report the error, none waits for another, and the filter works when the source works again.
#include "DivisionCases.h"
#include "RankTesting.h"

#include <vtkExecutive.h>
#include <vtkUnstructuredGridAlgorithm.h>

using namespace divisionCases;

namespace
{

enum class Failure
{
  None,
  Data,
  Information
};

/// A source that fails on request, without an event for its observers.
template <typename Base>
class FailingSource : public Base
{
public:
  void Fail(Failure how)
  {
    this->How = how;
    this->Modified();
  }
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override
  {
    const bool data = request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()) != 0;
    const bool information = request->Has(vtkDemandDrivenPipeline::REQUEST_INFORMATION()) != 0;
    if ((data && this->How == Failure::Data) || (information && this->How == Failure::Information))
    {
      return 0;
    }
    return this->Base::ProcessRequest(request, input, output);
  }

private:
  Failure How = Failure::None;
};

class MeshSource : public vtkUnstructuredGridAlgorithm
{
public:
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;

protected:
  MeshSource() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    // Without this, the executive updates the source on the first rank only.
    output->GetInformationObject(0)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    vtkUnstructuredGrid::GetData(output)->ShallowCopy(this->Mesh);
    return 1;
  }
};

class FailingVolume : public FailingSource<PartSource>
{
public:
  static FailingVolume* New();
  vtkTypeMacro(FailingVolume, PartSource);
};
vtkStandardNewMacro(FailingVolume);

class FailingMesh : public FailingSource<MeshSource>
{
public:
  static FailingMesh* New();
  vtkTypeMacro(FailingMesh, MeshSource);
};
vtkStandardNewMacro(FailingMesh);

struct Pipeline : Deformed
{
  explicit Pipeline(const Case& from)
  {
    this->Volume->SetVolume(from.Volume);
    for (FailingMesh* mesh : { this->Mesh.Get(), this->Rest.Get() })
    {
      mesh->Mesh = vtkUnstructuredGrid::SafeDownCast(from.Deformation);
    }
    this->Filter->SetInputConnection(this->Volume->GetOutputPort());
    this->Filter->SetDeformationConnection(this->Mesh->GetOutputPort());
    for (vtkAlgorithm* source : std::initializer_list<vtkAlgorithm*>{
           this->Volume.Get(), this->Mesh.Get(), this->Rest.Get() })
    {
      source->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, this->SourceObserver);
    }
    from.Set(this->Filter);
  }
  vtkNew<FailingVolume> Volume;
  vtkNew<FailingMesh> Mesh;
  vtkNew<FailingMesh> Rest;
  vtkNew<vtkTest::ErrorObserver> SourceObserver;
};

template <typename Source>
void TestFailure(Pipeline& pipeline, Source* source, Failure how, vtkMPIController* controller,
  const std::string& words)
{
  const int rank = controller->GetLocalProcessId();
  const int ranks = controller->GetNumberOfProcesses();
  const auto update = [&]
  {
    pipeline.Filter->UpdatePiece(rank, ranks, 0);
    return pipeline.TakeErrors();
  };
  source->Fail(rank == ranks - 1 ? how : Failure::None);
  EXPECT_EQ(update(), 1);
  EXPECT_TRUE(HasPart(pipeline.LastError, words));
  EXPECT_EQ(pipeline.Filter->GetOutput()->GetNumberOfPoints(), 0);
  source->Fail(Failure::None);
  EXPECT_EQ(update(), 0);
  EXPECT_GT(pipeline.Filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_GT(pipeline.Filter->GetNumberOfCoveredVoxels(), 0);
}

void TestFailures(vtkMPIController* controller)
{
  const Case from = MakeCases()[2];
  {
    Pipeline pipeline(from);
    TestFailure(
      pipeline, pipeline.Volume.Get(), Failure::Data, controller, "volume on input port 0");
    TestFailure(
      pipeline, pipeline.Mesh.Get(), Failure::Data, controller, "deformation on input port 1");
  }
  {
    // The source fails after an update that succeeded.
    Pipeline pipeline(from);
    pipeline.Filter->UpdatePiece(
      controller->GetLocalProcessId(), controller->GetNumberOfProcesses(), 0);
    EXPECT_EQ(pipeline.TakeErrors(), 0);
    TestFailure(
      pipeline, pipeline.Mesh.Get(), Failure::Data, controller, "deformation on input port 1");
    TestFailure(
      pipeline, pipeline.Volume.Get(), Failure::Data, controller, "volume on input port 0");
  }
  {
    Pipeline pipeline(from);
    pipeline.Filter->SetRestConnection(pipeline.Rest->GetOutputPort());
    TestFailure(pipeline, pipeline.Rest.Get(), Failure::Data, controller,
      "rest configuration on input port 2");
    // With these bounds, the filter does not need the mesh before RequestData().
    pipeline.Filter->SetOutputBoundsModeToVolumeBounds();
    TestFailure(pipeline, pipeline.Rest.Get(), Failure::Data, controller,
      "rest configuration on input port 2");
    TestFailure(
      pipeline, pipeline.Volume.Get(), Failure::Data, controller, "volume on input port 0");
  }
}

} // namespace

int main(int argc, char* argv[])
{
  return RunOnRanks(argc, argv, TestFailures);
}
