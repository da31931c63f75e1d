// SPDX-License-Identifier: BSD-3-Clause
#include "DeformedPositions.h"

#include "Error.h"
#include "IndexBounds.h"
#include "ParallelFor.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace deformvolume
{
namespace
{

constexpr double FieldTolerance = 1e-3; // of a field cell, as in DeformationMapping.cl

// Rows of a mesh, with local indices.
class MeshRows
{
public:
  MeshRows(const Extent& vertices, const StaticMapping& mapping,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements)
    : Vertices(vertices)
    , Mapping(mapping)
    , Tetrahedra(tetrahedra)
    , Displacements(displacements)
  {
  }

  void operator()(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const
  {
    const std::int64_t row =
      (z - this->Vertices[4]) * GetSize(this->Vertices, 1) + y - this->Vertices[2];
    const int first = x - this->Vertices[0];
    if (this->Mapping.Links.empty())
    {
      this->FollowRuns(static_cast<std::size_t>(row), first, y - this->Vertices[2],
        z - this->Vertices[4], count, displacements, hasPosition);
      return;
    }
    const VertexLink* link = this->Mapping.Links.data() + row * GetSize(this->Vertices, 0) + first;
    for (int i = 0; i < count; ++i, ++link)
    {
      hasPosition[i] = link->Tetrahedron >= 0;
      if (hasPosition[i])
      {
        const float* weights = link->Weights;
        displacements[i] = this->Mix(static_cast<std::size_t>(link->Tetrahedron),
          glm::dvec3(weights[0], weights[1], weights[2]));
      }
    }
  }

private:
  glm::dvec3 Mix(std::size_t tetrahedron, const glm::dvec3& weights) const
  {
    const Tetrahedron& nodes = this->Tetrahedra[tetrahedron];
    const glm::dvec3 last = GetVector(this->Displacements, nodes[3]);
    glm::dvec3 mixed = last;
    for (int k = 0; k < 3; ++k)
    {
      mixed += weights[k] * (GetVector(this->Displacements, nodes[k]) - last);
    }
    return mixed;
  }

  void FollowRuns(std::size_t row, int first, int y, int z, int count, glm::dvec3* displacements,
    bool* hasPosition) const
  {
    const VertexRuns& runs = this->Mapping.Runs;
    const VertexRun* const end = runs.Runs.data() + runs.RowBegins[row + 1];
    const VertexRun* run = std::upper_bound(runs.Runs.data() + runs.RowBegins[row], end, first,
                             [](int x, const VertexRun& other) { return x < other.Begin; }) -
      1;
    for (int i = 0; i < count; ++i)
    {
      while (run + 1 != end && run[1].Begin <= first + i)
      {
        ++run;
      }
      hasPosition[i] = run->Tetrahedron >= 0;
      if (!hasPosition[i])
      {
        continue;
      }
      const RestTetrahedron& rest = runs.Tetrahedra[static_cast<std::size_t>(run->Tetrahedron)];
      glm::dvec3 weights;
      for (int k = 0; k < 3; ++k)
      {
        const std::array<double, 3>& gradient = rest.Gradients[k];
        weights[k] = rest.Weights[k] + gradient[0] * (first + i - rest.Origin[0]) +
          gradient[1] * (y - rest.Origin[1]) + gradient[2] * (z - rest.Origin[2]);
      }
      displacements[i] = this->Mix(static_cast<std::size_t>(rest.Tetrahedron), weights);
    }
  }

  const Extent Vertices;
  const StaticMapping& Mapping;
  const std::vector<Tetrahedron>& Tetrahedra;
  const float* Displacements;
};

// Rows of a field.
class FieldRows
{
public:
  explicit FieldRows(const DisplacementField& field)
    : Field(field)
  {
  }

  void operator()(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const
  {
    for (int i = 0; i < count; ++i)
    {
      hasPosition[i] = this->Find(glm::dvec3(x + i, y, z), displacements[i]);
    }
  }

private:
  bool Find(const glm::dvec3& vertex, glm::dvec3& displacement) const
  {
    std::array<std::int64_t, 3> low;
    std::array<double, 3> fraction;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double* row = &this->Field.IndexToField[4 * axis];
      const double place = row[0] * vertex.x + row[1] * vertex.y + row[2] * vertex.z + row[3];
      const double last = this->Field.Dimensions[axis] - 1;
      if (!this->Field.Extrapolate && !(place >= -FieldTolerance && place <= last + FieldTolerance))
      {
        return false;
      }
      const double inside = std::min(std::max(place, 0.0), last);
      low[axis] = static_cast<std::int64_t>(inside);
      fraction[axis] = inside - static_cast<double>(low[axis]);
    }
    displacement = glm::dvec3(0.0);
    for (int corner = 0; corner < 8; ++corner)
    {
      double weight = 1.0;
      std::int64_t point = 0;
      for (int axis = 2; axis >= 0; --axis)
      {
        const int upper = corner >> axis & 1;
        weight *= upper ? fraction[axis] : 1.0 - fraction[axis];
        point = point * this->Field.Dimensions[axis] + low[axis] + upper;
      }
      if (weight != 0.0) // else the point may be none
      {
        displacement += weight * GetVector(this->Field, point);
      }
    }
    return true;
  }

  const DisplacementField Field;
};

} // namespace

DeformedPositions::DeformedPositions(const Extent& vertices, const Extent& mapped,
  const StaticMapping& mapping, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements)
  : VertexPositions(vertices)
{
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(mapped));
  const auto rows = static_cast<std::size_t>(GetSize(mapped, 1) * GetSize(mapped, 2));
  bool isHeld = true;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    isHeld = isHeld && mapped[2 * axis] <= vertices[2 * axis] &&
      vertices[2 * axis + 1] <= mapped[2 * axis + 1];
  }
  if (!isHeld || (mapping.Links.size() != voxels && mapping.Runs.RowBegins.size() != rows + 1))
  {
    throw Error("The static mapping is not one of the voxels that are to be cut. Build it for "
                "their extent.");
  }
  this->FindRow = MeshRows(mapped, mapping, tetrahedra, displacements);
  this->FindBoxes();
}

DeformedPositions::DeformedPositions(const Extent& vertices, const DisplacementField& field)
  : VertexPositions(vertices)
  , FindRow(FieldRows(field))
{
  this->FindBoxes();
}

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
        // Extrapolation can lead anywhere, and a field may hold anything, not-a-number included.
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

void DeformedPositions::FindBoxes()
{
  const std::size_t bricks = this->GetBricks().GetNumberOfBricks();
  this->Boxes.resize(bricks);
  constexpr std::size_t step = 32;
  ParallelForParts(bricks, step,
    [this](std::size_t begin, std::size_t end)
    {
      std::array<SnappedPoint, 729> positions;
      std::array<bool, 729> hasPosition;
      for (std::size_t brick = begin; brick < end; ++brick)
      {
        const Extent vertices = this->GetBricks().GetVertices(brick);
        this->Find(vertices, positions.data(), hasPosition.data());
        const auto count = static_cast<std::size_t>(GetNumberOfPoints(vertices));
        for (std::size_t i = 0; i < count; ++i)
        {
          if (hasPosition[i])
          {
            this->Boxes[brick].Add(positions[i]);
          }
        }
      }
    });
  for (const SnappedBox& box : this->Boxes)
  {
    this->Box.Add(box);
  }
}

} // namespace deformvolume
