// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElasticBody_h
#define DeformVolumeElasticBody_h

#include "DeformVolumeExport.h"
#include "MidSideNodes.h"
#include "Tetrahedron.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace deformvolume
{

class AbortCheck;

/// An isotropic elastic material.
struct ElasticMaterial
{
  /// In Pa, greater than 0.
  double YoungModulus = 1e4;
  /// 0 or more, less than LargestPoissonRatio.
  double PoissonRatio = 0.3;
  /// In kg/m^3, greater than 0.
  double Density = 1000.0;

  /// Lambda tends to infinity as the ratio tends to 0.5.
  static constexpr double LargestPoissonRatio = 0.495;

  ///@{
  /// The Lame parameters, in Pa.
  double GetShearModulus() const { return this->YoungModulus / (2.0 * (1.0 + this->PoissonRatio)); }
  double GetLambda() const
  {
    return this->YoungModulus * this->PoissonRatio /
      ((1.0 + this->PoissonRatio) * (1.0 - 2.0 * this->PoissonRatio));
  }
  ///@}
};

/// A tetrahedral mesh at rest with the properties that all physical models need.
struct ElasticBody
{
  /// Positions of the nodes at rest, in meters.
  std::vector<glm::dvec3> Points;
  /// The corners of each tetrahedron. In all tetrahedra the fourth node lies on the side to which
  /// the normal of the first three nodes points, or in all of them on the opposite side.
  std::vector<Tetrahedron> Tetrahedra;
  /// The mid-side nodes of each tetrahedron (AddMidSideNodes). Empty: the tetrahedra are linear.
  std::vector<MidSideNodes> MidSides;
  /// One material for the whole body, or one for each tetrahedron.
  std::vector<ElasticMaterial> Materials = std::vector<ElasticMaterial>(1);
  /// One byte for each node, not 0 if the node is fixed: at rest, or at
  /// BodyLoads::FixedDisplacements. Empty: no node is fixed.
  std::vector<unsigned char> Fixed;
  /// The normal, of any length, of the plane in which each node slides without friction. The plane
  /// contains the position of the node at rest. 0: the node does not slide. Empty: no node slides.
  std::vector<glm::dvec3> SlidingNormals;
  /// The normal of a second plane of each node. A node with two planes slides along their line of
  /// intersection, for example where two planes of symmetry meet. The second plane is ignored if it
  /// is parallel to the first one (GetSlidingNormals). Empty: no node has a second plane.
  std::vector<glm::dvec3> SecondSlidingNormals;

  /// Directions count as parallel if the sine of the angle between them is at most this number:
  /// coordinates may come from floats.
  static constexpr double ParallelSine = 1e-3;

  /// The material of a tetrahedron.
  const ElasticMaterial& GetMaterial(std::size_t tetrahedron) const
  {
    return this->Materials[this->Materials.size() == 1 ? 0 : tetrahedron];
  }
  /// The corners of a tetrahedron at rest.
  std::array<glm::dvec3, 4> GetCorners(std::size_t tetrahedron) const
  {
    const Tetrahedron& nodes = this->Tetrahedra[tetrahedron];
    const auto at = [&](std::size_t i) { return this->Points[static_cast<std::size_t>(nodes[i])]; };
    return { { at(0), at(1), at(2), at(3) } };
  }
  /// Whether a node is fixed.
  bool IsFixed(std::size_t node) const { return !this->Fixed.empty() && this->Fixed[node] != 0; }

  /// Calls take(node) for all nodes of a tetrahedron: the corners first, then the mid-side nodes.
  template <typename Take>
  void ForNodes(std::size_t tetrahedron, Take&& take) const
  {
    for (const std::int32_t node : this->Tetrahedra[tetrahedron])
    {
      take(node);
    }
    if (!this->MidSides.empty())
    {
      for (const std::int32_t node : this->MidSides[tetrahedron])
      {
        take(node);
      }
    }
  }
};

/// A node that a handle moves.
struct HeldNode
{
  /// The number of the node.
  std::int32_t Node = 0;
  /// The prescribed displacement of the node, in meters.
  glm::dvec3 Displacement{ 0.0 };
};

/// The loads and prescribed displacements of the nodes of a body.
struct BodyLoads
{
  /// The acceleration of gravity, in m/s^2.
  glm::dvec3 Gravity{ 0.0 };
  /// The force on each node, in N. Empty: no forces.
  std::vector<glm::dvec3> Forces;
  /// The prescribed displacement of each fixed node, in meters. Empty: fixed nodes stay at rest.
  std::vector<glm::dvec3> FixedDisplacements;
};

/// Returns the vector scaled to length 1; 0 for 0.
DEFORMVOLUME_EXPORT glm::dvec3 GetUnitVector(const glm::dvec3& vector);

/// The directions in which a sliding node cannot move: of length 1, and normal to each other. 0:
/// there is no such direction. The second direction is 0 if the two planes are parallel within
/// ElasticBody::ParallelSine.
DEFORMVOLUME_EXPORT std::array<glm::dvec3, 2> GetSlidingNormals(
  const ElasticBody& body, std::size_t node);

/// Returns six times the signed volume of a tetrahedron: negative if the order of its corners is
/// reversed.
inline double GetDeterminant(const std::array<glm::dvec3, 4>& corners)
{
  return glm::dot(
    glm::cross(corners[1] - corners[0], corners[2] - corners[0]), corners[3] - corners[0]);
}

/// Whether a tetrahedron has almost no volume: its determinant is at most 1e-6 of the cube of its
/// longest edge.
DEFORMVOLUME_EXPORT bool IsFlat(const std::array<glm::dvec3, 4>& points);

/// Throws an Error if a body cannot be simulated: it has no tetrahedra, an unknown node, a
/// coordinate that is not finite, a flat or inverted tetrahedron, a material out of range, or an
/// array of the wrong length. Also throws if mid-side nodes are so far from the middle of their
/// edges that a ten-node tetrahedron overlaps itself, or that one of the linear tetrahedra into
/// which it is split is inverted (QuadraticTetrahedron::IsSplitInverted). abortCheck: checks for an
/// abort. Callers outside the engine pass null.
DEFORMVOLUME_EXPORT void CheckBody(const ElasticBody& body, AbortCheck* abortCheck = nullptr);

/// The nodes of a tetrahedron for messages, such as "3, 4, 5 and 9". They are numbered as the
/// points of the user's mesh, whose cells may have other numbers than the tetrahedra.
DEFORMVOLUME_EXPORT std::string ListNodes(const Tetrahedron& tetrahedron);

/// Throws an Error if a property of a material is out of range. where: names the material in the
/// message, such as " of the tetrahedron with the points 3, 4, 5 and 9".
DEFORMVOLUME_EXPORT void CheckMaterial(const ElasticMaterial& material, const std::string& where);

/// Throws an Error if the number of materials does not fit the body, or one of them is out of
/// range.
DEFORMVOLUME_EXPORT void CheckMaterials(
  const ElasticBody& body, const std::vector<ElasticMaterial>& materials);

/// Throws an Error if a load is not finite, or the number of values does not fit the body.
DEFORMVOLUME_EXPORT void CheckLoads(const ElasticBody& body, const BodyLoads& loads);

/// Throws an Error if a held node does not exist, is fixed, is held twice, or has a displacement
/// that is not finite.
DEFORMVOLUME_EXPORT void CheckHeldNodes(const ElasticBody& body, const std::vector<HeldNode>& held);

/// The volume of each linear tetrahedron, in m^3. The volumes are positive for either order of
/// nodes.
DEFORMVOLUME_EXPORT std::vector<double> GetVolumes(const ElasticBody& body);

/// The mass of each node of linear tetrahedra, in kg: a quarter of the mass of each of its
/// tetrahedra. 0 for a node without a tetrahedron.
DEFORMVOLUME_EXPORT std::vector<double> GetNodeMasses(
  const ElasticBody& body, const std::vector<double>& volumes);

} // namespace deformvolume

#endif
