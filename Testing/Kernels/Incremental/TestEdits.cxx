// SPDX-License-Identifier: BSD-3-Clause
// After random edits, and with outputs in various memory, an incremental update equals the whole
// output of another deformer, bit by bit. --gtest_random_seed=N selects other edits.
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

/// Memory for an output. The memory of the first array may begin at an odd address. Such memory is
/// not aligned for 2-byte numbers, so it is not written in place.
struct Memory
{
  Memory(const EditedVolume& volume, bool isAligned)
    : IsAligned(isAligned)
  {
    const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(volume.Output));
    this->Shorts.assign(2 * voxels + 1, 77);
    this->Floats.assign(voxels, 777.0F);
    this->Labels.assign(2 * voxels, 777);
    this->Coverage.assign(voxels, 7);
  }

  std::vector<void*> GetArrays()
  {
    return { this->Shorts.data() + (this->IsAligned ? 0 : 1), this->Floats.data(),
      this->Labels.data() };
  }

  bool Holds(const EditedOutputs& outputs)
  {
    return this->Coverage == outputs.Coverage && this->Labels == outputs.Labels &&
      std::memcmp(this->GetArrays()[0], outputs.Shorts.data(), 2 * outputs.Shorts.size()) == 0 &&
      std::memcmp(
        this->Floats.data(), outputs.Floats.data(), outputs.Floats.size() * sizeof(float)) == 0;
  }

  bool IsAligned;
  std::uint64_t Revision = 0;
  std::vector<char> Shorts;
  std::vector<float> Floats;
  std::vector<std::uint16_t> Labels;
  std::vector<signed char> Coverage;
};

// Whether two outputs are the same outside an extent.
bool AreSameOutside(const EditedOutputs& first, const EditedOutputs& second, const Extent& output,
  const Extent& extent)
{
  std::size_t i = 0;
  for (int z = output[4]; z <= output[5]; ++z)
  {
    for (int y = output[2]; y <= output[3]; ++y)
    {
      for (int x = output[0]; x <= output[1]; ++x, ++i)
      {
        const bool isInside = x >= extent[0] && x <= extent[1] && y >= extent[2] &&
          y <= extent[3] && z >= extent[4] && z <= extent[5];
        const bool isSame = first.Shorts[i] == second.Shorts[i] &&
          first.Floats[i] == second.Floats[i] && first.Labels[2 * i] == second.Labels[2 * i] &&
          first.Labels[2 * i + 1] == second.Labels[2 * i + 1] &&
          first.Coverage[i] == second.Coverage[i];
        if (!isInside && !isSame)
        {
          return false;
        }
      }
    }
  }
  return true;
}

enum class Where
{
  InPlace,       // overwrites the last output
  OtherMemory,   // memory with the output before the last one: only differences are written
  NewMemory,     // memory without an earlier output
  UnevenAddress, // like NewMemory, but at an odd address
  Count
};

class Edits : public WayTest
{
protected:
  struct Kind
  {
    const char* Name;
    int Weight; // relative frequency
    void (Edits::*Apply)();
  };

  void SetUp() override
  {
    this->Volume.Method = GetMethod();
    // Cubic interpolation always uses the kernel by cells.
    if (GetMethod() == Resampling::ExactByCell && GetRoute() != Route::Runs)
    {
      this->Volume.Interpolation = Interpolation::Cubic;
    }
    this->Whole = std::make_unique<VolumeDeformer>();
    this->Volume.SendAll(*this->Whole, GetRoute());
    this->Volume.SendAll(this->Updated, GetRoute());
  }

  // A random index below count.
  std::size_t Pick(std::size_t count) { return this->Random() % count; }
  float PickFrom(float least, float most)
  {
    return std::uniform_real_distribution<float>(least, most)(this->Random);
  }

  // Displacements
  void MoveNode() { this->Volume.Move(this->Random, 0, 1.5F); }
  void MoveNodeInside() { this->Volume.MoveInside(this->Random, 2.0F); }
  void MoveRegion() { this->Volume.Move(this->Random, 1, 1.5F); }
  void MoveHalf() { this->Volume.Move(this->Random, 5, 1.0F); }
  void MoveAll() { this->Volume.Move(this->Random, 100, 1.5F); }
  void Fold() { this->Volume.Move(this->Random, 0, 14.0F); }
  void FoldInside() { this->Volume.MoveInside(this->Random, 14.0F); }
  // Puts samples on creases.
  void MoveByWholeVoxels()
  {
    std::transform(this->Volume.Displacements.begin(), this->Volume.Displacements.end(),
      this->Volume.Displacements.begin(), [](float v) { return v > 7.0F ? 8.0F : v; });
  }
  void LetGo()
  {
    std::fill(this->Volume.Displacements.begin(), this->Volume.Displacements.end(), 0.25F);
  }
  void DoNothing() {}

  // Masks
  void Blank()
  {
    this->Volume.Blanked.resize(GetNumberOfPoints(this->Volume.Shape.VertexExtent));
    this->Volume.Blanked[this->Pick(this->Volume.Blanked.size())] ^= 1;
  }
  void SwitchTetrahedra()
  {
    this->Volume.Active.resize(GetNumberOfCells(this->Volume.Shape.VertexExtent), 31);
    this->Volume.Active[this->Pick(this->Volume.Active.size())] = this->Random() % 32;
  }
  void ChangeDistance()
  {
    this->Volume.Distances.resize(GetNumberOfPoints(this->Volume.Shape.VertexExtent), 1.0F);
    this->Volume.Distances[this->Pick(this->Volume.Distances.size())] =
      static_cast<float>(this->Random() % 64) / 16.0F - 2.0F;
  }
  void TakeMasksAway()
  {
    this->Volume.Blanked.clear();
    this->Volume.Active.clear();
    this->Volume.Distances.clear();
  }

  // The smooth cut
  void Cut()
  {
    this->Volume.CutAlong(this->PickFrom(50.0F, 75.0F), this->PickFrom(0.0F, 0.3F), 99);
    this->AllCrossed = this->Volume.Crossed;
    // Some cuts end inside the volume.
    if (this->Random() % 2)
    {
      this->Volume.CutAlong(70.0, 0.2, 30);
    }
  }
  void ChangeCut() { this->Volume.EditCut(this->AllCrossed, this->Random); }
  void JoinCut() { this->Volume.Crossed.clear(); }

  // The mesh, the volume and the request
  void Split()
  {
    if (GetRoute() == Route::Field)
    {
      return; // there are no nodes
    }
    const std::vector<TetrahedronChange> changes = this->Volume.Split(this->Random, 60);
    for (VolumeDeformer* deformer : { this->Whole.get(), &this->Updated })
    {
      deformer->ChangeConnectivity(this->Volume.Tetrahedra.data(), this->Volume.Tetrahedra.size(),
        this->Volume.GetNumberOfNodes(), this->Random() % 4 ? &changes : nullptr);
    }
    this->IsSplit = true;
  }
  void ChangeExtent()
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const Extent& extent = this->Volume.Shape.VertexExtent;
      this->Volume.Output[2 * axis] = extent[2 * axis] - static_cast<int>(this->Pick(8)) + 4;
      this->Volume.Output[2 * axis + 1] =
        extent[2 * axis + 1] + static_cast<int>(this->Pick(8)) - 4;
    }
    this->HasSameExtent = false;
  }
  void ChangeBackground() { this->Volume.Background += 1.0; }
  void ChangeValue()
  {
    this->Volume.Arrays.Shorts[this->Pick(this->Volume.Arrays.Shorts.size())] ^= 1;
    for (VolumeDeformer* deformer : { this->Whole.get(), &this->Updated })
    {
      deformer->SetArrays(this->Volume.GetArrays());
    }
  }
  void Abort() { this->Aborts = true; }

  static const std::vector<Kind>& GetKinds()
  {
    // Small edits are more frequent: only these lead to partial updates.
    static const std::vector<Kind> kinds{
      { "a node moves", 6, &Edits::MoveNode },
      { "a node inside moves", 6, &Edits::MoveNodeInside },
      { "a region moves", 3, &Edits::MoveRegion },
      { "half of the nodes move", 1, &Edits::MoveHalf },
      { "all nodes move", 1, &Edits::MoveAll },
      { "a node folds its cells", 1, &Edits::Fold },
      { "a node inside folds its cells", 2, &Edits::FoldInside },
      { "whole voxels", 1, &Edits::MoveByWholeVoxels },
      { "the deformation is reset", 1, &Edits::LetGo },
      { "nothing", 1, &Edits::DoNothing },
      { "a voxel is blanked or not", 3, &Edits::Blank },
      { "tetrahedra of a cell", 3, &Edits::SwitchTetrahedra },
      { "a boundary distance", 2, &Edits::ChangeDistance },
      { "no masks", 1, &Edits::TakeMasksAway },
      { "another cut", 1, &Edits::Cut },
      { "the cut in a box", 4, &Edits::ChangeCut },
      { "no cut", 1, &Edits::JoinCut },
      { "nodes are split", 1, &Edits::Split },
      { "another extent", 1, &Edits::ChangeExtent },
      { "another background", 1, &Edits::ChangeBackground },
      { "a value", 1, &Edits::ChangeValue },
      { "an update that is aborted", 1, &Edits::Abort },
    };
    return kinds;
  }

  // Each series of edits begins folded or cut, in turn: random edits rarely lead to both.
  void Begin(int turn)
  {
    const bool isFolded = turn % 4 == 1 || turn % 4 == 2;
    const bool isCut = turn % 4 == 1 || turn % 4 == 3;
    this->LetGo();
    if (isFolded)
    {
      this->FoldInside();
    }
    if (isCut)
    {
      this->Cut();
    }
    else
    {
      this->JoinCut();
    }
  }

  const Kind& PickKind()
  {
    int sum = 0;
    for (const Kind& kind : GetKinds())
    {
      sum += kind.Weight;
    }
    int remaining = static_cast<int>(this->Pick(static_cast<std::size_t>(sum)));
    for (const Kind& kind : GetKinds())
    {
      remaining -= kind.Weight;
      if (remaining < 0)
      {
        return kind;
      }
    }
    return GetKinds().back();
  }

  // Sends the edits to both deformers. In half of the cases the updated one also gets the ranges of
  // changed displacements.
  void Send(const std::vector<float>& before)
  {
    const bool isKnown = this->Random() % 2 && before.size() == this->Volume.Displacements.size();
    const PointRanges changes =
      isKnown ? this->Volume.FindChanges(before, this->Random) : PointRanges();
    for (VolumeDeformer* deformer : { this->Whole.get(), &this->Updated })
    {
      deformer->SetArrayOptions(this->Volume.GetArrays());
      this->Volume.SendMasks(*deformer);
      this->Volume.SendDisplacements(
        *deformer, GetRoute(), isKnown && deformer == &this->Updated ? &changes : nullptr);
    }
  }

  std::shared_ptr<Memory> PickMemory(Where where)
  {
    if (this->Last && this->HasSameExtent)
    {
      if (where == Where::InPlace)
      {
        return this->Last;
      }
      if (where == Where::OtherMemory && this->BeforeLast)
      {
        return this->BeforeLast;
      }
    }
    return std::make_shared<Memory>(this->Volume, where != Where::UnevenAddress);
  }

  DeformRequest MakeRequest(Memory& memory)
  {
    DeformRequest request;
    request.Method = this->Volume.Method;
    request.Interpolation = this->Volume.Interpolation;
    request.OutputExtent = this->Volume.Output;
    request.Outputs = memory.GetArrays();
    request.Coverage = memory.Coverage.data();
    request.Incremental = true;
    if (this->Last)
    {
      const std::vector<void*> last = this->Last->GetArrays();
      request.LastOutputs.assign(last.begin(), last.end());
      request.LastCoverage = this->Last->Coverage.data();
    }
    request.OutputRevision = &memory == this->Last.get() ? 0 : memory.Revision;
    return request;
  }

  void Update(Where where)
  {
    const std::shared_ptr<Memory> memory = this->PickMemory(where);
    DeformRequest request = this->MakeRequest(*memory);
    if (this->Aborts)
    {
      request.Progress = [](double) { return false; };
      this->MoveNode();
      this->Volume.SendDisplacements(this->Updated, GetRoute());
      EXPECT_THROW(this->Updated.Deform(request), Aborted);
      this->Volume.SendDisplacements(*this->Whole, GetRoute());
      request.Progress = nullptr;
      if (this->Random() % 2)
      {
        request.LastOutputs.clear();
      }
    }
    auto expected = std::make_unique<EditedOutputs>(this->Volume);
    const DeformReport wanted = this->Whole->Deform(expected->MakeRequest(this->Volume));
    const DeformReport report = this->Updated.Deform(request);
    if (!this->Aborts)
    {
      ExpectSame(report, wanted);
    }
    ASSERT_TRUE(memory->Holds(*expected));
    EXPECT_EQ(wanted.NumberOfResampledBricks, wanted.NumberOfBricks);
    EXPECT_EQ(wanted.ChangedExtent, this->Volume.Output);
    if (this->Last && memory != this->Last)
    {
      EXPECT_TRUE(this->Last->Holds(*this->LastExpected))
        << "an update changed the previous output";
    }
    if (this->Last && this->HasSameExtent && !this->Aborts)
    {
      EXPECT_TRUE(
        AreSameOutside(*this->LastExpected, *expected, this->Volume.Output, report.ChangedExtent));
    }
    else
    {
      EXPECT_EQ(report.ChangedExtent, this->Volume.Output);
    }
    this->Count(report, *memory);
    memory->Revision = report.Revision;
    if (memory != this->Last)
    {
      this->BeforeLast = this->HasSameExtent ? this->Last : nullptr;
      this->Last = memory;
    }
    this->LastExpected = std::move(expected);
    this->HasSameExtent = true;
    this->Aborts = false;
  }

  void Count(const DeformReport& report, const Memory& memory)
  {
    if (report.NumberOfResampledBricks == report.NumberOfBricks)
    {
      return;
    }
    ++this->Parts;
    this->Nothings += report.NumberOfResampledBricks == 0;
    this->FoldedParts += report.NumberOfInvertedTetrahedra > 0;
    this->OverlappingParts += report.Overlapping;
    this->CutParts += !this->Volume.Crossed.empty();
    this->SplitParts += this->IsSplit;
    this->OtherMemoryParts += memory.Revision != 0 && &memory != this->Last.get();
    this->UnevenParts += !memory.IsAligned;
  }

  std::mt19937 Random{ 17U + static_cast<unsigned int>(GTEST_FLAG_GET(random_seed)) };
  // Large enough that moving one node affects only a part.
  EditedVolume Volume{ Extent{ { -5, 100, 0, 58, 3, 62 } } };
  std::vector<unsigned char> AllCrossed; // tetrahedra that the whole cut crosses
  std::unique_ptr<VolumeDeformer> Whole;
  VolumeDeformer Updated;
  std::shared_ptr<Memory> Last;
  std::shared_ptr<Memory> BeforeLast; // memory of the output before the last one
  std::unique_ptr<EditedOutputs> LastExpected;
  bool HasSameExtent = true;
  bool Aborts = false;
  bool IsSplit = false;

  // Numbers of partial updates: all of them, and those with a certain property.
  int Parts = 0;
  int Nothings = 0;
  int FoldedParts = 0;
  int OverlappingParts = 0;
  int CutParts = 0;
  int SplitParts = 0;
  int OtherMemoryParts = 0;
  int UnevenParts = 0;
};

} // namespace

TEST_P(Edits, EqualWholeUpdates)
{
  constexpr int most = 140;
  constexpr int turn = 10; // edits
  const int edits = GetNumberOf(most);
  for (int i = 0; i < edits; ++i)
  {
    const Kind& kind = this->PickKind();
    SCOPED_TRACE("edit " + std::to_string(i) + " of seed " +
      std::to_string(GTEST_FLAG_GET(random_seed)) + ": " + kind.Name);
    const std::vector<float> before = this->Volume.Displacements;
    if (i % turn == 0)
    {
      this->Begin(i / turn);
    }
    (this->*kind.Apply)();
    if (i % turn == turn - 1)
    {
      // A new deformer, without earlier outputs.
      this->Whole = std::make_unique<VolumeDeformer>();
      this->Volume.SendAll(*this->Whole, GetRoute());
    }
    this->Send(before);
    ASSERT_NO_FATAL_FAILURE(
      this->Update(static_cast<Where>(this->Pick(static_cast<std::size_t>(Where::Count)))));
    ASSERT_FALSE(HasFailure());
  }
  std::cout << this->Parts << " of " << edits << " updates in part: " << this->Nothings
            << " of nothing, " << this->FoldedParts << " folded, " << this->OverlappingParts
            << " overlapping, " << this->CutParts << " cut, " << this->SplitParts << " split, "
            << this->OtherMemoryParts << " in other memory, " << this->UnevenParts
            << " at an odd address\n";
  EXPECT_GT(this->Parts, edits / 5);
  if (edits == most)
  {
    EXPECT_GT(this->Nothings, 0);
    EXPECT_GT(this->FoldedParts, edits / 20);
    EXPECT_GT(this->OverlappingParts, edits / 20);
    EXPECT_GT(this->Parts - this->FoldedParts, edits / 20);
    EXPECT_GT(this->CutParts, edits / 20);
    EXPECT_GT(this->OtherMemoryParts, edits / 20);
    if (GetRoute() != Route::Field)
    {
      EXPECT_GT(this->SplitParts, 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, Edits, GetWays(), GetWayName);
