// SPDX-License-Identifier: BSD-3-Clause
// However nodes and tetrahedra are numbered, the device has them in the same order, and the results
// are the same to the last bit.
#include "DeviceNeeds.h"
#include "EditedVolume.h"
#include "MeshOrder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

using namespace deformvolume;

namespace
{

// A volume, and the same with other numbers.
struct Renumbered
{
  explicit Renumbered(const EditedVolume& volume)
    : Nodes(MakeNumbers(volume.GetNumberOfNodes()))
    , Tetrahedra(MakeNumbers(volume.Tetrahedra.size()))
    , Volume(volume)
  {
    for (std::size_t t = 0; t < this->Tetrahedra.size(); ++t)
    {
      std::transform(volume.Tetrahedra[t].begin(), volume.Tetrahedra[t].end(),
        this->Volume.Tetrahedra[this->Tetrahedra[t]].begin(),
        [&](std::int32_t node) { return this->Nodes[node]; });
    }
    for (VertexLink& link : this->Volume.Links)
    {
      link.Tetrahedron = link.Tetrahedron < 0 ? -1 : this->Tetrahedra[link.Tetrahedron];
    }
    for (RestTetrahedron& record : this->Volume.Runs.Tetrahedra)
    {
      record.Tetrahedron = this->Tetrahedra[record.Tetrahedron];
    }
    this->Follow(volume);
  }

  void Follow(const EditedVolume& volume)
  {
    for (std::size_t node = 0; node < this->Nodes.size(); ++node)
    {
      std::copy_n(volume.Displacements.begin() + 3 * node, 3,
        this->Volume.Displacements.begin() + 3 * this->Nodes[node]);
    }
  }

  static std::vector<std::int32_t> MakeNumbers(std::size_t count)
  {
    std::vector<std::int32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0);
    std::mt19937 random(3);
    std::shuffle(numbers.begin(), numbers.end(), random);
    return numbers;
  }

  std::vector<std::int32_t> Nodes; // the new number of each
  std::vector<std::int32_t> Tetrahedra;
  EditedVolume Volume;
};

void ExpectSameOnDevice(const MeshOrder& order, const MeshOrder& other, const Renumbered& numbers,
  const std::vector<bool>& isUsed)
{
  std::vector<bool> isTaken(order.Tetrahedra.size());
  for (std::size_t t = 0; t < order.Tetrahedra.size(); ++t)
  {
    const std::int32_t number = other.Tetrahedra[numbers.Tetrahedra[t]];
    EXPECT_FALSE(isTaken[number]);
    isTaken[number] = true;
    if (isUsed[t])
    {
      EXPECT_EQ(number, order.Tetrahedra[t]);
    }
  }
  std::vector<bool> isNodeTaken(order.Nodes.size());
  for (std::size_t node = 0; node < order.Nodes.size(); ++node)
  {
    const std::int32_t number = other.Nodes[numbers.Nodes[node]];
    EXPECT_FALSE(isNodeTaken[number]);
    isNodeTaken[number] = true;
  }
}

class Numbering : public testing::TestWithParam<Route>
{
};

} // namespace

TEST(MeshOrder, IsThatOfUseAndNotOfTheMesh)
{
  const EditedVolume volume;
  const Renumbered numbers(volume);
  const BrickGrid bricks(volume.Shape);
  std::vector<bool> isUsed(volume.Tetrahedra.size());
  for (const VertexLink& link : volume.Links)
  {
    if (link.Tetrahedron >= 0)
    {
      isUsed[link.Tetrahedron] = true;
    }
  }
  const auto find = [&](const EditedVolume& v, bool byRuns)
  {
    return byRuns
      ? FindOrder(v.Runs, v.Tetrahedra.data(), v.Tetrahedra.size(), v.GetNumberOfNodes())
      : FindOrder(
          bricks, v.Links.data(), v.Tetrahedra.data(), v.Tetrahedra.size(), v.GetNumberOfNodes());
  };
  for (const bool byRuns : { false, true })
  {
    ExpectSameOnDevice(find(volume, byRuns), find(numbers.Volume, byRuns), numbers, isUsed);
  }
  // Neighbours in a row are neighbours in memory.
  const MeshOrder order = find(numbers.Volume, false);
  std::int32_t highest = -1;
  for (const VertexLink& link : numbers.Volume.Links)
  {
    if (link.Tetrahedron >= 0)
    {
      EXPECT_LE(order.Tetrahedra[link.Tetrahedron], highest + 1);
      highest = std::max(highest, order.Tetrahedra[link.Tetrahedron]);
    }
    if (&link - numbers.Volume.Links.data() == 40)
    {
      break; // within the first brick
    }
  }
}

// Whole and incremental updates, with changes named and not.
TEST_P(Numbering, DoesNotMatter)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  EditedVolume volume;
  Renumbered numbers(volume);
  VolumeDeformer plain;
  VolumeDeformer updated;
  volume.SendAll(plain, GetParam());
  numbers.Volume.SendAll(updated, GetParam());
  EditedOutputs last(volume);
  std::mt19937 random(23);
  int parts = 0;
  for (int i = 0; i < 40; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    const std::vector<float> sent = numbers.Volume.Displacements;
    switch (i % 5)
    {
      case 0:
        volume.Move(random, 100, 1.5F);
        break;
      case 1:
        volume.MoveInside(random, 2.0F);
        break;
      case 2:
        volume.Move(random, 1, i % 2 ? 14.0F : 1.5F);
        break;
      default:
        volume.Move(random, 0, 1.5F);
    }
    numbers.Follow(volume);
    const PointRanges changes = numbers.Volume.FindChanges(sent, random);
    volume.SendDisplacements(plain, GetParam());
    numbers.Volume.SendDisplacements(updated, GetParam(), i % 2 ? &changes : nullptr);
    EditedOutputs expected(volume);
    const DeformReport wanted = plain.Deform(expected.MakeRequest(volume));
    DeformRequest request = last.MakeRequest(volume);
    request.Incremental = true;
    if (i > 0)
    {
      last.SetLast(request);
    }
    const DeformReport report = updated.Deform(request);
    ExpectSame(report, wanted);
    ASSERT_TRUE(last == expected);
    parts += report.NumberOfResampledBricks < report.NumberOfBricks ? 1 : 0;
  }
  if (parts > 0) // else the device is no processor
  {
    EXPECT_GT(parts, 10);
  }
}

INSTANTIATE_TEST_SUITE_P(Routes, Numbering, testing::Values(Route::Mesh, Route::Runs),
  [](const testing::TestParamInfo<Route>& info)
  { return info.param == Route::Mesh ? "Links" : "Runs"; });
