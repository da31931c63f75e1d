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

/// The boundary distances of the vertices of a volume: the signed distance of each vertex from the
/// surface of the carved region, negative inside it. The distance is the minimum of the distance
/// before all edits and the distances of the edits. So the order of edits does not matter, and
/// undoing an edit restores distances bit for bit.
class DEFORMVOLUME_EXPORT BoundaryDistances
{
public:
  /// vertices: structured indices of the voxels. far: the distance of vertices that are far from
  /// any boundary.
  BoundaryDistances(const Extent& vertices, float far);

  /// Returns the distance of vertices that are far from any boundary.
  float GetFar() const { return this->Far; }
  /// Returns the bricks of the vertices.
  const CellBricks& GetBricks() const { return this->Bricks; }

  /// Set the distances before all edits, one for each vertex; null: there is no boundary. sets: the
  /// distances of all edits.
  void SetBase(const float* base, const std::vector<const DistanceSet*>& sets);

  /// Adds an edit.
  void Add(const DistanceSet& edit);
  /// Computes the distances of some bricks again after an edit was removed. sets: the distances of
  /// the remaining edits.
  void Update(const std::vector<std::size_t>& bricks, const std::vector<const DistanceSet*>& sets);

  /// Returns one distance for each vertex, x varying fastest; empty if there was never a boundary.
  const std::vector<float>& Get() const { return this->Values; }
  /// Returns the bricks that may have changed since the last call, in ascending order. The first
  /// call after a boundary was added returns all bricks.
  std::vector<std::size_t> TakeChangedBricks();

private:
  void UpdateBrick(std::size_t brick, const std::vector<const DistanceSet*>& sets);

  CellBricks Bricks;
  float Far;
  std::vector<float> Base; // empty: all vertices are far from any boundary
  std::vector<float> Values;
  std::vector<bool> Changed; // for each brick
};

} // namespace deformvolume

#endif
