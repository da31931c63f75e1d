// SPDX-License-Identifier: BSD-3-Clause
#ifndef SampleCount_h
#define SampleCount_h

#include "Pose.h"

#include <cstdint>

/// Numbers of voxels of the output in the bounding boxes of the deformed tetrahedra of the sampling
/// mesh: the samples that a rasterizer has to test. A box is closed at its lower sides and open at
/// its upper ones, so that an undeformed tetrahedron has one sample.
struct SampleCount
{
  std::int64_t Tetrahedra = 0;
  std::int64_t Samples = 0;
  /// The fewest and the most samples of one tetrahedron.
  std::int64_t Fewest = 0;
  std::int64_t Most = 0;
};

/// Counts samples for a volume of these dimensions in a pose. Positions are rounded to 1/256 voxel.
SampleCount CountSamples(const std::array<int, 3>& dimensions, Pose pose);

#endif
