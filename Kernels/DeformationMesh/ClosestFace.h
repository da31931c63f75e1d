// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeClosestFace_h
#define DeformVolumeClosestFace_h

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace deformvolume
{

/// Finds the triangle that is closest to a point, by a tree of boxes. Calls may run side by side.
class ClosestFace
{
public:
  using Triangle = std::array<glm::dvec3, 3>;
  struct Result
  {
    std::int32_t Face = -1;
    double SquaredDistance = std::numeric_limits<double>::infinity();
    /// Of the closest point, which they add up to: barycentric weights of the triangle's corners,
    /// none negative.
    glm::dvec3 Weights{ 0.0 };
  };

  /// None of the triangles may be a line or a point.
  explicit ClosestFace(std::vector<Triangle> triangles);

  /// Of equally close ones the first. nearby: a triangle that may be close, or -1; the result does
  /// not depend on it. No triangle where there are none.
  Result Find(const glm::dvec3& point, std::int32_t nearby = -1) const;

private:
  struct Node
  {
    glm::dvec3 Min;
    glm::dvec3 Max;
    std::int32_t Begin; // triangles in Order; or of an inner node
    std::int32_t End;   // 0
    std::int32_t Upper; // whose lower half is the next node
  };

  void Build(std::int32_t begin, std::int32_t end, const std::vector<glm::dvec3>& centers);
  void Look(const glm::dvec3& point, std::int32_t face, Result& best) const;

  std::vector<Triangle> Triangles;
  std::vector<std::int32_t> Order;
  std::vector<Node> Nodes;
};

} // namespace deformvolume

#endif
