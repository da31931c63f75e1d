// SPDX-License-Identifier: BSD-3-Clause
#include "WorldHandles.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstddef>

namespace deformvolume
{

std::array<double, 9> GetVoxelMatrix(const ImageGeometry& volume)
{
  const glm::dmat4 toWorld = volume.GetIndexToWorld();
  std::array<double, 9> matrix;
  for (int i = 0; i < 9; ++i)
  {
    matrix[static_cast<std::size_t>(i)] = toWorld[i % 3][i / 3];
  }
  return matrix;
}

std::vector<ChainMailHandle> MakeHandles(const ImageGeometry& volume,
  const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& now, double radius)
{
  const glm::dmat4 toIndex = volume.GetWorldToIndex();
  std::vector<ChainMailHandle> handles(rest.size());
  for (std::size_t i = 0; i < handles.size(); ++i)
  {
    const glm::dvec3 index(toIndex * glm::dvec4(rest[i], 1.0));
    const glm::dvec3 displacement = glm::dmat3(toIndex) * (now[i] - rest[i]);
    handles[i].Radius = radius;
    for (int axis = 0; axis < 3; ++axis)
    {
      handles[i].RestPosition[static_cast<std::size_t>(axis)] = index[axis];
      handles[i].Displacement[static_cast<std::size_t>(axis)] = displacement[axis];
    }
  }
  return handles;
}

} // namespace deformvolume
