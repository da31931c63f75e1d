// SPDX-License-Identifier: BSD-3-Clause
#include "FieldFolds.h"

#include "FiveTetrahedra.h"
#include "IndexBounds.h" // for GetVector and FieldTransform
#include "ParallelFor.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace deformvolume
{
namespace
{

// 1 minus a margin for rounding: a cell is regular without further tests only if its sum is clearly
// below 1.
constexpr float LargestChange = 0.999F;

// Loops with std::min() and std::max(), which return references, are not vectorized.
float Lesser(float a, float b)
{
  return a < b ? a : b;
}

float Greater(float a, float b)
{
  return a > b ? a : b;
}

/// Counts the inverted tetrahedra in rows of cells.
class RowCounter
{
public:
  explicit RowCounter(const DisplacementField& field);
  std::int64_t Count(int y, int z);

private:
  const float* GetRow(int y, int z) const;
  void FindChanges();
  bool IsRegular(std::size_t x) const;
  int CountInCell(int x, int y, int z) const;

  const DisplacementField& Field;
  const std::size_t Size; // points on x
  const glm::dmat3 ToField;
  // Absolute values of the matrix, by component of the displacement, and by component of the
  // vectors of the field.
  std::array<std::array<float, 3>, 3> Factors;
  // Whether the vectors have the axes of the field.
  bool IsAligned = true;
  // The vectors of a row of cells, by the parities of y and z. Three floats for each point.
  std::array<std::array<const float*, 2>, 2> Rows{};
  // The largest change of each component of the vectors along the edges on y, and on z, at each
  // point on x.
  std::vector<float> ChangesAcross[2];
  // All cells are regular if no element of Changes is larger.
  float LargestForAll = 0.0F;
  // For each cell and each component of the vectors: see FindChanges().
  std::vector<float> Changes;
  // Whether the vectors of the rows are finite, and whether all cells of the row are regular.
  bool AreFinite = false;
  bool AreRegular = false;
};

RowCounter::RowCounter(const DisplacementField& field)
  : Field(field)
  , Size(static_cast<std::size_t>(field.Dimensions[0]))
  , ToField(FieldTransform(field).Matrix)
  , Changes(3 * this->Size)
{
  float largestSum = 0.0F;
  for (int i = 0; i < 3; ++i)
  {
    float sum = 0.0F;
    for (int j = 0; j < 3; ++j)
    {
      this->Factors[i][j] = static_cast<float>(std::abs(this->ToField[j][i]));
      this->IsAligned = this->IsAligned && (i == j || this->Factors[i][j] == 0.0F);
      sum += this->Factors[i][j];
    }
    largestSum = std::max(largestSum, sum);
  }
  this->LargestForAll = LargestChange / largestSum;
  for (auto& changes : this->ChangesAcross)
  {
    changes.resize(3 * this->Size);
  }
}

const float* RowCounter::GetRow(int y, int z) const
{
  const auto& size = this->Field.Dimensions;
  return this->Field.Vectors + 3 * ((static_cast<std::int64_t>(z) * size[1] + y) * size[0]);
}

// Finds, for each cell and component, a number from which IsRegular() proves that the cell has no
// inverted tetrahedron, and sets AreFinite and AreRegular. Works on neighboring floats, so that
// compilers use vector instructions.
//
// The derivative of the map in a tetrahedron is I + D. In a corner tetrahedron, column j of D is
// the change of the displacement along an edge of the cell on axis j. In the central tetrahedron,
// it is the mean of the changes along two edges on axis j, plus or minus half the difference of the
// changes along two edges on one of the other two axes, no matter which. If the absolute values in
// each row of D add up to less than 1, the determinant of I + D is positive. Let X, Y and Z be the
// largest changes of a component along the edges of a cell on each axis. If X + Y + Z + min(Y, Z) +
// min(X, Z) + min(X, Y) < 1 for all three components of the displacement, none of the five
// tetrahedra is inverted.
//
// If the vectors of the field have other axes than its grid, each component of the displacement is
// a sum over components of the vectors. Then the bound 2 (X + Y + Z) is used instead, which is
// linear.
void RowCounter::FindChanges()
{
  const float* const rows[4] = { this->Rows[0][0], this->Rows[1][0], this->Rows[0][1],
    this->Rows[1][1] };
  float* const changeY = this->ChangesAcross[0].data();
  float* const changeZ = this->ChangesAcross[1].data();
  int infinite = 0;
  for (std::size_t k = 0; k < 3 * this->Size; ++k)
  {
    // The sum is not finite if one of the four vectors is not.
    const float all = std::abs(rows[1][k] - rows[0][k]) + std::abs(rows[3][k] - rows[2][k]);
    infinite |= all <= std::numeric_limits<float>::max() ? 0 : 1;
    changeY[k] = Greater(std::abs(rows[1][k] - rows[0][k]), std::abs(rows[3][k] - rows[2][k]));
    changeZ[k] = Greater(std::abs(rows[2][k] - rows[0][k]), std::abs(rows[3][k] - rows[1][k]));
  }
  float* const changes = this->Changes.data();
  const float weight = this->IsAligned ? 1.0F : 0.0F;
  const float largest = this->LargestForAll;
  int larger = 0;
  for (std::size_t k = 0; k < 3 * (this->Size - 1); ++k)
  {
    const float alongX =
      Greater(Greater(std::abs(rows[0][k + 3] - rows[0][k]), std::abs(rows[1][k + 3] - rows[1][k])),
        Greater(std::abs(rows[2][k + 3] - rows[2][k]), std::abs(rows[3][k + 3] - rows[3][k])));
    const float alongY = Greater(changeY[k], changeY[k + 3]);
    const float alongZ = Greater(changeZ[k], changeZ[k + 3]);
    const float sum = alongX + alongY + alongZ;
    const float least = Lesser(alongY, alongZ) + Lesser(alongX, alongZ) + Lesser(alongX, alongY);
    changes[k] = sum + weight * least + (1.0F - weight) * sum;
    larger |= changes[k] < largest ? 0 : 1;
  }
  this->AreFinite = infinite == 0;
  this->AreRegular = this->AreFinite && larger == 0;
}

// Whether the changes in a cell prove that no tetrahedron is inverted.
bool RowCounter::IsRegular(std::size_t x) const
{
  const float* const changes = this->Changes.data() + 3 * x;
  return std::all_of(this->Factors.begin(), this->Factors.end(),
    [changes](const std::array<float, 3>& factors)
    {
      return factors[0] * changes[0] + factors[1] * changes[1] + factors[2] * changes[2] <
        LargestChange;
    });
}

int RowCounter::CountInCell(int x, int y, int z) const
{
  const glm::ivec3 cell(x, y, z);
  glm::dvec3 moved[8]; // in continuous indices of the field
  for (int vertex = 0; vertex < 8; ++vertex)
  {
    // The split is mirrored from cell to cell, so the bits of a vertex are the parities of its
    // point.
    const glm::ivec3 parity(
      DEFORMVOLUME_OFFSET_X(vertex), DEFORMVOLUME_OFFSET_Y(vertex), DEFORMVOLUME_OFFSET_Z(vertex));
    const glm::ivec3 point = cell + (parity ^ (cell & 1));
    const float* const row = this->Rows[parity.y][parity.z];
    moved[vertex] = glm::dvec3(point) + this->ToField * GetVector(row, point.x);
  }
  const bool isOdd = ((x + y + z) & 1) != 0;
  int inverted = 0;
  for (int t = 0; t < 5; ++t)
  {
    const glm::dvec3& a = moved[FiveTetrahedra[t][0]];
    const double volume = glm::dot(moved[FiveTetrahedra[t][1]] - a,
      glm::cross(moved[FiveTetrahedra[t][2]] - a, moved[FiveTetrahedra[t][3]] - a));
    inverted += (isOdd != (t == 4) ? -volume : volume) < 0.0 ? 1 : 0;
  }
  return inverted;
}

std::int64_t RowCounter::Count(int y, int z)
{
  for (int point = 0; point < 4; ++point)
  {
    const int pointY = y + (point & 1);
    const int pointZ = z + (point >> 1);
    this->Rows[pointY & 1][pointZ & 1] = this->GetRow(pointY, pointZ);
  }
  this->FindChanges();
  if (this->AreRegular)
  {
    return 0;
  }
  std::int64_t inverted = 0;
  for (std::size_t x = 0; x + 1 < this->Size; ++x)
  {
    inverted +=
      this->AreFinite && this->IsRegular(x) ? 0 : this->CountInCell(static_cast<int>(x), y, z);
  }
  return inverted;
}

} // namespace

std::int64_t CountInvertedTetrahedra(const DisplacementField& field)
{
  const auto& size = field.Dimensions;
  std::atomic<std::int64_t> count{ 0 };
  const int rows = size[1] - 1;
  if (size[0] > 1 && rows > 0)
  {
    ParallelFor(0, static_cast<std::int64_t>(rows) * (size[2] - 1), 0,
      [&](std::int64_t begin, std::int64_t end)
      {
        RowCounter counter(field);
        for (std::int64_t row = begin; row < end; ++row)
        {
          count += counter.Count(static_cast<int>(row % rows), static_cast<int>(row / rows));
        }
      });
  }
  return count;
}

} // namespace deformvolume
