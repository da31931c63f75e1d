// SPDX-License-Identifier: BSD-3-Clause
// Partial updates across a smooth cut equal whole outputs, bit for bit.
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory>
#include <random>
#include <utility>
#include <vector>

using namespace deformvolume;

namespace
{

class IncrementalCutMotions : public WayTest
{
};

} // namespace

// If tetrahedra extend over many voxels, an affine map is extrapolated exactly across the sheet:
// the output is the same as without a cut.
TEST_P(IncrementalCutMotions, AffineMotionsShowNoCut)
{
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
  volume.CutAlong(64.3, 0.2, 99);
  EditedOutputs cut(volume);
  deform(cut);
  EXPECT_TRUE(cut == whole);
}

namespace
{

// A volume with a displacement for each voxel, and two deformers of it.
struct VoxelField
{
  static constexpr int Size = 64;
  // Whether each voxel has a node of its own, which moves only this voxel. With a field instead,
  // changes extend one voxel further.
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
  void SendAll(VolumeDeformer& deformer)
  {
    deformer.SetDevice("");
    deformer.SetVoxelGrid(this->Volume.Shape);
    deformer.SetArrays(this->Volume.GetArrays());
    this->Volume.SendMasks(deformer);
    if (this->IsMesh)
    {
      this->SendMesh(deformer);
    }
  }
  void SendAll()
  {
    this->SendAll(this->Whole);
    this->SendAll(this->Updated);
  }
  void SendMesh(VolumeDeformer& deformer)
  {
    // All tetrahedra share the last three nodes, with weight zero.
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
  // Sets the x component of the displacements of 4 x 4 voxels in a plane of constant x.
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
  // Deforms with both deformers and expects the same results. Returns whether the update was
  // partial.
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

// One side of the cut is stretched towards the sheet. Its copies are extrapolated in that
// direction, beyond all vertices. The other side is far away.
TEST(IncrementalCuts, CopiesReachBeyondVertices)
{
  for (const Resampling method : GetExactMethods())
  {
    SCOPED_TRACE(static_cast<int>(method));
    VoxelField made;
    made.Volume.Method = method;
    made.Volume.Output = { { 0, 90, 0, 170, 0, VoxelField::Size - 1 } };
    for (int voxel = 0; voxel < VoxelField::Size * VoxelField::Size * VoxelField::Size; ++voxel)
    {
      // The divided cells are the last ones of a sub-brick.
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

namespace
{

// A sheet that divides random tetrahedra, and random displacements.
struct RandomSheet : VoxelField
{
  std::mt19937 Random{ 5 };
  std::uniform_real_distribution<float> Jitter{ -0.4F, 0.4F };

  RandomSheet()
  {
    for (float& component : this->Vectors)
    {
      component = this->Jitter(this->Random);
    }
    for (int voxel = 0; voxel < Size * Size * Size; ++voxel)
    {
      this->Volume.CutDistances.push_back(static_cast<float>(this->Random() % 33) / 16.0F - 1.0F);
    }
    const int cells = Size - 1;
    for (int cell = 0; cell < cells * cells * cells; ++cell)
    {
      const int x = cell % cells;
      this->Volume.Crossed.push_back(x > 28 && x < 36 ? 31 : 0);
    }
  }
  std::array<int, 3> PickVoxel()
  {
    const auto pick = [&](int count)
    { return static_cast<int>(this->Random() % static_cast<unsigned int>(count)); };
    const int x = 26 + pick(12);
    const int y = pick(Size);
    return { { x, y, pick(Size) } };
  }
  void Move(const std::array<int, 3>& voxel)
  {
    this->GetVector(voxel[0], voxel[1], voxel[2])[this->Random() % 3] = this->Jitter(this->Random);
  }
};

} // namespace

// Moves single voxels beside the sheet.
TEST(IncrementalCuts, VoxelsMoveCopiesUpToTwoVoxelsAway)
{
  RandomSheet made;
  made.SendAll();
  made.Deform();
  int parts = 0;
  const int steps = HasVectors() ? 20 : 3;
  for (int step = 0; step < steps; ++step)
  {
    SCOPED_TRACE(step);
    made.Move(made.PickVoxel());
    parts += made.Deform() ? 1 : 0;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(parts, steps);
}

// Masks and the sheet change while nothing moves, then a voxel near them moves. The output
// equals that of a new volume, and that of a volume of two chunks.
TEST(IncrementalCuts, MasksChangeCopiesUpToTwoVoxelsAway)
{
  constexpr int size = VoxelField::Size;
  RandomSheet made;
  made.Volume.Blanked.resize(made.Volume.CutDistances.size());
  made.Volume.Active.resize(made.Volume.Crossed.size(), 31);
  const auto getCell = [](const std::array<int, 3>& at)
  {
    const int cells = size - 1;
    return static_cast<std::size_t>((at[2] % cells * cells + at[1] % cells) * cells + at[0]);
  };
  VolumeDeformer chunked;
  chunked.SetAllocationLimit(16 * size * size * size);
  made.SendAll();
  made.SendAll(chunked);
  made.Deform();
  const int steps = HasVectors() ? 10 : 3;
  for (int step = 0; step < steps; ++step)
  {
    SCOPED_TRACE(step);
    const std::array<int, 3> at = made.PickVoxel();
    made.Volume.Active[getCell(at)] = 0;
    made.Volume.Blanked[static_cast<std::size_t>((at[1] * size + at[2]) * size + at[0])] ^= 1;
    made.Volume.Crossed[getCell({ { at[0] + 1, at[1], at[2] } })] ^= 31;
    made.Volume.SendMasks(made.Whole);
    made.Volume.SendMasks(made.Updated);
    EXPECT_TRUE(made.Deform());
    made.SendAll(made.Whole); // discards everything on the device
    made.Move(at);
    EXPECT_TRUE(made.Deform());
    made.Volume.SendMasks(chunked);
    made.SendDisplacements(chunked);
    EditedOutputs outputs(made.Volume);
    chunked.Deform(outputs.MakeRequest(made.Volume));
    EXPECT_TRUE(outputs == *made.Last);
    ASSERT_FALSE(HasFailure());
  }
}

// The moved voxels are two voxels away from another sub-brick, and move copies in it. The other
// copies of the same tetrahedra are far away, outside the part of the output near the voxels' own
// brick.
TEST(IncrementalCuts, CopiesInTheNextBrickMove)
{
  for (const Resampling method : GetExactMethods())
  {
    SCOPED_TRACE(static_cast<int>(method));
    VoxelField made;
    made.Volume.Method = method;
    made.Volume.Output = { { 0, 90, 0, 170, 0, VoxelField::Size - 1 } };
    for (int voxel = 0; voxel < VoxelField::Size * VoxelField::Size * VoxelField::Size; ++voxel)
    {
      // A sub-brick begins at x = 16. The planes x = 16 and x = 17 are the other side of the cut,
      // except for some vertices at x = 17. Some tetrahedra therefore have copies on both planes.
      const int x = voxel % VoxelField::Size;
      const int y = voxel / VoxelField::Size % VoxelField::Size;
      const bool isOther = x == 16 || (x == 17 && y % 4 != 0);
      made.Volume.CutDistances.push_back(isOther ? -1.0F : 1.0F);
      // Copies on the second plane are extrapolated away from the plane after the next one.
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

INSTANTIATE_TEST_SUITE_P(Ways, IncrementalCutMotions, GetWays(), GetWayName);
