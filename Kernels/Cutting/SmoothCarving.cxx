// SPDX-License-Identifier: BSD-3-Clause
// Carving with a boundary that passes through tetrahedra.
#include "BrickEdit.h"
#include "Carving.h"
#include "CarvingContainment.h"
#include "DistanceGatherer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace deformvolume
{
namespace
{

// Distances of the vertices of a brick of cells. Neighboring bricks share vertices.
using BrickDistances = std::array<float, BrickEdit::MaxVertices>;

/// Finds the distances of the vertices of a brick.
class CarvedBrick
{
public:
  explicit CarvedBrick(float far)
    : Far(far)
  {
  }

  /// Hits the tetrahedra with all vertices inside, and marks the vertices of cells that the
  /// boundary passes through. inside: whether each vertex is inside. Returns false if no vertex is
  /// inside.
  bool Mark(BrickEdit& edit, const std::array<bool, BrickEdit::MaxVertices>& inside)
  {
    this->Count = edit.GetNumberOfVertices();
    if (std::none_of(inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(this->Count),
          [](bool is) { return is; }))
    {
      return false;
    }
    this->Inside = inside;
    this->Marked.fill(false);
    edit.ForEachCell(
      [&](int x, int y, int z, std::size_t index) {
        this->MarkCell(edit, edit.GetVertex(x, y, z), { { x, y, z } }, index);
      });
    return true;
  }

  /// Returns the indices of the vertices whose distances are needed.
  std::vector<std::size_t> GetMarked() const
  {
    std::vector<std::size_t> marked;
    for (std::size_t i = 0; i < this->Count; ++i)
    {
      if (this->Marked[i])
      {
        marked.push_back(i);
      }
    }
    return marked;
  }

  /// Returns the signed distances of all vertices. known: the unsigned distances of the marked
  /// vertices.
  BrickDistances Join(const std::vector<std::size_t>& marked, const double* known) const
  {
    BrickDistances distances;
    for (std::size_t i = 0; i < this->Count; ++i)
    {
      distances[i] = this->Inside[i] ? -this->Far : this->Far;
    }
    for (std::size_t k = 0; k < marked.size(); ++k)
    {
      // The distance of a vertex inside must be negative, even if its unsigned distance is 0.
      const float least = this->Inside[marked[k]] ? std::numeric_limits<float>::min() : 0.0F;
      const double size = std::isnan(known[k]) ? this->Far : std::abs(known[k]);
      const float distance =
        std::max(static_cast<float>(std::min(size, static_cast<double>(this->Far))), least);
      distances[marked[k]] = this->Inside[marked[k]] ? -distance : distance;
    }
    return distances;
  }

private:
  void MarkCell(
    BrickEdit& edit, std::size_t first, const std::array<int, 3>& cell, std::size_t index)
  {
    std::array<std::size_t, 8> vertices;
    int insides = 0;
    for (std::size_t v = 0; v < 8; ++v)
    {
      vertices[v] = first + (v & 1U ? edit.GetSteps()[0] : 0) + (v & 2U ? edit.GetSteps()[1] : 0) +
        (v & 4U ? edit.GetSteps()[2] : 0);
      insides += this->Inside[vertices[v]] ? 1 : 0;
    }
    if (insides == 0)
    {
      return;
    }
    if (insides < 8)
    {
      for (const std::size_t vertex : vertices)
      {
        this->Marked[vertex] = true;
      }
    }
    const BrickEdit::CellTetrahedra tetrahedra = edit.GetTetrahedra(cell[0], cell[1], cell[2]);
    for (int t = 0; t < 5; ++t)
    {
      const auto& of = tetrahedra[static_cast<std::size_t>(t)];
      if (std::all_of(of.begin(), of.end(), [this](std::size_t v) { return this->Inside[v]; }))
      {
        edit.Hit(index, t);
      }
    }
  }

  float Far;
  std::size_t Count = 0;
  std::array<bool, BrickEdit::MaxVertices> Inside{};
  std::array<bool, BrickEdit::MaxVertices> Marked{};
};

/// Returns the distance with the smaller absolute value. A vertex of several bricks may have a cell
/// that the boundary passes through in only one of these bricks, and is far from the boundary in
/// the other bricks.
float CombineCarvedDistances(float last, float next)
{
  return std::abs(next) <= std::abs(last) ? next : last;
}

} // namespace

SmoothCarving FindSmoothCarving(const VertexPositions& positions, const CarvingTool& tool,
  float far, const EditProgress& progress)
{
  DistanceGatherer gatherer(positions.GetBricks().GetVertices(), far, CombineCarvedDistances);
  SmoothCarving carving;
  carving.Tetrahedra = BrickEdit::ForEachBrick(
    positions.GetBricks().GetNumberOfBricks(),
    [&](std::size_t brick, BrickEdit& edit)
    {
      if (FindContainment(positions.GetBox(brick), tool) == CarvingContainment::Nothing)
      {
        return;
      }
      edit.Set(positions, brick);
      const std::size_t count = edit.GetNumberOfVertices();
      std::array<glm::dvec3, BrickEdit::MaxVertices> points;
      edit.CopyPoints(points);
      std::array<double, BrickEdit::MaxVertices> values;
      tool.Function(points.data(), count, values.data());
      std::array<bool, BrickEdit::MaxVertices> inside{};
      for (std::size_t i = 0; i < count; ++i)
      {
        inside[i] = edit.HasPosition(i) && values[i] < 0.0;
      }
      CarvedBrick boundary(far);
      if (!boundary.Mark(edit, inside))
      {
        return;
      }
      const std::vector<std::size_t> marked = boundary.GetMarked();
      for (std::size_t k = 0; k < marked.size(); ++k)
      {
        points[k] = points[marked[k]];
        values[k] = values[marked[k]];
      }
      if (tool.Distance)
      {
        tool.Distance(points.data(), marked.size(), values.data());
      }
      gatherer.Add(edit.GetVertices(), boundary.Join(marked, values.data()).data());
    },
    progress);
  carving.Distances = gatherer.Take();
  return carving;
}

} // namespace deformvolume
