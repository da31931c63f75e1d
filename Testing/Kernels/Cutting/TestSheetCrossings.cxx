// SPDX-License-Identifier: BSD-3-Clause
// The tetrahedra that a sheet divides: planes with known numbers, rough sheets with known sides,
// sheets in parts, two sheets, sheets that end inside the volume, and edits.
#include "CuttingReference.h"
#include "MaskEditor.h"
#include "Sheet.h"
#include "SheetCut.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

using namespace deformvolume;

namespace
{

const Extent Cells{ { -1, 11, 2, 12, 0, 9 } };

// A sheet over a grid of points (u, v) from low to high, with triangles of random orientation.
// first, last: the range of rows of squares that the sheet has.
Sheet MakeSheet(std::mt19937& random, int count, double low, double high,
  const std::function<glm::dvec3(double, double)>& place, int first = 0, int last = 1000)
{
  std::vector<glm::dvec3> points;
  for (int v = 0; v <= count; ++v)
  {
    for (int u = 0; u <= count; ++u)
    {
      points.push_back(place(low + (high - low) * u / count, low + (high - low) * v / count));
    }
  }
  std::vector<Sheet::Triangle> triangles;
  for (int v = first; v < std::min(count, last); ++v)
  {
    for (int u = 0; u < count; ++u)
    {
      const std::int64_t p = v * (count + 1) + u;
      const std::int64_t q = p + count + 1;
      triangles.push_back({ { p, p + 1, q } });
      triangles.push_back({ { p + 1, q + 1, q } });
      std::shuffle(
        triangles[triangles.size() - 2].begin(), triangles[triangles.size() - 2].end(), random);
    }
  }
  std::shuffle(triangles.begin(), triangles.end(), random);
  return Sheet(points, triangles);
}

struct Made
{
  std::vector<unsigned char> Divided, Mask;
  std::vector<float> Distances;

  explicit Made(MaskEditor& editor)
    : Divided(editor.GetSmoothCrossings().GetCrossed())
    , Mask(editor.GetMask())
    , Distances(editor.GetSmoothCrossings().GetDistances())
  {
  }
  bool operator==(const Made& other) const
  {
    return this->Divided == other.Divided && this->Mask == other.Mask &&
      this->Distances == other.Distances;
  }
};

Made CutByAll(const VertexPositions& positions, const std::vector<Sheet>& sheets)
{
  MaskEditor editor(positions.GetBricks().GetVertices());
  for (const Sheet& sheet : sheets)
  {
    editor.Add({}, {}, FindSheetCrossings(positions, sheet));
  }
  return Made(editor);
}

int CountBits(const std::vector<unsigned char>& cells)
{
  int count = 0;
  for (const unsigned char cell : cells)
  {
    for (int t = 0; t < 5; ++t)
    {
      count += cell >> t & 1;
    }
  }
  return count;
}

int CountOff(const Made& made)
{
  return 5 * static_cast<int>(made.Mask.size()) - CountBits(made.Mask);
}

std::vector<unsigned char> FindCrossed(const VertexPositions& positions, const Sheet& sheet)
{
  MaskEditor editor(positions.GetBricks().GetVertices());
  editor.Add(FindCrossedTetrahedra(positions, sheet));
  std::vector<unsigned char> crossed = editor.GetMask();
  for (unsigned char& cell : crossed)
  {
    cell ^= 31;
  }
  return crossed;
}

// Calls function(cell, tetrahedron, local numbers of its vertices) for all tetrahedra.
void ForEachTetrahedron(const Extent& extent,
  const std::function<void(std::size_t, int, const std::array<std::size_t, 4>&)>& function)
{
  static const int table[5][4] = { { 0, 2, 3, 6 }, { 6, 7, 3, 5 }, { 3, 1, 0, 5 }, { 0, 4, 6, 5 },
    { 6, 3, 5, 0 } };
  const auto width = static_cast<std::size_t>(GetSize(extent, 0));
  const auto height = static_cast<std::size_t>(GetSize(extent, 1));
  std::size_t cell = 0;
  for (int z = extent[4]; z < extent[5]; ++z)
  {
    for (int y = extent[2]; y < extent[3]; ++y)
    {
      for (int x = extent[0]; x < extent[1]; ++x, ++cell)
      {
        for (int t = 0; t < 5; ++t)
        {
          std::array<std::size_t, 4> vertices;
          for (int k = 0; k < 4; ++k)
          {
            const int v = table[t][k] ^ ((x & 1) | (z & 1) << 1 | (y & 1) << 2);
            vertices[k] = (static_cast<std::size_t>(z - extent[4] + (v >> 1 & 1)) * height +
                            static_cast<std::size_t>(y - extent[2] + (v >> 2))) *
                width +
              static_cast<std::size_t>(x - extent[0] + (v & 1));
          }
          function(cell, t, vertices);
        }
      }
    }
  }
}

glm::dvec3 GetIndexOf(const Extent& extent, std::size_t vertex)
{
  const auto i = static_cast<std::int64_t>(vertex);
  return glm::dvec3(extent[0] + i % GetSize(extent, 0),
    extent[2] + i / GetSize(extent, 0) % GetSize(extent, 1),
    extent[4] + i / (GetSize(extent, 0) * GetSize(extent, 1)));
}

} // namespace

TEST(SheetCrossings, PlanesDivideWhatTheyCross)
{
  std::mt19937 random(1);
  const RestPositions positions(Cells);
  struct Case
  {
    glm::dvec3 Normal;
    double Place;
    std::function<glm::dvec3(double, double)> Plane;
  };
  const std::vector<Case> cases{ { { 1, 0, 0 }, 4.5,
                                   [](double u, double v) { return glm::dvec3(4.5, u, v); } },
    { { 1, 0, 0 }, 4.0, [](double u, double v) { return glm::dvec3(4.0, u, v); } },
    { { 0, 0, 1 }, 3.3, [](double u, double v) { return glm::dvec3(u, v, 3.3); } },
    { { 1, 1, 0 }, 12, [](double u, double v) { return glm::dvec3(u, 12.0 - u, v); } },
    { { 0.25, -0.5, 1 }, 1.5,
      [](double u, double v) { return glm::dvec3(u, v, 1.5 - 0.25 * u + 0.5 * v); } } };
  for (const Case& plane : cases)
  {
    for (int count = 1; count < 9; ++count)
    {
      SCOPED_TRACE(count);
      const Sheet sheet = MakeSheet(random, count, -20, 28, plane.Plane);
      const Made made = CutByAll(positions, { sheet });
      EXPECT_EQ(made.Divided, FindCrossed(positions, sheet));
      EXPECT_GT(CountBits(made.Divided), 300);
      EXPECT_EQ(CountOff(made), 0);
      // All signs may be reversed. Points are rounded to 1/256 on three axes.
      double sign = 0.0;
      for (std::size_t v = 0; v < made.Distances.size(); ++v)
      {
        const double expected =
          (glm::dot(plane.Normal, GetIndexOf(Cells, v)) - plane.Place) / glm::length(plane.Normal);
        if (made.Distances[v] == 0.0F)
        {
          continue;
        }
        sign = sign == 0.0 && std::abs(expected) > 0.1
          ? made.Distances[v] / expected > 0 ? 1.0 : -1.0
          : sign;
        ASSERT_NEAR(std::abs(made.Distances[v]), std::abs(expected), 4.0 / 256.0);
        if (sign != 0.0 && std::abs(expected) > 4.0 / 256.0)
        {
          ASSERT_GT(sign * expected * made.Distances[v], 0.0);
        }
      }
      EXPECT_NE(sign, 0.0);
    }
  }
}

// A sheet over the whole volume that goes up and down, with known sides of the vertices. No
// undivided tetrahedron has vertices on both sides, and divided tetrahedra are divided by these
// sides.
TEST(SheetCrossings, RoughSheetsDivideByTheirSides)
{
  std::mt19937 random(2);
  int divided = 0;
  int off = 0;
  for (int round = 0; round < 60; ++round)
  {
    SCOPED_TRACE(round);
    const int count = 6 + round % 12;
    std::vector<double> heights;
    std::uniform_int_distribution<int> height(256 * 3, 256 * (4 + round % 4));
    for (int i = 0; i < (count + 1) * (count + 1); ++i)
    {
      heights.push_back(height(random) / 256.0);
    }
    const double low = -5.0;
    const double step = 24.0 / count;
    const auto heightAt = [&](int u, int v) { return heights[v * (count + 1) + u]; };
    std::size_t next = 0;
    const Sheet sheet = MakeSheet(random, count, low, low + 24.0,
      [&](double u, double v) { return glm::dvec3(u, v, heights[next++]); });
    const RestPositions positions(Cells);
    const Made made = CutByAll(positions, { sheet });
    std::vector<int> sides(made.Distances.size());
    for (std::size_t i = 0; i < sides.size(); ++i)
    {
      const glm::dvec3 p = GetIndexOf(Cells, i);
      const double u = (p.x - low) / step;
      const double v = (p.y - low) / step;
      const int cu = static_cast<int>(u);
      const int cv = static_cast<int>(v);
      const double s = u - cu;
      const double t = v - cv;
      const double z = s + t <= 1.0
        ? heightAt(cu, cv) + s * (heightAt(cu + 1, cv) - heightAt(cu, cv)) +
          t * (heightAt(cu, cv + 1) - heightAt(cu, cv))
        : heightAt(cu + 1, cv + 1) + (1 - s) * (heightAt(cu, cv + 1) - heightAt(cu + 1, cv + 1)) +
          (1 - t) * (heightAt(cu + 1, cv) - heightAt(cu + 1, cv + 1));
      // Points of the sheet are rounded to 1/256. With slopes of about ten this changes the height
      // by about 10/256.
      sides[i] = std::abs(p.z - z) < 12.0 / 256.0 ? 0 : p.z > z ? 1 : -1;
    }
    double product = 0.0; // the product of side and sign, which is the same for all vertices
    ForEachTetrahedron(Cells,
      [&](std::size_t cell, int t, const std::array<std::size_t, 4>& v)
      {
        if ((made.Mask[cell] >> t & 1) == 0)
        {
          ++off;
          return;
        }
        const bool isDivided = (made.Divided[cell] >> t & 1) != 0;
        divided += isDivided ? 1 : 0;
        for (int k = 0; k < 4; ++k)
        {
          const bool known = sides[v[0]] != 0 && sides[v[k]] != 0;
          if (!isDivided && known)
          {
            ASSERT_EQ(sides[v[0]], sides[v[k]]);
          }
          if (isDivided && sides[v[k]] != 0)
          {
            const double here = made.Distances[v[k]] * sides[v[k]] > 0 ? 1.0 : -1.0;
            product = product == 0.0 ? here : product;
            ASSERT_EQ(product, here);
          }
        }
      });
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(divided, 10000);
  EXPECT_LT(off, divided / 2);
}

TEST(SheetCrossings, PartsOfASheetDivideAsTheWhole)
{
  std::mt19937 random(3);
  const RestPositions positions(Cells);
  const auto place = [](double u, double v)
  { return glm::dvec3(u, v, 4.3 + 0.3 * std::sin(0.5 * u) + 0.2 * v); };
  // All parts have the same orientation, which follows from their first triangles.
  const auto make = [&](int first, int last)
  {
    std::mt19937 same(1);
    std::vector<glm::dvec3> points;
    std::vector<Sheet::Triangle> triangles;
    for (int v = 0; v <= 12; ++v)
    {
      for (int u = 0; u <= 12; ++u)
      {
        points.push_back(place(2.0 * u - 6.0, 2.0 * v - 6.0));
      }
    }
    for (int v = first; v < last; ++v)
    {
      for (int u = 0; u < 12; ++u)
      {
        const std::int64_t p = v * 13 + u;
        triangles.push_back({ { p, p + 1, p + 13 } });
        triangles.push_back({ { p + 1, p + 14, p + 13 } });
      }
    }
    return Sheet(points, triangles);
  };
  const Made whole = CutByAll(positions, { make(0, 12) });
  EXPECT_GT(CountBits(whole.Divided), 300);
  EXPECT_TRUE(CutByAll(positions, { make(0, 5), make(5, 12) }) == whole);
  EXPECT_TRUE(CutByAll(positions, { make(7, 12), make(0, 3), make(3, 7) }) == whole);
  // A sheet that ends inside the volume does not divide the tetrahedra that it only enters.
  const Made half = CutByAll(positions, { make(0, 5) });
  const std::vector<unsigned char> crossed = FindCrossed(positions, make(0, 5));
  EXPECT_EQ(CountOff(half), 0);
  EXPECT_LT(CountBits(half.Divided), CountBits(crossed));
  EXPECT_GT(CountBits(half.Divided), CountBits(crossed) / 2);
  for (std::size_t cell = 0; cell < crossed.size(); ++cell)
  {
    ASSERT_EQ(half.Divided[cell] & ~crossed[cell], 0);
    ASSERT_EQ(half.Divided[cell] & ~whole.Divided[cell], 0);
  }
}

TEST(SheetCrossings, TetrahedraCrossedTwiceAreSwitchedOff)
{
  std::mt19937 random(4);
  const RestPositions positions(Cells);
  const Sheet first =
    MakeSheet(random, 3, -20, 28, [](double u, double v) { return glm::dvec3(u, v, 4.3); });
  for (const auto& [slope, place] :
    { std::pair(0.7, 1.0), std::pair(0.0, 4.6), std::pair(0.0, 5.2) })
  {
    SCOPED_TRACE(place);
    const Sheet second = MakeSheet(random, 3, -20, 28,
      [slope = slope, place = place](double u, double v)
      { return glm::dvec3(u, v, place + slope * u); });
    const Made both = CutByAll(positions, { first, second });
    EXPECT_TRUE(CutByAll(positions, { second, first }) == both);
    const std::vector<unsigned char> byFirst = FindCrossed(positions, first);
    const std::vector<unsigned char> bySecond = FindCrossed(positions, second);
    // If the sheets are a voxel apart and have opposite orientations, each tetrahedron is divided
    // by one of them.
    EXPECT_TRUE(CountOff(both) > 20 || place == 5.2);
    for (std::size_t cell = 0; cell < byFirst.size(); ++cell)
    {
      // Every crossed tetrahedron is divided or off. Tetrahedra that both sheets cross are off. No
      // other tetrahedron changes.
      const int off = 31 & ~both.Mask[cell];
      ASSERT_EQ(both.Divided[cell] | off, byFirst[cell] | bySecond[cell]);
      ASSERT_EQ(both.Divided[cell] & byFirst[cell] & bySecond[cell], 0);
      ASSERT_EQ(both.Divided[cell] & off, 0);
    }
    // The result is the same if the first cut is the base cut of the volume.
    const Made alone = CutByAll(positions, { first });
    MaskEditor chain(Cells);
    chain.SetBaseCut(alone.Divided.data(), alone.Distances.data());
    chain.Add({}, {}, FindSheetCrossings(positions, second));
    EXPECT_TRUE(Made(chain) == both);
  }
}

TEST(SheetCrossings, EditsAreUndoneBitForBit)
{
  std::mt19937 random(5);
  const RestPositions positions(Cells);
  MaskEditor editor(Cells);
  const std::vector<unsigned char> none(editor.GetMask().size(), 0);
  const std::vector<float> zeros(static_cast<std::size_t>(GetNumberOfPoints(Cells)), 0.0F);
  editor.SetBaseCut(none.data(), zeros.data());
  std::vector<std::pair<std::uint64_t, Sheet>> edits;
  std::vector<Made> states{ Made(editor) };
  for (int round = 0; round < 8; ++round)
  {
    const double slope = static_cast<double>(random() % 100) / 100.0;
    const double at = 2.0 + static_cast<double>(random() % 400) / 100.0;
    const Sheet sheet = MakeSheet(random, 4, round % 2 ? -20 : 3, 28,
      [=](double u, double v) { return glm::dvec3(u, v, at + slope * (u - 5.0)); });
    edits.emplace_back(editor.Add({}, {}, FindSheetCrossings(positions, sheet)), sheet);
    states.emplace_back(editor);
    std::vector<Sheet> sheets;
    for (const auto& edit : edits)
    {
      sheets.push_back(edit.second);
    }
    ASSERT_TRUE(CutByAll(positions, sheets) == states.back()) << "cut " << round;
  }
  for (std::size_t i = states.size() - 1; i-- > 0;)
  {
    ASSERT_TRUE(editor.Undo());
    ASSERT_TRUE(Made(editor) == states[i]) << "state " << i;
  }
  for (std::size_t i = 1; i < states.size(); ++i)
  {
    ASSERT_TRUE(editor.Redo());
    ASSERT_TRUE(Made(editor) == states[i]) << "state " << i;
  }
  // Remove an edit in the middle, change the base mask, then remove all edits.
  EXPECT_TRUE(editor.Remove(edits[3].first));
  edits.erase(edits.begin() + 3);
  std::vector<Sheet> sheets;
  for (const auto& edit : edits)
  {
    sheets.push_back(edit.second);
  }
  const Made left = CutByAll(positions, sheets);
  EXPECT_TRUE(Made(editor) == left);
  std::vector<unsigned char> base(left.Mask.size(), 31);
  base[17] = 5;
  editor.SetBase(base.data());
  EXPECT_EQ(editor.GetMask()[17], left.Mask[17] & 5);
  editor.SetBase(nullptr);
  EXPECT_TRUE(Made(editor) == left);
  editor.Reset();
  EXPECT_TRUE(Made(editor) == states.front());
  EXPECT_EQ(editor.GetNumberOfSwitchedOffTetrahedra(), 0);
}
