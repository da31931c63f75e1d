// SPDX-License-Identifier: BSD-3-Clause
#include "SolutionHistory.h"

#include "RowParts.h"

#include <algorithm>

namespace deformvolume
{

void SolutionHistory::Guess(AbortCheck& abortCheck, const BlockMatrix& matrix,
  const std::vector<unsigned char>& isFree, const std::vector<glm::dvec3>& rightHandSide,
  std::vector<glm::dvec3>& solution, std::vector<glm::dvec3>& residual)
{
  const std::size_t rows = rightHandSide.size();
  solution.assign(rows, glm::dvec3(0.0));
  residual = rightHandSide;
  for (std::size_t i = 0; i < this->Number && !this->HasProducts; ++i)
  {
    Entry& entry = this->Entries[i];
    entry.Product.resize(rows);
    ForRows(abortCheck, rows,
      [&](std::size_t begin, std::size_t end)
      { matrix.Multiply(begin, end, isFree.data(), entry.Solution.data(), entry.Product.data()); });
  }
  this->HasProducts = true;
  const Factors factors = this->FindFactors(abortCheck, rightHandSide);
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = 0; i < this->Number; ++i)
      {
        for (std::size_t row = begin; row < end; ++row)
        {
          solution[row] += factors[i] * this->Entries[i].Solution[row];
          residual[row] -= factors[i] * this->Entries[i].Product[row];
        }
      }
    });
}

// The energy is least if the residual is orthogonal to all solutions. This gives a small symmetric
// system, solved by elimination. A solution that nearly depends on those before it is skipped.
SolutionHistory::Factors SolutionHistory::FindFactors(
  AbortCheck& abortCheck, const std::vector<glm::dvec3>& rightHandSide) const
{
  constexpr double least = 1e-8;
  double system[Length][Length + 1] = {};
  double sizes[Length] = {};
  for (std::size_t i = 0; i < this->Number; ++i)
  {
    const std::vector<glm::dvec3>& solution = this->Entries[i].Solution;
    for (std::size_t j = i; j < this->Number; ++j)
    {
      system[i][j] = system[j][i] = SumOfProducts(abortCheck, solution, this->Entries[j].Product);
    }
    system[i][Length] = SumOfProducts(abortCheck, solution, rightHandSide);
    sizes[i] = system[i][i];
  }
  bool isUsed[Length] = {};
  for (std::size_t i = 0; i < this->Number; ++i)
  {
    isUsed[i] = system[i][i] > least * sizes[i];
    for (std::size_t row = i + 1; row < this->Number && isUsed[i]; ++row)
    {
      const double factor = system[row][i] / system[i][i];
      for (std::size_t column = i; column <= Length; ++column)
      {
        system[row][column] -= factor * system[i][column];
      }
    }
  }
  Factors factors{};
  for (std::size_t i = this->Number; i-- > 0;)
  {
    if (isUsed[i])
    {
      double sum = system[i][Length];
      for (std::size_t column = i + 1; column < this->Number; ++column)
      {
        sum -= system[i][column] * factors[column];
      }
      factors[i] = sum / system[i][i];
    }
  }
  return factors;
}

void SolutionHistory::Add(const std::vector<glm::dvec3>& solution,
  const std::vector<glm::dvec3>& rightHandSide, const std::vector<glm::dvec3>& residual)
{
  std::rotate(this->Entries.begin(), this->Entries.end() - 1, this->Entries.end());
  Entry& entry = this->Entries.front();
  entry.Solution = solution;
  entry.Product.resize(solution.size());
  std::transform(rightHandSide.begin(), rightHandSide.end(), residual.begin(),
    entry.Product.begin(), [](const glm::dvec3& a, const glm::dvec3& b) { return a - b; });
  this->Number = std::min(this->Number + 1, Length);
}

} // namespace deformvolume
