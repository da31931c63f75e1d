// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaskEditor_h
#define DeformVolumeMaskEditor_h

#include "BoundaryDistances.h"
#include "CellBricks.h"
#include "CrossingSet.h"
#include "DeformVolumeExport.h"
#include "DistanceSet.h"
#include "Extent.h"
#include "JoinedBlocks.h"
#include "PointRanges.h"
#include "SmoothCrossings.h"
#include "TetrahedronSet.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <list>
#include <vector>

namespace deformvolume
{

/// A mask of active tetrahedra, one byte a cell, with edits that switch tetrahedra off and can be
/// undone and redone.
///
/// An edit is kept as the set of tetrahedra that it hits. The mask is the base, which is the mask
/// before all edits, without what the edits hit. So the order of edits does not matter, one in the
/// middle can be removed, and what is undone comes back bit for bit. Work is done only on the
/// bricks that an edit hits, and does not grow with the number of edits before it; where one is
/// undone or removed, it does. Of the bytes of the base, the bits above the fifth stay as they are.
///
/// An edit may have the distances of vertices to a smooth boundary besides, which passes through
/// tetrahedra that stay active (BoundaryDistances), and where a sheet crosses edges, which divides
/// tetrahedra (SmoothCrossings).
class DEFORMVOLUME_EXPORT MaskEditor
{
public:
  /// vertices: structured indices of the voxels. All tetrahedra are active. far: the boundary
  /// distance where there is no boundary. Throws Error where there are less than two voxels on an
  /// axis.
  explicit MaskEditor(const Extent& vertices, float far = std::numeric_limits<float>::max());

  /// The bricks of the cells.
  const CellBricks& GetBricks() const { return this->Bricks; }

  /// Another mask before all edits, one byte a cell; null: all are active. The edits stay. changes:
  /// cells that may have changed since the last one; null where that is not known. Bricks that are
  /// equal do not count as changed.
  void SetBase(const unsigned char* base, const PointRanges* changes = nullptr);
  /// Other boundary distances before all edits, one a vertex; null: there are none.
  void SetBaseDistances(const float* base);

  /// Another smooth cut before all edits (SmoothCrossings::SetBase); null: there is none.
  void SetBaseCut(const unsigned char* crossed, const float* distances);

  /// Adds an edit and returns its number. What was undone cannot be redone any more. A set without
  /// tetrahedra is an edit as well. Throws Error where a brick is not one of this mask.
  std::uint64_t Add(
    TetrahedronSet&& set, DistanceSet&& distances = {}, CrossingSet&& crossings = {});
  /// Removes an edit, be it undone or not. False where it is not there any more.
  bool Remove(std::uint64_t edit);

  /// Switches the tetrahedra of the last edit on again, as far as no other edit hits them. False
  /// where there is none.
  bool Undo();
  /// Takes the last Undo() back. False where there is none.
  bool Redo();
  /// Removes all edits: the mask is the base.
  void Reset();

  /// Edits that are not undone.
  std::size_t GetNumberOfEdits() const { return this->Edits.size(); }
  /// Edits that Redo() can make again.
  std::size_t GetNumberOfUndoneEdits() const { return this->Undone.size(); }

  /// The mask, one byte a cell, x varying fastest.
  const std::vector<unsigned char>& GetMask() const { return this->Mask; }
  /// Tetrahedra that are active in the base and not in the mask.
  std::int64_t GetNumberOfSwitchedOffTetrahedra() const { return this->NumberOfSwitchedOff; }
  /// Bricks whose mask may have changed since the last call, in ascending order. At the first call
  /// these are all bricks.
  std::vector<std::size_t> TakeChangedBricks();

  /// Whether an edit divides tetrahedra.
  bool HasSmoothCuts() const;
  /// What is divided, where an edit or the cut before all edits does so.
  SmoothCrossings& GetSmoothCrossings() { return this->Crossings; }
  /// The same, to be read only.
  const SmoothCrossings& GetSmoothCrossings() const { return this->Crossings; }

  /// Whether an edit has boundary distances.
  bool HasDistanceEdits() const;
  /// The boundary distance where there is no boundary.
  float GetFarDistance() const { return this->Distances.GetFar(); }
  /// The bricks of the vertices.
  const CellBricks& GetVertexBricks() const { return this->Distances.GetBricks(); }
  /// The boundary distances, one a vertex, where there are some.
  const std::vector<float>& GetDistances() const { return this->Distances.Get(); }
  /// As TakeChangedBricks(), of their vertices.
  std::vector<std::size_t> TakeChangedVertexBricks() { return this->Distances.TakeChangedBricks(); }

  /// Blocks of edits that were joined so far, of tetrahedra and of crossings: what edits cost.
  std::uint64_t GetNumberOfJoins() const
  {
    return this->Hits.GetNumberOfJoins() + this->Crossings.GetNumberOfJoins();
  }

  /// Bytes of memory that the mask, the base and the edits take.
  std::uint64_t GetMemory() const;

private:
  struct Edit
  {
    std::uint64_t Number;
    TetrahedronSet Set;
    DistanceSet Distances;
    CrossingSet Crossings;
  };

  /// Which bricks of a base differ, in ascending order.
  std::vector<std::size_t> CompareBase(const unsigned char* base, const PointRanges& changes) const;
  /// Makes the mask of some bricks anew.
  void Update(const std::vector<std::size_t>& bricks);
  /// An edit comes, or goes: makes all anew that it hits.
  void Apply(const Edit& edit);
  void TakeBack(const Edit& edit);
  /// Those of all edits that are not empty.
  template <typename Set>
  std::vector<const Set*> GetSets(Set Edit::*set) const;
  void Update(const std::list<Edit>& edits);
  /// Makes all anew where smooth cuts may have switched something off.
  void UpdateSwitchedOff();
  void UpdateBrick(std::size_t brick);

  CellBricks Bricks;
  std::vector<unsigned char> Base; // empty: all active
  std::vector<unsigned char> Mask;
  std::list<Edit> Edits;
  std::list<Edit> Undone; // the last one undone at the end
  std::uint64_t LastNumber = 0;
  std::int64_t NumberOfSwitchedOff = 0;
  std::vector<bool> Changed;                // of each brick
  JoinedBlocks<TetrahedronSet::Block> Hits; // of all edits
  BoundaryDistances Distances;
  SmoothCrossings Crossings;
};

} // namespace deformvolume

#endif
