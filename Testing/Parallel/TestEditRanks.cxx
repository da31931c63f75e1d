// SPDX-License-Identifier: BSD-3-Clause
// Cuts, carves and drags a volume on several ranks: each rank makes its piece of the output, and
// all pieces equal the output of one process to the last bit, after each step of the drag, after
// undo and redo, and in a folded volume.
#include "ArrayMaking.h"
#include "ChainMailTesting.h"
#include "DivisionCases.h"
#include "EditChecks.h"
#include "RankTesting.h"

#include <vtkCarveVolume.h>
#include <vtkCutVolume.h>
#include <vtkPointData.h>
#include <vtkShortArray.h>
#include <vtkSphere.h>

#include <functional>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

constexpr Extent Box{ { -3, 60, 2, 45, 0, 40 } };

/// A volume, the filters that edit it, and the filter that deforms the edited volume.
struct Pipeline
{
  explicit Pipeline(vtkImageData* volume)
    : Volume(volume)
  {
    this->Source->SetVolume(volume);
    this->Cut->SetInputConnection(this->Source->GetOutputPort());
    this->Cut->SetSheetData(MakePlane(volume, glm::dvec3(30.5, -2.0, -2.0),
      glm::dvec3(0.0, 60.0, 0.0), glm::dvec3(0.0, 0.0, 25.0)));
    const glm::dvec3 center = GetWorld(this->Volume, glm::dvec3(12.0, 20.0, 15.0));
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(center.x, center.y, center.z);
    sphere->SetRadius(6.0);
    this->Carve->SetInputConnection(this->Cut->GetOutputPort());
    this->Carve->SetImplicitFunction(sphere);
    this->ChainMail->SetInputConnection(this->Carve->GetOutputPort());
    this->ChainMail->SetRelaxationSweeps(2);
    this->Deform->SetInputConnection(this->Carve->GetOutputPort());
    this->Deform->SetDeformationConnection(this->ChainMail->GetOutputPort());
    this->Drag(0.0);
  }

  /// Drags one side of the cut by a number of voxels.
  void Drag(double voxels)
  {
    const glm::dvec3 held(36.0, 24.0, 20.0);
    this->ChainMail->SetHandlesData(MakeHandles({ { GetWorld(this->Volume, held),
      GetWorld(this->Volume, held + glm::dvec3(voxels, 0.3 * voxels, -0.4 * voxels)) } }));
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkNew<PartSource> Source;
  vtkNew<vtkCutVolume> Cut;
  vtkNew<vtkCarveVolume> Carve;
  vtkNew<vtkChainMailDeformation> ChainMail;
  vtkNew<vtkDeformVolumeFilter> Deform;
};

struct Step
{
  std::string Name;
  std::function<void(Pipeline&)> Do;
};

void TestSteps()
{
  auto volume = divisionCases::MakeVolume(Box, glm::dvec3(1.0, 1.5, 0.75));
  SetObliqueDirection(volume);
  const std::vector<Step> steps = {
    { "At rest", [](Pipeline&) {} },
    { "Begin", [](Pipeline& edited) { edited.Drag(4.0); } },
    { "Further", [](Pipeline& edited) { edited.Drag(9.0); } },
    { "Folded over", [](Pipeline& edited) { edited.Drag(22.0); } },
    { "Folded over, moved", [](Pipeline& edited) { edited.Drag(23.0); } },
    { "The hole is undone", [](Pipeline& edited) { edited.Carve->Undo(); } },
    { "Without the cut", [](Pipeline& edited) { edited.Cut->Undo(); } },
    { "Cut again",
      [](Pipeline& edited)
      {
        edited.Cut->Redo();
        edited.Carve->Redo();
        edited.Drag(6.0);
      } },
    { "Start anew",
      [](Pipeline& edited)
      {
        edited.ChainMail->Reset();
        edited.Drag(3.0);
      } },
    { "A smooth cut",
      [](Pipeline& edited)
      {
        edited.Cut->SmoothCutOn();
        edited.Drag(6.0);
      } },
    { "The smooth cut is opened further", [](Pipeline& edited) { edited.Drag(9.0); } },
    { "Its sides are folded over", [](Pipeline& edited) { edited.Drag(-22.0); } },
    { "Without the smooth cut", [](Pipeline& edited) { edited.Cut->Undo(); } },
  };
  Pipeline whole(volume);
  Pipeline mine(volume);
  vtkIdType off = 0;
  vtkIdType folded = 0;
  for (const Step& step : steps)
  {
    vtkIdType counts[2] = { 0, 0 }; // of tetrahedra that are switched off and inverted
    const auto expected = MakeOnFirstRank(
      [&]
      {
        step.Do(whole);
        whole.Deform->Update();
        counts[0] = whole.Carve->GetNumberOfSwitchedOffTetrahedra();
        counts[1] = whole.Deform->GetNumberOfInvertedTetrahedra();
        return whole.Deform->GetOutput();
      });
    Controller->Broadcast(counts, 2, 0);
    off = std::max(off, counts[0]);
    folded += counts[1] > 0;
    step.Do(mine);
    // As a view does. Together with the whole extent that Deform requests, this is one step.
    mine.ChainMail->UpdatePiece(GetRank(), GetRanks(), 0);
    CheckPiece(mine.Deform, expected, step.Name);
    EXPECT_EQ(mine.Carve->GetNumberOfSwitchedOffTetrahedra(), counts[0]);
  }
  EXPECT_GT(off, 1000);
  EXPECT_GT(folded, 1);
}

// A label that only one rank has is not reported as missing.
void TestLabel()
{
  auto volume = divisionCases::MakeVolume(Box, glm::dvec3(1.0));
  const auto labels = MakeArray<vtkShortArray>("labels", volume->GetNumberOfPoints());
  labels->Fill(0.0);
  labels->SetValue(labels->GetNumberOfValues() - 1, 2);
  volume->GetPointData()->AddArray(labels);
  vtkNew<PartSource> source;
  source->SetVolume(volume);
  Observed<vtkCarveVolume> carve;
  carve.Filter->SetInputConnection(source->GetOutputPort());
  carve.Filter->SetLabelArrayName("labels");
  carve.Filter->SetLabel(2);
  carve.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
  EXPECT_EQ(carve.Observer->GetWarningMessage(), "");
  EXPECT_EQ(carve.Observer->GetErrorMessage(), "");
}

} // namespace

int main(int argc, char* argv[])
{
  return RunOnRanks(argc, argv,
    []
    {
      TestSteps();
      TestLabel();
    });
}
