// SPDX-License-Identifier: BSD-3-Clause
#ifndef SampleCount_h
#define SampleCount_h

#include "Pose.h"

#include <cstdint>

/// How many voxels of the output lie in the boxes of the deformed tetrahedra of the sampling mesh:
/// the samples that a rasteriser has to look at. A box is closed at its lower sides and open at its
/// upper ones, so that an undeformed tetrahedron has one.
struct SampleCount
{
  std::int64_t Tetrahedra = 0;
  std::int64_t Samples = 0;
  /// For one tetrahedron.
  std::int64_t Fewest = 0;
  std::int64_t Most = 0;
};

/// For a volume of these dimensions in a pose, positions rounded to 1/256 voxel.
SampleCount CountSamples(const std::array<int, 3>& dimensions, Pose pose);

#endif
