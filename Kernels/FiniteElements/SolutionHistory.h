// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSolutionHistory_h
#define DeformVolumeSolutionHistory_h

#include "BlockMatrix.h"
#include "Watch.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// The last solutions of linear systems that follow each other: what moves a handle now is mostly a
/// combination of what has moved it before (Fischer, "Projection techniques for iterative solution
/// of Ax = b with successive right-hand sides", 1998). Sums do not depend on the number of threads.
class SolutionHistory
{
public:
  /// As many as a handle has directions.
  static constexpr std::size_t Length = 3;

  void Clear() { this->Number = 0; }
  /// The matrix is another one.
  void ForgetProducts() { this->HasProducts = false; }

  /// The combination of them that is nearest to the solution, by its energy, and the residual of
  /// that; 0 and the right-hand side where there are none.
  void Guess(Watch& watch, const BlockMatrix& matrix, const std::vector<unsigned char>& isFree,
    const std::vector<glm::dvec3>& rightHandSide, std::vector<glm::dvec3>& solution,
    std::vector<glm::dvec3>& residual);

  /// Takes up a solution, as it was found for the matrix of the last guess, in place of the oldest.
  void Add(const std::vector<glm::dvec3>& solution, const std::vector<glm::dvec3>& rightHandSide,
    const std::vector<glm::dvec3>& residual);

private:
  struct Entry
  {
    std::vector<glm::dvec3> Solution;
    std::vector<glm::dvec3> Product; // of the matrix and the solution
  };
  using Factors = std::array<double, Length>;

  Factors FindFactors(Watch& watch, const std::vector<glm::dvec3>& rightHandSide) const;

  // Those that were taken up last come first.
  std::array<Entry, Length> Entries;
  std::size_t Number = 0;
  bool HasProducts = false;
};

} // namespace deformvolume

#endif
