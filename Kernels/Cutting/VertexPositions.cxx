// SPDX-License-Identifier: BSD-3-Clause
#include "VertexPositions.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

SnappedBox GetRestBox(const Extent& vertices)
{
  SnappedBox box;
  box.Min = StepsPerVoxel * SnappedPoint(vertices[0], vertices[2], vertices[4]);
  box.Max = StepsPerVoxel * SnappedPoint(vertices[1], vertices[3], vertices[5]);
  return box;
}

} // namespace

VertexPositions::~VertexPositions() = default;

SnappedBox RestPositions::GetBox(std::size_t brick) const
{
  return GetRestBox(this->GetBricks().GetVertices(brick));
}

SnappedBox RestPositions::GetBox() const
{
  return GetRestBox(this->GetBricks().GetVertices());
}

void RestPositions::Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const
{
  std::fill_n(hasPosition, GetNumberOfPoints(vertices), true);
  ForEachPoint(
    vertices, [&](int x, int y, int z) { *positions++ = StepsPerVoxel * SnappedPoint(x, y, z); });
}

} // namespace deformvolume
