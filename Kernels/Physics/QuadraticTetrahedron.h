// SPDX-License-Identifier: BSD-3-Clause
// Shape functions and four-point Gauss integration of the ten-node tetrahedron.
#ifndef DeformVolumeQuadraticTetrahedron_h
#define DeformVolumeQuadraticTetrahedron_h

#include "ElasticBody.h"
#include "MidSideNodes.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace deformvolume
{

/// The quadratic tetrahedron of ten nodes: four corners, then the mid-side nodes in the order of
/// TetrahedronEdges. Positions inside it (`weights`) are four barycentric coordinates.
struct QuadraticTetrahedron
{
  static constexpr std::size_t NumberOfNodes = 10;
  static constexpr std::size_t NumberOfGaussPoints = 4;

  /// The barycentric coordinates of Gauss point i: NearCoordinate for corner i, FarCoordinate for
  /// the other corners. Each of the four points has a quarter of the weight.
  static constexpr double NearCoordinate = 0.58541019662496845446; // (5 + 3 sqrt 5) / 20
  static constexpr double FarCoordinate = 0.13819660112501051518;  // (5 - sqrt 5) / 20
  static glm::dvec4 GetGaussPoint(std::size_t i)
  {
    glm::dvec4 weights(FarCoordinate);
    weights[static_cast<int>(i)] = NearCoordinate;
    return weights;
  }

  static std::array<glm::dvec3, NumberOfNodes> GetPoints(
    const ElasticBody& body, std::size_t tetrahedron)
  {
    std::array<glm::dvec3, NumberOfNodes> points{};
    std::size_t i = 0;
    body.ForNodes(tetrahedron,
      [&](std::int32_t node) { points[i++] = body.Points[static_cast<std::size_t>(node)]; });
    return points;
  }

  /// The derivatives of the position with respect to the barycentric coordinates of corners 1, 2
  /// and 3, as three columns; the coordinate of corner 0 is 1 minus the sum of these three. With
  /// straight edges the determinant is six times the volume.
  static glm::dmat3 GetJacobian(
    const std::array<glm::dvec3, NumberOfNodes>& points, const glm::dvec4& weights)
  {
    std::array<glm::dvec3, 4> slopes; // derivatives with respect to each coordinate
    for (std::size_t i = 0; i < 4; ++i)
    {
      slopes[i] = (4.0 * weights[static_cast<int>(i)] - 1.0) * points[i];
    }
    for (std::size_t edge = 0; edge < 6; ++edge)
    {
      const std::size_t a = TetrahedronEdges[edge][0];
      const std::size_t b = TetrahedronEdges[edge][1];
      slopes[a] += 4.0 * weights[static_cast<int>(b)] * points[4 + edge];
      slopes[b] += 4.0 * weights[static_cast<int>(a)] * points[4 + edge];
    }
    return { slopes[1] - slopes[0], slopes[2] - slopes[0], slopes[3] - slopes[0] };
  }

  /// The volume of a Gauss point: its share of the volume of the tetrahedron. determinant: of
  /// GetJacobian at this point.
  static double GetGaussVolume(double determinant)
  {
    constexpr double ofDeterminant = 1.0 / 24.0;
    return ofDeterminant * std::abs(determinant);
  }

  /// The volume of each Gauss point, in m^3.
  static std::array<double, NumberOfGaussPoints> GetGaussVolumes(
    const ElasticBody& body, std::size_t tetrahedron)
  {
    const std::array<glm::dvec3, NumberOfNodes> points = GetPoints(body, tetrahedron);
    std::array<double, NumberOfGaussPoints> volumes;
    for (std::size_t i = 0; i < NumberOfGaussPoints; ++i)
    {
      volumes[i] = GetGaussVolume(glm::determinant(GetJacobian(points, GetGaussPoint(i))));
    }
    return volumes;
  }

  /// Whether the order of the corners is reversed, so that the signed volume is negative.
  static bool IsMirrored(const std::array<glm::dvec3, NumberOfNodes>& points)
  {
    return GetDeterminant({ { points[0], points[1], points[2], points[3] } }) < 0.0;
  }

  /// Whether one of the twelve linear tetrahedra into which vtkDeformVolumeFilter splits this one
  /// is inverted. Four of them lie at the corners, eight around the center. isMirrored: whether the
  /// tetrahedron at rest IsMirrored.
  static bool IsSplitInverted(const std::array<glm::dvec3, NumberOfNodes>& p, bool isMirrored)
  {
    // Each corner with the three mid-side nodes next to it; and the triangles between mid-side
    // nodes on the faces, oriented inwards.
    constexpr std::size_t corners[4][4] = { { 0, 4, 6, 7 }, { 1, 5, 4, 8 }, { 2, 6, 5, 9 },
      { 3, 8, 7, 9 } };
    constexpr std::size_t faces[4][3] = { { 4, 5, 6 }, { 4, 7, 8 }, { 5, 8, 9 }, { 6, 9, 7 } };
    const glm::dvec3 center =
      0.25 * (p[4] + p[5] + p[6] + p[7] + p[8] + p[9]) - 0.125 * (p[0] + p[1] + p[2] + p[3]);
    const auto isBad = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                         const glm::dvec3& d) {
      return (isMirrored ? -1.0 : 1.0) * GetDeterminant({ { a, b, c, d } }) < 0.0;
    };
    for (const std::size_t(&c)[4] : corners)
    {
      if (isBad(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) || isBad(p[c[1]], p[c[2]], p[c[3]], center))
      {
        return true;
      }
    }
    for (const std::size_t(&f)[3] : faces)
    {
      if (isBad(p[f[0]], p[f[1]], p[f[2]], center))
      {
        return true;
      }
    }
    return false;
  }

  /// The shape functions at Gauss point i: the shares of the ten nodes of a force that acts at this
  /// point.
  static std::array<double, NumberOfNodes> GetShapeFunctions(std::size_t i)
  {
    const glm::dvec4 weights = GetGaussPoint(i);
    std::array<double, NumberOfNodes> shares;
    for (std::size_t a = 0; a < 4; ++a)
    {
      const double coordinate = weights[static_cast<int>(a)];
      shares[a] = coordinate * (2.0 * coordinate - 1.0);
    }
    for (std::size_t edge = 0; edge < 6; ++edge)
    {
      shares[4 + edge] = 4.0 * weights[static_cast<int>(TetrahedronEdges[edge][0])] *
        weights[static_cast<int>(TetrahedronEdges[edge][1])];
    }
    return shares;
  }
};

} // namespace deformvolume

#endif
