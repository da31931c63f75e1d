// SPDX-License-Identifier: BSD-3-Clause
// Deforms a volume by a simulated body on several ranks: each rank makes its piece of the output,
// and all pieces equal the output of one process to the last bit, also after a cut.
#include "ChainMailTesting.h"
#include "DivisionCases.h"
#include "EditChecks.h"
#include "RankTesting.h"

#include <vtkFiniteElementDeformation.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkMassSpringDeformation.h>
#include <vtkUnstructuredGrid.h>

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

  glm::dvec3 GetWorld(const glm::dvec3& index) const
  {
    glm::dvec3 world;
    this->Volume->TransformContinuousIndexToPhysicalPoint(&index.x, &world.x);
    return world;
  }

  void Drag(double voxels)
  {
    const glm::dvec3 held(40.0, 18.0, 15.0);
    const glm::dvec3 other(-3.0, 18.0, 15.0);
    this->Body->SetHandlesData(
      MakeHandles({ { this->GetWorld(held), this->GetWorld(held + glm::dvec3(voxels, 0.0, 1.0)) },
        { this->GetWorld(other), this->GetWorld(other - glm::dvec3(voxels, 0.0, 0.0)) } }));
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
  const std::vector<Step> steps = { [](Pipeline<Model>& body) { body.Drag(2.0); },
    [](Pipeline<Model>& body) { body.Drag(4.0); },
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

} // namespace

int main(int argc, char* argv[])
{
  return RunOnRanks(argc, argv,
    []
    {
      TestSteps<vtkMassSpringDeformation>();
      TestSteps<vtkFiniteElementDeformation>();
    });
}
