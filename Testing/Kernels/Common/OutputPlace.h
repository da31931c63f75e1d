// SPDX-License-Identifier: BSD-3-Clause
// VoxelGrid::ToOutput by its definition, and its inverse by Cramer's rule.
#ifndef OutputPlace_h
#define OutputPlace_h

#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <array>

/// Maps an index of the volume to a continuous index of the output.
inline glm::dvec3 PlaceInOutput(const deformvolume::OutputMap& map, const glm::dvec3& index)
{
  glm::dvec3 place;
  for (int row = 0; row < 3; ++row)
  {
    place[row] = map.Get(row, 0) * index.x + map.Get(row, 1) * index.y + map.Get(row, 2) * index.z +
      map.Shift[static_cast<std::size_t>(row)];
  }
  return place;
}

/// Maps a continuous index of the output to an index of the volume.
inline std::array<long double, 3> FindRestIndex(
  const deformvolume::OutputMap& map, const std::array<long double, 3>& place)
{
  const auto getDeterminant = [&](int replaced)
  {
    long double m[3][3];
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        m[row][column] = column == replaced
          ? place[static_cast<std::size_t>(row)] - map.Shift[static_cast<std::size_t>(row)]
          : static_cast<long double>(map.Get(row, column));
      }
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
      m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
      m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  std::array<long double, 3> index;
  for (int axis = 0; axis < 3; ++axis)
  {
    index[static_cast<std::size_t>(axis)] = getDeterminant(axis) / getDeterminant(-1);
  }
  return index;
}

/// The error of the index on an axis if the output position has an error of 1/256 on each axis.
inline long double FindRestTolerance(const deformvolume::OutputMap& map, int axis)
{
  long double sum = 0.0L;
  for (int k = 0; k < 3; ++k)
  {
    std::array<long double, 3> moved = { { map.Shift[0], map.Shift[1], map.Shift[2] } };
    moved[static_cast<std::size_t>(k)] += 1.0L / 256.0L;
    const long double step = FindRestIndex(map, moved)[static_cast<std::size_t>(axis)];
    sum += step < 0.0L ? -step : step;
  }
  return sum;
}

#endif
