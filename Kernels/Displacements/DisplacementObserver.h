// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementObserver_h
#define DeformVolumeDisplacementObserver_h

#include "BrickPoints.h"
#include "DisplacementBounds.h"
#include "Extent.h"
#include "Tetrahedron.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace deformvolume
{

class PointSet;

/// What a DisplacementSource tells of its changes.
class DisplacementObserver
{
public:
  virtual ~DisplacementObserver() = default;

  /// Whether it is worthwhile to find out which points change.
  virtual bool IsTracking() const = 0;
  /// Of so many points: where more change, it is as good as all of them.
  virtual std::size_t GetMostMoved(std::size_t numberOfPoints) const = 0;

  /// Which points move the sub-bricks. Not known at first, nor after ForgetMapping; needed for
  /// MovePoints.
  virtual bool HasPoints() const = 0;
  virtual void SetPoints(BrickPoints&& points) = 0;
  /// Other points move them now, or the same in another way.
  virtual void ForgetMapping() = 0;

  /// Whether it is known of all sub-bricks where they lie, so that a change may be told when it has
  /// been made.
  virtual bool KnowsAllBoxes() const = 0;
  /// Points will change. last: four floats a point, the displacements before the change; null: they
  /// have changed, and all boxes were known.
  virtual void MovePoints(const PointSet& changed, const float* last) = 0;
  /// Tetrahedra get other nodes. last: as above. Returns
  /// boxes that hold all vertices which lie in one of these; nothing where that is not known.
  virtual std::optional<std::vector<Extent>> ChangeTetrahedra(
    const std::vector<TetrahedronChange>& changes, const float* last) = 0;
  /// Points have changed. after: of these, or of more.
  virtual void AddMoved(const DisplacementBounds& after) = 0;
  /// All points change. after: of all of them, where it is known.
  virtual void MoveAll(const std::optional<DisplacementBounds>& after) = 0;
};

} // namespace deformvolume

#endif
