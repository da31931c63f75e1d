// SPDX-License-Identifier: BSD-3-Clause
#include "VectorComponents.h"

#include "DisplacementField.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformvolume
{

namespace
{

constexpr float Largest = std::numeric_limits<float>::max();

} // namespace

ComponentFinder::ComponentFinder()
{
  this->Min.fill(Largest);
  this->Max.fill(-Largest);
  this->AreFinite.fill(1);
}

void ComponentFinder::Add(const float* values, std::size_t count)
{
  // Local copies allow vectorization: the members may alias the values.
  std::array<float, Width> least = this->Min;
  std::array<float, Width> greatest = this->Max;
  std::array<int, Width> areFinite = this->AreFinite;
  const auto add = [&](std::size_t k, float value)
  {
    least[k] = std::min(least[k], value);
    greatest[k] = std::max(greatest[k], value);
    areFinite[k] &= std::abs(value) <= Largest ? 1 : 0;
  };
  std::size_t i = 0;
  for (; i + Width <= count; i += Width)
  {
    for (std::size_t k = 0; k < Width; ++k)
    {
      add(k, values[i + k]);
    }
  }
  for (std::size_t k = 0; i + k < count; ++k)
  {
    add(k, values[i + k]);
  }
  this->Min = least;
  this->Max = greatest;
  this->AreFinite = areFinite;
}

VectorComponents ComponentFinder::Get() const
{
  VectorComponents found;
  found.Min.fill(Largest);
  found.Max.fill(-Largest);
  found.AreFinite = true;
  for (std::size_t k = 0; k < Width; ++k)
  {
    found.Min[k % 3] = std::min(found.Min[k % 3], this->Min[k]);
    found.Max[k % 3] = std::max(found.Max[k % 3], this->Max[k]);
    found.AreFinite = found.AreFinite && this->AreFinite[k] != 0;
  }
  return found;
}

VectorComponents FindComponents(const float* values, std::size_t count)
{
  ComponentFinder finder;
  finder.Add(values, count);
  return finder.Get();
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
      const double a = factor * static_cast<double>(components.Min[k]);
      const double b = factor * static_cast<double>(components.Max[k]);
      low += std::min(a, b);
      high += std::max(a, b);
    }
    range.Min[axis] = static_cast<double>(static_cast<float>(low));
    range.Max[axis] = static_cast<double>(static_cast<float>(high));
  }
  return range;
}

} // namespace deformvolume
