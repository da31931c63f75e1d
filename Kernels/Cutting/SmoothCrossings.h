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

/// The tetrahedra of a volume that smooth cuts divide, and the signed distance of each of their
/// vertices from the sheet (VolumeDeformer::SetCut), by all edits together: what is undone comes
/// back bit for bit, and the order of edits does not matter.
///
/// A tetrahedron is divided where the edges that are crossed, each of them once, part its vertices
/// into two sides, and the sides that triangles see them on are the same. Where the sheet only
/// enters it, and parts no vertices, as at the end of a cut, it stays whole. Where two sheets pass
/// through an edge, or a vertex is on different sides of two sheets, it is switched off.
class DEFORMVOLUME_EXPORT SmoothCrossings
{
public:
  /// vertices: structured indices of the voxels.
  explicit SmoothCrossings(const Extent& vertices);

  /// The bricks of the cells.
  const CellBricks& GetBricks() const { return this->Bricks; }
  /// The bricks of the vertices.
  const CellBricks& GetVertexBricks() const { return this->VertexBricks; }

  /// Another cut before all edits, as GetCrossed() and GetDistances() have it; null: there is none.
  /// sets: of the edits.
  void SetBase(const unsigned char* crossed, const float* distances,
    const std::vector<const CrossingSet*>& sets);

  ///@{
  /// An edit comes, or goes; sets: of all that are left. Returns the bricks of cells that may have
  /// changed.
  std::vector<std::size_t> Add(const CrossingSet& edit);
  std::vector<std::size_t> Remove(
    const CrossingSet& edit, const std::vector<const CrossingSet*>& sets);
  ///@}
  /// Blocks of edits that were joined so far.
  std::uint64_t GetNumberOfJoins() const
  {
    return this->Cells.GetNumberOfJoins() + this->VertexDistances.GetNumberOfJoins();
  }

  ///@{
  /// One a cell, x varying fastest: tetrahedra that are divided, as bits, and that are switched
  /// off. One a vertex: its distance, 0 far from all sheets and on both sides of some. None before
  /// there was a set.
  const std::vector<unsigned char>& GetCrossed() const { return this->Crossed; }
  const std::vector<unsigned char>& GetSwitchedOff() const { return this->SwitchedOff; }
  const std::vector<float>& GetDistances() const { return this->Distances; }
  ///@}

  /// Tetrahedra that are divided, and were not so in the cut before all edits.
  std::int64_t GetNumberOfDividedTetrahedra() const { return this->NumberOfDivided; }

  ///@{
  /// Bricks, of cells and of vertices, that may have changed since the last call, in ascending
  /// order. At the first call after there was a set these are all.
  std::vector<std::size_t> TakeChangedBricks();
  std::vector<std::size_t> TakeChangedVertexBricks();
  ///@}

  /// Bytes of memory.
  std::uint64_t GetMemory() const;

private:
  void Allocate();
  std::vector<std::size_t> FindNeighbours(const std::vector<std::size_t>& bricks) const;
  std::vector<std::size_t> Update(const CrossingSet& edit);
  void UpdateDistances(std::size_t brick);
  void UpdateCells(std::size_t brick);
  std::size_t GetVertex(const std::array<int, 3>& cell, int offset) const;

  CellBricks Bricks;
  CellBricks VertexBricks;
  CrossingSet Base;
  // The base and all edits together.
  JoinedBlocks<CrossingSet::Block> Cells;
  JoinedBlocks<DistanceSet::Block> VertexDistances;
  std::vector<unsigned char> Crossed;
  std::vector<unsigned char> SwitchedOff;
  std::vector<float> Distances;
  std::int64_t NumberOfDivided = 0;
  std::vector<bool> Changed; // of each brick
  std::vector<bool> ChangedVertices;
};

} // namespace deformvolume

#endif
