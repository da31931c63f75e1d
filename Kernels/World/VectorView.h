// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorView_h
#define DeformVolumeVectorView_h

#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>

namespace deformvolume
{

/// A view of consecutive vectors of three floats or three doubles each.
struct VectorView
{
  const void* Data = nullptr;
  bool AreDoubles = false;
  std::size_t Count = 0;

  glm::dvec3 Get(std::size_t i) const
  {
    if (this->AreDoubles)
    {
      const auto* vector = static_cast<const double*>(this->Data) + 3 * i;
      return { vector[0], vector[1], vector[2] };
    }
    const auto* vector = static_cast<const float*>(this->Data) + 3 * i;
    return { vector[0], vector[1], vector[2] };
  }
};

inline bool IsFiniteVector(const glm::dvec3& vector)
{
  return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

} // namespace deformvolume

#endif
