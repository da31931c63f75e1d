// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorView_h
#define DeformVolumeVectorView_h

#include "IndexBounds.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// A view of consecutive vectors of three floats or three doubles each.
struct VectorView
{
  /// The first number of the first vector.
  const void* Data = nullptr;
  /// Whether the numbers are doubles; otherwise they are floats.
  bool AreDoubles = false;
  /// The number of vectors.
  std::size_t Count = 0;

  /// Returns a vector.
  glm::dvec3 Get(std::size_t i) const
  {
    const auto index = static_cast<std::int64_t>(i);
    return this->AreDoubles ? GetVector(static_cast<const double*>(this->Data), index)
                            : GetVector(static_cast<const float*>(this->Data), index);
  }
};

} // namespace deformvolume

#endif
