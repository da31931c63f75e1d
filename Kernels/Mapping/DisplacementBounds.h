// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementBounds_h
#define DeformVolumeDisplacementBounds_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

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
  alignas(16) std::array<float, 4> Least;
  alignas(16) std::array<float, 4> Greatest;
};

/// What holds all of some bounds.
DisplacementBounds Join(const std::vector<DisplacementBounds>& bounds);

inline void DisplacementBounds::Add(const float* displacements, std::size_t begin, std::size_t end)
{
#ifdef __SSE__
  // Compilers do not find these by themselves, and there are millions of points.
  __m128 least = _mm_load_ps(this->Least.data());
  __m128 greatest = _mm_load_ps(this->Greatest.data());
  // Two points at a time, which do not wait for each other.
  __m128 otherLeast = least;
  __m128 otherGreatest = greatest;
  std::size_t point = begin;
  for (; point + 2 <= end; point += 2)
  {
    const __m128 next = _mm_loadu_ps(displacements + 4 * point);
    const __m128 other = _mm_loadu_ps(displacements + 4 * point + 4);
    least = _mm_min_ps(least, next);
    greatest = _mm_max_ps(greatest, next);
    otherLeast = _mm_min_ps(otherLeast, other);
    otherGreatest = _mm_max_ps(otherGreatest, other);
  }
  if (point < end)
  {
    const __m128 next = _mm_loadu_ps(displacements + 4 * point);
    least = _mm_min_ps(least, next);
    greatest = _mm_max_ps(greatest, next);
  }
  _mm_store_ps(this->Least.data(), _mm_min_ps(least, otherLeast));
  _mm_store_ps(this->Greatest.data(), _mm_max_ps(greatest, otherGreatest));
#else
  for (std::size_t i = 4 * begin; i < 4 * end; ++i)
  {
    this->Least[i % 4] = std::min(this->Least[i % 4], displacements[i]);
    this->Greatest[i % 4] = std::max(this->Greatest[i % 4], displacements[i]);
  }
#endif
}

} // namespace deformvolume

#endif
