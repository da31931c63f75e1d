// SPDX-License-Identifier: BSD-3-Clause
#include "DeformedPositions.h"

#include "FieldChecker.h" // for AreVoxelsPoints
#include "VectorComponents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace deformvolume
{
DeformedFieldPositions::DeformedFieldPositions(
  const Extent& vertices, const DisplacementField& field)
  : DeformedPositions(vertices)
  , Field(field)
{
  this->FindBoxes({});
}

bool DeformedFieldPositions::FindDisplacement(
  const glm::dvec3& vertex, glm::dvec3& displacement) const
{
  glm::dvec3 position;
  glm::dvec3 inside;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double* row = &this->Field.IndexToField[4 * axis];
    const double coordinate = row[0] * vertex.x + row[1] * vertex.y + row[2] * vertex.z + row[3];
    const double last = this->Field.Dimensions[axis] - 1;
    if (!this->Field.Extrapolate &&
      !(coordinate >= -FieldTolerance && coordinate <= last + FieldTolerance))
    {
      return false;
    }
    position[axis] = coordinate;
    inside[axis] = std::min(std::max(coordinate, 0.0), last);
  }
  displacement = Interpolate(
    this->Field, inside, [this](std::int64_t point) { return GetVector(this->Field, point); });
  displacement *= GetWeightBeyond(this->Field, position, FieldTolerance);
  return true;
}

void DeformedFieldPositions::FindRow(
  int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const
{
  for (int i = 0; i < count; ++i)
  {
    hasPosition[i] = this->FindDisplacement(glm::dvec3(x + i, y, z), displacements[i]);
  }
}

// Returns the limits of the displacements at all points of the field that affect a vertex.
// Displacements of vertices lie within these limits, because weights are between 0 and 1 and add up
// to 1. Rounding errors can omit a point whose weight is almost 0.
DisplacementLimits DeformedFieldPositions::GetLimits(std::size_t brick) const
{
  const Extent vertices = this->GetBricks().GetVertices(brick);
  DisplacementLimits limits;
  bool mayFade = false;
  std::array<std::int64_t, 6> points;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double* row = &this->Field.IndexToField[4 * axis];
    double low = row[3];
    double high = row[3];
    for (int k = 0; k < 3; ++k)
    {
      const double a = row[k] * vertices[2 * k];
      const double b = row[k] * vertices[2 * k + 1];
      low += std::min(a, b);
      high += std::max(a, b);
    }
    const double last = this->Field.Dimensions[axis] - 1;
    if (!this->Field.Extrapolate && !(high >= -FieldTolerance && low <= last + FieldTolerance))
    {
      return limits;
    }
    mayFade = mayFade || (IsFading(this->Field) && (low < 0.0 || high > last));
    points[2 * axis] = static_cast<std::int64_t>(std::clamp(low, 0.0, last));
    points[2 * axis + 1] = static_cast<std::int64_t>(std::ceil(std::clamp(high, 0.0, last)));
  }
  ComponentFinder rows;
  const auto count = static_cast<std::size_t>(3 * (points[1] - points[0] + 1));
  for (std::int64_t z = points[4]; z <= points[5]; ++z)
  {
    for (std::int64_t y = points[2]; y <= points[3]; ++y)
    {
      const std::int64_t first =
        (z * this->Field.Dimensions[1] + y) * this->Field.Dimensions[0] + points[0];
      rows.Add(this->Field.Vectors + 3 * first, count);
    }
  }
  const VectorComponents all = rows.Get();
  limits.AreKnown = all.AreFinite;
  const DisplacementRange range = GetRange(GetFactors(this->Field), all);
  for (int axis = 0; axis < 3; ++axis)
  {
    limits.Min[axis] = range.Min[static_cast<std::size_t>(axis)];
    limits.Max[axis] = range.Max[static_cast<std::size_t>(axis)];
    if (mayFade)
    {
      limits.Min[axis] = std::min(limits.Min[axis], 0.0);
      limits.Max[axis] = std::max(limits.Max[axis], 0.0);
    }
  }
  return limits;
}

void DeformedFieldPositions::SetField(const DisplacementField& field, const PointRanges* changed)
{
  const DisplacementField last = std::exchange(this->Field, field);
  this->FindBoxes(this->FindChanged(last, changed));
}

std::vector<unsigned char> DeformedFieldPositions::FindChanged(
  const DisplacementField& last, const PointRanges* changed) const
{
  const DisplacementField& field = this->Field;
  // Changed vertices are only found in the simple case that points of the field are voxels.
  const VoxelGrid vertices{ this->GetBricks().GetVertices(), {}, {} };
  if (!changed || last.Dimensions != field.Dimensions || last.IndexToField != field.IndexToField ||
    last.ToDisplacement != field.ToDisplacement || last.Extrapolate != field.Extrapolate ||
    last.Fading != field.Fading || !AreVoxelsPoints(vertices, field))
  {
    return {};
  }
  std::vector<unsigned char> marked(this->GetBricks().GetNumberOfBricks(), 0);
  const std::int64_t width = field.Dimensions[0];
  for (const auto& [begin, end] : *changed)
  {
    for (auto point = static_cast<std::int64_t>(begin); point < static_cast<std::int64_t>(end);)
    {
      const std::int64_t row = point / width;
      const std::int64_t next = std::min(static_cast<std::int64_t>(end), (row + 1) * width);
      const auto y = static_cast<int>(row % field.Dimensions[1]);
      const auto z = static_cast<int>(row / field.Dimensions[1]);
      this->MarkRow({ { static_cast<int>(point - row * width),
                      static_cast<int>(next - 1 - row * width), y, y, z, z } },
        marked);
      point = next;
    }
  }
  return marked;
}

// Marks the bricks of the vertices at the given points of the field. A vertex on the common face of
// two bricks belongs to both bricks.
void DeformedFieldPositions::MarkRow(const Extent& points, std::vector<unsigned char>& bricks) const
{
  Extent cells;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const int first = this->GetBricks().GetVertices()[2 * axis] +
      static_cast<int>(this->Field.IndexToField[4 * axis + 3]); // the point at the first vertex
    cells[2 * axis] = std::max(points[2 * axis] - first - 1, 0);
    cells[2 * axis + 1] =
      std::min(points[2 * axis + 1] - first, this->GetBricks().GetSize()[axis] - 1);
    if (cells[2 * axis] > cells[2 * axis + 1])
    {
      return;
    }
  }
  constexpr int length = CellBricks::Length;
  Extent marked;
  std::transform(
    cells.begin(), cells.end(), marked.begin(), [](int cell) { return cell / length; });
  ForEachPoint(marked,
    [&](int x, int y, int z) {
      bricks[this->GetBricks().FindBrick({ { x * length, y * length, z * length } })] = 1;
    });
}

} // namespace deformvolume
