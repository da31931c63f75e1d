// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCrossingSet_h
#define DeformVolumeCrossingSet_h

#include "DistanceSet.h"
#include "TetrahedronSet.h"

#include <cmath>
#include <cstdint>
#include <limits>

namespace deformvolume
{

/// The edges of the five tetrahedra of a cell that a smooth cut crosses.
struct CrossedEdges
{
  /// Crossed edges: bit 6 t + k is edge k of tetrahedron t, in the order of CrossingSet::Ends.
  std::uint32_t Edges = 0;
  /// Bit t: an edge of tetrahedron t is crossed more than once.
  std::uint32_t MultiplyCrossed = 0;

  /// Adds the crossings of another triangle or edit.
  void Join(const CrossedEdges& other)
  {
    const std::uint32_t both = this->Edges & other.Edges;
    for (unsigned int t = 0; t < 5; ++t)
    {
      this->MultiplyCrossed |= ((both >> 6 * t & 63U) != 0 ? 1U : 0U) << t;
    }
    this->MultiplyCrossed |= other.MultiplyCrossed;
    this->Edges |= other.Edges;
  }
};

/// Where one smooth cut crosses a sampling mesh: the edges that the sheet crosses, and the
/// distances of their ends from the sheet.
struct CrossingSet : BrickSet<CrossedEdges>
{
  /// The two vertices of each edge of a tetrahedron.
  static constexpr int Ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };

  /// The signed distances of the ends of crossed edges from the sheet; 0 for vertices on both sides
  /// of it, infinite for all other vertices.
  DistanceSet Distances;
};

/// The distance of a vertex that is not an end of a crossed edge.
constexpr float FarFromSheets = std::numeric_limits<float>::infinity();

/// Joins the distances of a vertex from two triangles, or from two edits.
inline float CombineSheetDistances(float a, float b)
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
