// SPDX-License-Identifier: BSD-3-Clause
// Cutting a volume where a deformation has moved it.
#include "CuttingReference.h"
#include "DeformedPositions.h"
#include "Error.h"
#include "Sheet.h"
#include "SheetCut.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

using namespace deformvolume;

namespace
{

reference::Mask Cut(const VertexPositions& positions, const Sheet& sheet)
{
  return reference::GetMask(positions.GetBricks(), FindCrossedTetrahedra(positions, sheet));
}

// Three random triangles, moved.
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

} // namespace

// Where the volume has moved by whole voxels, the cut is that of a sheet that has moved back.
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
  const DeformedPositions byLinks(vertices, vertices, links, tetrahedra, displacements.data());
  const DeformedPositions byRuns(vertices, vertices, runs, tetrahedra, displacements.data());
  const DeformedPositions byField(vertices, field);
  EXPECT_THROW(
    DeformedPositions({ { 0, 8, 0, 8, 0, 8 } }, vertices, links, tetrahedra, displacements.data()),
    Error);
  int count = 0;
  for (unsigned int round = 0; round < 50; ++round)
  {
    const Sheet moved = MakeSheet(round, move);
    const reference::Mask expected = Cut(rest, MakeSheet(round, glm::dvec3(0.0)));
    count += reference::Count(expected);
    for (const DeformedPositions* positions : { &byLinks, &byRuns, &byField })
    {
      ASSERT_EQ(Cut(*positions, moved), expected);
    }
  }
  EXPECT_GT(count, 5000);
  // Outside the mesh there is nothing to cut.
  const std::vector<glm::dvec3> half{ glm::dvec3(5, 5, 5), glm::dvec3(160, 5, 5),
    glm::dvec3(5, 170, 5), glm::dvec3(5, 5, 165) };
  const StaticMapping part = BuildStaticMapping(
    vertices, glm::dvec3(1.0), half, tetrahedra, false, StaticMappingForm::Links);
  const DeformedPositions inPart(vertices, vertices, part, tetrahedra, displacements.data());
  const Sheet below({ glm::dvec3(-50, -50, 6.5), glm::dvec3(90, -50, 6.5), glm::dvec3(0, 90, 6.5) },
    { { { 0, 1, 2 } } });
  EXPECT_EQ(reference::Count(Cut(inPart, below)), 0);
  const Sheet inside(
    { glm::dvec3(-50, -50, 12.5), glm::dvec3(90, -50, 12.5), glm::dvec3(0, 90, 12.5) },
    { { { 0, 1, 2 } } });
  EXPECT_EQ(reference::Count(Cut(inPart, inside)), 5 * 12 * 8);
}

// An affine deformation, by links, by runs and by a field.
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
    const std::unique_ptr<DeformedPositions> positions = form == 2
      ? std::make_unique<DeformedPositions>(vertices, field)
      : std::make_unique<DeformedPositions>(
          vertices, vertices, mapping, tetrahedra, displacements.data());
    SnappedBox all;
    for (std::size_t brick = 0; brick < positions->GetBricks().GetNumberOfBricks(); ++brick)
    {
      const Extent box = positions->GetBricks().GetVertices(brick);
      std::vector<SnappedPoint> points(729);
      bool has[729];
      positions->Find(box, points.data(), has);
      std::size_t i = 0;
      SnappedBox found;
      for (int z = box[4]; z <= box[5]; ++z)
      {
        for (int y = box[2]; y <= box[3]; ++y)
        {
          for (int x = box[0]; x <= box[1]; ++x, ++i)
          {
            ASSERT_TRUE(has[i]);
            const glm::dvec3 p(x, y, z);
            // Rounding moves by half a step, and floats of weights and displacements, which are
            // exact to 2^-20 of at most 32 voxels, by less than a hundredth.
            const glm::dvec3 error = 256.0 * (p + move(p)) - glm::dvec3(points[i]);
            ASSERT_LT(
              glm::max(glm::abs(error.x), glm::max(glm::abs(error.y), glm::abs(error.z))), 0.51);
            found.Add(points[i]);
          }
        }
      }
      EXPECT_EQ(positions->GetBox(brick).Min, found.Min);
      EXPECT_EQ(positions->GetBox(brick).Max, found.Max);
      all.Add(found);
    }
    EXPECT_EQ(positions->GetBox().Min, all.Min);
    EXPECT_EQ(positions->GetBox().Max, all.Max);
  }
}
