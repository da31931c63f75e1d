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

/// A mask of active tetrahedra, one byte per cell, with edits that switch tetrahedra off. Edits can
/// be undone, redone and removed.
///
/// An edit is stored as the set of tetrahedra that it hits. The mask is the base (the mask before
/// all edits) without the tetrahedra that edits hit. So the order of edits does not matter, any
/// edit can be removed, and undoing restores the mask bit for bit. The time to add an edit depends
/// on the number of bricks that it hits, and not on earlier edits. The time to undo or remove an
/// edit depends on the number of these bricks and of the edits that hit them. The upper three bits
/// of the bytes of the base do not change.
///
/// An edit can also have boundary distances, for a smooth boundary through active tetrahedra
/// (BoundaryDistances), and crossed edges, for a smooth cut that divides tetrahedra
/// (SmoothCrossings).
class DEFORMVOLUME_EXPORT MaskEditor
{
public:
  /// vertices: structured indices of the voxels. All tetrahedra are active at first. far: the
  /// boundary distance of vertices that are far from any boundary. Throws an Error if there are
  /// fewer than two voxels on an axis.
  explicit MaskEditor(const Extent& vertices, float far = std::numeric_limits<float>::max());

  /// Returns the bricks of the cells.
  const CellBricks& GetBricks() const { return this->Bricks; }

  /// Set the mask before all edits, one byte per cell; null: all are active. Edits are kept.
  /// changes: cells that may have changed since the last base; null: unknown. Bricks without
  /// differences do not count as changed.
  void SetBase(const unsigned char* base, const PointRanges* changes = nullptr);
  /// Set the boundary distances before all edits, one per vertex; null: none.
  void SetBaseDistances(const float* base);

  /// Set the smooth cut before all edits, in the format of SmoothCrossings::SetBase(); null: none.
  void SetBaseCut(const unsigned char* crossed, const float* distances);

  /// Adds an edit, which may be empty, and returns its number. Undone edits cannot be redone
  /// afterwards. Throws an Error if a brick does not exist in this mask.
  std::uint64_t Add(
    TetrahedronSet&& set, DistanceSet&& distances = {}, CrossingSet&& crossings = {});
  /// Removes an edit, undone or not. Returns false if it does not exist.
  bool Remove(std::uint64_t edit);

  /// Undoes the last edit: switches its tetrahedra on again, unless another edit hits them. Returns
  /// false if there is no edit.
  bool Undo();
  /// Redoes the edit of the last Undo(). Returns false if there is none.
  bool Redo();
  /// Removes all edits, so that the mask is the base.
  void Reset();

  /// Returns the number of edits that are not undone.
  std::size_t GetNumberOfEdits() const { return this->Edits.size(); }
  /// Returns the number of edits that Redo() can restore.
  std::size_t GetNumberOfUndoneEdits() const { return this->Undone.size(); }

  /// Returns the mask, one byte per cell, x varying fastest.
  const std::vector<unsigned char>& GetMask() const { return this->Mask; }
  /// Returns the number of tetrahedra that are active in the base and not in the mask.
  std::int64_t GetNumberOfSwitchedOffTetrahedra() const { return this->NumberOfSwitchedOff; }
  /// Returns the bricks whose mask may have changed since the last call, in ascending order. The
  /// first call returns all bricks.
  std::vector<std::size_t> TakeChangedBricks();

  /// Whether an edit divides tetrahedra.
  bool HasSmoothCuts() const;
  /// Returns the divided tetrahedra of all edits and of the cut before all edits.
  SmoothCrossings& GetSmoothCrossings() { return this->Crossings; }
  /// Returns the same for reading.
  const SmoothCrossings& GetSmoothCrossings() const { return this->Crossings; }

  /// Whether an edit has boundary distances.
  bool HasDistanceEdits() const;
  /// Returns the boundary distances of all edits and of the base.
  BoundaryDistances& GetBoundaryDistances() { return this->Distances; }
  /// Returns the same for reading.
  const BoundaryDistances& GetBoundaryDistances() const { return this->Distances; }

  /// Returns the number of blocks of tetrahedra and crossings that were joined, a measure of the
  /// work for edits.
  std::uint64_t GetNumberOfJoins() const
  {
    return this->Hits.GetNumberOfJoins() + this->Crossings.GetNumberOfJoins();
  }

private:
  struct Edit
  {
    std::uint64_t Number;
    TetrahedronSet Set;
    DistanceSet Distances;
    CrossingSet Crossings;
  };

  /// Returns the bricks in which a base differs from the current one, in ascending order.
  std::vector<std::size_t> CompareBase(const unsigned char* base, const PointRanges& changes) const;
  /// Computes the mask of some bricks again.
  void Update(const std::vector<std::size_t>& bricks);
  /// Update the masks, distances and crossings of the bricks that an added or removed edit hits.
  void Apply(const Edit& edit);
  void Revert(const Edit& edit);
  /// Returns the sets of one kind of all edits, without empty sets.
  template <typename Set>
  std::vector<const Set*> GetSets(Set Edit::*set) const;
  void Update(const std::list<Edit>& edits);
  /// Computes the mask again if smooth cuts may have switched tetrahedra off.
  void UpdateSwitchedOff();
  void UpdateBrick(std::size_t brick);

  CellBricks Bricks;
  std::vector<unsigned char> Base; // empty: all are active
  std::vector<unsigned char> Mask;
  std::list<Edit> Edits;
  std::list<Edit> Undone; // the edit that was undone last is at the end
  std::uint64_t LastNumber = 0;
  std::int64_t NumberOfSwitchedOff = 0;
  std::vector<bool> Changed;        // for each brick
  JoinedBlocks<unsigned char> Hits; // joined hits of all edits
  BoundaryDistances Distances;
  SmoothCrossings Crossings;
};

} // namespace deformvolume

#endif
