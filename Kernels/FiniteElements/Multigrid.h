// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMultigrid_h
#define DeformVolumeMultigrid_h

#include "BlockMatrix.h"
#include "FloatBlocks.h"
#include "Preconditioner.h"
#include "Watch.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A level of the multigrid method in single precision, and how it is coarsened.
template <int Size>
struct MultigridLevel
{
  FloatBlocks<Size, Size> Matrix;
  /// Damped inverses of the blocks on the diagonal.
  std::vector<float> Smoother;
  FloatBlocks<Size, 6> Prolongation;
  FloatBlocks<6, Size> Restriction;
  std::vector<float> Right;
  std::vector<float> Solution;
  std::vector<float> Work;
};

/// A cycle of the multigrid method over aggregates of nodes that move like rigid bodies, smoothed.
/// It is built from a matrix once and used for others of the same body: the stiffness at a node is
/// about what it was, turned with what is around the node.
class Multigrid : public Preconditioner
{
public:
  /// Where the nodes are now: what was built is turned with them.
  void SetPositions(
    Watch& watch, const BlockPattern& pattern, const std::vector<glm::dvec3>& positions);

  /// positions: of the nodes, as they are deformed now.
  void Build(Watch& watch, const BlockMatrix& matrix, const std::vector<unsigned char>& isFree,
    const std::vector<glm::dvec3>& positions);
  void Apply(Watch& watch, const std::vector<glm::dvec3>& vector, double size,
    std::vector<glm::dvec3>& result) override;

private:
  void SolveCoarse(Watch& watch, std::size_t level);
  void SolveCoarsest(Watch& watch, const std::vector<float>& right, std::vector<float>& solution);

  std::vector<std::int32_t> FreeNodes;
  // Where the nodes were when the levels were built, and how they have turned since.
  std::vector<glm::dvec3> Positions;
  std::vector<glm::mat3> Rotations;
  MultigridLevel<3> Fine;
  std::vector<MultigridLevel<6>> Coarse;
  // The inverse of the coarsest matrix, by rows; empty where that is the one of its diagonal.
  std::vector<float> Inverse;
};

} // namespace deformvolume

#endif
