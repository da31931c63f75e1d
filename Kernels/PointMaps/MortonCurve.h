// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMortonCurve_h
#define DeformVolumeMortonCurve_h

#include <glm/vec3.hpp>

#include <algorithm>
#include <cstdint>

namespace deformvolume
{

/// The number on a Morton curve of a point between 0 and 1: points with similar numbers are near to
/// each other. bits: of the number for each axis, at most 21.
inline std::uint64_t GetMortonNumber(const glm::dvec3& point, int bits)
{
  const auto most = static_cast<double>((std::uint64_t{ 1 } << bits) - 1);
  std::uint64_t number = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    auto spread = static_cast<std::uint64_t>(std::min(std::max(point[axis] * most, 0.0), most));
    // Two zeros between each two bits.
    spread = (spread | spread << 32) & 0x001f00000000ffffU;
    spread = (spread | spread << 16) & 0x001f0000ff0000ffU;
    spread = (spread | spread << 8) & 0x100f00f00f00f00fU;
    spread = (spread | spread << 4) & 0x10c30c30c30c30c3U;
    spread = (spread | spread << 2) & 0x1249249249249249U;
    number |= spread << axis;
  }
  return number;
}

} // namespace deformvolume

#endif
