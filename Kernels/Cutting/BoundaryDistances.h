// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoundaryDistances_h
#define DeformVolumeBoundaryDistances_h

#include "CellBricks.h"
#include "DeformVolumeExport.h"
#include "DistanceSet.h"
#include "Extent.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The signed distance of each vertex of a volume to the boundary of what has been carved out:
/// the least of that before all edits and of those of the edits. So the order of edits does not
/// matter, and what is undone comes back bit for bit.
class DEFORMVOLUME_EXPORT BoundaryDistances
{
public:
  /// vertices: structured indices of the voxels. far: the distance where there is no boundary.
  BoundaryDistances(const Extent& vertices, float far);

  /// The distance where there is no boundary.
  float GetFar() const { return this->Far; }
  /// The bricks of the vertices.
  const CellBricks& GetBricks() const { return this->Bricks; }

  /// Other distances before all edits, one a vertex; null: there is no boundary. sets: of the
  /// edits.
  void SetBase(const float* base, const std::vector<const DistanceSet*>& sets);

  /// An edit comes.
  void Add(const DistanceSet& edit);
  /// Makes some bricks anew, as an edit has gone. sets: of those that are left.
  void Update(const std::vector<std::size_t>& bricks, const std::vector<const DistanceSet*>& sets);

  /// One a vertex, x varying fastest; none before there was a boundary.
  const std::vector<float>& Get() const { return this->Values; }
  /// Bricks that may have changed since the last call, in ascending order. At the first call after
  /// there is a boundary these are all bricks.
  std::vector<std::size_t> TakeChangedBricks();

  /// Bytes of memory.
  std::uint64_t GetMemory() const;

private:
  void UpdateBrick(std::size_t brick, const std::vector<const DistanceSet*>& sets);

  CellBricks Bricks;
  float Far;
  std::vector<float> Base; // empty: far from any boundary
  std::vector<float> Values;
  std::vector<bool> Changed; // of each brick
};

} // namespace deformvolume

#endif
