// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSmoothCrossings_h
#define DeformVolumeSmoothCrossings_h

#include "CellBricks.h"
#include "CrossingSet.h"
#include "DeformVolumeExport.h"
#include "Extent.h"
#include "JoinedBlocks.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The tetrahedra of a volume that smooth cuts divide, and the signed distances of their vertices
/// from the sheets (VolumeDeformer::SetCut), for all edits together. Undoing an edit restores bits
/// and distances exactly, and the order of edits does not matter.
///
/// A tetrahedron is divided if three conditions hold: each crossed edge is crossed once; the
/// crossed edges separate its vertices into two sides; and these sides agree with the signs of the
/// distances. If a sheet only enters the tetrahedron without separating vertices, as at the end of
/// a cut, the tetrahedron stays whole. If two sheets cross an edge, or a vertex is on different
/// sides of two sheets, the tetrahedron is switched off.
class DEFORMVOLUME_EXPORT SmoothCrossings
{
public:
  /// vertices: structured indices of the voxels.
  explicit SmoothCrossings(const Extent& vertices);

  /// Returns the bricks of the cells.
  const CellBricks& GetBricks() const { return this->Bricks; }
  /// Returns the bricks of the vertices.
  const CellBricks& GetVertexBricks() const { return this->VertexBricks; }

  /// Set the cut before all edits, in the format of GetCrossed() and GetDistances(); null: none.
  /// sets: the crossings of all edits.
  void SetBase(const unsigned char* crossed, const float* distances,
    const std::vector<const CrossingSet*>& sets);

  ///@{
  /// Add or remove an edit. sets: the crossings of all remaining edits. Both return the bricks of
  /// cells that may have changed.
  std::vector<std::size_t> Add(const CrossingSet& edit);
  std::vector<std::size_t> Remove(
    const CrossingSet& edit, const std::vector<const CrossingSet*>& sets);
  ///@}
  /// Returns the number of blocks that were joined.
  std::uint64_t GetNumberOfJoins() const
  {
    return this->Cells.GetNumberOfJoins() + this->VertexDistances.GetNumberOfJoins();
  }

  ///@{
  /// Get the bits of the divided tetrahedra and of the switched-off tetrahedra of each cell, and
  /// the distance of each vertex, x varying fastest. The distance is 0 for vertices far from all
  /// sheets and for vertices on both sides. All arrays are empty if there was never a cut.
  const std::vector<unsigned char>& GetCrossed() const { return this->Crossed; }
  const std::vector<unsigned char>& GetSwitchedOff() const { return this->SwitchedOff; }
  const std::vector<float>& GetDistances() const { return this->Distances; }
  ///@}

  /// Returns the number of divided tetrahedra that the cut before all edits does not divide.
  std::int64_t GetNumberOfDividedTetrahedra() const { return this->NumberOfDivided; }

  ///@{
  /// Return the bricks of cells, or of vertices, that may have changed since the last call, in
  /// ascending order. The first call after a cut was added returns all bricks.
  std::vector<std::size_t> TakeChangedBricks();
  std::vector<std::size_t> TakeChangedVertexBricks();
  ///@}

private:
  void Allocate();
  std::vector<std::size_t> FindNeighbors(const std::vector<std::size_t>& bricks) const;
  std::vector<std::size_t> Update(const CrossingSet& edit);
  void UpdateDistances(std::size_t brick);
  void UpdateCells(std::size_t brick);
  std::size_t GetVertex(const std::array<int, 3>& cell, int offset) const;

  CellBricks Bricks;
  CellBricks VertexBricks;
  CrossingSet Base;
  // The base and all edits joined.
  JoinedBlocks<CrossedEdges> Cells;
  JoinedBlocks<float> VertexDistances;
  std::vector<unsigned char> Crossed;
  std::vector<unsigned char> SwitchedOff;
  std::vector<float> Distances;
  std::int64_t NumberOfDivided = 0;
  std::vector<bool> Changed; // for each brick
  std::vector<bool> ChangedVertices;
};

} // namespace deformvolume

#endif
