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

#ifdef __SSE__
namespace
{
// In bytes. Not in a function of its own: compilers leave out calls that return nothing.
constexpr std::ptrdiff_t PrefetchDistance = 3072;
}
#endif

VectorComponents FindComponents(const float* values, std::size_t count)
{
  // Twelve numbers at a time, of four vectors, side by side.
  constexpr std::size_t width = 12;
  constexpr float largest = std::numeric_limits<float>::max();
  alignas(16) std::array<float, width> least;
  alignas(16) std::array<float, width> greatest;
  least.fill(largest);
  greatest.fill(-largest);
  bool areNumbers = true;
  std::size_t i = 0;
#ifdef __SSE__
  // Compilers do not find these by themselves, and there are millions of points.
  __m128 lows[3];
  __m128 highs[3];
  __m128 others = _mm_setzero_ps(); // bits where not-a-number was
  for (int k = 0; k < 3; ++k)
  {
    lows[k] = _mm_set1_ps(largest);
    highs[k] = _mm_set1_ps(-largest);
  }
  for (; i + width <= count; i += width)
  {
    // What follows is often wanted soon, and the processor by itself does not look beyond a page.
    _mm_prefetch(reinterpret_cast<const char*>(values + i) + PrefetchDistance, _MM_HINT_T0);
    __m128 next[3];
    for (int k = 0; k < 3; ++k)
    {
      next[k] = _mm_loadu_ps(values + i + 4 * k);
      lows[k] = _mm_min_ps(next[k], lows[k]);
      highs[k] = _mm_max_ps(next[k], highs[k]);
    }
    others = _mm_or_ps(
      others, _mm_or_ps(_mm_cmpunord_ps(next[0], next[1]), _mm_cmpunord_ps(next[2], next[2])));
  }
  areNumbers = _mm_movemask_ps(others) == 0;
  for (int k = 0; k < 3; ++k)
  {
    _mm_store_ps(&least[4 * k], lows[k]);
    _mm_store_ps(&greatest[4 * k], highs[k]);
  }
#endif
  for (; i < count; ++i)
  {
    const std::size_t k = i % width;
    least[k] = std::min(least[k], values[i]);
    greatest[k] = std::max(greatest[k], values[i]);
    areNumbers = areNumbers && values[i] == values[i];
  }
  VectorComponents found;
  found.AreFinite = areNumbers;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    found.Least[axis] =
      std::min({ least[axis], least[axis + 3], least[axis + 6], least[axis + 9] });
    found.Greatest[axis] =
      std::max({ greatest[axis], greatest[axis + 3], greatest[axis + 6], greatest[axis + 9] });
    found.AreFinite =
      found.AreFinite && found.Least[axis] >= -largest && found.Greatest[axis] <= largest;
  }
  return found;
}

DisplacementFactors GetFactors(const DisplacementField& field)
{
  DisplacementFactors factors;
  for (int element = 0; element < 9; ++element)
  {
    factors[element] = GetFactor(field, element);
  }
  return factors;
}

DisplacementRange GetRange(const DisplacementFactors& factors, const VectorComponents& components)
{
  DisplacementRange range;
  for (int axis = 0; axis < 3; ++axis)
  {
    // Products and sums are rounded alike for all vectors.
    double low = 0.0;
    double high = 0.0;
    for (int k = 0; k < 3; ++k)
    {
      const double factor = factors[3 * axis + k];
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
