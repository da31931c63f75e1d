// SPDX-License-Identifier: BSD-3-Clause
#include "FieldFolds.h"

#include "FiveTetrahedra.h"
#include "IndexBounds.h" // for GetVector and GetVoxelsToField
#include "ParallelFor.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <vector>

namespace deformvolume
{
namespace
{

// The displacements of a row of points along x, in steps between points of the field.
struct Row
{
  std::array<std::vector<double>, 3> Components;
  bool IsFinite = true;
  int Y = -1;
  int Z = -1;
};

/// Counts the inverted tetrahedra in rows of cells.
class RowCounter
{
public:
  explicit RowCounter(const DisplacementField& field);
  std::int64_t Count(int y, int z);

private:
  void Read(Row& row, int y, int z) const;
  void FindRegularCells();
  int CountInCell(int x, int y, int z) const;

  const DisplacementField& Field;
  const std::size_t Size; // points on x
  const glm::dmat3 ToField;
  // Indexed by the parities of y and z, so that the next row of cells can reuse two rows.
  std::array<std::array<Row, 2>, 2> Rows;
  // Largest change of one component along the edges on y, and on z, at each x.
  std::vector<double> ChangeAcross[2];
  // For each cell of the row: whether the changes along its edges prove that no tetrahedron is
  // inverted.
  std::vector<unsigned char> IsRegular;
};

RowCounter::RowCounter(const DisplacementField& field)
  : Field(field)
  , Size(static_cast<std::size_t>(field.Dimensions[0]))
  , ToField(GetVoxelsToField(field))
  , IsRegular(this->Size)
{
  for (auto& rows : this->Rows)
  {
    for (Row& row : rows)
    {
      for (auto& component : row.Components)
      {
        component.resize(this->Size);
      }
    }
  }
  for (auto& change : this->ChangeAcross)
  {
    change.resize(this->Size);
  }
}

void RowCounter::Read(Row& row, int y, int z) const
{
  if (row.Y == y && row.Z == z)
  {
    return;
  }
  const auto& size = this->Field.Dimensions;
  const std::int64_t first = (static_cast<std::int64_t>(z) * size[1] + y) * size[0];
  double zero = 0.0;
  for (std::size_t x = 0; x < this->Size; ++x)
  {
    const glm::dvec3 vector =
      this->ToField * GetVector(this->Field.Vectors, first + static_cast<std::int64_t>(x));
    for (int i = 0; i < 3; ++i)
    {
      row.Components[i][x] = vector[i];
      zero += 0.0 * vector[i];
    }
  }
  row.IsFinite = zero == 0.0;
  row.Y = y;
  row.Z = z;
}

// Finds cells that certainly have no inverted tetrahedron, with vector instructions. In most fields
// it finds most cells.
//
// The derivative of the map in a tetrahedron is I + D. In a corner tetrahedron, column j of D is
// the change of the displacement along an edge of the cell on axis j. In the central tetrahedron,
// it is the mean of the changes along two edges on axis j, plus or minus half the difference of the
// changes along two edges on one of the other two axes, no matter which. If the absolute values in
// each row of D add up to less than 1, the determinant of I + D is positive. Let X, Y and Z be the
// largest changes of a component along the edges of a cell on each axis. If X + Y + Z + min(Y, Z) +
// min(X, Z) + min(X, Y) < 1 for all three components, none of the five tetrahedra is inverted.
void RowCounter::FindRegularCells()
{
  bool areFinite = true;
  for (const auto& rows : this->Rows)
  {
    areFinite = areFinite && rows[0].IsFinite && rows[1].IsFinite;
  }
  std::fill(
    this->IsRegular.begin(), this->IsRegular.end(), static_cast<unsigned char>(areFinite ? 1 : 0));
  for (int i = 0; i < 3; ++i)
  {
    const double* rows[4] = { this->Rows[0][0].Components[i].data(),
      this->Rows[1][0].Components[i].data(), this->Rows[0][1].Components[i].data(),
      this->Rows[1][1].Components[i].data() };
    double* changeY = this->ChangeAcross[0].data();
    double* changeZ = this->ChangeAcross[1].data();
    for (std::size_t x = 0; x < this->Size; ++x)
    {
      changeY[x] = std::max(std::abs(rows[1][x] - rows[0][x]), std::abs(rows[3][x] - rows[2][x]));
      changeZ[x] = std::max(std::abs(rows[2][x] - rows[0][x]), std::abs(rows[3][x] - rows[1][x]));
    }
    unsigned char* isRegular = this->IsRegular.data();
    for (std::size_t x = 0; x + 1 < this->Size; ++x)
    {
      const double alongX = std::max(
        std::max(std::abs(rows[0][x + 1] - rows[0][x]), std::abs(rows[1][x + 1] - rows[1][x])),
        std::max(std::abs(rows[2][x + 1] - rows[2][x]), std::abs(rows[3][x + 1] - rows[3][x])));
      const double alongY = std::max(changeY[x], changeY[x + 1]);
      const double alongZ = std::max(changeZ[x], changeZ[x + 1]);
      const double sum = alongX + alongY + alongZ + std::min(alongY, alongZ) +
        std::min(alongX, alongZ) + std::min(alongX, alongY);
      isRegular[x] &= sum < 0.999 ? 1 : 0; // the margin to 1 is far larger than rounding errors
    }
  }
}

int RowCounter::CountInCell(int x, int y, int z) const
{
  static constexpr int tetrahedra[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
  const glm::ivec3 cell(x, y, z);
  glm::dvec3 moved[8]; // in continuous indices of the field
  for (int vertex = 0; vertex < 8; ++vertex)
  {
    // The split is mirrored from cell to cell, so the bits of a vertex are the parities of its
    // point.
    const glm::ivec3 parity(vertex & 1, vertex >> 2 & 1, vertex >> 1 & 1);
    const glm::ivec3 point = cell + (parity ^ (cell & 1));
    const Row& row = this->Rows[parity.y][parity.z];
    for (int i = 0; i < 3; ++i)
    {
      moved[vertex][i] = point[i] + row.Components[i][static_cast<std::size_t>(point.x)];
    }
  }
  const bool isOdd = ((x + y + z) & 1) != 0;
  int inverted = 0;
  for (int t = 0; t < 5; ++t)
  {
    const glm::dvec3& a = moved[tetrahedra[t][0]];
    const double volume = glm::dot(moved[tetrahedra[t][1]] - a,
      glm::cross(moved[tetrahedra[t][2]] - a, moved[tetrahedra[t][3]] - a));
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
    this->Read(this->Rows[pointY & 1][pointZ & 1], pointY, pointZ);
  }
  this->FindRegularCells();
  std::int64_t inverted = 0;
  for (std::size_t x = 0; x + 1 < this->Size; ++x)
  {
    inverted += this->IsRegular[x] ? 0 : this->CountInCell(static_cast<int>(x), y, z);
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
