// SPDX-License-Identifier: BSD-3-Clause
#include "NodeRotations.h"

#include "RowParts.h"
#include "SingularValues.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cstddef>

namespace deformvolume
{
namespace
{

struct RotationArguments
{
  const BlockPattern* Pattern;
  const std::int32_t* Nodes;
  std::size_t Begin;
  std::size_t End;
  const glm::dvec3* Before;
  const glm::dvec3* Now;
  glm::dmat3* Rotations;
};

DEFORMVOLUME_ALWAYS_INLINE void FindRotations(const RotationArguments& arguments)
{
  for (std::size_t begin = arguments.Begin; begin < arguments.End; begin += NumberOfLanes)
  {
    double sums[9][NumberOfLanes] = {};
    const int number =
      static_cast<int>(std::min<std::size_t>(NumberOfLanes, arguments.End - begin));
    for (int lane = 0; lane < number; ++lane)
    {
      const auto node =
        static_cast<std::size_t>(arguments.Nodes[begin + static_cast<std::size_t>(lane)]);
      const BlockPattern& pattern = *arguments.Pattern;
      for (std::int32_t block = pattern.Rows[node]; block < pattern.Rows[node + 1]; ++block)
      {
        const auto other =
          static_cast<std::size_t>(pattern.Columns[static_cast<std::size_t>(block)]);
        for (int j = 0; j < 3; ++j)
        {
          const double edge = arguments.Before[other][j] - arguments.Before[node][j];
          for (int i = 0; i < 3; ++i)
          {
            sums[3 * j + i][lane] += (arguments.Now[other][i] - arguments.Now[node][i]) * edge;
          }
        }
      }
    }
    LaneMatrix matrix;
    for (int j = 0; j < 3; ++j)
    {
      const auto row = [&](int i) __attribute__((always_inline))
      {
        const double* const sum = sums[3 * j + i];
        return Lanes{ sum[0], sum[1], sum[2], sum[3] };
      };
      matrix.Columns[j] = { row(0), row(1), row(2) };
    }
    const SingularValues values = FindSingularValues(matrix);
    const LaneMatrix& V = values.V;
    const LaneVector rows[3] = { { V.Columns[0].X, V.Columns[1].X, V.Columns[2].X },
      { V.Columns[0].Y, V.Columns[1].Y, V.Columns[2].Y },
      { V.Columns[0].Z, V.Columns[1].Z, V.Columns[2].Z } };
    for (int j = 0; j < 3; ++j)
    {
      const LaneVector column = Multiply(values.U, rows[j]);
      for (int lane = 0; lane < number; ++lane)
      {
        double* const rotation =
          glm::value_ptr(arguments.Rotations[begin + static_cast<std::size_t>(lane)]);
        rotation[3 * j] = column.X[lane];
        rotation[3 * j + 1] = column.Y[lane];
        rotation[3 * j + 2] = column.Z[lane];
      }
    }
  }
}

} // namespace

void FindNodeRotations(AbortCheck& abortCheck, const BlockPattern& pattern,
  const std::vector<std::int32_t>& nodes, const std::vector<glm::dvec3>& before,
  const std::vector<glm::dvec3>& now, std::vector<glm::dmat3>& rotations)
{
  rotations.resize(nodes.size());
  ForRows(abortCheck, nodes.size(),
    [&](std::size_t begin, std::size_t end)
    {
      const RotationArguments arguments = { &pattern, nodes.data(), begin, end, before.data(),
        now.data(), rotations.data() };
      RunOnLanes([&]() __attribute__((always_inline)) { FindRotations(arguments); });
    });
}

} // namespace deformvolume
