// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEquilibriumTypes_h
#define DeformVolumeEquilibriumTypes_h

#include "ElasticBody.h"
#include "ElementResults.h"
#include "MaterialModel.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// How accurately Solve() finds the equilibrium.
enum class EquilibriumMode
{
  /// For a frame of an animation: few Newton steps. The report has the remaining residual, and the
  /// next call continues from there.
  Interactive,
  /// Iterates until the limits below are met, or until several steps with inverted tetrahedra have
  /// brought the body no closer to equilibrium. Then the next call starts at rest.
  Converged
};

/// When to stop. A value of 0 selects the default of the mode.
struct EquilibriumLimits
{
  /// Largest number of Newton steps; 0: 2 in mode Interactive, otherwise 200.
  int NewtonSteps = 0;
  /// Largest number of conjugate gradient iterations in each Newton step; 0: 500 in mode
  /// Interactive, otherwise 5000.
  int LinearIterations = 0;
  /// The factor by which the iterations reduce the residual of the linear system. 0: 1e-6 in mode
  /// Converged, 3e-3 in mode Interactive. In mode Interactive, the factor is larger, up to 0.3, if
  /// the tolerances below permit.
  double LinearTolerance = 0.0;
  /// The body is in equilibrium if no component of the residual force on a free node exceeds this
  /// fraction of the largest applied force or reaction. 0: 1e-6 in mode Converged; 1e-3 in mode
  /// Interactive, and 1e-2 if held nodes moved. The body is also in equilibrium if no component
  /// exceeds the rounding errors of the forces.
  double RelativeTolerance = 0.0;
};

/// The input of FiniteElementModel::Solve().
struct EquilibriumRequest
{
  /// Nodes that handles move, in addition to the fixed nodes of the body.
  std::vector<HeldNode> Held;
  /// Forces, gravity and the prescribed displacements of fixed nodes.
  BodyLoads Loads;
  /// How accurately to solve. Default: Interactive.
  EquilibriumMode Mode = EquilibriumMode::Interactive;
  /// When to stop. Default: the defaults of the mode.
  EquilibriumLimits Limits;
  /// Called every few milliseconds in the calling thread. Return false to abort.
  std::function<bool()> Progress;
};

/// The output of FiniteElementModel::Solve().
struct EquilibriumReport
{
  /// Whether the residual is within the tolerances.
  bool IsConverged = false;
  /// The number of linear systems that were solved.
  int NewtonSteps = 0;
  /// The number of conjugate gradient iterations, summed over these linear systems.
  int LinearIterations = 0;
  /// The largest component of the residual force on a free node, in N.
  double Residual = 0.0;
  /// The residual divided by the largest applied force or reaction; 0 if there are no forces.
  double RelativeResidual = 0.0;
  /// The strain energy, in J.
  double StrainEnergy = 0.0;
  /// The number of pieces of the body (BodyPieces) that are not held (PieceSupports). Such
  /// frozen pieces bear no loads and exert no forces.
  std::int32_t NumberOfFrozenPieces = 0;
  /// The nodes of a tetrahedron of the first frozen piece, for messages; -1 if no piece is frozen.
  Tetrahedron FrozenNodes{ { -1, -1, -1, -1 } };
  /// The number of frozen pieces that moved like rigid bodies with their supporting nodes. The
  /// other frozen pieces did not move, but have their shape at rest (MakePiecesRigid).
  std::int32_t NumberOfFollowingPieces = 0;
  /// The number of tetrahedra that are partly inverted: one of the twelve linear tetrahedra into
  /// which vtkDeformVolumeFilter splits each of them is inverted.
  std::int64_t NumberOfInvertedTetrahedra = 0;
};

} // namespace deformvolume

#endif
