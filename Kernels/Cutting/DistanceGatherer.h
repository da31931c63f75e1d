// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDistanceGatherer_h
#define DeformVolumeDistanceGatherer_h

#include "DistanceSet.h"
#include "Extent.h"

#include <cstddef>
#include <map>
#include <mutex>

namespace deformvolume
{

/// Gathers the distances of the vertices of bricks of cells into those of a volume. Several threads
/// may add some.
class DistanceGatherer
{
public:
  /// far: the distance of vertices that are not gathered. join: what a vertex gets that several
  /// bricks have, of the last distance, or far, and the next one.
  DistanceGatherer(const Extent& volume, float far, float (*join)(float last, float next))
    : Volume(volume)
    , Bricks(GetVertexBricks(volume))
    , Far(far)
    , Join(join)
  {
  }

  /// distances: of the vertices of a part of the volume, x varying fastest.
  void Add(const Extent& vertices, const float* distances);
  DistanceSet Take() const;

private:
  Extent Volume;
  CellBricks Bricks;
  float Far;
  float (*Join)(float last, float next);
  std::mutex Mutex;
  std::map<std::size_t, DistanceSet::Block> Blocks;
};

} // namespace deformvolume

#endif
