// SPDX-License-Identifier: BSD-3-Clause
#include "VectorComponents.h"

#include "DisplacementField.h"

#include <algorithm>
#include <limits>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace deformvolume
{

VectorComponents FindComponents(const float* values, std::size_t count)
{
  // Twelve numbers at a time, of four vectors, side by side.
  constexpr std::size_t width = 12;
  alignas(16) std::array<float, width> least;
  alignas(16) std::array<float, width> greatest;
  alignas(16) std::array<float, width> rest{}; // nothing, where all numbers are finite
  least.fill(std::numeric_limits<float>::max());
  greatest.fill(-std::numeric_limits<float>::max());
  std::size_t i = 0;
#ifdef __SSE__
  // Compilers do not find these by themselves, and there are millions of points.
  __m128 lows[3];
  __m128 highs[3];
  __m128 rests[3];
  for (int k = 0; k < 3; ++k)
  {
    lows[k] = _mm_load_ps(&least[4 * k]);
    highs[k] = _mm_load_ps(&greatest[4 * k]);
    rests[k] = _mm_setzero_ps();
  }
  for (; i + width <= count; i += width)
  {
    for (int k = 0; k < 3; ++k)
    {
      const __m128 next = _mm_loadu_ps(values + i + 4 * k);
      lows[k] = _mm_min_ps(next, lows[k]);
      highs[k] = _mm_max_ps(next, highs[k]);
      rests[k] = _mm_add_ps(rests[k], _mm_sub_ps(next, next));
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    _mm_store_ps(&least[4 * k], lows[k]);
    _mm_store_ps(&greatest[4 * k], highs[k]);
    _mm_store_ps(&rest[4 * k], rests[k]);
  }
#endif
  for (; i < count; ++i)
  {
    const std::size_t k = i % width;
    least[k] = std::min(least[k], values[i]);
    greatest[k] = std::max(greatest[k], values[i]);
    rest[k] += values[i] - values[i];
  }
  VectorComponents found;
  found.AreFinite = std::all_of(rest.begin(), rest.end(), [](float r) { return r == 0.0F; });
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    found.Least[axis] =
      std::min({ least[axis], least[axis + 3], least[axis + 6], least[axis + 9] });
    found.Greatest[axis] =
      std::max({ greatest[axis], greatest[axis + 3], greatest[axis + 6], greatest[axis + 9] });
  }
  return found;
}

DisplacementRange GetRange(const DisplacementField& field, const VectorComponents& components)
{
  DisplacementRange range;
  for (int axis = 0; axis < 3; ++axis)
  {
    // Products and sums are rounded alike for all vectors.
    double low = 0.0;
    double high = 0.0;
    for (int k = 0; k < 3; ++k)
    {
      const double factor = GetFactor(field, 3 * axis + k);
      const double a = factor * static_cast<double>(components.Least[k]);
      const double b = factor * static_cast<double>(components.Greatest[k]);
      low += std::min(a, b);
      high += std::max(a, b);
    }
    range.Least[axis] = static_cast<double>(static_cast<float>(low));
    range.Greatest[axis] = static_cast<double>(static_cast<float>(high));
  }
  return range;
}

} // namespace deformvolume
