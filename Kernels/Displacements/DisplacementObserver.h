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

/// Receives notifications of the changes of a DisplacementSource.
class DisplacementObserver
{
public:
  virtual ~DisplacementObserver() = default;

  /// Whether the observer needs to know which points change.
  virtual bool IsTracking() const = 0;
  /// Returns the largest number of changed points, of numberOfPoints, that are worth tracking. If
  /// more points change, call MoveAll().
  virtual std::size_t GetMaxMoved(std::size_t numberOfPoints) const = 0;

  /// Whether the observer knows which points move each sub-brick, as MovePoints() needs. False at
  /// first and after InvalidateMapping().
  virtual bool HasPoints() const = 0;
  /// Set the points that move each sub-brick.
  virtual void SetPoints(BrickPoints&& points) = 0;
  /// The mapping from points to vertices has changed.
  virtual void InvalidateMapping() = 0;

  /// Whether the observer knows the boxes of all sub-bricks. If so, MovePoints() may be called
  /// after the change.
  virtual bool HasAllBoxes() const = 0;
  /// Points will change. last: displacements before the change, four floats per point; null: the
  /// points have already changed (HasAllBoxes()).
  virtual void MovePoints(const PointSet& changed, const float* last) = 0;
  /// The nodes of tetrahedra will change. last: as in MovePoints(). Returns boxes that contain all
  /// vertices in these tetrahedra; empty if they are not known.
  virtual std::optional<std::vector<Extent>> ChangeTetrahedra(
    const std::vector<TetrahedronChange>& changes, const float* last) = 0;
  /// Points have changed. after: bounds of the new displacements of at least these points.
  virtual void AddMoved(const DisplacementBounds& after) = 0;
  /// All points may have changed. after: bounds of all new displacements, if they are known.
  virtual void MoveAll(const std::optional<DisplacementBounds>& after) = 0;
};

} // namespace deformvolume

#endif
