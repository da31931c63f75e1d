// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementBounds_h
#define DeformVolumeDisplacementBounds_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

struct DisplacementField;

struct DisplacementBounds;

/// Displacements of points, in output voxels. One of the pointers is set.
struct Displacements
{
  const float* Padded = nullptr; // four floats per point
  const DisplacementField* Field = nullptr;
  // Bounds in each sub-brick, for displacements that are not in host memory.
  const std::vector<DisplacementBounds>* OfSubBricks = nullptr;
};

/// The least and the greatest components of displacements.
struct DisplacementBounds
{
  DisplacementBounds();
  /// Adds the displacements of the points begin to end - 1. displacements: four floats per point.
  void Add(const float* displacements, std::size_t begin, std::size_t end);
  /// Adds the displacements of the points begin to end - 1. The bounds of a field may be slightly
  /// too large if its ToDisplacement is not diagonal.
  void Add(const Displacements& displacements, std::size_t begin, std::size_t end);
  void Add(const DisplacementBounds& other);
  std::array<float, 4> Min;
  std::array<float, 4> Max;
};

/// Returns the union of bounds.
DisplacementBounds Join(const std::vector<DisplacementBounds>& bounds);

inline void DisplacementBounds::Add(const float* displacements, std::size_t begin, std::size_t end)
{
  // Local copies allow vectorization: the members may alias the displacements.
  std::array<float, 4> least = this->Min;
  std::array<float, 4> greatest = this->Max;
  for (std::size_t point = begin; point < end; ++point)
  {
    for (std::size_t c = 0; c < 4; ++c)
    {
      least[c] = std::min(least[c], displacements[4 * point + c]);
      greatest[c] = std::max(greatest[c], displacements[4 * point + c]);
    }
  }
  this->Min = least;
  this->Max = greatest;
}

} // namespace deformvolume

#endif
