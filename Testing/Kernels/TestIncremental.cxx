// SPDX-License-Identifier: BSD-3-Clause
// Incremental updates against whole ones of another deformer, bit by bit, after random edits of the
// deformation, the masks and the request.
#include "DeformerCase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <memory>
#include <random>

using namespace deformvolume;

namespace
{

constexpr int Step = 8; // voxels between nodes

// A volume of several bricks, and a grid of nodes round it. Each cell of the grid is split into six
// tetrahedra, one for each order of the axes: along a way from its lowest to its highest corner.
struct Subject
{
  Lattice Shape;
  std::array<int, 3> Nodes;
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<VertexLink> Links;
  VertexRuns Runs;
  std::vector<float> Displacements;
  std::vector<std::uint16_t> First;
  std::vector<double> Second;
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  Extent Output;
  double Background = 3.0;
  bool HasCorner; // a corner of the volume is outside the mesh

  explicit Subject(const Extent& extent = { { -5, 140, 0, 50, 3, 40 } }, bool hasCorner = true)
    : HasCorner(hasCorner)
  {
    this->Shape.VertexExtent = extent;
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Nodes[axis] =
        static_cast<int>(GetSize(this->Shape.VertexExtent, axis) + Step - 2) / Step + 1;
    }
    const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(this->Shape.VertexExtent));
    this->First = MakeRandomValues<std::uint16_t>(voxels, 1);
    this->Second = MakeRandomValues<double>(2 * voxels, 2);
    this->Displacements.assign(3 * this->GetNumberOfNodes(), 0.0F);
    this->Output = this->Shape.VertexExtent;
    this->MakeTetrahedra();
    this->MakeLinks();
  }

  std::size_t GetNumberOfNodes() const
  {
    return static_cast<std::size_t>(this->Nodes[0]) * this->Nodes[1] * this->Nodes[2];
  }
  std::int32_t GetNode(const std::array<int, 3>& place) const
  {
    return (place[2] * this->Nodes[1] + place[1]) * this->Nodes[0] + place[0];
  }

  static std::array<int, 3> GetOrder(int permutation)
  {
    static const std::array<int, 3> orders[6] = { { { 0, 1, 2 } }, { { 0, 2, 1 } }, { { 1, 0, 2 } },
      { { 1, 2, 0 } }, { { 2, 0, 1 } }, { { 2, 1, 0 } } };
    return orders[permutation];
  }

  void MakeTetrahedra()
  {
    for (int z = 0; z + 1 < this->Nodes[2]; ++z)
    {
      for (int y = 0; y + 1 < this->Nodes[1]; ++y)
      {
        for (int x = 0; x + 1 < this->Nodes[0]; ++x)
        {
          for (int permutation = 0; permutation < 6; ++permutation)
          {
            std::array<int, 3> place{ { x, y, z } };
            Tetrahedron tetrahedron{ { this->GetNode(place) } };
            for (int k = 0; k < 3; ++k)
            {
              ++place[GetOrder(permutation)[k]];
              tetrahedron[k + 1] = this->GetNode(place);
            }
            this->Tetrahedra.push_back(tetrahedron);
          }
        }
      }
    }
  }

  void MakeLinks()
  {
    const Extent& extent = this->Shape.VertexExtent;
    std::vector<std::int32_t> records(this->Tetrahedra.size(), -1);
    for (int z = 0; z < GetSize(extent, 2); ++z)
    {
      for (int y = 0; y < GetSize(extent, 1); ++y)
      {
        this->Runs.RowBegins.push_back(static_cast<std::uint32_t>(this->Runs.Runs.size()));
        std::int32_t last = -2;
        for (int x = 0; x < GetSize(extent, 0); ++x)
        {
          this->AddVoxel({ { x, y, z } }, records, last);
        }
      }
    }
    this->Runs.RowBegins.push_back(static_cast<std::uint32_t>(this->Runs.Runs.size()));
  }

  void AddVoxel(
    const std::array<int, 3>& voxel, std::vector<std::int32_t>& records, std::int32_t& last)
  {
    double place[3];
    int cell[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      cell[axis] = std::min(voxel[axis] / Step, this->Nodes[axis] - 2);
      place[axis] = double(voxel[axis]) / Step - cell[axis];
    }
    int permutation = 0;
    std::array<int, 3> order = GetOrder(0);
    while (!(place[order[0]] >= place[order[1]] && place[order[1]] >= place[order[2]]))
    {
      order = GetOrder(++permutation);
    }
    VertexLink link;
    if (!this->HasCorner || voxel[0] + voxel[1] + voxel[2] >= 12)
    {
      link.Tetrahedron =
        6 * ((cell[2] * (this->Nodes[1] - 1) + cell[1]) * (this->Nodes[0] - 1) + cell[0]) +
        permutation;
      link.Weights[0] = static_cast<float>(1.0 - place[order[0]]);
      link.Weights[1] = static_cast<float>(place[order[0]] - place[order[1]]);
      link.Weights[2] = static_cast<float>(place[order[1]] - place[order[2]]);
    }
    this->Links.push_back(link);
    if (link.Tetrahedron == last)
    {
      return;
    }
    last = link.Tetrahedron;
    VertexRun run;
    run.Begin = voxel[0];
    if (link.Tetrahedron >= 0)
    {
      if (records[link.Tetrahedron] < 0)
      {
        records[link.Tetrahedron] = static_cast<std::int32_t>(this->Runs.Tetrahedra.size());
        RestTetrahedron rest;
        rest.Tetrahedron = link.Tetrahedron;
        for (int k = 0; k < 3; ++k)
        {
          rest.Origin[k] = voxel[k];
          rest.Weights[k] = link.Weights[k];
        }
        rest.Gradients[0][order[0]] = -1.0 / Step;
        rest.Gradients[1][order[0]] = 1.0 / Step;
        rest.Gradients[1][order[1]] = -1.0 / Step;
        rest.Gradients[2][order[1]] = 1.0 / Step;
        rest.Gradients[2][order[2]] = -1.0 / Step;
        this->Runs.Tetrahedra.push_back(rest);
      }
      run.Tetrahedron = records[link.Tetrahedron];
    }
    this->Runs.Runs.push_back(run);
  }

  std::vector<VolumeArray> GetArrays() const
  {
    return { MakeArray(this->First, 1, false, this->Background),
      MakeArray(this->Second, 2, false, this->Background) };
  }

  void SendDisplacements(
    VolumeDeformer& deformer, Route route, const PointRanges* changes = nullptr) const
  {
    if (route != Route::Field)
    {
      deformer.SetNodeDisplacements(this->Displacements.data(), changes);
      return;
    }
    DisplacementField field;
    field.Dimensions = this->Nodes;
    field.Vectors = this->Displacements.data();
    for (int axis = 0; axis < 3; ++axis)
    {
      field.IndexToField[5 * axis] = 1.0 / Step;
      field.IndexToField[4 * axis + 3] = -double(this->Shape.VertexExtent[2 * axis]) / Step;
    }
    deformer.SetDisplacementField(field, changes);
  }

  // Where the displacements are not those, and a few points more.
  PointRanges FindChanges(const std::vector<float>& last, std::mt19937& random) const
  {
    PointRanges changes;
    for (std::size_t point = 0; point < this->GetNumberOfNodes(); ++point)
    {
      if (std::equal(last.begin() + 3 * point, last.begin() + 3 * point + 3,
            this->Displacements.begin() + 3 * point) &&
        random() % 50)
      {
        continue;
      }
      if (changes.empty() || changes.back()[1] != point)
      {
        changes.push_back({ { point, point } });
      }
      changes.back()[1] = point + 1;
    }
    return changes;
  }

  void SendMasks(VolumeDeformer& deformer) const
  {
    deformer.SetBlanked(this->Blanked.empty() ? nullptr : this->Blanked.data());
    deformer.SetActiveTetrahedra(this->Active.empty() ? nullptr : this->Active.data());
  }

  void SendAll(VolumeDeformer& deformer, Route route) const
  {
    deformer.SetDevice("");
    deformer.SetLattice(this->Shape);
    deformer.SetArrays(this->GetArrays());
    this->SendMasks(deformer);
    if (route == Route::Mesh)
    {
      deformer.SetMesh(this->Tetrahedra.data(), this->Tetrahedra.size(), this->GetNumberOfNodes(),
        this->Links.data());
    }
    else if (route == Route::Runs)
    {
      deformer.SetMesh(
        this->Tetrahedra.data(), this->Tetrahedra.size(), this->GetNumberOfNodes(), this->Runs);
    }
    this->SendDisplacements(deformer, route);
  }

  // Moves nodes round one by up to so many voxels; a radius of 0 moves one node.
  void Move(std::mt19937& random, int radius, float amount)
  {
    std::array<int, 3> center;
    for (int axis = 0; axis < 3; ++axis)
    {
      center[axis] = static_cast<int>(random() % this->Nodes[axis]);
    }
    this->MoveRound(center, random, radius, amount);
  }

  // Moves a node in the middle.
  void MoveInside(std::mt19937& random, float amount)
  {
    std::array<int, 3> center;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int border = this->Nodes[axis] / 2 - 1;
      center[axis] = border + static_cast<int>(random() % (this->Nodes[axis] - 2 * border));
    }
    this->MoveRound(center, random, 0, amount);
  }

  void MoveRound(const std::array<int, 3>& center, std::mt19937& random, int radius, float amount)
  {
    std::uniform_real_distribution<float> move(-amount, amount);
    for (int z = 0; z < this->Nodes[2]; ++z)
    {
      for (int y = 0; y < this->Nodes[1]; ++y)
      {
        for (int x = 0; x < this->Nodes[0]; ++x)
        {
          if (std::abs(x - center[0]) <= radius && std::abs(y - center[1]) <= radius &&
            std::abs(z - center[2]) <= radius)
          {
            for (int c = 0; c < 3; ++c)
            {
              this->Displacements[3 * this->GetNode({ { x, y, z } }) + c] = move(random);
            }
          }
        }
      }
    }
  }
};

struct Outputs
{
  std::vector<std::uint16_t> First;
  std::vector<double> Second;
  std::vector<signed char> Coverage;

  explicit Outputs(const Subject& subject)
    : First(GetNumberOfPoints(subject.Output), 999)
    , Second(2 * GetNumberOfPoints(subject.Output), 999.0)
    , Coverage(GetNumberOfPoints(subject.Output), 9)
  {
  }

  DeformRequest MakeRequest(const Subject& subject)
  {
    DeformRequest request;
    request.OutputExtent = subject.Output;
    request.Outputs = { this->First.data(), this->Second.data() };
    request.Coverage = this->Coverage.data();
    return request;
  }
  void SetLast(DeformRequest& request) const
  {
    request.LastOutputs = { this->First.data(), this->Second.data() };
    request.LastCoverage = this->Coverage.data();
  }
  bool operator==(const Outputs& other) const
  {
    return this->First == other.First && this->Coverage == other.Coverage &&
      std::memcmp(this->Second.data(), other.Second.data(), this->Second.size() * sizeof(double)) ==
      0;
  }
};

enum class Edit
{
  None,
  Node,
  Inside,
  FoldInside,
  Region,
  Half,
  All,
  Fold,
  Unfold,
  Blanked,
  Active,
  NoMasks,
  Extent,
  Background,
  Values,
  Abort,
  Count
};

void Change(Subject& subject, Edit edit, std::mt19937& random)
{
  switch (edit)
  {
    case Edit::Node:
      subject.Move(random, 0, 1.5F);
      break;
    case Edit::Inside:
      subject.MoveInside(random, 2.0F);
      break;
    case Edit::FoldInside:
      subject.MoveInside(random, 14.0F);
      break;
    case Edit::Region:
      subject.Move(random, 1, 1.5F);
      break;
    case Edit::Half:
      subject.Move(random, 5, 1.0F);
      break;
    case Edit::All:
      subject.Move(random, 100, 1.5F);
      break;
    case Edit::Fold:
      subject.Move(random, 0, 14.0F);
      break;
    case Edit::Unfold:
      std::fill(subject.Displacements.begin(), subject.Displacements.end(), 0.25F);
      break;
    case Edit::Blanked:
      subject.Blanked.resize(GetNumberOfPoints(subject.Shape.VertexExtent));
      subject.Blanked[random() % subject.Blanked.size()] ^= 1;
      break;
    case Edit::Active:
      subject.Active.resize(GetNumberOfCells(subject.Shape.VertexExtent), 31);
      subject.Active[random() % subject.Active.size()] = random() % 32;
      break;
    case Edit::NoMasks:
      subject.Blanked.clear();
      subject.Active.clear();
      break;
    case Edit::Extent:
      for (int axis = 0; axis < 3; ++axis)
      {
        subject.Output[2 * axis] =
          subject.Shape.VertexExtent[2 * axis] - static_cast<int>(random() % 8) + 4;
        subject.Output[2 * axis + 1] =
          subject.Shape.VertexExtent[2 * axis + 1] + static_cast<int>(random() % 8) - 4;
      }
      break;
    case Edit::Background:
      subject.Background += 1.0;
      break;
    case Edit::Values:
      subject.First[random() % subject.First.size()] ^= 1;
      break;
    default:
      break;
  }
}

// Two deformers, one of which updates what it made last, in place.
struct Twins
{
  VolumeDeformer Whole;
  VolumeDeformer Updated;
  std::unique_ptr<Outputs> Last;
  DeformReport WholeReport;
  DeformReport UpdatedReport;

  void SendAll(const Subject& subject, Route route)
  {
    subject.SendAll(this->Whole, route);
    subject.SendAll(this->Updated, route);
  }

  // After displacements have changed. Expects the same of both.
  void Deform(const Subject& subject, Route route)
  {
    subject.SendDisplacements(this->Whole, route);
    subject.SendDisplacements(this->Updated, route);
    Outputs expected(subject);
    this->WholeReport = this->Whole.Deform(expected.MakeRequest(subject));
    const bool isFirst = !this->Last;
    if (isFirst)
    {
      this->Last = std::make_unique<Outputs>(subject);
    }
    DeformRequest request = this->Last->MakeRequest(subject);
    request.Incremental = true;
    if (!isFirst)
    {
      this->Last->SetLast(request);
    }
    this->UpdatedReport = this->Updated.Deform(request);
    const DeformReport& wanted = this->WholeReport;
    const DeformReport& report = this->UpdatedReport;
    ASSERT_TRUE(*this->Last == expected);
    EXPECT_EQ(report.NumberOfCoveredVoxels, wanted.NumberOfCoveredVoxels);
    EXPECT_EQ(report.Overlapping, wanted.Overlapping);
    EXPECT_EQ(report.NumberOfInvertedTetrahedra, wanted.NumberOfInvertedTetrahedra);
  }

  // Whether the last one ran a part of the bricks only.
  bool IsPart() const
  {
    return this->UpdatedReport.NumberOfResampledBricks < this->UpdatedReport.NumberOfBricks;
  }
};

class Incremental : public testing::TestWithParam<Route>
{
};

} // namespace

TEST_P(Incremental, EqualsWholeUpdates)
{
  const Route route = GetParam();
  Subject subject;
  VolumeDeformer whole;
  VolumeDeformer incremental;
  subject.SendAll(whole, route);
  subject.SendAll(incremental, route);
  std::mt19937 random(17);
  auto last = std::make_unique<Outputs>(subject);
  bool hasLast = false;
  int parts = 0;
  std::int64_t fewest = 1000000;
  for (int i = 0; i < 150; ++i)
  {
    // Small edits come more often: only they are worked on in part.
    static const Edit small[] = { Edit::Node, Edit::Inside, Edit::Region, Edit::Blanked,
      Edit::Active };
    const Edit edit = i < 3 ? Edit::None
      : random() % 3        ? small[random() % std::size(small)]
                            : static_cast<Edit>(random() % static_cast<int>(Edit::Count));
    SCOPED_TRACE("edit " + std::to_string(i) + " of kind " + std::to_string(int(edit)));
    const std::vector<float> sent = subject.Displacements;
    Change(subject, edit, random);
    const PointRanges changes = subject.FindChanges(sent, random);
    for (VolumeDeformer* deformer : { &whole, &incremental })
    {
      if (edit == Edit::Values)
      {
        deformer->SetArrays(subject.GetArrays());
      }
      deformer->SetArrayOptions(subject.GetArrays());
      if (edit == Edit::Blanked || edit == Edit::Active || edit == Edit::NoMasks)
      {
        subject.SendMasks(*deformer);
      }
      subject.SendDisplacements(
        *deformer, route, deformer == &incremental && i % 2 ? &changes : nullptr);
    }
    Outputs expected(subject);
    const DeformReport wanted = whole.Deform(expected.MakeRequest(subject));

    // In place, or from the last output, which has to stay as it is.
    auto next = std::make_unique<Outputs>(subject);
    const bool inPlace = edit != Edit::Extent && random() % 2 == 0;
    const Outputs before = *last;
    DeformRequest request = (inPlace ? *last : *next).MakeRequest(subject);
    request.Incremental = true;
    if (hasLast)
    {
      last->SetLast(request);
    }
    if (edit == Edit::Abort)
    {
      request.Progress = [](double) { return false; };
      subject.Move(random, 0, 1.5F);
      subject.SendDisplacements(incremental, route);
      EXPECT_THROW(incremental.Deform(request), Aborted);
      subject.SendDisplacements(whole, route);
      whole.Deform(expected.MakeRequest(subject));
      request.Progress = nullptr;
      if (random() % 2)
      {
        request.LastOutputs.clear();
      }
    }
    const DeformReport report = incremental.Deform(request);
    if (edit != Edit::Abort)
    {
      EXPECT_EQ(report.NumberOfCoveredVoxels, wanted.NumberOfCoveredVoxels);
      EXPECT_EQ(report.NumberOfInvertedTetrahedra, wanted.NumberOfInvertedTetrahedra);
      EXPECT_EQ(report.NumberOfOverstretchedCells, wanted.NumberOfOverstretchedCells);
      EXPECT_EQ(report.Overlapping, wanted.Overlapping);
    }
    if (!inPlace)
    {
      EXPECT_TRUE(*last == before) << "the last output was written to";
      last = std::move(next);
    }
    ASSERT_TRUE(*last == expected);
    hasLast = true;
    EXPECT_EQ(wanted.NumberOfResampledBricks, wanted.NumberOfBricks);
    if (report.NumberOfResampledBricks < report.NumberOfBricks)
    {
      ++parts;
      fewest = std::min(fewest, report.NumberOfResampledBricks);
    }
  }
  // A device that is no processor does all anew.
  if (parts > 0)
  {
    EXPECT_GT(parts, 30);
    EXPECT_EQ(fewest, 0) << "an edit of nothing";
  }
}

// Where only vertices inside the mesh move nothing is cleared, as long as nothing folds.
TEST_P(Incremental, EditsInsideEqualWholeUpdates)
{
  const Route route = GetParam();
  // So deep that these parts reach no border.
  Subject subject(Extent{ { -5, 140, 0, 74, 3, 78 } });
  Twins twins;
  twins.SendAll(subject, route);
  std::mt19937 random(29);
  int parts = 0;
  int folds = 0;
  for (int i = 0; i < 50; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    const bool folding = i % 5 == 3;
    const bool unfolding = i % 5 == 4;
    Change(subject, folding ? Edit::FoldInside : unfolding ? Edit::Unfold : Edit::Inside, random);
    ASSERT_NO_FATAL_FAILURE(twins.Deform(subject, route));
    folds += twins.WholeReport.NumberOfInvertedTetrahedra > 0;
    if (twins.IsPart())
    {
      EXPECT_EQ(twins.WholeReport.NumberOfInvertedTetrahedra, 0);
      // What a node moves lies in three bricks on an axis at most.
      EXPECT_LE(twins.UpdatedReport.NumberOfResampledBricks, 3 * 3);
      ++parts;
    }
  }
  EXPECT_GT(folds, 3);
  if (parts > 0) // else the device is no processor
  {
    EXPECT_GT(parts, 5);
  }
}

// Edits that change what is covered, but not how much of it, so that counts do not tell: of two
// sides, of a hole, and of masks.
class IncrementalBorders : public Incremental
{
protected:
  IncrementalBorders()
    : Edited(Extent{ { 0, 64, 0, 64, 0, 128 } }, false)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Edited.Output[2 * axis] -= 4;
      this->Edited.Output[2 * axis + 1] += 4;
    }
  }

  // A node that lies on a voxel.
  float* At(int x, int y, int z)
  {
    return &this->Edited.Displacements[3 * this->Edited.GetNode({ { x, y, z } })];
  }
  unsigned char& BlankedAt(int x, int y, int z)
  {
    this->Edited.Blanked.resize(GetNumberOfPoints(this->Edited.Shape.VertexExtent));
    return this->Edited.Blanked[(z * 65 + y) * 65 + x];
  }

  void Start()
  {
    this->Both.SendAll(this->Edited, GetParam());
    this->Both.Deform(this->Edited, GetParam());
  }

  // Whether as much is covered as before.
  bool Update()
  {
    const std::int64_t before = this->Both.WholeReport.NumberOfCoveredVoxels;
    this->Edited.SendMasks(this->Both.Whole);
    this->Edited.SendMasks(this->Both.Updated);
    this->Both.Deform(this->Edited, GetParam());
    this->Parts += this->Both.IsPart();
    return this->Both.WholeReport.NumberOfCoveredVoxels == before;
  }

  // Unless the device is no processor.
  void ExpectParts(int number) const { EXPECT_TRUE(this->Parts == number || this->Parts == 0); }

  Subject Edited;
  Twins Both;
  int Parts = 0; // updates that were not whole
};

TEST_P(IncrementalBorders, OneSideGoesOutAndTheOtherIn)
{
  this->Start();
  for (int y = 0; y < this->Edited.Nodes[1]; ++y)
  {
    for (int x = 0; x < this->Edited.Nodes[0]; ++x)
    {
      this->At(x, y, 0)[2] = -1.0F;
      this->At(x, y, 16)[2] = -1.0F;
    }
  }
  EXPECT_TRUE(this->Update()) << "a plane comes, and one goes";
  this->ExpectParts(1);
}

TEST_P(IncrementalBorders, AHoleMoves)
{
  this->BlankedAt(32, 32, 64) = 1;
  this->Start();
  int same = 0;
  for (const float shift : { 1.0F, 2.0F, -1.0F, 0.0F })
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->At(4, 4, 8)[axis] = shift;
      same += this->Update();
    }
  }
  EXPECT_GT(same, 0) << "the hole never covers as much";
  this->ExpectParts(12);
}

TEST_P(IncrementalBorders, AMaskChangesAndWhatIsInsideMoves)
{
  this->BlankedAt(32, 32, 64) = 1;
  this->Start();
  int same = 0;
  for (int step = 1; step <= 3; ++step)
  {
    // The hole goes elsewhere, and something far away moves.
    this->BlankedAt(32, 32, 63 + step) = 0;
    this->BlankedAt(32, 32, 64 + step) = 1;
    *this->At(4, 4, 4) = 0.25F * static_cast<float>(step);
    same += this->Update();
  }
  EXPECT_GT(same, 0) << "the hole never covers as much";
  this->ExpectParts(3);
}

TEST_P(Incremental, LocalEditsRunFewBricks)
{
  Subject subject(Extent{ { -5, 140, 0, 100, 3, 80 } });
  VolumeDeformer deformer;
  subject.SendAll(deformer, GetParam());
  Outputs outputs(subject);
  DeformRequest request = outputs.MakeRequest(subject);
  request.Incremental = true;
  const DeformReport first = deformer.Deform(request);
  EXPECT_EQ(first.NumberOfResampledBricks, first.NumberOfBricks);
  EXPECT_EQ(first.NumberOfBricks, 1 * 7 * 5);
  outputs.SetLast(request);
  // A node inside moves the bricks that it lies between, and what others own stays as it is.
  const std::int32_t node = subject.GetNode({ { 12, 6, 5 } });
  subject.Displacements[3 * node] = 0.5F;
  subject.SendDisplacements(deformer, GetParam());
  const DeformReport second = deformer.Deform(request);
  if (second.NumberOfResampledBricks == second.NumberOfBricks)
  {
    GTEST_SKIP() << "the device is no processor";
  }
  EXPECT_GE(second.NumberOfResampledBricks, 1);
  EXPECT_LE(second.NumberOfResampledBricks, 1 * 2 * 2);
  EXPECT_EQ(second.NumberOfCoveredVoxels, first.NumberOfCoveredVoxels);
  // One on the border of the mesh changes what is covered: neighbours may own what it leaves.
  subject.Displacements[3 * subject.GetNode({ { 12, 6, 0 } }) + 2] = 1.5F;
  subject.SendDisplacements(deformer, GetParam());
  const DeformReport third = deformer.Deform(request);
  EXPECT_LE(third.NumberOfResampledBricks, 1 * 4 * 3);
  EXPECT_LT(third.NumberOfCoveredVoxels, first.NumberOfCoveredVoxels);
  // Nothing changed.
  subject.SendDisplacements(deformer, GetParam());
  EXPECT_EQ(deformer.Deform(request).NumberOfResampledBricks, 0);
  // Without being told where the last output is, all is made.
  request.LastOutputs.clear();
  const DeformReport last = deformer.Deform(request);
  EXPECT_EQ(last.NumberOfResampledBricks, last.NumberOfBricks);
}

namespace
{

std::string GetRouteName(const testing::TestParamInfo<Route>& info)
{
  return info.param == Route::Mesh ? "Links" : info.param == Route::Runs ? "Runs" : "Field";
}

} // namespace

INSTANTIATE_TEST_SUITE_P(
  Routes, Incremental, testing::Values(Route::Mesh, Route::Runs, Route::Field), GetRouteName);
INSTANTIATE_TEST_SUITE_P(Routes, IncrementalBorders,
  testing::Values(Route::Mesh, Route::Runs, Route::Field), GetRouteName);
