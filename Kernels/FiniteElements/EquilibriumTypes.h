// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEquilibriumTypes_h
#define DeformVolumeEquilibriumTypes_h

#include "ElasticBody.h"
#include "ElementResults.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// How the strain energy follows from the deformation gradient F. Small strains of both are linear
/// elasticity.
enum class MaterialModel
{
  /// Stable, without a logarithm: mu/2 (|F|^2 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2, where
  /// J is the determinant of F. For soft tissue.
  StableNeoHookean,
  /// mu |F - R|^2 + lambda/2 tr(S - 1)^2, where F = R S and R is a rotation: linear elasticity in
  /// the frame that turns with the material. Large strains do not keep the volume. The part of
  /// lambda that is more than 4 mu acts on the mean of J - 1, as in the other model.
  Corotational
};

/// How far a solution goes.
enum class EquilibriumMode
{
  /// A frame of an animation: few steps, each as far as the next one needs it. What is left is
  /// reported, and the next call goes on from there.
  Interactive,
  /// Equilibrium, as far as the limits below say.
  Converged
};

/// When to stop. What is 0 is chosen by the mode.
struct EquilibriumLimits
{
  /// Steps of Newton's method; 0: 2 when interactive, else 200.
  int NewtonSteps = 0;
  /// Iterations of conjugate gradients in each step; 0: 500 when interactive, else 5000.
  int LinearIterations = 0;
  /// By how much these make the residual of the linear system smaller; 0: at least 3e-3 when
  /// interactive, and no more than the tolerances need, else 1e-6.
  double LinearTolerance = 0.0;
  /// A body is in equilibrium where no component of a force on a free node is larger than this part
  /// of the largest force that is applied or that holds a node; 0: 1e-3 when interactive, and 1e-2
  /// where held nodes have moved, else 1e-6.
  double RelativeTolerance = 0.0;
  /// Or than this part of E h^2, the force that a stress as large as the Young modulus exerts on a
  /// tetrahedron of mean size; 0: 1e-6 when interactive, else 1e-11.
  double AbsoluteTolerance = 0.0;
};

/// What FiniteElementModel::Solve() is to do.
struct EquilibriumRequest
{
  /// Nodes that are moved, besides those of the body that are fixed at rest.
  std::vector<HeldNode> Held;
  /// Forces, gravity and the displacements of fixed nodes.
  BodyLoads Loads;
  /// Whether to go all the way to equilibrium.
  EquilibriumMode Mode = EquilibriumMode::Interactive;
  /// When to stop; by default the mode says it.
  EquilibriumLimits Limits;
  /// Called every few milliseconds, in the thread that called; returning false aborts.
  std::function<bool()> Progress;
};

/// What FiniteElementModel::Solve() has done.
struct EquilibriumReport
{
  /// Whether the residual is within the tolerances.
  bool IsConverged = false;
  /// Linear systems that were solved.
  int NewtonSteps = 0;
  /// Iterations of conjugate gradients in all of them.
  int LinearIterations = 0;
  /// The largest component of what is left of the force on a free node, in N.
  double Residual = 0.0;
  /// The same as a part of the largest force that is applied or holds a node; 0 without forces.
  double RelativeResidual = 0.0;
  /// The strain energy, in J.
  double StrainEnergy = 0.0;
  /// Pieces of the body (BodyPieces) that are not held by three nodes that lie on no common line,
  /// and a tetrahedron of the first of them. They bear no loads, and exert no forces.
  std::int32_t NumberOfFrozenPieces = 0;
  /// A tetrahedron of the first frozen piece, for a message; -1 where no piece is frozen.
  std::int32_t FirstFrozenTetrahedron = -1;
  /// Those of them that have gone like rigid bodies with nodes that hold or that they share with
  /// others; the rest has stayed where it was.
  std::int32_t NumberOfFollowingPieces = 0;
  /// Tetrahedra that are inside out now, somewhere: split into twelve linear ones, as
  /// vtkDeformVolumeFilter does it, one of these is inside out.
  std::int64_t NumberOfInvertedTetrahedra = 0;
};

} // namespace deformvolume

#endif
