// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEquilibriumProblem_h
#define DeformVolumeEquilibriumProblem_h

#include "BodyPieces.h"
#include "ElasticBody.h"
#include "EquilibriumTypes.h"
#include "QuadraticTetrahedron.h"
#include "SlidingNodes.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The data that do not change during one call of Solve.
struct EquilibriumProblem
{
  /// Nodes of held pieces that are neither fixed nor held by a handle.
  std::vector<unsigned char> IsFree;
  /// Nodes that are fixed or held by a handle.
  std::vector<std::int32_t> HeldNodes;
  /// The prescribed displacements of HeldNodes.
  std::vector<glm::dvec3> Targets;
  /// The loads on nodes of held pieces, in N; 0 at other nodes.
  std::vector<glm::dvec3> Loads;
  PieceSupports Supports;
  /// The limits of the request, with defaults filled in.
  EquilibriumLimits Limits;
  bool IsInteractive = false;
};

/// The volumes of the Gauss points of each tetrahedron.
using GaussVolumes = std::vector<std::array<double, QuadraticTetrahedron::NumberOfGaussPoints>>;

/// Throws an Error if no piece of the body is held, or if limits, loads or handles are invalid.
EquilibriumProblem MakeProblem(const EquilibriumRequest& request, const ElasticBody& body,
  const BodyPieces& pieces, const GaussVolumes& volumes, const SlidingNodes& sliding);

/// The largest component of the unbalanced forces on free nodes, and the largest component of
/// applied forces and reactions. Both in N.
struct Residuals
{
  double Largest = 0.0;
  double Reference = 0.0;
};

/// forces: the elastic forces on nodes. The component normal to the plane of a sliding node is a
/// reaction.
Residuals FindResiduals(const EquilibriumProblem& problem, const SlidingNodes& sliding,
  const std::vector<glm::dvec3>& forces);

/// Returns the forces of the supports on the nodes, in N: the elastic forces minus the loads. At
/// free nodes only the part that keeps a sliding node in its plane or on its line.
std::vector<glm::dvec3> FindReactions(const EquilibriumProblem& problem,
  const SlidingNodes& sliding, const std::vector<glm::dvec3>& forces);

/// The absolute value of the largest component.
double LargestComponent(const glm::dvec3& vector);

} // namespace deformvolume

#endif
