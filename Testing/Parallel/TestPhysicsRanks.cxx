// SPDX-License-Identifier: BSD-3-Clause
// Deforms a volume by a simulated body on several ranks: each rank makes its piece of the output,
// and all pieces equal the output of one process to the last bit, also after a cut. After an error,
// all ranks have the same result.
#include "ChainMailTesting.h"
#include "DivisionCases.h"
#include "EditChecks.h"
#include "RankTesting.h"

#include <vtkDeformationHandleSource.h>
#include <vtkFiniteElementDeformation.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkMassSpringDeformation.h>
#include <vtkPolyData.h>
#include <vtkTetGenMesher.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>
#include <functional>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

constexpr Extent Box{ { -3, 40, 2, 35, 0, 30 } };

/// A volume, and a body that deforms it.
template <typename Model>
struct Pipeline
{
  explicit Pipeline(vtkImageData* volume)
    : Volume(volume)
  {
    this->Source->SetVolume(volume);
    this->Lattice->SetInputData(volume);
    this->Lattice->SetNumberOfNodes(9, 8, 7);
    this->Body->SetInputConnection(this->Lattice->GetOutputPort());
    this->Body->SetHandleRadius(6.0);
    this->Deform->SetInputConnection(this->Source->GetOutputPort());
    this->Deform->SetDeformationConnection(this->Body->GetOutputPort());
    this->Deform->OpenSplitsOn();
    this->Drag(0.0);
  }

  void Drag(double voxels)
  {
    const glm::dvec3 held(40.0, 18.0, 15.0);
    const glm::dvec3 other(-3.0, 18.0, 15.0);
    this->Body->SetHandlesData(
      MakeHandles({ { GetWorld(this->Volume, held),
                      GetWorld(this->Volume, held + glm::dvec3(voxels, 0.0, 1.0)) },
        { GetWorld(this->Volume, other),
          GetWorld(this->Volume, other - glm::dvec3(voxels, 0.0, 0.0)) } }));
  }

  /// Requests the piece of this rank, as a view does, or the whole mesh if this is the only
  /// process.
  void Show()
  {
    const bool isAlone = !vtkMultiProcessController::GetGlobalController();
    this->Body->UpdatePiece(isAlone ? 0 : GetRank(), isAlone ? 1 : GetRanks(), 0);
  }

  void Cut()
  {
    this->Body->SetSheetData(MakePlane(this->Volume, glm::dvec3(18.3, -2.0, 15.0),
      glm::dvec3(0.0, 60.0, 0.0), glm::dvec3(0.0, 0.0, 60.0)));
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkNew<PartSource> Source;
  vtkNew<vtkLatticeTetrahedraSource> Lattice;
  vtkNew<Model> Body;
  vtkNew<vtkDeformVolumeFilter> Deform;
};

template <typename Model>
void TestSteps()
{
  auto volume = divisionCases::MakeVolume(Box, glm::dvec3(1.0, 1.5, 0.75));
  SetObliqueDirection(volume);
  using Step = std::function<void(Pipeline<Model>&)>;
  const std::vector<Step> steps = { [](Pipeline<Model>& body)
    {
      body.Drag(2.0);
      body.Show(); // one step with the whole mesh that Deform requests
    },
    [](Pipeline<Model>& body)
    {
      body.Drag(3.0);
      body.Show();
      body.Drag(4.0);
    },
    [](Pipeline<Model>& body)
    {
      body.Cut();
      body.Drag(6.0);
    },
    [](Pipeline<Model>& body) { body.Body->UndoCut(); } };
  Pipeline<Model> whole(volume);
  Pipeline<Model> mine(volume);
  for (const Step& step : steps)
  {
    const auto expected = MakeOnFirstRank(
      [&]
      {
        step(whole);
        whole.Deform->Update();
        return whole.Deform->GetOutput();
      });
    step(mine);
    CheckPiece(mine.Deform, expected, mine.Body->GetClassName());
  }
}

/// Updates a filter that fails on the first rank, or on all. Ranks with different results would
/// wait for each other forever in filters downstream that communicate.
template <typename Filter>
void TestFailure(Observed<Filter>& observed, bool failsOnAll = false)
{
  for (int repeat = 0; repeat < 2; ++repeat) // nothing changes before the second update
  {
    const int result = observed.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
    EXPECT_EQ(result, GetRanks() > 1 ? 1 : 0) << observed.Filter->GetClassName();
    EXPECT_EQ(observed.Observer->GetError(), failsOnAll || GetRank() == 0)
      << observed.Filter->GetClassName();
    EXPECT_EQ(observed.Filter->GetOutput()->GetNumberOfPoints(), 0);
    observed.ClearMessages();
  }
}

template <typename Filter>
void TestSuccess(Observed<Filter>& observed)
{
  EXPECT_EQ(observed.Filter->UpdatePiece(GetRank(), GetRanks(), 0), 1);
  EXPECT_EQ(observed.Observer->GetErrorMessage(), "");
  EXPECT_EQ(observed.Filter->GetOutput()->GetNumberOfPoints() > 0, GetRank() == 0);
}

void TestErrors()
{
  Observed<vtkLatticeTetrahedraSource> lattice;
  lattice.Filter->SetNumberOfNodes(1, 3, 3);
  TestFailure(lattice);
  lattice.Filter->SetNumberOfNodes(3, 3, 3);
  TestSuccess(lattice);

  Observed<vtkFiniteElementDeformation> body;
  body.Filter->SetInputConnection(lattice.Filter->GetOutputPort());
  body.Filter->SetHandlesData(MakeHandles({ { glm::dvec3(0.5), glm::dvec3(0.5, 0.5, 0.6) } }));
  body.Filter->SetHandleRadius(0.6);
  body.Filter->SetPoissonRatio(0.6);
  TestFailure(body, true);
  body.Filter->SetPoissonRatio(0.3);
  TestSuccess(body);

  Observed<vtkDeformationHandleSource> handle;
  handle.Filter->SetPosition(0.0, std::nan(""), 0.0);
  TestFailure(handle);
  handle.Filter->SetPosition(0.0, 1.0, 0.0);
  TestSuccess(handle);

  Observed<vtkTetGenMesher> mesher; // without a success, because TetGen may not be installed
  mesher.Filter->SetInputData(divisionCases::MakeVolume(Box, glm::dvec3(1.0)));
  mesher.Filter->SetTetGenExecutable("/no/such/program");
  TestFailure(mesher);
}

} // namespace

int main(int argc, char* argv[])
{
  return RunOnRanks(argc, argv,
    []
    {
      TestSteps<vtkMassSpringDeformation>();
      TestSteps<vtkFiniteElementDeformation>();
      TestErrors();
    });
}
