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

/// What does not change during a call of Solve.
struct EquilibriumProblem
{
  /// Nodes of pieces that are held, but for those that are fixed or held by a handle.
  std::vector<unsigned char> IsFree;
  /// Nodes that are fixed or held by a handle.
  std::vector<std::int32_t> HeldNodes;
  /// Where these are to be.
  std::vector<glm::dvec3> Targets;
  /// On the nodes of pieces that are held.
  std::vector<glm::dvec3> Loads;
  PieceSupports Supports;
  /// None of them 0.
  EquilibriumLimits Limits;
  bool IsInteractive = false;
};

/// The volumes of the Gauss points of each tetrahedron.
using GaussVolumes = std::vector<std::array<double, QuadraticTetrahedron::NumberOfGaussPoints>>;

/// Throws an Error where nothing holds the body, and where limits or loads make no sense.
EquilibriumProblem MakeProblem(const EquilibriumRequest& request, const ElasticBody& body,
  const BodyPieces& pieces, const GaussVolumes& volumes, const SlidingNodes& sliding);

/// Components of forces: the largest of those that are left on free nodes, and of those that are
/// applied or hold a node.
struct Residuals
{
  double Largest = 0.0;
  double Reference = 0.0;
};

/// forces: what the strains exert on nodes. What acts along the normal of a node that slides counts
/// as what holds it.
Residuals FindResiduals(const EquilibriumProblem& problem, const SlidingNodes& sliding,
  const std::vector<glm::dvec3>& forces);

/// The absolute value of the largest component.
double LargestComponent(const glm::dvec3& vector);

} // namespace deformvolume

#endif
