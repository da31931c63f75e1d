// SPDX-License-Identifier: BSD-3-Clause
// Updates of a part of the output where a smooth cut passes: they equal whole outputs, bit for bit.
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <random>
#include <utility>
#include <vector>

using namespace deformvolume;

namespace
{

class IncrementalCutWays : public WayTest
{
};

// Cuts along a plane, through all of the volume or up to a y, counted from the first voxel.
void Cut(EditedVolume& volume, double place, double slope, int end)
{
  const Extent& extent = volume.Shape.VertexExtent;
  std::array<int, 3> size;
  for (int axis = 0; axis < 3; ++axis)
  {
    size[axis] = static_cast<int>(GetSize(extent, axis));
  }
  const auto distance = [=](int x, int y, int z) { return x - place + slope * y - 0.125 * z; };
  volume.CutDistances.clear();
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        volume.CutDistances.push_back(static_cast<float>(distance(x, y, z)));
      }
    }
  }
  volume.Crossed.clear();
  for (int z = 0; z + 1 < size[2]; ++z)
  {
    for (int y = 0; y + 1 < size[1]; ++y)
    {
      for (int x = 0; x + 1 < size[0]; ++x)
      {
        // Those of which one side has no vertex are not divided, and may be among them.
        const bool isNear = std::abs(distance(x, y, z)) < 2.0;
        volume.Crossed.push_back(isNear && y < end ? 31 : 0);
      }
    }
  }
}

// In a box takes over what is crossed, or joins it again, and moves the sheet.
void EditCut(EditedVolume& volume, const std::vector<unsigned char>& crossed, std::mt19937& random)
{
  const Extent& extent = volume.Shape.VertexExtent;
  const auto sizeX = static_cast<std::size_t>(GetSize(extent, 0));
  const auto sizeY = static_cast<std::size_t>(GetSize(extent, 1));
  const std::size_t firstY = random() % 40;
  const std::size_t firstZ = random() % 30;
  const bool joins = random() % 4 == 0;
  for (std::size_t z = firstZ; z < firstZ + 4; ++z)
  {
    for (std::size_t y = firstY; y < firstY + 4; ++y)
    {
      for (std::size_t x = 0; x + 1 < sizeX; ++x)
      {
        volume.CutDistances[(z * sizeY + y) * sizeX + x] += 0.3F;
        const std::size_t cell = (z * (sizeY - 1) + y) * (sizeX - 1) + x;
        volume.Crossed[cell] = joins ? 0 : crossed[cell];
      }
    }
  }
}

// An edit of the mask, or of the boundary distances, beside the plane.
void EditBeside(EditedVolume& volume, std::mt19937& random, int kind)
{
  const Extent& extent = volume.Shape.VertexExtent;
  const std::size_t voxels = static_cast<std::size_t>(GetNumberOfPoints(extent));
  const int x = 60 + static_cast<int>(random() % 20);
  const int y = static_cast<int>(random() % 40);
  const int z = static_cast<int>(random() % 30);
  const auto sizeX = static_cast<std::size_t>(GetSize(extent, 0));
  const auto sizeY = static_cast<std::size_t>(GetSize(extent, 1));
  const std::size_t vertex = (static_cast<std::size_t>(z) * sizeY + y) * sizeX + x;
  const std::size_t cell = (static_cast<std::size_t>(z) * (sizeY - 1) + y) * (sizeX - 1) + x;
  if (kind == 0)
  {
    volume.Active.resize(volume.Crossed.size(), 31);
    volume.Active[cell] = static_cast<unsigned char>(random() % 32);
  }
  else if (kind == 1)
  {
    volume.Blanked.resize(voxels);
    volume.Blanked[vertex] ^= 1;
  }
  else
  {
    volume.Distances.resize(voxels, 1.0F);
    volume.Distances[vertex] = static_cast<float>(random() % 3) - 1.5F;
  }
}

} // namespace

TEST_P(IncrementalCutWays, EqualWholeOutputs)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  std::mt19937 random(7);
  EditedVolume volume = MakeVolume();
  Cut(volume, 68.3, 0.2, 30);
  Twins twins;
  twins.SendAll(volume, GetRoute());
  twins.Deform(volume, GetRoute());
  int parts = 0;
  int foldedParts = 0;
  constexpr int most = 30;
  const int edits = GetNumberOf(most);
  for (int edit = 0; edit < edits; ++edit)
  {
    SCOPED_TRACE(edit);
    if (edit % 15 == 0)
    {
      std::fill(volume.Displacements.begin(), volume.Displacements.end(), 0.0F);
    }
    // Some open the cut, or fold its sides over each other.
    const float amount = edit % 15 == 9 ? 9.0F : edit % 3 == 0 ? 0.3F : 2.5F;
    if (edit % 2 == 0)
    {
      volume.MoveInside(random, amount);
    }
    else
    {
      volume.Move(random, 0, amount);
    }
    if (edit % 4 == 3)
    {
      EditBeside(volume, random, static_cast<int>(random() % 3));
    }
    if (edit % 10 == 9)
    {
      Cut(volume, 60.3 + edit % 3 * 4.0, 0.3, edit % 20 == 9 ? 99 : 20);
    }
    if (edit % 30 == 18)
    {
      volume.Crossed.clear();
    }
    volume.SendMasks(twins.Whole);
    volume.SendMasks(twins.Updated);
    twins.Deform(volume, GetRoute());
    ASSERT_FALSE(HasFailure());
    parts += twins.IsPart() ? 1 : 0;
    foldedParts += twins.IsPart() && twins.UpdatedReport.Overlapping ? 1 : 0;
    if (volume.Crossed.empty())
    {
      Cut(volume, 70.0, 0.0, 99);
      volume.SendMasks(twins.Whole);
      volume.SendMasks(twins.Updated);
      twins.Deform(volume, GetRoute());
      ASSERT_FALSE(HasFailure());
    }
  }
  std::cout << parts << " of " << edits << " outputs in part, " << foldedParts << " folded\n";
  EXPECT_GT(parts, edits / 4);
  if (edits == most)
  {
    EXPECT_GT(foldedParts, 0);
  }
}

// By tetrahedra over many voxels an affine motion is continued across the sheet, and all is as
// without a cut.
TEST_P(IncrementalCutWays, AffineMotionsShowNoCut)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  EditedVolume volume = MakeVolume();
  volume.Output = { { -20, 170, -20, 70, -20, 60 } };
  std::size_t component = 0;
  for (int z = 0; z < volume.Nodes[2]; ++z)
  {
    for (int y = 0; y < volume.Nodes[1]; ++y)
    {
      for (int x = 0; x < volume.Nodes[0]; ++x)
      {
        volume.Displacements[component++] = 0.5F * x + 2.0F * y;
        volume.Displacements[component++] = 1.25F * x - 0.75F * z;
        volume.Displacements[component++] = 0.5F * y + 0.75F * x;
      }
    }
  }
  const auto deform = [&](EditedOutputs& outputs)
  {
    VolumeDeformer deformer;
    volume.SendAll(deformer, GetRoute());
    EXPECT_FALSE(deformer.Deform(outputs.MakeRequest(volume)).Overlapping);
  };
  EditedOutputs whole(volume);
  deform(whole);
  Cut(volume, 64.3, 0.2, 99);
  EditedOutputs cut(volume);
  deform(cut);
  EXPECT_TRUE(cut == whole);
}

// A cut that is made, goes on, is moved and is taken back, bit by bit: all of it in part. Nodes
// move meanwhile.
TEST_P(IncrementalCutWays, EditsOfTheCutAreMadeInPart)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  std::mt19937 random(23);
  EditedVolume volume = MakeVolume();
  Twins twins;
  twins.SendAll(volume, GetRoute());
  volume.MoveInside(random, 2.5F);
  twins.Deform(volume, GetRoute());
  Cut(volume, 64.3, 0.2, 99);
  const std::vector<unsigned char> all = volume.Crossed;
  volume.Crossed.assign(all.size(), 0);
  int parts = 0;
  const int edits = GetNumberOf(25);
  for (int edit = 0; edit < edits; ++edit)
  {
    SCOPED_TRACE(edit);
    if (edit % 8 == 7)
    {
      volume.Crossed.assign(all.size(), 0);
    }
    else
    {
      EditCut(volume, all, random);
    }
    if (edit % 3 == 1)
    {
      volume.MoveInside(random, 1.5F);
    }
    volume.SendMasks(twins.Whole);
    volume.SendMasks(twins.Updated);
    twins.Deform(volume, GetRoute());
    ASSERT_FALSE(HasFailure());
    parts += twins.IsPart() ? 1 : 0;
  }
  EXPECT_GT(parts, edits / 2);
}

// Beside a cut that stands open what moves on one side moves the other side's copies.
TEST_P(IncrementalCutWays, NodesOfOneSideAreSplit)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  if (GetRoute() == Route::Field)
  {
    GTEST_SKIP() << "fields have no nodes to split";
  }
  std::mt19937 random(11);
  EditedVolume volume = MakeVolume();
  Cut(volume, 68.3, 0.2, 99);
  Twins twins;
  twins.SendAll(volume, GetRoute());
  twins.Deform(volume, GetRoute());
  int parts = 0;
  const int edits = GetNumberOf(24);
  for (int edit = 0; edit < edits; ++edit)
  {
    SCOPED_TRACE(edit);
    const std::vector<TetrahedronChange> changes = volume.Split(random, 60);
    for (VolumeDeformer* deformer : { &twins.Whole, &twins.Updated })
    {
      deformer->ChangeConnectivity(
        volume.Tetrahedra.data(), volume.Tetrahedra.size(), volume.GetNumberOfNodes(), &changes);
    }
    volume.MoveInside(random, 0.5F);
    twins.Deform(volume, GetRoute());
    ASSERT_FALSE(HasFailure());
    parts += twins.IsPart() ? 1 : 0;
  }
  EXPECT_GT(parts, edits / 4);
}

namespace
{

// A volume with a displacement for each voxel, and two deformers of it.
struct VoxelField
{
  static constexpr int Size = 64;
  // The displacements are those of nodes, of which each moves its voxel only: with a field, bricks
  // look one voxel further.
  bool IsMesh = false;
  EditedVolume Volume{ { { 0, Size - 1, 0, Size - 1, 0, Size - 1 } }, false };
  std::vector<float> Vectors = std::vector<float>(3 * Size * Size * Size);
  VolumeDeformer Whole, Updated;
  std::unique_ptr<EditedOutputs> Last;

  float* GetVector(int x, int y, int z)
  {
    return this->Vectors.data() + 3 * static_cast<std::size_t>((z * Size + y) * Size + x);
  }
  void SendDisplacements(VolumeDeformer& deformer) const
  {
    if (this->IsMesh)
    {
      deformer.SetNodeDisplacements(this->Vectors.data(), nullptr);
      return;
    }
    DisplacementField field;
    field.Dimensions = { { Size, Size, Size } };
    field.Vectors = this->Vectors.data();
    for (int axis = 0; axis < 3; ++axis)
    {
      field.IndexToField[5 * axis] = 1.0;
    }
    deformer.SetDisplacementField(field, nullptr);
  }
  void SendAll()
  {
    for (VolumeDeformer* deformer : { &this->Whole, &this->Updated })
    {
      deformer->SetDevice("");
      deformer->SetVoxelGrid(this->Volume.Shape);
      deformer->SetArrays(this->Volume.GetArrays());
      this->Volume.SendMasks(*deformer);
      if (this->IsMesh)
      {
        this->SendMesh(*deformer);
      }
    }
  }
  void SendMesh(VolumeDeformer& deformer)
  {
    // The last three nodes belong to all tetrahedra, without weight.
    const auto nodes = static_cast<std::int32_t>(this->Vectors.size() / 3) - 3;
    std::vector<Tetrahedron> tetrahedra;
    std::vector<VertexLink> links(static_cast<std::size_t>(nodes));
    for (std::int32_t node = 0; node < nodes; ++node)
    {
      tetrahedra.push_back({ { node, nodes, nodes + 1, nodes + 2 } });
      VertexLink& link = links[static_cast<std::size_t>(node)];
      link.Tetrahedron = node;
      link.Weights[0] = 1.0F;
    }
    deformer.SetMesh(tetrahedra.data(), tetrahedra.size(), this->Vectors.size() / 3, links.data());
  }
  // Moves 4 x 4 voxels of a plane, by the first component.
  void MoveSquare(int x, float amount)
  {
    for (int z = 8; z < 12; ++z)
    {
      for (int y = 8; y < 12; ++y)
      {
        *this->GetVector(x, y, z) = amount;
      }
    }
  }
  // Expects the same of both deformers. Returns whether one made a part.
  bool Deform()
  {
    this->SendDisplacements(this->Whole);
    this->SendDisplacements(this->Updated);
    EditedOutputs expected(this->Volume);
    const DeformReport wanted = this->Whole.Deform(expected.MakeRequest(this->Volume));
    const bool isFirst = !this->Last;
    this->Last = isFirst ? std::make_unique<EditedOutputs>(this->Volume) : std::move(this->Last);
    DeformRequest request = this->Last->MakeRequest(this->Volume);
    request.Incremental = true;
    if (!isFirst)
    {
      this->Last->SetLast(request);
    }
    const DeformReport report = this->Updated.Deform(request);
    ExpectSame(report, wanted);
    EXPECT_TRUE(*this->Last == expected);
    return report.NumberOfResampledBricks < report.NumberOfBricks;
  }
};

} // namespace

// A side that is drawn out towards the sheet: its copies go on in that direction, and reach further
// than any of its vertices. The other side is far away.
TEST(IncrementalCuts, CopiesReachFurtherThanVertices)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (const Resampling method : GetExactMethods())
  {
    SCOPED_TRACE(static_cast<int>(method));
    VoxelField made;
    made.Volume.Method = method;
    made.Volume.Output = { { 0, 90, 0, 170, 0, VoxelField::Size - 1 } };
    for (int voxel = 0; voxel < VoxelField::Size * VoxelField::Size * VoxelField::Size; ++voxel)
    {
      // The cells that are divided are the last ones of a part of a brick.
      const int x = voxel % VoxelField::Size;
      made.Volume.CutDistances.push_back(static_cast<float>(x) - 15.9F);
      made.Vectors[3 * static_cast<std::size_t>(voxel)] = x == 15 ? 20.0F : 0.0F;
      made.Vectors[3 * static_cast<std::size_t>(voxel) + 1] = x > 15 ? 100.0F : 0.0F;
    }
    const int cells = VoxelField::Size - 1;
    for (int cell = 0; cell < cells * cells * cells; ++cell)
    {
      made.Volume.Crossed.push_back(cell % cells == 15 ? 31 : 0);
    }
    made.SendAll();
    made.Deform();
    for (const float amount : { 10.0F, 30.0F, 20.0F })
    {
      made.MoveSquare(15, amount);
      EXPECT_TRUE(made.Deform());
    }
  }
}

// What one voxel moves beside a sheet that divides at random.
TEST(IncrementalCuts, VoxelsMoveCopiesUpToTwoVoxelsAway)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  std::mt19937 random(5);
  std::uniform_real_distribution<float> jitter(-0.4F, 0.4F);
  VoxelField made;
  for (float& component : made.Vectors)
  {
    component = jitter(random);
  }
  for (int voxel = 0; voxel < VoxelField::Size * VoxelField::Size * VoxelField::Size; ++voxel)
  {
    made.Volume.CutDistances.push_back(static_cast<float>(random() % 33) / 16.0F - 1.0F);
  }
  const int cells = VoxelField::Size - 1;
  for (int cell = 0; cell < cells * cells * cells; ++cell)
  {
    const int x = cell % cells;
    made.Volume.Crossed.push_back(x > 28 && x < 36 ? 31 : 0);
  }
  made.SendAll();
  made.Deform();
  int parts = 0;
  const int steps = HasVectors() ? 20 : 3;
  for (int step = 0; step < steps; ++step)
  {
    SCOPED_TRACE(step);
    float* vector = made.GetVector(26 + static_cast<int>(random() % 12),
      static_cast<int>(random() % VoxelField::Size), static_cast<int>(random() % VoxelField::Size));
    vector[step % 3] = jitter(random);
    parts += made.Deform() ? 1 : 0;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(parts, steps);
}

// What moves lies two voxels beside a part of a brick, of which it moves copies: they belong to
// tetrahedra whose other copies are far away, beyond all that the brick of the voxel reaches.
TEST(IncrementalCuts, CopiesOfTheNextBrickMove)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (const Resampling method : GetExactMethods())
  {
    SCOPED_TRACE(static_cast<int>(method));
    VoxelField made;
    made.Volume.Method = method;
    made.Volume.Output = { { 0, 90, 0, 170, 0, VoxelField::Size - 1 } };
    for (int voxel = 0; voxel < VoxelField::Size * VoxelField::Size * VoxelField::Size; ++voxel)
    {
      // A part of a brick begins at 16. Two planes of vertices there are another side, but for some
      // vertices, so that there are tetrahedra with copies in both.
      const int x = voxel % VoxelField::Size;
      const int y = voxel / VoxelField::Size % VoxelField::Size;
      const bool isOther = x == 16 || (x == 17 && y % 4 != 0);
      made.Volume.CutDistances.push_back(isOther ? -1.0F : 1.0F);
      // Copies in the second plane go on away from the plane behind the next one.
      made.Vectors[3 * static_cast<std::size_t>(voxel) + 1] = x == 19 ? -60.0F : 0.0F;
    }
    const int cells = VoxelField::Size - 1;
    for (int cell = 0; cell < cells * cells * cells; ++cell)
    {
      const int x = cell % cells;
      made.Volume.Crossed.push_back(x >= 15 && x < 18 ? 31 : 0);
    }
    made.IsMesh = true;
    made.Vectors.resize(made.Vectors.size() + 9);
    made.SendAll();
    made.Deform();
    for (const float amount : { 10.0F, -5.0F, 0.0F })
    {
      made.MoveSquare(14, amount);
      EXPECT_TRUE(made.Deform());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, IncrementalCutWays, GetWays(), GetWayName);
