// SPDX-License-Identifier: BSD-3-Clause
#include "WorldSheet.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstdint>

namespace deformvolume
{

void WorldSheet::AddSweep(
  const glm::dvec3& fromA, const glm::dvec3& fromB, const glm::dvec3& toA, const glm::dvec3& toB)
{
  const auto first = static_cast<std::int64_t>(this->Points.size());
  this->Points.insert(this->Points.end(), { fromA, fromB, toA, toB });
  this->Triangles.push_back({ { first, first + 1, first + 3 } });
  this->Triangles.push_back({ { first, first + 3, first + 2 } });
}

Sheet WorldSheet::GetSheet(const ImageGeometry& volume) const
{
  const glm::dmat4 toIndex = volume.GetWorldToIndex();
  std::vector<glm::dvec3> indices;
  indices.reserve(this->Points.size());
  for (const glm::dvec3& point : this->Points)
  {
    indices.emplace_back(toIndex * glm::dvec4(point, 1.0));
  }
  return Sheet(indices, this->Triangles);
}

} // namespace deformvolume
