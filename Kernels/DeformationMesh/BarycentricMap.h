// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBarycentricMap_h
#define DeformVolumeBarycentricMap_h

#include "Tetrahedron.h"
#include "VertexLink.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace deformvolume
{

/// Barycentric weights of points in a tetrahedron, in double precision.
class BarycentricMap
{
public:
  /// Returns false for a flat tetrahedron: one whose determinant is not larger than its rounding
  /// error when the coordinates are rounded to double precision.
  bool SetTetrahedron(const Tetrahedron& tetrahedron, const std::vector<glm::dvec3>& points)
  {
    const glm::dvec3& last = points[tetrahedron[3]];
    const glm::dvec3 a = points[tetrahedron[0]] - last;
    const glm::dvec3 b = points[tetrahedron[1]] - last;
    const glm::dvec3 c = points[tetrahedron[2]] - last;
    const glm::dvec3 bc = glm::cross(b, c);
    const glm::dvec3 ca = glm::cross(c, a);
    const glm::dvec3 ab = glm::cross(a, b);
    const double determinant = glm::dot(a, bc);

    const glm::dvec3 magnitude = glm::max(glm::abs(last),
      glm::max(glm::abs(points[tetrahedron[0]]),
        glm::max(glm::abs(points[tetrahedron[1]]), glm::abs(points[tetrahedron[2]]))));
    const double largest = std::max(magnitude.x, std::max(magnitude.y, magnitude.z));
    const glm::dvec3 cofactors = AbsoluteCross(b, c) + AbsoluteCross(c, a) + AbsoluteCross(a, b);
    const double rounding = 8.0 * std::numeric_limits<double>::epsilon() * largest *
      (cofactors.x + cofactors.y + cofactors.z);
    if (!(std::abs(determinant) > rounding))
    {
      return false;
    }
    const double scale = 1.0 / determinant;
    this->Origin = last;
    this->Gradients[0] = bc * scale;
    this->Gradients[1] = ca * scale;
    this->Gradients[2] = ab * scale;
    return true;
  }

  glm::dvec3 GetWeights(const glm::dvec3& point) const
  {
    const glm::dvec3 offset = point - this->Origin;
    return glm::dvec3(glm::dot(this->Gradients[0], offset), glm::dot(this->Gradients[1], offset),
      glm::dot(this->Gradients[2], offset));
  }

  /// Returns the weights of all four nodes.
  glm::dvec4 GetAllWeights(const glm::dvec3& point) const
  {
    const glm::dvec3 weights = this->GetWeights(point);
    return glm::dvec4(weights, 1.0 - weights.x - weights.y - weights.z);
  }

  /// Returns the gradient of the weight of a node.
  glm::dvec3 GetGradient(int node) const
  {
    return node < 3 ? this->Gradients[node]
                    : -(this->Gradients[0] + this->Gradients[1] + this->Gradients[2]);
  }

  const glm::dvec3& GetOrigin() const { return this->Origin; }

private:
  static glm::dvec3 AbsoluteCross(const glm::dvec3& u, const glm::dvec3& v)
  {
    const glm::dvec3 p = glm::abs(u);
    const glm::dvec3 q = glm::abs(v);
    return glm::dvec3(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
  }

  glm::dvec3 Origin{ 0.0 };
  glm::dvec3 Gradients[3] = { glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec3(0.0) };
};

/// Makes the link of a point to a tetrahedron. weights: of the first three nodes.
inline VertexLink MakeLink(std::int32_t tetrahedron, const glm::dvec3& weights)
{
  VertexLink link;
  link.Tetrahedron = tetrahedron;
  for (int node = 0; node < 3; ++node)
  {
    link.Weights[node] = static_cast<float>(weights[node]);
  }
  return link;
}

} // namespace deformvolume

#endif
