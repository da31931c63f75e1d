// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeClosestFace_h
#define DeformVolumeClosestFace_h

#include "BoxTree.h"
#include "IndexBounds.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace deformvolume
{

/// Finds the triangle that is closest to a point. Thread-safe.
class ClosestFace
{
public:
  using Triangle = std::array<glm::dvec3, 3>;
  struct Result
  {
    std::int32_t Face = -1;
    double SquaredDistance = std::numeric_limits<double>::infinity();
    /// Barycentric weights of the closest point in the triangle. None is negative.
    glm::dvec3 Weights{ 0.0 };
  };

  /// No triangle may be degenerate.
  explicit ClosestFace(std::vector<Triangle> triangles);

  /// Returns the closest triangle; of several at the same distance, the first. Face is -1 if there
  /// are no triangles. nearby: a triangle that may be close, or -1. It makes the search faster and
  /// does not change the result.
  Result Find(const glm::dvec3& point, std::int32_t nearby = -1) const;
  /// As Find(), but returns the first of the triangles whose distances differ only by rounding.
  /// Beyond the edge between two triangles, Find() takes either of them, from point to point.
  Result FindFirst(const glm::dvec3& point) const;

private:
  void Look(const glm::dvec3& point, std::int32_t face, Result& best) const;

  std::vector<Triangle> Triangles;
  BoxTree<IndexBounds> Tree;
};

} // namespace deformvolume

#endif
