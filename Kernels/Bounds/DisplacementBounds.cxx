// SPDX-License-Identifier: BSD-3-Clause
#include "DisplacementBounds.h"

#include "DisplacementField.h"
#include "VectorComponents.h"

#include <algorithm>
#include <limits>

namespace deformvolume
{

DisplacementBounds::DisplacementBounds()
{
  this->Min.fill(std::numeric_limits<float>::infinity());
  this->Max.fill(-std::numeric_limits<float>::infinity());
}

void DisplacementBounds::Add(const Displacements& displacements, std::size_t begin, std::size_t end)
{
  if (displacements.Padded)
  {
    this->Add(displacements.Padded, begin, end);
    return;
  }
  const VectorComponents components =
    FindComponents(displacements.Field->Vectors + 3 * begin, 3 * (end - begin));
  if (components.AreFinite)
  {
    const DisplacementRange range = GetRange(GetFactors(*displacements.Field), components);
    for (int axis = 0; begin < end && axis < 3; ++axis)
    {
      this->Min[axis] = std::min(this->Min[axis], static_cast<float>(range.Min[axis]));
      this->Max[axis] = std::max(this->Max[axis], static_cast<float>(range.Max[axis]));
    }
    return;
  }
  for (std::size_t point = begin; point < end; ++point)
  {
    const std::array<float, 3> found =
      GetDisplacement(*displacements.Field, static_cast<std::int64_t>(point));
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Min[axis] = std::min(this->Min[axis], found[axis]);
      this->Max[axis] = std::max(this->Max[axis], found[axis]);
    }
  }
}

void DisplacementBounds::Add(const DisplacementBounds& other)
{
  for (int c = 0; c < 4; ++c)
  {
    this->Min[c] = std::min(this->Min[c], other.Min[c]);
    this->Max[c] = std::max(this->Max[c], other.Max[c]);
  }
}

DisplacementBounds Join(const std::vector<DisplacementBounds>& bounds)
{
  DisplacementBounds all;
  for (const DisplacementBounds& one : bounds)
  {
    all.Add(one);
  }
  return all;
}

} // namespace deformvolume
