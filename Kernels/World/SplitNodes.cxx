// SPDX-License-Identifier: BSD-3-Clause
#include "SplitNodes.h"

#include "CoincidentPoints.h"
#include "MeshAtRest.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <sstream>

namespace deformvolume
{

void SplitNodes::Update(const MeshAtRest& mesh, std::uint64_t connectivity)
{
  if (this->Owner == mesh.Owner && this->ShapeVersion == mesh.ShapeVersion &&
    this->Connectivity == connectivity)
  {
    return;
  }
  this->Owner = mesh.Owner;
  this->ShapeVersion = mesh.ShapeVersion;
  this->Connectivity = connectivity;
  this->Pairs.clear();
  const std::vector<std::int32_t> lowest = FindCoincidentPoints(mesh.Points);
  constexpr std::int32_t unused = -1;
  std::vector<std::int32_t> used(lowest.size(), unused); // the first used node at each position
  std::vector<unsigned char> isKnown(lowest.size(), 0);
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    for (const std::int32_t node : tetrahedron)
    {
      std::int32_t& first = used[static_cast<std::size_t>(lowest[static_cast<std::size_t>(node)])];
      first = first == unused ? node : first;
      unsigned char& known = isKnown[static_cast<std::size_t>(node)];
      if (first != node && known == 0)
      {
        this->Pairs.emplace_back(first, node);
      }
      known = 1;
    }
  }
}

std::string SplitNodes::Describe(const float* displacements) const
{
  const auto get = [displacements](std::int32_t node)
  {
    const float* vector = displacements + 3 * static_cast<std::size_t>(node);
    return glm::dvec3(vector[0], vector[1], vector[2]);
  };
  double farthest = 0.0;
  for (const auto& [first, second] : this->Pairs)
  {
    farthest = std::max(farthest, glm::distance(get(first), get(second)));
  }
  if (!(farthest > 1.0))
  {
    return "";
  }
  std::ostringstream text;
  text.precision(3);
  text << "The deformation mesh is split: nodes with one position at rest move up to " << farthest
       << " output voxels apart, and the volume is stretched over the gap.";
  return text.str();
}

} // namespace deformvolume
