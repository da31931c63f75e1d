// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCrossingSet_h
#define DeformVolumeCrossingSet_h

#include "CellBricks.h"
#include "DistanceSet.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace deformvolume
{

/// Where one edit crosses a sampling mesh smoothly: edges that a sheet crosses, and on which side
/// of it their ends are.
struct CrossingSet
{
  /// What crosses the five tetrahedra of a cell. Two edits' crossings are joined by Join().
  struct Cell
  {
    /// Crossed edges: bit 6 t + k is edge k of tetrahedron t, in the order of Ends.
    std::uint32_t Edges = 0;
    /// Bit t: an edge of tetrahedron t is crossed more than once.
    std::uint32_t IsMultiple = 0;

    /// Adds the crossings of another edit.
    void Join(const Cell& other)
    {
      const std::uint32_t both = this->Edges & other.Edges;
      for (unsigned int t = 0; t < 5; ++t)
      {
        this->IsMultiple |= ((both >> 6 * t & 63U) != 0 ? 1U : 0U) << t;
      }
      this->IsMultiple |= other.IsMultiple;
      this->Edges |= other.Edges;
    }
  };
  /// The two vertices of each edge of a tetrahedron.
  static constexpr int Ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };

  /// One for each cell of a brick, at the number that TetrahedronSet::GetPlace() gives it.
  using Block = std::array<Cell, CellBricks::Cells>;

  /// Bricks of cells with crossed edges, in ascending order, and as many blocks.
  std::vector<std::size_t> Bricks;
  /// The block of each of these bricks.
  std::vector<Block> Blocks;
  /// The signed distances of the ends of edges from the sheet: infinite for all other vertices, 0
  /// for those that are on both sides of it.
  DistanceSet Distances;

  /// Whether no edge is crossed.
  bool IsEmpty() const { return this->Bricks.empty(); }
};

/// Of a vertex that is no end of a crossed edge.
constexpr float FarFromSheets = std::numeric_limits<float>::infinity();

/// What two triangles, or two edits, make of the distance of a vertex.
inline float JoinSheetDistances(float a, float b)
{
  if (a == FarFromSheets || b == FarFromSheets)
  {
    return a == FarFromSheets ? b : a;
  }
  if (a == 0.0F || b == 0.0F || (a < 0.0F) != (b < 0.0F))
  {
    return 0.0F;
  }
  return std::abs(b) < std::abs(a) ? b : a;
}

} // namespace deformvolume

#endif
