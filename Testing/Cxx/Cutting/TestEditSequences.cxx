// SPDX-License-Identifier: BSD-3-Clause
// Random cuts, carvings, drags, undo and redo in one pipeline. After each step it is compared with
// filters without a history: new filters make the masks from all edits, a second ChainMail model
// computes displacements from copies without logs, and a second deformation filter resamples the
// whole volume. At the end all edits are undone, and the output must be equal, bit by bit, to the
// output without edits.
#include "ChainMailTesting.h"
#include "EditChecks.h"

#include <vtkCarveVolume.h>
#include <vtkCutVolume.h>
#include <vtkSphere.h>

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <random>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

constexpr Extent EditedBox{ { -2, 45, 1, 36, 0, 28 } };

vtkUnsignedCharArray* GetMask(vtkImageData* volume)
{
  return vtkUnsignedCharArray::SafeDownCast(volume->GetCellData()->GetArray("ActiveTetrahedra"));
}

// Arrays that exist only with smooth boundaries and smooth cuts.
std::array<vtkDataArray*, 3> GetOthers(vtkImageData* volume)
{
  return { { volume->GetPointData()->GetArray("BoundaryDistance"),
    volume->GetCellData()->GetArray("CutTetrahedra"),
    volume->GetPointData()->GetArray("CutDistance") } };
}

bool HaveSameOthers(vtkImageData* first, vtkImageData* second)
{
  const std::array<vtkDataArray*, 3> a = GetOthers(first);
  const std::array<vtkDataArray*, 3> b = GetOthers(second);
  return std::equal(a.begin(), a.end(), b.begin(),
    [](vtkDataArray* one, vtkDataArray* other)
    { return one || other ? HaveEqualBits(one, other) : true; });
}

vtkSmartPointer<vtkImageData> Copy(vtkImageData* image)
{
  auto copy = vtkSmartPointer<vtkImageData>::New();
  copy->DeepCopy(image);
  return copy;
}

/// The current edits of a filter, and those that were undone.
template <typename FilterT>
class History
{
public:
  using Edit = std::function<void(FilterT*)>;

  explicit History(FilterT* filter)
    : Filter(filter)
  {
    this->Filter->AccumulateOn();
  }

  /// Update the filter after each call of Do(), Undo() or Redo().
  void Do(const Edit& edit)
  {
    edit(this->Filter);
    this->Done.push_back(edit);
    this->Undone.clear();
  }
  void Undo() { this->Move(this->Done, this->Undone, &FilterT::Undo); }
  void Redo() { this->Move(this->Undone, this->Done, &FilterT::Redo); }
  bool HasDone() const { return !this->Done.empty(); }

  /// The output of a new filter with the same edits.
  vtkSmartPointer<vtkImageData> Repeat(vtkImageData* volume) const
  {
    Edited<FilterT> fresh;
    fresh.Filter->AccumulateOn();
    fresh.Filter->SetInputData(volume);
    fresh.Update();
    for (const Edit& edit : this->Done)
    {
      edit(fresh.Filter);
      fresh.Update();
    }
    return fresh.Filter->GetOutput();
  }

private:
  void Move(std::vector<Edit>& from, std::vector<Edit>& to, void (FilterT::*command)())
  {
    (this->Filter->*command)(); // called even if there is no such edit
    if (!from.empty())
    {
      to.push_back(from.back());
      from.pop_back();
    }
  }

  FilterT* Filter;
  std::vector<Edit> Done;
  std::vector<Edit> Undone;
};

class Sequence
{
public:
  explicit Sequence(unsigned seed)
    : Random(seed)
  {
    SetObliqueDirection(this->Volume);
    this->Cut->SetInputData(this->Volume);
    this->Carve->SetInputConnection(this->Cut->GetOutputPort());
    this->ChainMail.Filter->SetInputConnection(this->Carve->GetOutputPort());
    this->Output.Filter->SetInputConnection(this->Carve->GetOutputPort());
    this->Output.Filter->SetDeformationConnection(this->ChainMail.Filter->GetOutputPort());
    SetBounds(this->Output.Filter);
    SetBounds(this->Wanted.Filter);
    this->Wanted.Filter->IncrementalOff();
    this->Drag();
  }

  void Step()
  {
    switch (this->Random() % 10)
    {
      case 0:
        this->Cuts.Do(this->MakeSheetEdit());
        break;
      case 1:
      case 2:
        this->Carvings.Do(this->MakeSphereEdit());
        break;
      case 3:
        this->Cuts.Undo();
        break;
      case 4:
        this->Cuts.Redo();
        break;
      case 5:
        this->Carvings.Undo();
        break;
      case 6:
        this->Carvings.Redo();
        break;
      case 7:
        this->Sweeps = static_cast<int>(this->Random() % 3);
        break;
      default:
        this->Drag();
    }
    if (this->Random() % 40 == 0)
    {
      this->ChainMail.Filter->Reset();
      this->Twin.Filter->Reset();
    }
    this->Compare();
  }

  void UndoAll()
  {
    while (this->Cuts.HasDone() || this->Carvings.HasDone())
    {
      this->Cuts.Undo();
      this->Carvings.Undo();
      this->Compare();
    }
    this->Handles.clear();
    this->ChainMail.Filter->Reset();
    this->Twin.Filter->Reset();
    this->Compare();
    vtkUnsignedCharArray* mask = GetMask(this->Carve->GetOutput());
    EXPECT_TRUE(std::all_of(mask->GetPointer(0), mask->GetPointer(0) + mask->GetNumberOfTuples(),
      [](unsigned char byte) { return byte == 31; }));
    EXPECT_TRUE(HaveSameOthers(this->Carve->GetOutput(), this->Volume));
    // The output must be equal to the output of the volume without edits.
    Deformed rest(this->Volume, this->Twin.Filter->GetOutput());
    SetBounds(rest.Filter);
    EXPECT_TRUE(AreEqual(this->Output.Filter->GetOutput(), rest.Update()));
    EXPECT_EQ(rest.Filter->GetNumberOfCoveredVoxels(), this->Volume->GetNumberOfPoints());
  }

  int Parts = 0;       // number of outputs that were updated in part
  int FoldedParts = 0; // number of these in which the volume overlapped itself

private:
  double GetNumber(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(this->Random);
  }
  // With these bounds all outputs have one extent, so they can be updated in part.
  static void SetBounds(vtkDeformVolumeFilter* filter)
  {
    filter->SetOutputBoundsModeToVolumeBounds();
    filter->SetPadding(6);
  }
  glm::dvec3 GetIndex(double margin)
  {
    return { this->GetNumber(EditedBox[0] - margin, EditedBox[1] + margin),
      this->GetNumber(EditedBox[2] - margin, EditedBox[3] + margin),
      this->GetNumber(EditedBox[4] - margin, EditedBox[5] + margin) };
  }

  History<vtkCutVolume>::Edit MakeSheetEdit()
  {
    const auto sheet =
      MakeSheet(this->Volume, { this->GetIndex(4.0), this->GetIndex(4.0), this->GetIndex(4.0) });
    const bool smooth = this->Random() % 2 == 0;
    return [=](vtkCutVolume* cut)
    {
      cut->SetSheetData(sheet);
      cut->SetSmoothCut(smooth);
    };
  }

  History<vtkCarveVolume>::Edit MakeSphereEdit()
  {
    const auto sphere = vtkSmartPointer<vtkSphere>::New();
    const glm::dvec3 center = GetWorld(this->Volume, this->GetIndex(0.0));
    sphere->SetCenter(center.x, center.y, center.z);
    sphere->SetRadius(this->GetNumber(0.5, 6.0));
    const int rule = static_cast<int>(this->Random() % 3);
    const bool smooth = this->Random() % 2 == 0;
    return [=](vtkCarveVolume* carve)
    {
      carve->SetImplicitFunction(sphere);
      carve->SetRule(rule);
      carve->SetSmoothBoundary(smooth);
    };
  }

  // Sets one or two handles. Some are moved far enough to fold the volume.
  void Drag()
  {
    this->Handles.clear();
    const double most = this->Random() % 4 == 0 ? 12.0 : 3.0;
    for (unsigned i = 0; i < 1 + this->Random() % 2; ++i)
    {
      const glm::dvec3 held = glm::round(this->GetIndex(0.0));
      const glm::dvec3 by(
        this->GetNumber(-most, most), this->GetNumber(-most, most), this->GetNumber(-most, most));
      this->Handles.push_back({ GetWorld(this->Volume, held), GetWorld(this->Volume, held + by) });
    }
  }

  // Updates all filters, and compares their outputs.
  void Compare()
  {
    for (Dragged* one : { &this->ChainMail, &this->Twin })
    {
      one->Filter->SetHandlesData(MakeHandles(this->Handles));
      one->Filter->SetRelaxationSweeps(this->Sweeps);
    }
    vtkImageData* output = this->Output.Update();
    const bool isPart = GetReported(this->Output.Filter, "Bricks resampled") <
      GetReported(this->Output.Filter, "Bricks of the volume");

    const auto cut = this->Cuts.Repeat(this->Volume);
    const auto edited = this->Carvings.Repeat(cut);
    EXPECT_TRUE(HaveEqualBits(GetMask(this->Cut->GetOutput()), GetMask(cut)));
    EXPECT_TRUE(HaveEqualBits(GetMask(this->Carve->GetOutput()), GetMask(edited)));
    EXPECT_TRUE(HaveSameOthers(this->Carve->GetOutput(), edited));

    const auto copy = Copy(edited);
    this->Twin.Filter->SetInputData(copy);
    this->Twin.Filter->Update();
    const auto field = Copy(this->Twin.Filter->GetOutput());
    EXPECT_TRUE(HaveEqualBits(this->ChainMail.Filter->GetOutput()->GetPointData()->GetVectors(),
      field->GetPointData()->GetVectors()));

    this->Wanted.Filter->SetInputData(copy);
    this->Wanted.Filter->SetDeformationData(field);
    EXPECT_TRUE(AreEqual(output, this->Wanted.Update()));
    const vtkIdType inverted = this->Wanted.Filter->GetNumberOfInvertedTetrahedra();
    EXPECT_EQ(this->Output.Filter->GetNumberOfInvertedTetrahedra(), inverted);
    EXPECT_EQ(this->Output.Filter->GetNumberOfCoveredVoxels(),
      this->Wanted.Filter->GetNumberOfCoveredVoxels());
    this->Parts += isPart;
    this->FoldedParts += isPart && inverted > 0;
  }

  std::mt19937 Random;
  vtkSmartPointer<vtkImageData> Volume = MakeVolume(EditedBox);
  vtkNew<vtkCutVolume> Cut;
  vtkNew<vtkCarveVolume> Carve;
  History<vtkCutVolume> Cuts{ this->Cut };
  History<vtkCarveVolume> Carvings{ this->Carve };
  std::vector<Handle> Handles;
  int Sweeps = 0;
  Dragged ChainMail{ nullptr };
  Dragged Twin{ nullptr };
  Deformed Output;
  Deformed Wanted;
};

} // namespace

// --gtest_random_seed=N selects other edits.
TEST(EditSequences, EqualNewFilters)
{
  Sequence sequence(3 + static_cast<unsigned>(GTEST_FLAG_GET(random_seed)));
  for (int step = 0; step < 150 && !HasFailure(); ++step)
  {
    SCOPED_TRACE(testing::Message() << "step " << step);
    sequence.Step();
  }
  sequence.UndoAll();
  std::cout << sequence.Parts << " outputs were updated in part, " << sequence.FoldedParts
            << " of them folded\n";
  EXPECT_GT(sequence.FoldedParts, 10);
}
