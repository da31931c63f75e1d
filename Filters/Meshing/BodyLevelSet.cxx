// SPDX-License-Identifier: BSD-3-Clause
#include "BodyLevelSet.h"

#include "DistanceTransform.h"
#include "Error.h"
#include "ParallelFor.h"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace deformvolume
{
namespace
{

// Values that a margin may add to the grid.
constexpr double MaximumMarginValues = 2e9;
// No vertex of the surface lies closer to a node than that part of the distance of nodes:
// otherwise there are several almost in one place, and TetGen has to keep the tiny triangles
// between them.
constexpr float LeastValue = 0.1f;
// The value of nodes around a voxel that the distances alone leave outside.
constexpr float ForcedValue = 0.3f;

double Smallest(const glm::dvec3& v)
{
  return std::min({ v.x, v.y, v.z });
}

// Distances to the convex hull of the body, which is approximated from outside by half-spaces in
// directions that are spread evenly over the sphere (a Fibonacci lattice), and along the axes, so
// that it ends where the body does: positive inside.
void SetHullDistances(BodyLevelSet& grid, const BodyVoxels& body, double margin, double unit)
{
  constexpr int spread = 400;
  constexpr int directions = spread + 6;
  std::vector<glm::dvec3> corners;
  for (vtkIdType row = 0; row < body.NumberOfRows(); ++row)
  {
    if (body.RowStarts[row] == body.RowStarts[row + 1])
    {
      continue;
    }
    const double y = static_cast<double>(row % body.Size[1]);
    const double z = static_cast<double>(row / body.Size[1]);
    const int first = body.Runs[body.RowStarts[row]].Begin;
    const int last = body.Runs[body.RowStarts[row + 1] - 1].End - 1;
    corners.push_back(glm::dvec3(first, y, z) * grid.VoxelSpacing);
    corners.push_back(glm::dvec3(last, y, z) * grid.VoxelSpacing);
  }
  std::vector<glm::dvec3> normals(directions);
  std::vector<double> reaches(directions);
  ParallelFor(0, directions, 0,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin; i < end; ++i)
      {
        if (i < spread)
        {
          const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / spread;
          const double angle = static_cast<double>(i) * glm::pi<double>() * (3.0 - std::sqrt(5.0));
          const double radius = std::sqrt(1.0 - z * z);
          normals[i] = glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), z);
        }
        else
        {
          normals[i] = glm::dvec3(0.0);
          normals[i][static_cast<int>(i - spread) / 2] = i % 2 == 0 ? 1.0 : -1.0;
        }
        reaches[i] = -std::numeric_limits<double>::infinity();
        for (const glm::dvec3& corner : corners)
        {
          reaches[i] = std::max(reaches[i], glm::dot(normals[i], corner));
        }
      }
    });
  const glm::dvec3 first = grid.FirstPosition();
  const glm::dvec3 spacing = grid.Spacing();
  const vtkIdType plane = grid.Size[0] * grid.Size[1];
  ParallelFor(0, grid.Size[2], 0,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin * plane; i < end * plane; ++i)
      {
        const glm::dvec3 position = first +
          spacing * glm::dvec3(i % grid.Size[0], i / grid.Size[0] % grid.Size[1], i / plane);
        double inside = std::numeric_limits<double>::infinity();
        for (int k = 0; k < directions; ++k)
        {
          inside = std::min(inside, reaches[k] - glm::dot(normals[k], position));
        }
        grid.Values[i] = static_cast<float>((inside + margin) / unit);
      }
    });
}

void SetBodyDistances(
  BodyLevelSet& grid, const BodyVoxels& body, double margin, double half, double unit)
{
  std::vector<float> outer = SquaredDistances(grid, body, false);
  if (margin + half > glm::length(grid.Spacing()))
  {
    // The surface is so far from the voxels that what lies on their other side does not matter.
    std::transform(outer.begin(), outer.end(), grid.Values.begin(),
      [&](float square) { return static_cast<float>((margin + half - std::sqrt(square)) / unit); });
    return;
  }
  const std::vector<float> inner = SquaredDistances(grid, body, true);
  for (std::size_t i = 0; i < outer.size(); ++i)
  {
    // The body ends about half a voxel beyond its outermost voxels.
    const double distance =
      outer[i] > inner[i] ? half - std::sqrt(outer[i]) : std::sqrt(inner[i]) - half;
    grid.Values[i] = static_cast<float>((margin + distance) / unit);
  }
}

// The offsets of the corners of a cell from its first one.
std::array<vtkIdType, 8> CornerOffsets(const BodyLevelSet& grid)
{
  std::array<vtkIdType, 8> offsets;
  for (int corner = 0; corner < 8; ++corner)
  {
    offsets[corner] =
      (corner & 1) + grid.Size[0] * ((corner >> 1 & 1) + grid.Size[1] * vtkIdType(corner >> 2 & 1));
  }
  return offsets;
}

double Interpolate(const std::array<float, 8>& values, const glm::dvec3& t)
{
  double result = 0.0;
  for (int corner = 0; corner < 8; ++corner)
  {
    result += values[corner] * (corner & 1 ? t.x : 1.0 - t.x) * (corner & 2 ? t.y : 1.0 - t.y) *
      (corner & 4 ? t.z : 1.0 - t.z);
  }
  return result;
}

// All corners of a cell become inside where a voxel in it would not be: parts that are thinner than
// the distance of nodes.
void EncloseVoxels(BodyLevelSet& grid, const BodyVoxels& body, bool wholeCells)
{
  const std::array<vtkIdType, 8> offsets = CornerOffsets(grid);
  std::vector<vtkIdType> forced;
  for (vtkIdType row = 0; row < body.NumberOfRows(); ++row)
  {
    const vtkIdType y = row % body.Size[1];
    const vtkIdType z = row / body.Size[1];
    const vtkIdType rowCell =
      ((z / grid.Step[2] + grid.Border[2]) * grid.Size[1] + y / grid.Step[1] + grid.Border[1]) *
        grid.Size[0] +
      grid.Border[0];
    glm::dvec3 t;
    t.y = static_cast<double>(y % grid.Step[1]) / static_cast<double>(grid.Step[1]);
    t.z = static_cast<double>(z % grid.Step[2]) / static_cast<double>(grid.Step[2]);
    for (vtkIdType i = body.RowStarts[row]; i < body.RowStarts[row + 1]; ++i)
    {
      const VoxelRun& run = body.Runs[i];
      for (vtkIdType x = run.Begin; x < run.End;)
      {
        const vtkIdType column = x / grid.Step[0];
        const vtkIdType next = std::min<vtkIdType>(run.End, (column + 1) * grid.Step[0]);
        std::array<float, 8> values;
        bool inside = true;
        for (int corner = 0; corner < 8; ++corner)
        {
          values[corner] = grid.Values[rowCell + column + offsets[corner]];
          inside = inside && values[corner] > 0.0f;
        }
        for (; x < next && !inside; ++x)
        {
          t.x = static_cast<double>(x % grid.Step[0]) / static_cast<double>(grid.Step[0]);
          if (wholeCells || Interpolate(values, t) <= 0.0)
          {
            forced.push_back(rowCell + column);
            break;
          }
        }
        x = next;
      }
    }
  }
  for (const vtkIdType cell : forced)
  {
    for (const vtkIdType offset : offsets)
    {
      float& value = grid.Values[cell + offset];
      value = std::max(value, ForcedValue);
    }
  }
}

// What cannot be reached from outside the body becomes inside.
void FillCavities(BodyLevelSet& grid)
{
  std::vector<unsigned char> reached(grid.Count(), 0);
  std::vector<vtkIdType> queue(1, 0);
  reached[0] = 1;
  const vtkIdType strides[3] = { 1, grid.Size[0], grid.Size[0] * grid.Size[1] };
  while (!queue.empty())
  {
    const vtkIdType node = queue.back();
    queue.pop_back();
    for (int axis = 0; axis < 3; ++axis)
    {
      const vtkIdType position = node / strides[axis] % grid.Size[axis];
      const vtkIdType neighbors[2] = { position > 0 ? node - strides[axis] : -1,
        position + 1 < grid.Size[axis] ? node + strides[axis] : -1 };
      for (const vtkIdType neighbor : neighbors)
      {
        if (neighbor >= 0 && !reached[neighbor] && grid.Values[neighbor] < 0.0f)
        {
          reached[neighbor] = 1;
          queue.push_back(neighbor);
        }
      }
    }
  }
  for (vtkIdType i = 0; i < grid.Count(); ++i)
  {
    grid.Values[i] = reached[i] ? grid.Values[i] : std::abs(grid.Values[i]);
  }
}

// Where two diagonally opposite corners of a face are inside and the two others are not, an
// isosurface can have edges with four triangles: one more corner becomes inside.
void SeparateSheets(BodyLevelSet& grid)
{
  const vtkIdType strides[3] = { 1, grid.Size[0], grid.Size[0] * grid.Size[1] };
  std::vector<float>& values = grid.Values;
  bool changed = true;
  while (changed)
  {
    changed = false;
    for (int axis = 0; axis < 3; ++axis)
    {
      const vtkIdType u = strides[axis];
      const vtkIdType v = strides[(axis + 1) % 3];
      // Nodes at the border are outside, so that an index beyond a row's end does no harm.
      for (vtkIdType i = 0; i + u + v < grid.Count(); ++i)
      {
        const bool first = values[i] > 0.0f;
        if (first != (values[i + u + v] > 0.0f) || first == (values[i + u] > 0.0f) ||
          first == (values[i + v] > 0.0f))
        {
          continue;
        }
        const vtkIdType a = first ? i + u : i;
        const vtkIdType b = first ? i + v : i + u + v;
        values[values[a] >= values[b] ? a : b] = LeastValue;
        changed = true;
      }
    }
  }
}

} // namespace

glm::dvec3 BodyLevelSet::Spacing() const
{
  return this->VoxelSpacing *
    glm::dvec3(static_cast<double>(this->Step[0]), static_cast<double>(this->Step[1]),
      static_cast<double>(this->Step[2]));
}

glm::dvec3 BodyLevelSet::FirstPosition() const
{
  return -this->Spacing() *
    glm::dvec3(static_cast<double>(this->Border[0]), static_cast<double>(this->Border[1]),
      static_cast<double>(this->Border[2]));
}

BodyLevelSet MakeGrid(
  const BodyVoxels& body, const glm::dvec3& spacing, double resolution, double margin)
{
  BodyLevelSet grid;
  grid.VoxelSpacing = spacing;
  double inside = 1.0;
  double count = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double largest = std::max(1, body.Size[axis] / 2);
    grid.Step[axis] = static_cast<vtkIdType>(
      std::min(std::max(1.0, std::floor(resolution / spacing[axis])), largest));
    const double step = static_cast<double>(grid.Step[axis]);
    const double border = margin / (step * spacing[axis]);
    const double nodes = body.Size[axis] / step;
    inside *= nodes;
    count *= nodes + 2.0 * border;
    if (!(border <= MaximumMarginValues && count - inside <= MaximumMarginValues))
    {
      std::ostringstream text;
      text << "The body's surface cannot be moved out by a margin of " << margin
           << " world units: that is too far for a volume of this size. Set a smaller Margin or "
              "TargetEdgeLength.";
      throw Error(text.str());
    }
    grid.Border[axis] = static_cast<vtkIdType>(border) + 3;
    // One more than reaches the last voxel, so that each voxel lies in a cell.
    grid.Size[axis] = (body.Size[axis] - 1) / grid.Step[axis] + 2 + 2 * grid.Border[axis];
  }
  return grid;
}

void SetDistances(BodyLevelSet& grid, const BodyVoxels& body, const LevelSetParameters& parameters)
{
  grid.Values.resize(grid.Count());
  const double unit = Smallest(grid.Spacing());
  const double half = (grid.VoxelSpacing.x + grid.VoxelSpacing.y + grid.VoxelSpacing.z) / 6.0;
  if (parameters.Hull)
  {
    SetHullDistances(grid, body, parameters.Margin + half, unit);
  }
  else
  {
    SetBodyDistances(grid, body, parameters.Margin, half, unit);
  }
  for (float& value : grid.Values)
  {
    value = std::copysign(std::max(std::abs(value), LeastValue), value);
  }
  EncloseVoxels(grid, body, parameters.WholeCells);
  SeparateSheets(grid);
  FillCavities(grid);
}

} // namespace deformvolume
