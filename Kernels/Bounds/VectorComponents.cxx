// SPDX-License-Identifier: BSD-3-Clause
#include "VectorComponents.h"

#include "DisplacementField.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformvolume
{

VectorComponents FindComponents(const float* values, std::size_t count)
{
  // Process 8 vectors at a time, so that compilers vectorize the loop.
  constexpr std::size_t width = 24;
  constexpr float largest = std::numeric_limits<float>::max();
  std::array<float, width> least;
  std::array<float, width> greatest;
  std::array<int, width> areFinite;
  least.fill(largest);
  greatest.fill(-largest);
  areFinite.fill(1);
  const auto add = [&](std::size_t k, float value)
  {
    least[k] = std::min(least[k], value);
    greatest[k] = std::max(greatest[k], value);
    areFinite[k] &= std::abs(value) <= largest ? 1 : 0;
  };
  std::size_t i = 0;
  for (; i + width <= count; i += width)
  {
    for (std::size_t k = 0; k < width; ++k)
    {
      add(k, values[i + k]);
    }
  }
  for (std::size_t k = 0; i + k < count; ++k)
  {
    add(k, values[i + k]);
  }
  VectorComponents found;
  found.Least.fill(largest);
  found.Greatest.fill(-largest);
  found.AreFinite = true;
  for (std::size_t k = 0; k < width; ++k)
  {
    found.Least[k % 3] = std::min(found.Least[k % 3], least[k]);
    found.Greatest[k % 3] = std::max(found.Greatest[k % 3], greatest[k]);
    found.AreFinite = found.AreFinite && areFinite[k] != 0;
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
    // The order of operations is that of GetDisplacement(): rounding is monotonic, so no
    // displacement exceeds the range.
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
