// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSolutionHistory_h
#define DeformVolumeSolutionHistory_h

#include "AbortCheck.h"
#include "BlockMatrix.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Recent solutions of a sequence of similar linear systems, for initial guesses. The response to a
/// moving handle is mostly a combination of earlier responses. Source: Fischer, "Projection
/// techniques for iterative solution of Ax = b with successive right-hand sides", 1998. Results do
/// not depend on the number of threads.
class SolutionHistory
{
public:
  /// The number of stored solutions: a handle moves in three directions.
  static constexpr std::size_t Length = 3;

  void Clear() { this->Number = 0; }
  /// Call this when the matrix changed.
  void ForgetProducts() { this->HasProducts = false; }

  /// Finds the combination of stored solutions with the least energy, and its residual. Without
  /// stored solutions, the solution is 0 and the residual is the right-hand side.
  void Guess(AbortCheck& abortCheck, const BlockMatrix& matrix,
    const std::vector<unsigned char>& isFree, const std::vector<glm::dvec3>& rightHandSide,
    std::vector<glm::dvec3>& solution, std::vector<glm::dvec3>& residual);

  /// Stores a solution for the matrix of the last guess, in place of the oldest one.
  void Add(const std::vector<glm::dvec3>& solution, const std::vector<glm::dvec3>& rightHandSide,
    const std::vector<glm::dvec3>& residual);

private:
  struct Entry
  {
    std::vector<glm::dvec3> Solution;
    std::vector<glm::dvec3> Product; // of the matrix and the solution
  };
  using Factors = std::array<double, Length>;

  Factors FindFactors(AbortCheck& abortCheck, const std::vector<glm::dvec3>& rightHandSide) const;

  // The latest solution comes first.
  std::array<Entry, Length> Entries;
  std::size_t Number = 0;
  bool HasProducts = false;
};

} // namespace deformvolume

#endif
