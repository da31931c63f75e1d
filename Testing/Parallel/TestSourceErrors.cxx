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

/// A source that fails on request, without an event for its observers.
template <typename Base>
class FailingSource : public Base
{
public:
  void SetFails(bool fails)
  {
    this->Fails = fails;
    this->Modified();
  }
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override
  {
    const bool isOfData = request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()) != 0;
    return isOfData && this->Fails ? 0 : this->Base::ProcessRequest(request, input, output);
  }

private:
  bool Fails = false;
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
void TestFailure(Pipeline& pipeline, Source* source, const std::string& words)
{
  const auto update = [&]
  {
    pipeline.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
    return pipeline.TakeErrors();
  };
  source->SetFails(GetRank() == GetRanks() - 1);
  EXPECT_EQ(update(), 1);
  EXPECT_TRUE(HasPart(pipeline.LastError, words));
  EXPECT_TRUE(HasPart(
    pipeline.LastError, "that the source reports. (On rank " + std::to_string(GetRanks() - 1)));
  EXPECT_EQ(pipeline.Filter->GetOutput()->GetNumberOfPoints(), 0);
  source->SetFails(false);
  EXPECT_EQ(update(), 0);
  EXPECT_GT(pipeline.Filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_GT(pipeline.Filter->GetNumberOfCoveredVoxels(), 0);
}

void TestFailures()
{
  const Case from = MakeCases()[2];
  {
    Pipeline pipeline(from);
    TestFailure(pipeline, pipeline.Volume.Get(), "volume on input port 0");
    TestFailure(pipeline, pipeline.Mesh.Get(), "deformation on input port 1");
  }
  {
    // The source fails after an update that succeeded.
    Pipeline pipeline(from);
    pipeline.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
    EXPECT_EQ(pipeline.TakeErrors(), 0);
    TestFailure(pipeline, pipeline.Mesh.Get(), "deformation on input port 1");
    TestFailure(pipeline, pipeline.Volume.Get(), "volume on input port 0");
  }
  {
    Pipeline pipeline(from);
    pipeline.Filter->SetRestConnection(pipeline.Rest->GetOutputPort());
    TestFailure(pipeline, pipeline.Rest.Get(), "mesh at rest on input port 2");
    // With these bounds, the filter does not need the mesh before RequestData().
    pipeline.Filter->SetOutputBoundsModeToVolumeBounds();
    TestFailure(pipeline, pipeline.Rest.Get(), "mesh at rest on input port 2");
    TestFailure(pipeline, pipeline.Volume.Get(), "volume on input port 0");
  }
}

} // namespace

int main(int argc, char* argv[])
{
  return RunOnRanks(argc, argv, TestFailures);
}
