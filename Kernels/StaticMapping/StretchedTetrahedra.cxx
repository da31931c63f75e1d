// SPDX-License-Identifier: BSD-3-Clause
#include "StretchedTetrahedra.h"

#include "FadedLinks.h"
#include "FiveTetrahedra.h"
#include "ParallelFor.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>

namespace deformvolume
{

namespace
{

// Largest number of tetrahedra to test when the deformation changes. Testing them takes about a
// millisecond.
constexpr std::int64_t MostStretchable = 1 << 13;
constexpr double StretchLimit = 2.0; // output voxels
// If the weights of two neighbors differ by more than this, one neighbor follows the boundary and
// the other does not move.
constexpr double LargestStep = 0.5;

// The point of the mesh that a voxel follows, and the factor of the displacement.
struct Anchor
{
  glm::dvec3 Position{ 0.0 };
  double Weight = 0.0;
};

Anchor GetAnchor(const VertexLink& link, const glm::dvec3& voxel, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const std::vector<TetrahedronFace>& faces)
{
  const auto number = static_cast<std::size_t>(link.Tetrahedron);
  if (number < tetrahedra.size())
  {
    return { spacing * voxel, 1.0 };
  }
  if (number == tetrahedra.size())
  {
    return {};
  }
  const TetrahedronFace& face = faces[number - tetrahedra.size() - 1];
  const auto nodes = face.GetNodes(tetrahedra[static_cast<std::size_t>(face.Tetrahedron)]);
  Anchor anchor;
  for (std::size_t k = 0; k < 3; ++k)
  {
    anchor.Position +=
      double{ link.Weights[k] } * (spacing * restPoints[static_cast<std::size_t>(nodes[k])]);
    anchor.Weight += double{ link.Weights[k] };
  }
  anchor.Position /= anchor.Weight;
  return anchor;
}

} // namespace

void StretchedTetrahedra::Find(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const std::vector<TetrahedronFace>& faces, const std::vector<VertexLink>& links)
{
  this->Candidates.clear();
  const auto still = static_cast<std::int32_t>(tetrahedra.size());
  const std::int64_t size = GetSize(voxels, 0);
  const std::int64_t plane = size * GetSize(voxels, 1);
  const std::int64_t layers = std::max<std::int64_t>(GetSize(voxels, 2) - 1, 0);
  // Whether two vertices follow points that are too far apart. On a convex boundary, the closest
  // points of two voxels are not farther apart than the voxels.
  const auto isStretchable = [&](const std::array<Anchor, 8>& anchors,
                               const std::array<glm::dvec3, 8>& positions, const int* vertices)
  {
    for (int i = 1; i < 4; ++i)
    {
      for (int j = 0; j < i; ++j)
      {
        const auto a = static_cast<std::size_t>(vertices[i]);
        const auto b = static_cast<std::size_t>(vertices[j]);
        const bool isStep = std::abs(anchors[a].Weight - anchors[b].Weight) > LargestStep;
        const bool isJump = anchors[a].Weight > 0.0 && anchors[b].Weight > 0.0 &&
          glm::distance(anchors[a].Position, anchors[b].Position) >
            2.0 * (1.0 + 1e-6) * glm::distance(positions[a], positions[b]);
        if (isStep || isJump)
        {
          return true;
        }
      }
    }
    return false;
  };
  const auto findInCell = [&](int x, int y, int z, std::vector<Candidate>& found)
  {
    const std::int64_t first = z * plane + y * size + x;
    std::array<Anchor, 8> anchors;
    std::array<glm::dvec3, 8> positions;
    std::array<std::int64_t, 8> numbers;
    bool anyOutside = false;
    bool allStill = true;
    for (int corner = 0; corner < 8; ++corner)
    {
      const std::int64_t number =
        first + (corner & 1) + (corner >> 2 & 1) * size + (corner >> 1 & 1) * plane;
      const std::int32_t tetrahedron = links[static_cast<std::size_t>(number)].Tetrahedron;
      anyOutside = anyOutside || tetrahedron >= still;
      allStill = allStill && tetrahedron == still;
      numbers[static_cast<std::size_t>(corner)] = number;
    }
    if (!anyOutside || allStill)
    {
      return;
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      const auto at = static_cast<std::size_t>(corner);
      const glm::dvec3 voxel(voxels[0] + x + (corner & 1), voxels[2] + y + (corner >> 2 & 1),
        voxels[4] + z + (corner >> 1 & 1));
      positions[at] = spacing * voxel;
      anchors[at] = GetAnchor(links[static_cast<std::size_t>(numbers[at])], voxel, spacing,
        restPoints, tetrahedra, faces);
    }
    const int mirror = DEFORMVOLUME_MIRROR(voxels[0] + x, voxels[2] + y, voxels[4] + z);
    for (int tetrahedron = 0; tetrahedron < 5; ++tetrahedron)
    {
      int vertices[4];
      for (int k = 0; k < 4; ++k)
      {
        vertices[k] = FiveTetrahedra[tetrahedron][k] ^ mirror;
      }
      if (isStretchable(anchors, positions, vertices))
      {
        Candidate& one = found.emplace_back();
        one.Cell = first - y - z * (size + GetSize(voxels, 1) - 1); // there are fewer cells
        one.Tetrahedron = tetrahedron;
        for (std::size_t k = 0; k < 4; ++k)
        {
          one.Vertices[k] = numbers[static_cast<std::size_t>(vertices[k])];
        }
      }
    }
  };
  const std::vector<Candidate> found = CollectItems<Candidate>(static_cast<std::size_t>(layers), 1,
    [&](std::size_t layer, std::vector<Candidate>& some)
    {
      const auto z = static_cast<int>(layer);
      ForEachPoint(
        { { 0, static_cast<int>(size) - 2, 0, static_cast<int>(GetSize(voxels, 1)) - 2, z, z } },
        [&](int x, int y, int) { findInCell(x, y, z, some); });
    });
  const auto count = static_cast<std::int64_t>(found.size());
  this->Step = std::max<std::int64_t>(1, (count + MostStretchable - 1) / MostStretchable);
  for (std::int64_t i = 0; i < count; i += this->Step)
  {
    Candidate& one = this->Candidates.emplace_back(found[static_cast<std::size_t>(i)]);
    for (std::size_t k = 0; k < 4; ++k)
    {
      one.Links[k] = links[static_cast<std::size_t>(one.Vertices[k])];
    }
  }
}

std::int64_t StretchedTetrahedra::Count(const FadedLinks& links,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
  const std::function<bool(const Candidate&)>& isWhole) const
{
  std::atomic<std::int64_t> count{ 0 };
  ParallelForParts(this->Candidates.size(), 1024,
    [&](std::size_t begin, std::size_t end)
    {
      std::int64_t some = 0;
      for (std::size_t i = begin; i < end; ++i)
      {
        glm::dvec3 low(std::numeric_limits<double>::infinity());
        glm::dvec3 high(-std::numeric_limits<double>::infinity());
        for (const VertexLink& link : this->Candidates[i].Links)
        {
          const glm::dvec3 moved = links.Displace(link, tetrahedra, displacements);
          low = glm::min(low, moved);
          high = glm::max(high, moved);
        }
        const glm::dvec3 size = high - low;
        const bool isStretched = std::max({ size.x, size.y, size.z }) > StretchLimit;
        some += isStretched && (!isWhole || isWhole(this->Candidates[i])) ? 1 : 0;
      }
      count += some;
    });
  return this->Step * count;
}

} // namespace deformvolume
