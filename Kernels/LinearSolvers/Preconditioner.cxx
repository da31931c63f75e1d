// SPDX-License-Identifier: BSD-3-Clause
#include "Preconditioner.h"

#include "RowParts.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <cstddef>

namespace deformvolume
{

void BlockJacobi::Build(
  AbortCheck& abortCheck, const BlockMatrix& matrix, const std::vector<unsigned char>& isFree)
{
  const std::size_t rows = isFree.size();
  this->Inverses.resize(rows);
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t row = begin; row < end; ++row)
      {
        this->Inverses[row] = isFree[row] != 0
          ? glm::inverse(glm::make_mat3(matrix.GetDiagonal(row)))
          : glm::dmat3(0.0);
      }
    });
}

void BlockJacobi::Apply(AbortCheck& abortCheck, const std::vector<glm::dvec3>& vector, double,
  std::vector<glm::dvec3>& result)
{
  const std::size_t rows = vector.size();
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t row = begin; row < end; ++row)
      {
        result[row] = this->Inverses[row] * vector[row];
      }
    });
}

} // namespace deformvolume
