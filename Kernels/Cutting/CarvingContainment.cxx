// SPDX-License-Identifier: BSD-3-Clause
#include "CarvingContainment.h"

#include "Carving.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace deformvolume
{

CarvingContainment FindContainment(const SnappedBox& box, const CarvingTool& tool)
{
  if (box.IsEmpty() || !IndexBounds{ GetIndex(box.Min), GetIndex(box.Max) }.Overlaps(tool.Bounds))
  {
    return CarvingContainment::Nothing;
  }
  if (!tool.IsLinear)
  {
    return CarvingContainment::Some;
  }
  constexpr double rounding = 1e-9; // relative to the largest value
  std::array<glm::dvec3, 8> corners;
  for (std::size_t corner = 0; corner < corners.size(); ++corner)
  {
    corners[corner] = GetIndex(SnappedPoint(corner & 1U ? box.Max.x : box.Min.x,
      corner & 2U ? box.Max.y : box.Min.y, corner & 4U ? box.Max.z : box.Min.z));
  }
  std::array<double, 8> values;
  tool.Function(corners.data(), corners.size(), values.data());
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double near = rounding * std::max(std::abs(*least), std::abs(*most));
  return *most < -near ? CarvingContainment::All
    : *least > near    ? CarvingContainment::Nothing
                       : CarvingContainment::Some;
}

} // namespace deformvolume
