// SPDX-License-Identifier: BSD-3-Clause
#include "DeformedPositions.h"

#include "ParallelFor.h"
#include "TriangleCrossing.h"

#include <glm/common.hpp>

#include <array>
#include <cmath>

namespace deformvolume
{

DeformedPositions::~DeformedPositions() = default;

void DeformedPositions::Find(
  const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const
{
  const auto count = static_cast<int>(GetSize(vertices, 0));
  std::vector<glm::dvec3> displacements(static_cast<std::size_t>(count));
  for (int z = vertices[4]; z <= vertices[5]; ++z)
  {
    for (int y = vertices[2]; y <= vertices[3]; ++y)
    {
      this->FindRow(vertices[0], y, z, count, displacements.data(), hasPosition);
      for (int i = 0; i < count; ++i)
      {
        const glm::dvec3& move = displacements[static_cast<std::size_t>(i)];
        // Extrapolation can give any value, and a field may contain any value, including
        // not-a-number.
        hasPosition[i] = hasPosition[i] && std::abs(move.x) <= LargestDisplacement &&
          std::abs(move.y) <= LargestDisplacement && std::abs(move.z) <= LargestDisplacement;
        const SnappedPoint rest = StepsPerVoxel * SnappedPoint(vertices[0] + i, y, z);
        positions[i] = hasPosition[i] ? rest + Snap(move) : rest;
      }
      positions += count;
      hasPosition += count;
    }
  }
}

void DeformedPositions::FindBoxes(const std::vector<unsigned char>& marked)
{
  const std::size_t bricks = this->GetBricks().GetNumberOfBricks();
  this->Boxes.resize(bricks);
  constexpr std::size_t step = 32;
  ParallelForItems(bricks, step,
    [&](std::size_t brick)
    {
      if (marked.empty() || marked[brick] != 0)
      {
        this->Boxes[brick] = this->FindBox(brick);
      }
    });
  this->Box = SnappedBox();
  for (const SnappedBox& box : this->Boxes)
  {
    this->Box.Add(box);
  }
}

SnappedBox DeformedPositions::FindBox(std::size_t brick) const
{
  const DisplacementLimits limits = this->GetLimits(brick);
  if (!limits.AreKnown)
  {
    return this->FindExactBox(brick);
  }
  if (limits.IsEmpty())
  {
    return {};
  }
  const glm::dvec3 most(LargestDisplacement); // vertices with larger displacements have no position
  const glm::dvec3 low = glm::clamp(limits.Min, -most, most);
  const glm::dvec3 high = glm::clamp(limits.Max, -most, most);
  const Extent vertices = this->GetBricks().GetVertices(brick);
  // Rounding of sums can move a position by one step.
  SnappedBox box;
  box.Add(StepsPerVoxel * SnappedPoint(vertices[0], vertices[2], vertices[4]) + Snap(low) -
    SnappedPoint(1));
  box.Add(StepsPerVoxel * SnappedPoint(vertices[1], vertices[3], vertices[5]) + Snap(high) +
    SnappedPoint(1));
  // Limits overestimate the box. So compute the exact box before a brick is reported as too large.
  return box.GetLength() <= TriangleCrossing::LargestBox ? box : this->FindExactBox(brick);
}

SnappedBox DeformedPositions::FindExactBox(std::size_t brick) const
{
  std::array<SnappedPoint, 729> positions;
  std::array<bool, 729> hasPosition;
  const Extent vertices = this->GetBricks().GetVertices(brick);
  this->Find(vertices, positions.data(), hasPosition.data());
  const auto count = static_cast<std::size_t>(GetNumberOfPoints(vertices));
  SnappedBox box;
  for (std::size_t i = 0; i < count; ++i)
  {
    if (hasPosition[i])
    {
      box.Add(positions[i]);
    }
  }
  return box;
}

} // namespace deformvolume
