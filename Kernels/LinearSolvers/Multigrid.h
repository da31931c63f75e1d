// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMultigrid_h
#define DeformVolumeMultigrid_h

#include "AbortCheck.h"
#include "BlockMatrix.h"
#include "PaddedBlocks.h"
#include "Preconditioner.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A level of a multigrid hierarchy.
template <typename Real, int Size>
struct MultigridLevel
{
  PaddedBlocks<Real, Size, Size> Matrix;
  /// Damped inverses of the diagonal blocks.
  std::vector<Real> Smoother;
  PaddedBlocks<Real, Size, 6> Prolongation;
  PaddedBlocks<Real, 6, Size> Restriction;
  std::vector<Real> Right;
  std::vector<Real> Solution;
  std::vector<Real> Work;
};

/// One V-cycle of smoothed aggregation multigrid, with rigid-body modes as near null space. The
/// hierarchy is built from one matrix and reused for later matrices of the same body. The stiffness
/// around a node is assumed to rotate with the body (SetPositions).
///
/// Real: float or double. Floats are faster, but not enough for slender bodies, and if stiffnesses
/// differ by more than about 10^6.
template <typename Real>
class Multigrid : public Preconditioner
{
public:
  /// Sets the current positions of the nodes, by which the hierarchy is rotated.
  void SetPositions(
    AbortCheck& abortCheck, const BlockPattern& pattern, const std::vector<glm::dvec3>& positions);

  /// positions: the deformed positions of the nodes, for which the matrix was computed.
  void Build(AbortCheck& abortCheck, const BlockMatrix& matrix,
    const std::vector<unsigned char>& isFree, const std::vector<glm::dvec3>& positions);
  void Apply(AbortCheck& abortCheck, const std::vector<glm::dvec3>& vector, double size,
    std::vector<glm::dvec3>& result) override;

private:
  void SolveCoarse(AbortCheck& abortCheck, std::size_t level);
  void SolveCoarsest(
    AbortCheck& abortCheck, const std::vector<Real>& right, std::vector<Real>& solution);

  std::vector<std::int32_t> FreeNodes;
  // The positions of the nodes at Build(), and the rotations of their neighborhoods since then.
  std::vector<glm::dvec3> Positions;
  std::vector<glm::dmat3> Rotations;
  MultigridLevel<Real, 3> Fine;
  std::vector<MultigridLevel<Real, 6>> Coarse;
  // The inverse of the coarsest matrix, by rows. Empty if the coarsest level uses only its inverse
  // diagonal blocks (Smoother).
  std::vector<Real> Inverse;
};

} // namespace deformvolume

#endif
