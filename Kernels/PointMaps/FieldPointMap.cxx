// SPDX-License-Identifier: BSD-3-Clause
#include "FieldPointMap.h"

#include "BoxTree.h"
#include "IndexBounds.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

namespace deformvolume
{

namespace
{

constexpr int BlockSize = 2;      // cells in a box of the tree, on each axis
constexpr int MostCellSteps = 20; // of Newton's method in a cell
// Newton's method ends when a step is shorter than this, in cells.
constexpr double LastCellStep = 1e-12;
// Tolerance at the faces of a cell, in cells: rounding must not lose points between two cells.
constexpr double CellFaceTolerance = 1e-9;
// Largest distance from the solution, in cells, at which Newton's method counts as converged.
constexpr double CellSolutionTolerance = 1e-8;
// The same relative to the largest coordinate: rounding of world coordinates.
constexpr double RoundingOfPositions = 1e-14;
// Points of the field with a smaller weight are ignored: the weight may be a rounding error.
constexpr double LeastWeight = 1e-5;

/// Values at the corners of a cell. Bits 0, 1 and 2 of a corner's number: upper x, y and z.
using Corners = std::array<glm::dvec3, 8>;

/// Interpolates trilinearly at a position in a cell, with coordinates from 0 to 1. gradient:
/// returns the derivatives with respect to the position.
glm::dvec3 Interpolate(const Corners& corners, const glm::dvec3& position, glm::dmat3& gradient)
{
  const auto mix = [](const glm::dvec3& a, const glm::dvec3& b, double t)
  { return a + t * (b - a); };
  std::array<glm::dvec3, 4> alongX;
  std::array<glm::dvec3, 4> byX;
  for (std::size_t i = 0; i < 4; ++i)
  {
    byX[i] = corners[2 * i + 1] - corners[2 * i];
    alongX[i] = corners[2 * i] + position.x * byX[i];
  }
  const glm::dvec3 low = mix(alongX[0], alongX[1], position.y);
  const glm::dvec3 high = mix(alongX[2], alongX[3], position.y);
  gradient[0] = mix(mix(byX[0], byX[1], position.y), mix(byX[2], byX[3], position.y), position.z);
  gradient[1] = mix(alongX[1] - alongX[0], alongX[3] - alongX[2], position.z);
  gradient[2] = high - low;
  return mix(low, high, position.z);
}

} // namespace

class FieldPointMap::Internals
{
public:
  explicit Internals(const WorldField& field)
    : Field(field)
    , Origin(field.IndexToWorld[3])
    , ToWorld(field.IndexToWorld)
    , ToIndex(glm::inverse(this->ToWorld))
  {
    std::int64_t stride = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int points = field.Dimensions[static_cast<std::size_t>(axis)];
      this->Last[axis] = points - 1;
      this->Cells[axis] = std::max(points - 1, 1);
      this->Strides[axis] = stride;
      stride *= points;
    }
  }

  glm::ivec3 GetCell(const glm::dvec3& index) const
  {
    return glm::min(glm::ivec3(index), this->Cells - 1);
  }

  std::int64_t GetNumber(const glm::ivec3& point) const
  {
    return point.x * this->Strides.x + point.y * this->Strides.y + point.z * this->Strides.z;
  }

  /// Returns the vectors at the corners of a cell. On an axis with one point, both sides have the
  /// same vectors.
  Corners GetVectors(const glm::ivec3& cell) const
  {
    Corners corners;
    for (int corner = 0; corner < 8; ++corner)
    {
      const glm::ivec3 offset(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      corners[static_cast<std::size_t>(corner)] =
        this->Field.GetVector(this->GetNumber(glm::min(cell + offset, this->Last)));
    }
    return corners;
  }

  /// Returns a position relative to Origin.
  glm::dvec3 GetPosition(const glm::dvec3& index) const { return this->ToWorld * index; }

  /// Returns the deformed positions of the corners of a cell, relative to Origin.
  Corners GetMoved(const glm::ivec3& cell) const
  {
    Corners corners = this->GetVectors(cell);
    for (int corner = 0; corner < 8; ++corner)
    {
      const glm::ivec3 offset(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      corners[static_cast<std::size_t>(corner)] += this->GetPosition(glm::dvec3(cell + offset));
    }
    return corners;
  }

  /// Whether all vectors that are needed at a position in a cell are defined.
  bool IsDefined(const glm::ivec3& cell, const glm::dvec3& position) const
  {
    for (int corner = 0; this->Field.Undefined && corner < 8; ++corner)
    {
      const glm::ivec3 offset(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      bool isNeeded = true;
      for (int axis = 0; axis < 3; ++axis)
      {
        isNeeded =
          isNeeded && (offset[axis] != 0 ? position[axis] : 1.0 - position[axis]) > LeastWeight;
      }
      if (isNeeded &&
        this->Field.Undefined[this->GetNumber(glm::min(cell + offset, this->Last))] != 0)
      {
        return false;
      }
    }
    return true;
  }

  glm::ivec3 GetBlocks() const { return (this->Cells + BlockSize - 1) / BlockSize; }

  template <typename Body>
  void ForEachCell(std::size_t block, Body&& body) const
  {
    const glm::ivec3 blocks = this->GetBlocks();
    const auto number = static_cast<std::int64_t>(block);
    const glm::ivec3 first = BlockSize *
      glm::ivec3(number % blocks.x, number / blocks.x % blocks.y,
        number / (std::int64_t{ blocks.x } * blocks.y));
    const glm::ivec3 end = glm::min(first + BlockSize, this->Cells);
    ForEachPoint({ { first.x, end.x - 1, first.y, end.y - 1, first.z, end.z - 1 } },
      [&](int x, int y, int z) { body(glm::ivec3(x, y, z)); });
  }

  /// Returns the bounding box of a deformed cell, enlarged by a tolerance.
  IndexBounds GetBox(const Corners& moved) const
  {
    IndexBounds box = deformvolume::GetBox(moved);
    // The tolerance is relative to the size of the deformed cell.
    const glm::dvec3 margin =
      2.0 * (this->Field.Tolerance + CellFaceTolerance) * (box.Max - box.Min);
    box.Min -= margin;
    box.Max += margin;
    return box;
  }

  void MakeBoxes()
  {
    const glm::ivec3 blocks = this->GetBlocks();
    const auto count = static_cast<std::size_t>(blocks.x) * static_cast<std::size_t>(blocks.y) *
      static_cast<std::size_t>(blocks.z);
    std::vector<IndexBounds> boxes(count);
    for (std::size_t block = 0; block < count; ++block)
    {
      this->ForEachCell(block,
        [&](const glm::ivec3& cell) { boxes[block].Add(this->GetBox(this->GetMoved(cell))); });
    }
    this->Boxes = BoxTree<IndexBounds>(std::move(boxes));
  }

  /// A position in a cell whose deformed position is a given point.
  struct Solution
  {
    std::int64_t Number = -1; // of the cell; -1: no solution
    bool IsBeside = true;     // outside the cell, within the tolerance
    bool IsInverted = false;
    glm::ivec3 Cell{ 0 };
    glm::dvec3 Position{ 0.0 };
    glm::dmat3 Gradient{ 1.0 };

    bool IsBetterThan(const Solution& other) const
    {
      return this->Number >= 0 &&
        (other.Number < 0 ||
          std::make_tuple(this->IsBeside, this->IsInverted, this->Number) <
            std::make_tuple(other.IsBeside, other.IsInverted, other.Number));
    }
  };

  /// Runs Newton's method from a start. Number is -1 if the method leaves the cell.
  Solution Find(const glm::ivec3& cell, const Corners& moved, const glm::dvec3& point,
    const glm::dvec3& start) const
  {
    Solution found;
    found.Cell = cell;
    found.Position = start;
    bool isDone = false;
    for (int i = 0; i < MostCellSteps && !isDone; ++i)
    {
      const glm::dvec3 miss = Interpolate(moved, found.Position, found.Gradient) - point;
      const glm::dvec3 step = glm::inverse(found.Gradient) * miss;
      found.Position -= step;
      const glm::dvec3 away = glm::abs(found.Position - 0.5);
      if (!(std::max({ away.x, away.y, away.z }) < 3.0))
      {
        return found;
      }
      isDone = glm::length(step) < LastCellStep;
    }
    if (!isDone)
    {
      return found;
    }
    found.IsBeside = false;
    for (int axis = 0; axis < 3; ++axis)
    {
      // On an axis with one point the cell has no thickness.
      const double beyond = this->Last[axis] == 0
        ? std::abs(found.Position[axis])
        : std::max(-found.Position[axis], found.Position[axis] - 1.0);
      if (beyond > std::max(this->Field.Tolerance, CellFaceTolerance))
      {
        return found;
      }
      found.IsBeside = found.IsBeside || beyond > CellFaceTolerance;
    }
    if (this->IsDefined(cell, found.Position))
    {
      Interpolate(moved, found.Position, found.Gradient);
      found.IsInverted =
        (glm::determinant(found.Gradient) > 0.0) != (glm::determinant(this->ToWorld) > 0.0);
      found.Number = this->GetNumber(cell);
    }
    return found;
  }

  /// thorough: tries 27 more starts.
  Solution FindInCell(
    const glm::ivec3& cell, const Corners& moved, const glm::dvec3& point, bool thorough) const
  {
    Solution best = this->Find(cell, moved, point, glm::dvec3(0.5));
    for (int start = 0; thorough && start < 27; ++start)
    {
      const glm::dvec3 position(start % 3, start / 3 % 3, start / 9);
      const Solution found = this->Find(cell, moved, point, 0.1 + 0.4 * position);
      best = found.IsBetterThan(best) ? found : best;
    }
    return best;
  }

  Solution FindInCells(const glm::dvec3& point) const
  {
    const Solution found = this->FindInCells(point, false);
    // In a folded cell, the method may leave the cell from some starts.
    return found.Number < 0 || found.IsInverted ? this->FindInCells(point, true) : found;
  }

  Solution FindInCells(const glm::dvec3& point, bool thorough) const
  {
    Solution best;
    this->Boxes.Visit({ point, point },
      [&](std::size_t block)
      {
        this->ForEachCell(block,
          [&](const glm::ivec3& cell)
          {
            if (best.Number >= 0 && !best.IsBeside && !best.IsInverted &&
              this->GetNumber(cell) > best.Number)
            {
              return;
            }
            const Corners moved = this->GetMoved(cell);
            const IndexBounds box = this->GetBox(moved);
            if (box.Overlaps({ point, point }))
            {
              const Solution found = this->FindInCell(cell, moved, point, thorough);
              best = found.IsBetterThan(best) ? found : best;
            }
          });
        return true;
      });
    return best;
  }

  const WorldField Field;
  // The first point of the field. Positions of cells are relative to it, as large coordinates would
  // have large rounding errors.
  const glm::dvec3 Origin;
  const glm::dmat3 ToWorld;
  const glm::dmat3 ToIndex;
  glm::ivec3 Last{ 0 };  // index of the last point on each axis
  glm::ivec3 Cells{ 1 }; // cells on each axis; 1 on an axis with one point
  glm::i64vec3 Strides{ 1 };
  BoxTree<IndexBounds> Boxes;
};

FieldPointMap::FieldPointMap(const WorldField& field, const OutsideVoxels& outside, bool isInverse)
  : Inside(std::make_unique<Internals>(field))
{
  this->Outside = outside;
  const glm::dmat3& axes = this->Inside->ToWorld;
  const glm::dvec3 largest = glm::abs(this->Inside->Origin) +
    glm::abs(axes[0]) * static_cast<double>(field.Dimensions[0]) +
    glm::abs(axes[1]) * static_cast<double>(field.Dimensions[1]) +
    glm::abs(axes[2]) * static_cast<double>(field.Dimensions[2]);
  this->SolutionTolerance = std::max(CellSolutionTolerance *
      std::min({ glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]) }),
    RoundingOfPositions * std::max({ largest.x, largest.y, largest.z }));
  if (isInverse)
  {
    this->Inside->MakeBoxes();
  }
}

FieldPointMap::~FieldPointMap() = default;

bool FieldPointMap::Map(const glm::dvec3& point, Image& image) const
{
  const Internals& inside = *this->Inside;
  const glm::dvec3 index = inside.ToIndex * (point - inside.Origin);
  const glm::dvec3 nearest = glm::clamp(index, glm::dvec3(0.0), glm::dvec3(inside.Last));
  bool isOutside = false;
  bool isBeside = false;
  glm::dmat3 reported(1.0);
  glm::dmat3 clamped(1.0);
  for (int axis = 0; axis < 3; ++axis)
  {
    const double beyond = std::abs(index[axis] - nearest[axis]);
    isOutside = isOutside || beyond > inside.Field.Tolerance;
    isBeside = isBeside || (beyond > 0.0 && beyond <= inside.Field.Tolerance);
    // Points that rounding has moved across the border have the derivatives of the field.
    reported[axis][axis] = beyond > inside.Field.Tolerance ? 0.0 : 1.0;
    clamped[axis][axis] = beyond > 0.0 ? 0.0 : 1.0;
  }
  image = { point };
  double weight = 1.0;
  glm::dvec3 slope(0.0); // gradient of the weight
  if (isOutside && this->Outside.AreDiscarded())
  {
    return false;
  }
  if (isOutside && this->Outside.AreKept())
  {
    const glm::dvec3 offset = inside.ToWorld * (index - nearest);
    const double distance = glm::length(offset);
    if (!(distance < this->Outside.FadeDistance))
    {
      return true;
    }
    const double s = distance / this->Outside.FadeDistance;
    weight = GetFadedWeight(s);
    slope = GetFadedSlope(s) / this->Outside.FadeDistance * offset / distance;
  }
  const glm::ivec3 cell = inside.GetCell(nearest);
  const glm::dvec3 position = nearest - glm::dvec3(cell);
  if (!inside.IsDefined(cell, position))
  {
    return false;
  }
  glm::dmat3 gradient;
  const glm::dvec3 displacement = Interpolate(inside.GetVectors(cell), position, gradient);
  image.FadingDisplacement = weight < 1.0 ? glm::length(displacement) : 0.0;
  image.Point += weight * displacement;
  const glm::dmat3 fading = glm::outerProduct(displacement, slope);
  image.Gradient += weight * gradient * reported * inside.ToIndex + fading;
  if (isBeside)
  {
    image.StepGradient = glm::dmat3(1.0) + (weight * gradient * clamped * inside.ToIndex + fading);
  }
  return true;
}

bool FieldPointMap::InvertInside(const glm::dvec3& point, Image& image) const
{
  const Internals& inside = *this->Inside;
  const Internals::Solution found = inside.FindInCells(point - inside.Origin);
  if (found.Number < 0)
  {
    return false;
  }
  const glm::dvec3 position =
    inside.Origin + inside.GetPosition(glm::dvec3(found.Cell) + found.Position);
  if (found.IsBeside)
  {
    // Outside the cell, points follow the border of the field.
    return this->Solve(point, position, image);
  }
  image = { position, inside.ToWorld * glm::inverse(found.Gradient) };
  return true;
}

} // namespace deformvolume
