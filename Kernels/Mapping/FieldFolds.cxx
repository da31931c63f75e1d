// SPDX-License-Identifier: BSD-3-Clause
#include "FieldFolds.h"

#include "FiveTetrahedra.h"
#include "IndexBounds.h" // for GetVector
#include "ParallelFor.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <atomic>

namespace deformvolume
{

std::int64_t CountInvertedTetrahedra(const DisplacementField& field)
{
  static constexpr int tetrahedra[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
  const auto& size = field.Dimensions;
  const auto& m = field.IndexToField;
  const glm::dmat3 toField(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
  std::atomic<std::int64_t> count{ 0 };
  const auto countRow = [&](int y, int z)
  {
    std::int64_t inverted = 0;
    for (int x = 0; x + 1 < size[0]; ++x)
    {
      glm::dvec3 moved[8]; // in points of the field
      for (int vertex = 0; vertex < 8; ++vertex)
      {
        const glm::ivec3 odd = glm::ivec3(x, y, z) & 1;
        const glm::ivec3 point =
          glm::ivec3(x, y, z) + (glm::ivec3(vertex & 1, vertex >> 2 & 1, vertex >> 1 & 1) ^ odd);
        const std::int64_t index =
          (static_cast<std::int64_t>(point.z) * size[1] + point.y) * size[0] + point.x;
        moved[vertex] = glm::dvec3(point) + toField * GetVector(field.Vectors, index);
      }
      const bool isOdd = ((x + y + z) & 1) != 0;
      for (int t = 0; t < 5; ++t)
      {
        const glm::dvec3& a = moved[tetrahedra[t][0]];
        const double volume = glm::dot(moved[tetrahedra[t][1]] - a,
          glm::cross(moved[tetrahedra[t][2]] - a, moved[tetrahedra[t][3]] - a));
        inverted += (isOdd != (t == 4) ? -volume : volume) < 0.0 ? 1 : 0;
      }
    }
    count += inverted;
  };
  const int rows = size[1] - 1;
  if (rows > 0)
  {
    ParallelFor(0, static_cast<std::int64_t>(rows) * (size[2] - 1), 0,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t row = begin; row < end; ++row)
        {
          countRow(static_cast<int>(row % rows), static_cast<int>(row / rows));
        }
      });
  }
  return count;
}

} // namespace deformvolume
