// SPDX-License-Identifier: BSD-3-Clause
// Samples that single precision cannot decide: on a face, an edge or a vertex of a cell, or beside
// a face by the least distance that positions in 1/256 voxel allow. Random cells have too few such
// samples to test the error bounds of the kernels. These tests construct such cells.
//
// Cells do not touch: only every third cell of a volume along each axis is active, so that all
// parities occur. A wrong decision about a sample then changes the coverage of a voxel.
#include "DeformerCase.h"
#include "NarrowCells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>

using namespace deformvolume;

namespace
{

using Position = reference::Position;
/// The vertices of a cell of even parity, in the order of FiveTetrahedra.h, relative to a sample.
using Cell = std::array<Position, 8>;

constexpr int Pitch = 3; // distance of active cells, in cells

/// Mirrors a cell to get the cell of another parity. All calculations stay the same, except for
/// signs. axes[i] is the axis that axis i is mapped to.
Cell Transform(const Cell& cell, int mirror, const std::array<int, 3>& axes, int scale)
{
  Cell result{};
  for (int v = 0; v < 8; ++v)
  {
    // The bits of a vertex number are x, z and y.
    const std::array<int, 3> bits{ { v & 1, v >> 2 & 1, v >> 1 & 1 } };
    std::array<int, 3> turned{};
    Position position{};
    for (int axis = 0; axis < 3; ++axis)
    {
      turned[axes[axis]] = bits[axis];
      const std::int64_t sign = mirror >> axes[axis] & 1 ? -1 : 1;
      position[axes[axis]] = sign * scale * cell[v][axis];
    }
    result[turned[0] | turned[2] << 1 | turned[1] << 2] = position;
  }
  return result;
}

/// Whether the tetrahedra of a cell of this parity are neither flat nor inverted.
bool IsUpright(const Cell& cell, bool odd)
{
  constexpr int tetrahedra[5][4] = { { 0, 2, 3, 6 }, { 6, 7, 3, 5 }, { 3, 1, 0, 5 }, { 0, 4, 6, 5 },
    { 6, 3, 5, 0 } };
  for (int t = 0; t < 5; ++t)
  {
    Position e[3];
    for (int k = 0; k < 3; ++k)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        e[k][axis] = cell[tetrahedra[t][k + 1]][axis] - cell[tetrahedra[t][0]][axis];
      }
    }
    const std::int64_t determinant = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
      e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
      e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    if (odd != (t == 4) ? determinant >= 0 : determinant <= 0)
    {
      return false;
    }
  }
  return true;
}

/// A volume of such cells. make(number, mirror) returns the cell with this number, for the
/// mirroring at its position. Each sample lies in the middle of a box of `box` voxels on each axis,
/// which contains its cell.
DeformerCase MakeCells(
  const std::array<int, 3>& count, int box, const std::function<Cell(int number, int mirror)>& make)
{
  DeformerCase made;
  Extent& extent = made.VoxelGrid.VertexExtent;
  for (int axis = 0; axis < 3; ++axis)
  {
    extent[2 * axis] = 0;
    extent[2 * axis + 1] = Pitch * count[axis];
    made.Output[2 * axis] = 0;
    made.Output[2 * axis + 1] = box * count[axis] - 1;
  }
  const std::int64_t width = GetSize(extent, 0);
  const std::int64_t height = GetSize(extent, 1);
  made.Displacements.resize(static_cast<std::size_t>(GetNumberOfPoints(extent)));
  made.Active.assign(static_cast<std::size_t>(GetNumberOfCells(extent)), 0);
  int number = 0;
  for (int z = 0; z < count[2]; ++z)
  {
    for (int y = 0; y < count[1]; ++y)
    {
      for (int x = 0; x < count[0]; ++x)
      {
        const std::array<int, 3> place{ { x, y, z } };
        const int mirror = (x & 1) | (y & 1) << 1 | (z & 1) << 2;
        const Cell cell = make(number++, mirror);
        made.Active[static_cast<std::size_t>(
          (Pitch * z * (height - 1) + Pitch * y) * (width - 1) + Pitch * x)] = 31;
        for (int v = 0; v < 8; ++v)
        {
          const std::array<int, 3> bits{ { v & 1, v >> 2 & 1, v >> 1 & 1 } };
          std::array<int, 3> index{};
          Position displacement{};
          for (int axis = 0; axis < 3; ++axis)
          {
            index[axis] = Pitch * place[axis] + (bits[axis] ^ (mirror >> axis & 1));
            displacement[axis] = cell[v][axis] + 256 * (box * place[axis] + box / 2 - index[axis]);
          }
          made.Displacements[static_cast<std::size_t>(
            (index[2] * height + index[1]) * width + index[0])] = displacement;
        }
      }
    }
  }
  return made;
}

/// Compares the kernels by lanes and by cells with the reference.
void CheckCells(const DeformerCase& cells)
{
  const UsualArrays usual(cells.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const reference::Result reference = ResampleByReference(cells);
  ExpectEmbedding(reference);
  EXPECT_GT(reference.NumberOfCoveredVoxels, 0);
  ExpectEqualsReference(cells, reference, arrays, LoadAndRun(cells, arrays));
}

constexpr std::array<std::array<int, 3>, 6> Orders{ { { { 0, 1, 2 } }, { { 1, 2, 0 } },
  { { 2, 0, 1 } }, { { 0, 2, 1 } }, { { 2, 1, 0 } }, { { 1, 0, 2 } } } };

Cell GetNarrowCell(int number)
{
  Cell cell{};
  const auto& row = NarrowCells[static_cast<std::size_t>(number) % NarrowCells.size()];
  for (int i = 0; i < 24; ++i)
  {
    cell[i / 3][i % 3] = row[i];
  }
  return cell;
}

/// The position of the sample relative to the cell.
enum class Relation
{
  Face,
  Beside, // by a volume of a sixth of a cube of 1/256 voxel
  Edge,
  Vertex
};

std::int64_t Dot(const Position& a, const Position& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Position Cross(const Position& a, const Position& b)
{
  return { { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] } };
}

/// Moves c slightly, so that the tetrahedron of the origin, a, b and c has this volume. Returns
/// false if no position nearby does.
bool MoveBeside(const Position& a, const Position& b, Position& c, std::int64_t volume)
{
  const Position normal = Cross(a, b);
  for (int i = 0; i < 25 && normal[2] != 0; ++i)
  {
    const Position moved{ { c[0] + i % 5 - 2, c[1] + i / 5 - 2, 0 } };
    const std::int64_t rest = volume - Dot(normal, moved);
    if (rest % normal[2] == 0 && std::abs(rest / normal[2] - c[2]) < 16)
    {
      c = { { moved[0], moved[1], rest / normal[2] } };
      return true;
    }
  }
  return false;
}

/// A random cell of which one outer face has this relation to the sample.
Cell MakeRandomCell(std::mt19937& random, Relation relation, double size, double distortion)
{
  constexpr int faces[12][3] = { { 2, 0, 3 }, { 2, 3, 6 }, { 2, 6, 0 }, { 7, 6, 3 }, { 7, 3, 5 },
    { 7, 5, 6 }, { 1, 3, 0 }, { 1, 0, 5 }, { 1, 5, 3 }, { 4, 0, 6 }, { 4, 6, 5 }, { 4, 5, 0 } };
  std::uniform_real_distribution<double> jitter(-0.12 * size, 0.12 * size);
  for (;;)
  {
    const glm::dmat3 matrix = size * MakeRandomMatrix(random, distortion);
    Cell cell{};
    for (int v = 0; v < 8; ++v)
    {
      const glm::dvec3 moved = matrix * glm::dvec3(v & 1, v >> 2 & 1, v >> 1 & 1);
      for (int axis = 0; axis < 3; ++axis)
      {
        cell[v][axis] = std::llround(256.0 * (moved[axis] + jitter(random)));
      }
    }
    const int* face = faces[random() % 12];
    const int a = face[random() % 3];
    const int b = a == face[0] ? face[1] : face[0];
    const int c = face[0] + face[1] + face[2] - a - b;
    Position sample = cell[a];
    if (relation == Relation::Edge)
    {
      // At a half or a third of the edge.
      const std::int64_t parts = 2 + random() % 2;
      for (int axis = 0; axis < 3; ++axis)
      {
        cell[b][axis] -= (cell[b][axis] - cell[a][axis]) % parts;
        sample[axis] += (cell[b][axis] - cell[a][axis]) / parts;
      }
    }
    else if (relation != Relation::Vertex)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        sample[axis] = (2 * cell[a][axis] + cell[b][axis] + 2 * cell[c][axis]) / 5;
      }
    }
    for (Position& vertex : cell)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        vertex[axis] -= sample[axis];
      }
    }
    const std::int64_t volume =
      relation == Relation::Beside ? 1 - 2 * static_cast<std::int64_t>(random() % 2) : 0;
    const bool isPlaced = relation == Relation::Edge || relation == Relation::Vertex ||
      MoveBeside(cell[a], cell[b], cell[c], volume);
    if (isPlaced && IsUpright(cell, false))
    {
      return cell;
    }
  }
}

} // namespace

// Cells that are scaled to over 4 voxels are decided sample by sample.
TEST(NarrowDecisions, CellsThatSinglePrecisionGetsWrong)
{
  constexpr int number = static_cast<int>(NarrowCells.size());
  for (const int scale : { 1, 2, 3 })
  {
    for (const auto& order : Orders)
    {
      SCOPED_TRACE(scale);
      // Each cell in the four mirrorings on x and y.
      const DeformerCase cells = MakeCells({ { 4, 4, (number + 1) / 2 } }, 4 * scale + 2,
        [&](int i, int mirror) { return Transform(GetNarrowCell(i / 8), mirror, order, scale); });
      CheckCells(cells);
    }
  }
}

TEST(NarrowDecisions, SamplesOnAndBesideFaces)
{
  std::mt19937 random(5);
  for (const Relation relation :
    { Relation::Face, Relation::Beside, Relation::Edge, Relation::Vertex })
  {
    for (const double size : { 1.0, 2.5, 4.5, 9.0 })
    {
      SCOPED_TRACE(testing::Message() << "relation " << int(relation) << " size " << size);
      const int count = size < 4.0 ? 10 : 4;
      const DeformerCase cells =
        MakeCells({ { count, count, count } }, 2 * static_cast<int>(3.0 * size) + 2,
          [&](int, int mirror)
          {
            return Transform(
              MakeRandomCell(random, relation, size, 0.2), mirror, Orders[random() % 3], 1);
          });
      CheckCells(cells);
    }
  }
}
