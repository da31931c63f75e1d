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

/// Collects the distances of the vertices of bricks of cells into a set for a volume. Add() may be
/// called by several threads.
class DistanceGatherer
{
public:
  /// far: the distance of vertices that were not added. join: combines the last distance of a
  /// vertex, or `far`, with the next one, as a vertex can belong to several bricks.
  DistanceGatherer(const Extent& volume, float far, float (*join)(float last, float next))
    : Volume(volume)
    , Bricks(GetVertexBricks(volume))
    , Far(far)
    , Join(join)
  {
  }

  /// distances: one for each vertex of a part of the volume, x varying fastest.
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
