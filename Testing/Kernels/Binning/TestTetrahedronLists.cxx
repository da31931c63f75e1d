// SPDX-License-Identifier: BSD-3-Clause
// The lists of the tetrahedra in each tile, compared with lists that the host makes tile by tile.
// Tests misuse, limits, and that results do not depend on the size of work-groups. With a given
// size of work-groups, CPUs make the lists as other devices do.
#include "CaughtError.h"
#include "MemoryBudget.h"
#include "Tetrahedron.h"
#include "TetrahedronLists.h"
#include "WorkDevice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

constexpr int TileSize[3] = { 32, 8, 8 };

// 0: chosen for the device.
constexpr std::size_t GroupSizes[] = { 0, 1, 2, 7, 64, 256, 1000 };

using Lists = std::vector<std::vector<int>>;
using Position = std::array<cl_int, 4>; // in 1/256 voxel

// A deformed mesh and an output. Tiles are aligned to multiples of their size.
struct ListCase
{
  ListCase(const std::array<int, 3>& first, const std::array<int, 3>& size)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const auto divide = [axis](int index)
      {
        const int rest = (index % TileSize[axis] + TileSize[axis]) % TileSize[axis];
        return (index - rest) / TileSize[axis];
      };
      this->Parameters.OutputFirst[axis] = first[axis];
      this->Parameters.OutputSize[axis] = size[axis];
      this->Parameters.TileFirst[axis] = divide(first[axis]);
      this->Parameters.TileCount[axis] =
        divide(first[axis] + size[axis] - 1) - this->Parameters.TileFirst[axis] + 1;
    }
  }

  std::size_t GetNumberOfTiles() const
  {
    return static_cast<std::size_t>(CountTiles(this->Parameters));
  }

  // Adds a tetrahedron with its own four nodes, in 1/256 voxel.
  void Add(const std::array<Position, 4>& nodes)
  {
    const int first = static_cast<int>(this->Positions.size());
    this->Tetrahedra.push_back({ { first, first + 1, first + 2, first + 3 } });
    this->Positions.insert(this->Positions.end(), nodes.begin(), nodes.end());
  }

  // Adds tetrahedra anywhere in and around the output, up to `width` voxels wide. About half of
  // them are inverted, and some are flat.
  void AddRandom(int number, int width, unsigned int seed)
  {
    std::mt19937 random(seed);
    const auto pick = [&random](int low, int high)
    { return std::uniform_int_distribution<int>(low, high)(random); };
    for (int i = 0; i < number; ++i)
    {
      std::array<Position, 4> nodes{};
      Position corner{};
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const int first = this->Parameters.OutputFirst[axis];
        corner[axis] = 256 * pick(first - width, first + this->Parameters.OutputSize[axis]);
      }
      for (Position& node : nodes)
      {
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          node[axis] = corner[axis] + pick(0, 256 * width);
        }
      }
      if (i % 10 == 9)
      {
        nodes[3] = nodes[1];
      }
      this->Add(nodes);
      if (i % 17 == 16)
      {
        this->Tetrahedra.back().fill(-1); // flat at rest
      }
    }
  }

  // Adds a tetrahedron that contains the whole output.
  void AddLarge()
  {
    std::array<Position, 4> nodes{};
    for (std::size_t node = 0; node < 4; ++node)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const int first = this->Parameters.OutputFirst[axis];
        nodes[node][axis] =
          256 * (node == axis + 1 ? first + this->Parameters.OutputSize[axis] + 3 : first - 2);
      }
    }
    this->Add(nodes);
  }

  std::vector<Tetrahedron> Tetrahedra;
  std::vector<Position> Positions;
  RasterParameters Parameters = {};
};

__extension__ typedef __int128 Wide;

// The sign of the signed volume.
int GetSign(const ListCase& c, const Tetrahedron& tetrahedron)
{
  Wide m[3][3];
  for (std::size_t side = 0; side < 3; ++side)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      m[side][axis] =
        Wide(c.Positions[tetrahedron[side + 1]][axis]) - c.Positions[tetrahedron[0]][axis];
    }
  }
  const Wide volume = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
    m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
    m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (volume > 0) - (volume < 0);
}

// Whether the box around a tetrahedron contains output voxels of a tile, on one axis.
bool Meets(const ListCase& c, const Tetrahedron& tetrahedron, std::size_t axis, int tile)
{
  const RasterParameters& p = c.Parameters;
  const int origin = (p.TileFirst[axis] + tile) * TileSize[axis];
  const int begin = std::max(origin, p.OutputFirst[axis]);
  const int end = std::min(origin + TileSize[axis], p.OutputFirst[axis] + p.OutputSize[axis]);
  cl_int low = c.Positions[tetrahedron[0]][axis];
  cl_int high = low;
  for (const int node : tetrahedron)
  {
    low = std::min(low, c.Positions[node][axis]);
    high = std::max(high, c.Positions[node][axis]);
  }
  for (int voxel = begin; voxel < end; ++voxel)
  {
    if (low <= 256 * voxel && 256 * voxel <= high)
    {
      return true;
    }
  }
  return false;
}

Lists MakeReference(const ListCase& c, std::int64_t& inverted)
{
  Lists lists(c.GetNumberOfTiles());
  inverted = 0;
  for (const int sign : { 1, -1 })
  {
    for (std::size_t t = 0; t < c.Tetrahedra.size(); ++t)
    {
      if (c.Tetrahedra[t][0] < 0 || GetSign(c, c.Tetrahedra[t]) != sign)
      {
        continue;
      }
      inverted += sign < 0;
      std::array<std::vector<bool>, 3> meets;
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        for (int tile = 0; tile < c.Parameters.TileCount[axis]; ++tile)
        {
          meets[axis].push_back(Meets(c, c.Tetrahedra[t], axis, tile));
        }
      }
      std::size_t tile = 0;
      for (const bool z : meets[2])
      {
        for (const bool y : meets[1])
        {
          for (const bool x : meets[0])
          {
            if (x && y && z)
            {
              lists[tile].push_back(static_cast<int>(t));
            }
            ++tile;
          }
        }
      }
    }
  }
  return lists;
}

class TetrahedronListing : public testing::Test
{
protected:
  // Makes the lists and reads them. Reuses the buffers of the previous call.
  Lists Make(const ListCase& c, std::int64_t& inverted)
  {
    cl::Buffer tetrahedra;
    this->Device.Send(tetrahedra, c.Tetrahedra);
    cl::Buffer positions;
    this->Device.Send(positions, c.Positions);
    RasterParameters p = c.Parameters;
    p.Tetrahedra = static_cast<int>(c.Tetrahedra.size());
    MemoryBudget budget(this->Device, [] { return std::uint64_t{ 0 }; });
    const TetrahedronLists::Counts counts =
      this->Made.Make(this->Device, budget, tetrahedra, positions, p);
    inverted = counts.Inverted;
    this->Overstretched = counts.Overstretched;
    const cl::CommandQueue& queue = this->Device.GetQueue();
    std::vector<cl_uint> begins(c.GetNumberOfTiles() + 1);
    queue.enqueueReadBuffer(
      this->Made.GetBegins(), CL_TRUE, 0, begins.size() * sizeof(cl_uint), begins.data());
    std::vector<int> all(begins.back());
    if (!all.empty())
    {
      queue.enqueueReadBuffer(
        this->Made.GetLists(), CL_TRUE, 0, all.size() * sizeof(cl_int), all.data());
    }
    EXPECT_EQ(begins.front(), 0U);
    EXPECT_TRUE(std::is_sorted(begins.begin(), begins.end()));
    Lists lists;
    for (std::size_t tile = 0; tile + 1 < begins.size(); ++tile)
    {
      lists.emplace_back(all.begin() + begins[tile], all.begin() + begins[tile + 1]);
    }
    return lists;
  }

  // Returns the total length of all lists.
  std::size_t ExpectEqualsReference(const ListCase& c)
  {
    std::int64_t expectedInverted = 0;
    const Lists expected = MakeReference(c, expectedInverted);
    for (const std::size_t size : GroupSizes)
    {
      this->Device.SetWorkGroupSize(size);
      std::int64_t inverted = 0;
      EXPECT_TRUE(this->Make(c, inverted) == expected) << "work-groups of " << size << " items";
      EXPECT_EQ(inverted, expectedInverted) << "work-groups of " << size << " items";
    }
    return std::accumulate(expected.begin(), expected.end(), std::size_t{ 0 },
      [](std::size_t sum, const std::vector<int>& list) { return sum + list.size(); });
  }

  std::string GetListError(const ListCase& c)
  {
    std::int64_t inverted = 0;
    return GetError([&] { this->Make(c, inverted); });
  }

  WorkDevice Device;
  TetrahedronLists Made;
  std::int64_t Overstretched = 0; // of the last call of Make
};

} // namespace

TEST_F(TetrahedronListing, MisuseLeavesThemUsable)
{
  ListCase good({ { 0, 0, 0 } }, { { 100, 50, 50 } });
  good.AddRandom(200, 20, 1);
  ListCase stretched = good;
  stretched.Add(
    { { { { 0, 0, 0 } }, { { 5001 * 256, 0, 0 } }, { { 0, 2560, 0 } }, { { 0, 0, 2560 } } } });
  stretched.Add(
    { { { { 0, 0, 0 } }, { { 0, 2560, 0 } }, { { 0, 0, 2560 } }, { { -5001 * 256, 0, 0 } } } });
  for (const std::size_t size : GroupSizes)
  {
    this->Device.SetWorkGroupSize(size);
    std::int64_t inverted = 0;
    EXPECT_TRUE(this->Make(stretched, inverted) == this->Make(good, inverted));
    this->Make(stretched, inverted);
    EXPECT_EQ(this->Overstretched, 2);
    this->Device.SetAllocationLimit(1500); // less than one box per tetrahedron
    EXPECT_NE(this->GetListError(good).find("in one allocation"), std::string::npos);
    this->Device.SetAllocationLimit(0);
    EXPECT_EQ(this->GetListError(good), "");
  }
  this->ExpectEqualsReference(good);
}

// Overflow of 32-bit numbers: 80 tetrahedra in 61 million tiles each.
TEST_F(TetrahedronListing, ListsThatAreTooLong)
{
  ListCase large({ { -2500, -2500, -2500 } }, { { 4990, 4990, 4990 } });
  for (int i = 0; i < 80; ++i)
  {
    large.AddLarge();
  }
  this->Device.SetWorkGroupSize(64);
  EXPECT_NE(this->GetListError(large).find("too large for mesh rasterization"), std::string::npos);
  ListCase small({ { 0, 0, 0 } }, { { 100, 50, 50 } });
  small.AddRandom(20, 20, 1);
  this->ExpectEqualsReference(small);
}

TEST_F(TetrahedronListing, OutputsFarFromIndexZero)
{
  for (const int first : { -1000, -33, -1, 0, 5, 31, 4096 })
  {
    SCOPED_TRACE(first);
    ListCase anywhere({ { first, first / 2, -first } }, { { 131, 47, 41 } });
    anywhere.AddRandom(700, 3, 2);
    anywhere.AddRandom(300, 40, 3);
    EXPECT_GT(this->ExpectEqualsReference(anywhere), 1000U);
  }
}

// Numbers of tiles near powers of two, which determine the number of bits of the sort keys, up to
// more than 16 bits.
TEST_F(TetrahedronListing, AnyNumberOfTiles)
{
  for (const int tiles : { 1, 2, 3, 64, 65, 127, 128, 129, 4097, 32767, 32768, 32769, 70001 })
  {
    SCOPED_TRACE(tiles);
    ListCase row({ { 0, 0, 0 } }, { { 3, 2, 8 * tiles } });
    row.AddRandom(300, 9, 4);
    row.AddRandom(20, 4000, 5);
    this->ExpectEqualsReference(row);
  }
}

TEST_F(TetrahedronListing, NothingToList)
{
  ListCase flat({ { 0, 0, 0 } }, { { 70, 30, 20 } });
  flat.AddRandom(300, 20, 6);
  for (Tetrahedron& tetrahedron : flat.Tetrahedra)
  {
    tetrahedron[1] = tetrahedron[3];
  }
  EXPECT_EQ(this->ExpectEqualsReference(flat), 0U);
  for (Tetrahedron& tetrahedron : flat.Tetrahedra)
  {
    tetrahedron.fill(-1);
  }
  EXPECT_EQ(this->ExpectEqualsReference(flat), 0U);
  ListCase outside({ { 0, 0, 0 } }, { { 70, 30, 20 } });
  outside.AddRandom(300, 20, 6);
  outside.Parameters.OutputFirst[0] = 32000;
  outside.Parameters.TileFirst[0] = 1000;
  EXPECT_EQ(this->ExpectEqualsReference(outside), 0U);
  // A single tetrahedron with tiles among tetrahedra without tiles: in the middle and at both ends.
  for (const std::size_t place : { 0, 150, 299 })
  {
    ListCase one = flat;
    one.AddLarge();
    std::swap(one.Tetrahedra[place], one.Tetrahedra.back());
    EXPECT_EQ(this->ExpectEqualsReference(one), one.GetNumberOfTiles());
  }
}

// Some tetrahedra of the largest possible width, which meet all tiles, among small ones.
TEST_F(TetrahedronListing, LargeTetrahedra)
{
  ListCase large({ { -1000, 0, 0 } }, { { 4995, 300, 100 } });
  large.AddRandom(200, 30, 7);
  large.AddLarge();
  large.AddRandom(200, 30, 8);
  large.AddLarge();
  std::swap(large.Tetrahedra.back()[2], large.Tetrahedra.back()[3]); // inverted
  large.AddLarge();
  EXPECT_GT(this->ExpectEqualsReference(large), 3 * large.GetNumberOfTiles());
  // The largest number of tiles that a tetrahedron can meet on each axis: the packed counts of
  // tiles (TetrahedronBinning.cl) must have enough bits for it.
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    std::array<int, 3> size{ { 3, 3, 3 } };
    size[axis] = 4990;
    ListCase lengthwise({ { -1, -1, -1 } }, size);
    lengthwise.AddLarge();
    EXPECT_EQ(this->ExpectEqualsReference(lengthwise), lengthwise.GetNumberOfTiles());
  }
}

// Tens of thousands of tetrahedra in one tile, next to empty tiles.
TEST_F(TetrahedronListing, LongLists)
{
  ListCase one({ { 0, 0, 0 } }, { { 32, 8, 8 } });
  one.AddRandom(60000, 6, 9);
  EXPECT_GT(this->ExpectEqualsReference(one), 20000U);
  one.Parameters.OutputSize[0] = 32 * 9;
  one.Parameters.TileCount[0] = 9;
  EXPECT_GT(this->ExpectEqualsReference(one), 20000U);
}

// Enough tetrahedra for several work-groups in each phase. Results must be the same in each
// repetition.
TEST_F(TetrahedronListing, EqualFromRunToRun)
{
  ListCase many({ { 0, 0, 0 } }, { { 500, 300, 100 } });
  many.AddRandom(30000, 12, 10);
  EXPECT_GT(this->ExpectEqualsReference(many), 40000U);
  std::int64_t inverted = 0;
  const Lists expected = this->Make(many, inverted);
  for (int run = 0; run < 5; ++run)
  {
    EXPECT_TRUE(this->Make(many, inverted) == expected);
  }
}

// Small enough for Oclgrind, an interpreter of kernels.
TEST_F(TetrahedronListing, TinyEqualsReference)
{
  ListCase tiny({ { -5, 3, 0 } }, { { 70, 12, 70 } });
  tiny.AddRandom(60, 10, 11);
  tiny.AddLarge();
  EXPECT_GT(this->ExpectEqualsReference(tiny), 60U);
}
