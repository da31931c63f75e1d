// SPDX-License-Identifier: BSD-3-Clause
// Cutting a volume at its deformed position.
#include "CutMask.h"
#include "CuttingReference.h"
#include "DeformedPositions.h"
#include "Error.h"
#include "Sheet.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

using namespace deformvolume;

namespace
{

// Three random triangles, translated by move.
Sheet MakeSheet(unsigned int seed, const glm::dvec3& move)
{
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> place(-5 * 256, 20 * 256);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 9; ++i)
  {
    points.push_back(move + glm::dvec3(place(random), place(random), place(random)) / 256.0);
  }
  return Sheet(points, { { { 0, 1, 2 } }, { { 3, 4, 5 } }, { { 6, 7, 8 } } });
}

struct BrickPositions
{
  std::vector<SnappedPoint> Points;
  std::vector<char> HasPosition;
};

BrickPositions FindPositions(const DeformedPositions& positions, std::size_t brick)
{
  const Extent vertices = positions.GetBricks().GetVertices(brick);
  const auto count = static_cast<std::size_t>(GetNumberOfPoints(vertices));
  BrickPositions found;
  found.Points.resize(count);
  std::unique_ptr<bool[]> has(new bool[count]);
  positions.Find(vertices, found.Points.data(), has.get());
  found.HasPosition.assign(has.get(), has.get() + count);
  return found;
}

// Checks that the box of each brick contains its vertices, and that the box of the volume contains
// these boxes. Returns by how many steps a box is longer than necessary, at most.
std::int64_t CheckBoxes(const DeformedPositions& positions)
{
  std::int64_t most = 0;
  for (std::size_t brick = 0; brick < positions.GetBricks().GetNumberOfBricks(); ++brick)
  {
    const BrickPositions found = FindPositions(positions, brick);
    SnappedBox exact;
    for (std::size_t i = 0; i < found.Points.size(); ++i)
    {
      if (found.HasPosition[i] != 0)
      {
        exact.Add(found.Points[i]);
      }
    }
    const SnappedBox box = positions.GetBox(brick);
    for (int axis = 0; axis < 3 && !exact.IsEmpty(); ++axis)
    {
      EXPECT_LE(box.Min[axis], exact.Min[axis]);
      EXPECT_GE(box.Max[axis], exact.Max[axis]);
      EXPECT_LE(positions.GetBox().Min[axis], box.Min[axis]);
      EXPECT_GE(positions.GetBox().Max[axis], box.Max[axis]);
      most = std::max({ most, exact.Min[axis] - box.Min[axis], box.Max[axis] - exact.Max[axis] });
    }
  }
  return most;
}

} // namespace

// If the volume moves by whole voxels, the cut equals that of the sheet moved back.
TEST(DeformedCutting, FollowsTheDeformation)
{
  const Extent vertices{ { -3, 17, 2, 13, 1, 12 } };
  const RestPositions rest(vertices);
  const std::vector<glm::dvec3> nodes{ glm::dvec3(-60, -60, -60), glm::dvec3(160, -50, -70),
    glm::dvec3(-50, 170, -40), glm::dvec3(-60, -40, 165) };
  const std::vector<Tetrahedron> tetrahedra{ { { 0, 1, 2, 3 } } };
  const glm::dvec3 move(3.0, -2.0, 5.0);
  std::vector<float> displacements;
  for (int node = 0; node < 4; ++node)
  {
    displacements.insert(displacements.end(), { 3.0F, -2.0F, 5.0F });
  }
  DisplacementField field;
  field.Dimensions = { { 2, 2, 2 } };
  const std::vector<float> vectors = [&]
  {
    std::vector<float> all;
    for (int i = 0; i < 8; ++i)
    {
      all.insert(all.end(), displacements.begin(), displacements.begin() + 3);
    }
    return all;
  }();
  field.Vectors = vectors.data();
  field.IndexToField = { { 0.04, 0, 0, 0.2, 0, 0.04, 0, 0.2, 0, 0, 0.04, 0.2 } };
  const StaticMapping links = BuildStaticMapping(
    vertices, glm::dvec3(1.0), nodes, tetrahedra, false, StaticMappingForm::Links);
  const StaticMapping runs = BuildStaticMapping(
    vertices, glm::dvec3(1.0), nodes, tetrahedra, false, StaticMappingForm::Runs);
  const DeformedMeshPositions byLinks(vertices, vertices, links, tetrahedra, displacements.data());
  const DeformedMeshPositions byRuns(vertices, vertices, runs, tetrahedra, displacements.data());
  const DeformedFieldPositions byField(vertices, field);
  EXPECT_THROW(DeformedMeshPositions(
                 { { 0, 8, 0, 8, 0, 8 } }, vertices, links, tetrahedra, displacements.data()),
    Error);
  int count = 0;
  for (unsigned int round = 0; round < 50; ++round)
  {
    const Sheet moved = MakeSheet(round, move);
    const reference::Mask expected = Cut(rest, MakeSheet(round, glm::dvec3(0.0)));
    count += reference::Count(expected);
    for (const VertexPositions* positions :
      std::initializer_list<const VertexPositions*>{ &byLinks, &byRuns, &byField })
    {
      ASSERT_EQ(Cut(*positions, moved), expected);
    }
  }
  EXPECT_GT(count, 5000);
  // Nothing is cut outside the mesh.
  const std::vector<glm::dvec3> half{ glm::dvec3(5, 5, 5), glm::dvec3(160, 5, 5),
    glm::dvec3(5, 170, 5), glm::dvec3(5, 5, 165) };
  const StaticMapping part = BuildStaticMapping(
    vertices, glm::dvec3(1.0), half, tetrahedra, false, StaticMappingForm::Links);
  const DeformedMeshPositions inPart(vertices, vertices, part, tetrahedra, displacements.data());
  const Sheet below({ glm::dvec3(-50, -50, 6.5), glm::dvec3(90, -50, 6.5), glm::dvec3(0, 90, 6.5) },
    { { { 0, 1, 2 } } });
  EXPECT_EQ(reference::Count(Cut(inPart, below)), 0);
  const Sheet inside(
    { glm::dvec3(-50, -50, 12.5), glm::dvec3(90, -50, 12.5), glm::dvec3(0, 90, 12.5) },
    { { { 0, 1, 2 } } });
  EXPECT_EQ(reference::Count(Cut(inPart, inside)), 5 * 12 * 8);
}

// Tests an affine deformation by links, by runs and by a field.
TEST(DeformedCutting, FindsDeformedPositions)
{
  const Extent vertices{ { -3, 20, 2, 13, 1, 12 } };
  const auto move = [](const glm::dvec3& p) {
    return glm::dvec3(0.3 * p.x - 0.2 * p.z + 1.0, 0.1 * p.y + 0.05 * p.x, 0.4 * p.z - 0.25 * p.y);
  };
  std::vector<glm::dvec3> nodes;
  std::vector<float> displacements;
  for (int i = 0; i < 8; ++i)
  {
    nodes.emplace_back(i & 1 ? 31 : -9, i & 2 ? 31 : -9, i & 4 ? 31 : -9);
    const glm::dvec3 moved = move(nodes.back());
    displacements.insert(displacements.end(),
      { static_cast<float>(moved.x), static_cast<float>(moved.y), static_cast<float>(moved.z) });
  }
  const std::vector<Tetrahedron> tetrahedra{ { { 0, 1, 3, 5 } }, { { 0, 3, 2, 6 } },
    { { 0, 5, 4, 6 } }, { { 3, 5, 6, 7 } }, { { 0, 3, 5, 6 } } };
  DisplacementField field;
  field.Dimensions = { { 2, 2, 2 } };
  field.Vectors = displacements.data();
  field.IndexToField = { { 0.025, 0, 0, 0.225, 0, 0.025, 0, 0.225, 0, 0, 0.025, 0.225 } };
  for (int form = 0; form < 3; ++form)
  {
    const StaticMapping mapping = BuildStaticMapping(vertices, glm::dvec3(1.0), nodes, tetrahedra,
      false, form == 1 ? StaticMappingForm::Runs : StaticMappingForm::Links);
    std::unique_ptr<DeformedPositions> positions;
    if (form == 2)
    {
      positions = std::make_unique<DeformedFieldPositions>(vertices, field);
    }
    else
    {
      positions = std::make_unique<DeformedMeshPositions>(
        vertices, vertices, mapping, tetrahedra, displacements.data());
    }
    for (std::size_t brick = 0; brick < positions->GetBricks().GetNumberOfBricks(); ++brick)
    {
      const Extent box = positions->GetBricks().GetVertices(brick);
      const BrickPositions found = FindPositions(*positions, brick);
      std::size_t i = 0;
      for (int z = box[4]; z <= box[5]; ++z)
      {
        for (int y = box[2]; y <= box[3]; ++y)
        {
          for (int x = box[0]; x <= box[1]; ++x, ++i)
          {
            ASSERT_TRUE(found.HasPosition[i]);
            const glm::dvec3 p(x, y, z);
            // The error of rounding is half a step. Displacements of at most 32 voxels have a
            // relative error of 2^-20, because they and the weights are floats. This adds less than
            // a hundredth of a step.
            const glm::dvec3 error = 256.0 * (p + move(p)) - glm::dvec3(found.Points[i]);
            ASSERT_LT(
              glm::max(glm::abs(error.x), glm::max(glm::abs(error.y), glm::abs(error.z))), 0.51);
          }
        }
      }
    }
    // A brick has 8 voxels, and tetrahedra have 40: the box of a brick may be larger by a
    // tetrahedron.
    EXPECT_LE(CheckBoxes(*positions), 256 * 40);
  }
}

// Tests random displacements of a mesh. Many vertices are extrapolated, or lie outside it.
TEST(DeformedCutting, BoxesHoldTheirVertices)
{
  const Extent vertices{ { -3, 30, 2, 23, 1, 20 } };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-2.0, 2.0);
  std::uniform_real_distribution<float> move(-20.0F, 20.0F);
  for (int round = 0; round < 30; ++round)
  {
    std::vector<glm::dvec3> nodes;
    std::vector<float> displacements;
    for (int i = 0; i < 8; ++i)
    {
      nodes.emplace_back(glm::dvec3(i & 1 ? 21 : 2, i & 2 ? 21 : 5, i & 4 ? 17 : 4) +
        glm::dvec3(jitter(random), jitter(random), jitter(random)));
      displacements.insert(displacements.end(), { move(random), move(random), move(random) });
    }
    const std::vector<Tetrahedron> tetrahedra{ { { 0, 1, 3, 5 } }, { { 0, 3, 2, 6 } },
      { { 0, 5, 4, 6 } }, { { 3, 5, 6, 7 } }, { { 0, 3, 5, 6 } } };
    const bool extrapolate = round % 3 == 0;
    const StaticMapping mapping = BuildStaticMapping(vertices, glm::dvec3(1.0), nodes, tetrahedra,
      extrapolate, round % 3 == 1 ? StaticMappingForm::Runs : StaticMappingForm::Links);
    DeformedMeshPositions positions(vertices, vertices, mapping, tetrahedra, displacements.data());
    CheckBoxes(positions);

    // After new displacements, the positions equal those of a new object.
    std::vector<float> others;
    for (std::size_t i = 0; i < displacements.size(); ++i)
    {
      others.push_back(move(random));
    }
    positions.SetDisplacements(others.data());
    CheckBoxes(positions);
    const DeformedMeshPositions made(vertices, vertices, mapping, tetrahedra, others.data());
    for (std::size_t brick = 0; brick < made.GetBricks().GetNumberOfBricks(); ++brick)
    {
      EXPECT_EQ(FindPositions(positions, brick).Points, FindPositions(made, brick).Points);
      EXPECT_EQ(positions.GetBox(brick).Min, made.GetBox(brick).Min);
      EXPECT_EQ(positions.GetBox(brick).Max, made.GetBox(brick).Max);
    }
  }
}

// Tests fields whose points lie beside and between the voxels, also rotated ones. They end within
// the volume, and contain NaN and values that are far too large.
TEST(DeformedCutting, BoxesOfFieldsHoldTheirVertices)
{
  const Extent vertices{ { -3, 30, 2, 23, 1, 20 } };
  std::mt19937 random(4);
  std::uniform_real_distribution<float> move(-20.0F, 20.0F);
  const std::vector<std::array<double, 12>> matrices{
    { { 1, 0, 0, 3, 0, 1, 0, -2, 0, 0, 1, -1 } },
    { { 0.3, 0, 0, 1.1, 0, 0.3, 0, -0.4, 0, 0, 0.4, 0 } },
    { { 0.4, 0.3, 0, 1, -0.3, 0.4, 0.1, 7, 0, -0.2, 1.2, 1 } },
  };
  for (int round = 0; round < 30; ++round)
  {
    DisplacementField field;
    field.Dimensions = { { 34, 22, 20 } };
    std::vector<float> vectors;
    for (std::int64_t i = 0; i < 3 * GetNumberOfPoints(field); ++i)
    {
      vectors.push_back(move(random));
    }
    if (round % 4 == 1)
    {
      vectors[3 * 2000 + 1] = std::numeric_limits<float>::quiet_NaN();
      vectors[3 * 5000] = std::numeric_limits<float>::infinity();
    }
    if (round % 4 == 2)
    {
      vectors[3 * 2000 + 1] = 1e30F;
      vectors[3 * 5000] = -20000.0F;
    }
    field.Vectors = vectors.data();
    field.IndexToField = matrices[static_cast<std::size_t>(round % 3)];
    field.ToDisplacement = { { 0.5, 0.25, 0, -0.125, 1, 0, 0, 0, 2 } };
    field.Extrapolate = round % 2 == 0;
    CheckBoxes(DeformedFieldPositions(vertices, field));
  }
}

// Bricks that are far from the moved points of a field have the box that they have at rest.
TEST(DeformedCutting, BoxesAreTight)
{
  const Extent vertices{ { 0, 32, 0, 32, 0, 32 } };
  DisplacementField field;
  field.Dimensions = { { 33, 33, 33 } };
  std::vector<float> vectors(static_cast<std::size_t>(3 * GetNumberOfPoints(field)), 0.0F);
  for (std::size_t i = 0; i < 3; ++i)
  {
    vectors[3 * (33 * (33 * 4 + 4) + 4) + i] = 7.0F;
  }
  field.Vectors = vectors.data();
  const DeformedFieldPositions positions(vertices, field);
  const RestPositions rest(vertices);
  EXPECT_LE(CheckBoxes(positions), 256 * 7);
  EXPECT_GE(positions.GetBox(0).Max.x, 256 * 11);
  for (std::size_t brick = 1; brick < 64; ++brick)
  {
    EXPECT_EQ(positions.GetBox(brick).Min, rest.GetBox(brick).Min - SnappedPoint(1));
    EXPECT_EQ(positions.GetBox(brick).Max, rest.GetBox(brick).Max + SnappedPoint(1));
  }
}

// A field changes at some reported points. The boxes of all bricks must equal those of a new
// object.
TEST(DeformedCutting, BoxesFollowChanges)
{
  const Extent vertices{ { 3, 30, 2, 23, -4, 20 } };
  std::mt19937 random(5);
  std::uniform_real_distribution<float> move(-20.0F, 20.0F);
  DisplacementField field;
  field.Dimensions = { { 31, 25, 28 } };
  field.IndexToField = { { 1, 0, 0, -2, 0, 1, 0, 1, 0, 0, 1, 5 } };
  std::vector<float> vectors(static_cast<std::size_t>(3 * GetNumberOfPoints(field)), 0.0F);
  field.Vectors = vectors.data();
  DeformedFieldPositions positions(vertices, field);
  for (int round = 0; round < 60; ++round)
  {
    PointRanges changes;
    const std::size_t points = vectors.size() / 3;
    std::size_t begin = random() % points;
    for (int i = 0; i < 3 && begin < points; ++i)
    {
      const std::size_t end = std::min(begin + 1 + random() % (round % 5 == 0 ? 2000 : 3), points);
      changes.push_back({ { begin, end } });
      for (std::size_t value = 3 * begin; value < 3 * end; ++value)
      {
        vectors[value] = move(random);
      }
      begin = end + random() % 5000;
    }
    positions.SetField(field, round % 20 == 19 ? nullptr : &changes);
    const DeformedFieldPositions made(vertices, field);
    for (std::size_t brick = 0; brick < made.GetBricks().GetNumberOfBricks(); ++brick)
    {
      ASSERT_EQ(positions.GetBox(brick).Min, made.GetBox(brick).Min);
      ASSERT_EQ(positions.GetBox(brick).Max, made.GetBox(brick).Max);
    }
    ASSERT_EQ(positions.GetBox().Min, made.GetBox().Min);
  }
}
