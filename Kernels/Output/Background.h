// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBackground_h
#define DeformVolumeBackground_h

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace deformvolume
{

/// What a background becomes in the type of an array: rounded to the nearest integer where that is
/// one, and clamped to its range.
template <typename T>
T ClampTo(double value)
{
  if (std::is_integral<T>::value)
  {
    if (std::isnan(value))
    {
      return 0;
    }
    // As doubles the ends of the range may round outwards, hence >= and <=.
    if (value >= static_cast<double>(std::numeric_limits<T>::max()))
    {
      return std::numeric_limits<T>::max();
    }
    if (value <= static_cast<double>(std::numeric_limits<T>::lowest()))
    {
      return std::numeric_limits<T>::lowest();
    }
    return static_cast<T>(std::nearbyint(value));
  }
  // A finite value stays finite.
  const double largest = static_cast<double>(std::numeric_limits<T>::max());
  return static_cast<T>(
    std::isfinite(value) ? std::min(std::max(value, -largest), largest) : value);
}

} // namespace deformvolume

#endif
