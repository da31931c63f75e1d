// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBackground_h
#define DeformVolumeBackground_h

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace deformvolume
{

/// Converts a background value to the type of an array: rounded to the nearest integer for integer
/// types, and clamped to the range of the type.
template <typename T>
T ClampTo(double value)
{
  if (std::is_integral<T>::value)
  {
    if (std::isnan(value))
    {
      return 0;
    }
    // Converting the limits of 64-bit integers to double can round them outwards, hence >= and <=.
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
  // Finite values stay finite.
  const double largest = static_cast<double>(std::numeric_limits<T>::max());
  return static_cast<T>(
    std::isfinite(value) ? std::min(std::max(value, -largest), largest) : value);
}

} // namespace deformvolume

#endif
