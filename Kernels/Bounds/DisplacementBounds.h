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

/// Displacements of points, in output voxels, as they lie in memory, or as they are known.
struct Displacements
{
  const float* Padded = nullptr; // four floats each, or else
  const DisplacementField* Field = nullptr;
  // Or, of displacements that are not on the host, their bounds in each sub-brick.
  const std::vector<DisplacementBounds>* OfSubBricks = nullptr;
};

/// The least and the greatest displacement of some points.
struct DisplacementBounds
{
  DisplacementBounds();
  /// Points from begin to before end, of four floats each in the first form.
  void Add(const float* displacements, std::size_t begin, std::size_t end);
  /// Of a field maybe a little wider, where its axes are turned.
  void Add(const Displacements& displacements, std::size_t begin, std::size_t end);
  void Add(const DisplacementBounds& other);
  std::array<float, 4> Least;
  std::array<float, 4> Greatest;
};

/// What holds all of some bounds.
DisplacementBounds Join(const std::vector<DisplacementBounds>& bounds);

inline void DisplacementBounds::Add(const float* displacements, std::size_t begin, std::size_t end)
{
  // Local: the compiler cannot rule out that the floats are the memory of the members.
  std::array<float, 4> least = this->Least;
  std::array<float, 4> greatest = this->Greatest;
  for (std::size_t point = begin; point < end; ++point)
  {
    for (std::size_t c = 0; c < 4; ++c)
    {
      least[c] = std::min(least[c], displacements[4 * point + c]);
      greatest[c] = std::max(greatest[c], displacements[4 * point + c]);
    }
  }
  this->Least = least;
  this->Greatest = greatest;
}

} // namespace deformvolume

#endif
