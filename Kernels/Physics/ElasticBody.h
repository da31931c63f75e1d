// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElasticBody_h
#define DeformVolumeElasticBody_h

#include "DeformVolumeExport.h"
#include "MidSideNodes.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace deformvolume
{

class Watch;

/// An isotropic elastic material.
struct ElasticMaterial
{
  /// In Pa, greater than 0.
  double YoungModulus = 1e4;
  /// 0 or more, less than LargestPoissonRatio.
  double PoissonRatio = 0.3;
  /// In kg/m^3, greater than 0.
  double Density = 1000.0;

  /// Lambda grows without bounds where the ratio comes near 0.5.
  static constexpr double LargestPoissonRatio = 0.495;

  ///@{
  /// The constants of Lame, in Pa.
  double GetShearModulus() const { return this->YoungModulus / (2.0 * (1.0 + this->PoissonRatio)); }
  double GetLambda() const
  {
    return this->YoungModulus * this->PoissonRatio /
      ((1.0 + this->PoissonRatio) * (1.0 - 2.0 * this->PoissonRatio));
  }
  ///@}
};

/// A mesh of tetrahedra at rest, with what the physical models need to know of it.
struct ElasticBody
{
  /// In metres.
  std::vector<glm::dvec3> Points;
  /// The corners of tetrahedra. All with the fourth node on the side to which the normal of the
  /// first three points, or all on the other side.
  std::vector<Tetrahedron> Tetrahedra;
  /// Of each tetrahedron the nodes in the middle of its edges (AddMidSideNodes); empty: the
  /// tetrahedra are linear.
  std::vector<MidSideNodes> MidSides;
  /// One for the whole body, or one a tetrahedron.
  std::vector<ElasticMaterial> Materials = std::vector<ElasticMaterial>(1);
  /// One byte a node, not 0 where it is held, at rest or where BodyLoads say; empty: no node is.
  std::vector<unsigned char> Fixed;
  /// Of each node the normal, of any length, of the plane in which it slides without friction: the
  /// one that it lies in at rest. 0: it does not slide; empty: no node does.
  std::vector<glm::dvec3> SlidingNormals;
  /// The same of a second plane: nodes in two planes slide along the line in both, such as where
  /// two planes of symmetry meet. Where they are parallel (GetSlidingNormals) there is one plane.
  /// Empty: no node has one.
  std::vector<glm::dvec3> SecondSlidingNormals;

  /// The sine of the largest angle between what counts as parallel: coordinates may be floats.
  static constexpr double LargestSine = 1e-3;

  /// The material of a tetrahedron.
  const ElasticMaterial& GetMaterial(std::size_t tetrahedron) const
  {
    return this->Materials[this->Materials.size() == 1 ? 0 : tetrahedron];
  }
  /// Whether a node is fixed.
  bool IsFixed(std::size_t node) const { return !this->Fixed.empty() && this->Fixed[node] != 0; }

  /// Calls take(node) for all nodes of a tetrahedron, first the corners.
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

/// A node that is moved by a handle.
struct HeldNode
{
  /// The number of the node.
  std::int32_t Node = 0;
  /// Where it is displaced to, in metres.
  glm::dvec3 Displacement{ 0.0 };
};

/// What acts on the nodes of a body.
struct BodyLoads
{
  /// In m/s^2.
  glm::dvec3 Gravity{ 0.0 };
  /// Of each node, in N; empty: none.
  std::vector<glm::dvec3> Forces;
  /// Where fixed nodes are displaced to, of each node, in metres; empty: they stay at rest.
  std::vector<glm::dvec3> FixedDisplacements;
};

/// Of length 1, in the direction of a vector of any length; 0 for 0.
DEFORMVOLUME_EXPORT glm::dvec3 GetUnitVector(const glm::dvec3& vector);

/// The directions in which a node that slides cannot go: of length 1, and normal to each other. 0:
/// none. The second plane counts where it is not parallel to the first, within a thousandth.
DEFORMVOLUME_EXPORT std::array<glm::dvec3, 2> GetSlidingNormals(
  const ElasticBody& body, std::size_t node);

/// Whether a tetrahedron has hardly any volume: its height is less than a millionth of its longest
/// edge.
DEFORMVOLUME_EXPORT bool IsFlat(const std::array<glm::dvec3, 4>& points);

/// Throws an Error where a body cannot be simulated: no tetrahedra, nodes that are not there,
/// coordinates that are not finite, tetrahedra that are flat or turned inside out, mid-side nodes
/// so far from the middle of their edge that the tetrahedron overlaps itself, or the linear ones do
/// into which it is split (QuadraticTetrahedron::IsSplitInverted), a material out of its range, or
/// arrays of another length. watch: of the engine; asked now and then.
DEFORMVOLUME_EXPORT void CheckBody(const ElasticBody& body, Watch* watch = nullptr);

/// Throws an Error where a number of a material is out of its range; where: of which, in words.
DEFORMVOLUME_EXPORT void CheckMaterial(const ElasticMaterial& material, const std::string& where);

/// Throws an Error where other materials are not for this body, or out of their range.
DEFORMVOLUME_EXPORT void CheckMaterials(
  const ElasticBody& body, const std::vector<ElasticMaterial>& materials);

/// Throws an Error where a load is not finite or not for this body.
DEFORMVOLUME_EXPORT void CheckLoads(const ElasticBody& body, const BodyLoads& loads);

/// Throws an Error where a held node is not there, is fixed or held twice, or its displacement is
/// not finite.
DEFORMVOLUME_EXPORT void CheckHeldNodes(const ElasticBody& body, const std::vector<HeldNode>& held);

/// Volumes of linear tetrahedra with these corners, in m^3, all of them greater than 0 whichever
/// way the nodes go round.
DEFORMVOLUME_EXPORT std::vector<double> GetVolumes(const ElasticBody& body);

/// Mass of each node of linear tetrahedra, in kg: a quarter of that of each of its tetrahedra. 0
/// for a node without any.
DEFORMVOLUME_EXPORT std::vector<double> GetNodeMasses(
  const ElasticBody& body, const std::vector<double>& volumes);

} // namespace deformvolume

#endif
