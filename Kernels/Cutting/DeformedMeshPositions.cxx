// SPDX-License-Identifier: BSD-3-Clause
#include "DeformedPositions.h"

#include "Error.h"
#include "ParallelFor.h"

#include <glm/common.hpp>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr std::size_t BricksPerPart = 32;

} // namespace

DeformedMeshPositions::DeformedMeshPositions(const Extent& vertices, const Extent& mapped,
  const StaticMapping& mapping, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements)
  : DeformedPositions(vertices)
  , Mapped(mapped)
  , Mapping(mapping)
  , Tetrahedra(tetrahedra)
{
  const CellBricks& bricks = this->GetBricks();
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(mapped));
  const auto rows = static_cast<std::size_t>(GetSize(mapped, 1) * GetSize(mapped, 2));
  bool isContained = true;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    isContained = isContained && mapped[2 * axis] <= vertices[2 * axis] &&
      vertices[2 * axis + 1] <= mapped[2 * axis + 1];
  }
  if (!isContained || (mapping.Links.size() != voxels && mapping.Runs.RowBegins.size() != rows + 1))
  {
    throw Error("The static mapping does not contain the voxels to cut. Build it for an extent "
                "that contains them.");
  }
  const std::size_t count = bricks.GetNumberOfBricks();
  this->NegativeWeightSums.resize(count);
  this->Begins.resize(count + 1);
  this->OfBricks = CollectItems<std::int32_t>(count, BricksPerPart,
    [&](std::size_t brick, std::vector<std::int32_t>& all)
    {
      const std::vector<std::int32_t> found =
        this->FindTetrahedra(bricks.GetVertices(brick), this->NegativeWeightSums[brick]);
      all.insert(all.end(), found.begin(), found.end());
      this->Begins[brick + 1] = found.size();
    });
  std::partial_sum(this->Begins.begin(), this->Begins.end(), this->Begins.begin());
  this->SetDisplacements(displacements);
}

// Calls function(i, tetrahedron, weights) for the vertices of a row that lie in a tetrahedron.
// ends: if the mapping has runs, only calls the function for the first and the last vertex of each
// run, because all other vertices of the run lie between these two.
template <typename Function>
void DeformedMeshPositions::FollowRow(
  int x, int y, int z, int count, bool ends, Function&& function) const
{
  const int first = x - this->Mapped[0];
  const int up = y - this->Mapped[2];
  const int over = z - this->Mapped[4];
  const auto row =
    static_cast<std::size_t>(over * GetSize(this->Mapped, 1) + static_cast<std::int64_t>(up));
  if (!this->Mapping.Links.empty())
  {
    const VertexLink* link =
      this->Mapping.Links.data() + row * static_cast<std::size_t>(GetSize(this->Mapped, 0)) + first;
    for (int i = 0; i < count; ++i, ++link)
    {
      if (link->Tetrahedron >= 0)
      {
        const float* weights = link->Weights;
        function(i, link->Tetrahedron, glm::dvec3(weights[0], weights[1], weights[2]));
      }
    }
    return;
  }
  const VertexRuns& runs = this->Mapping.Runs;
  const VertexRun* const end = runs.Runs.data() + runs.RowBegins[row + 1];
  const VertexRun* run = std::upper_bound(runs.Runs.data() + runs.RowBegins[row], end, first,
                           [](int at, const VertexRun& other) { return at < other.Begin; }) -
    1;
  for (int i = 0; i < count; ++run)
  {
    const int next = run + 1 != end ? std::min(run[1].Begin - first, count) : count;
    if (run->Tetrahedron < 0)
    {
      i = next;
      continue;
    }
    const RestTetrahedron& rest = runs.Tetrahedra[static_cast<std::size_t>(run->Tetrahedron)];
    for (const int step = ends ? std::max(next - 1 - i, 1) : 1; i < next; i += step)
    {
      glm::dvec3 weights;
      for (int k = 0; k < 3; ++k)
      {
        const std::array<double, 3>& gradient = rest.Gradients[k];
        weights[k] = rest.Weights[k] + gradient[0] * (first + i - rest.Origin[0]) +
          gradient[1] * (up - rest.Origin[1]) + gradient[2] * (over - rest.Origin[2]);
      }
      function(i, rest.Tetrahedron, weights);
    }
    i = next;
  }
}

std::vector<std::int32_t> DeformedMeshPositions::FindTetrahedra(
  const Extent& vertices, float& overshoot) const
{
  std::vector<std::int32_t> tetrahedra;
  double most = 0.0;
  for (int z = vertices[4]; z <= vertices[5]; ++z)
  {
    for (int y = vertices[2]; y <= vertices[3]; ++y)
    {
      this->FollowRow(vertices[0], y, z, static_cast<int>(GetSize(vertices, 0)), true,
        [&](int, std::int32_t tetrahedron, const glm::dvec3& weights)
        {
          const glm::dvec3 negative = glm::max(-weights, glm::dvec3(0.0));
          const double last = 1.0 - weights.x - weights.y - weights.z;
          most = std::max(most, negative.x + negative.y + negative.z + std::max(-last, 0.0));
          if (tetrahedra.empty() || tetrahedra.back() != tetrahedron)
          {
            tetrahedra.push_back(tetrahedron);
          }
        });
    }
  }
  std::sort(tetrahedra.begin(), tetrahedra.end());
  tetrahedra.erase(std::unique(tetrahedra.begin(), tetrahedra.end()), tetrahedra.end());
  constexpr double rounding = 1e-6; // a generous bound for rounding of doubles
  overshoot = static_cast<float>(most * (1.0 + rounding) + rounding);
  return tetrahedra;
}

void DeformedMeshPositions::SetDisplacements(const float* displacements)
{
  this->Displacements = displacements;
  this->Limits.resize(this->Tetrahedra.size());
  constexpr std::size_t step = 8192;
  ParallelForItems(this->Tetrahedra.size(), step,
    [this](std::size_t tetrahedron)
    {
      NodeLimits& box = this->Limits[tetrahedron];
      for (std::size_t k = 0; k < 4; ++k)
      {
        const float* node = this->Displacements + 3 * this->Tetrahedra[tetrahedron][k];
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          box.Min[axis] = k == 0 ? node[axis] : std::min(box.Min[axis], node[axis]);
          box.Max[axis] = k == 0 ? node[axis] : std::max(box.Max[axis], node[axis]);
        }
      }
    });
  this->FindBoxes({});
}

void DeformedMeshPositions::FindRow(
  int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const
{
  std::fill_n(hasPosition, count, false);
  this->FollowRow(x, y, z, count, false,
    [&](int i, std::int32_t tetrahedron, const glm::dvec3& weights)
    {
      const Tetrahedron& nodes = this->Tetrahedra[static_cast<std::size_t>(tetrahedron)];
      const glm::dvec3 last = GetVector(this->Displacements, nodes[3]);
      glm::dvec3 mixed = last;
      for (int k = 0; k < 3; ++k)
      {
        mixed += weights[k] * (GetVector(this->Displacements, nodes[k]) - last);
      }
      displacements[i] = mixed;
      hasPosition[i] = true;
    });
}

DisplacementLimits DeformedMeshPositions::GetLimits(std::size_t brick) const
{
  DisplacementLimits limits;
  for (std::size_t i = this->Begins[brick]; i < this->Begins[brick + 1]; ++i)
  {
    const NodeLimits& box = this->Limits[static_cast<std::size_t>(this->OfBricks[i])];
    limits.Add(glm::dvec3(box.Min[0], box.Min[1], box.Min[2]));
    limits.Add(glm::dvec3(box.Max[0], box.Max[1], box.Max[2]));
  }
  if (!limits.IsEmpty())
  {
    const glm::dvec3 beyond =
      static_cast<double>(this->NegativeWeightSums[brick]) * (limits.Max - limits.Min);
    limits.Min -= beyond;
    limits.Max += beyond;
  }
  return limits;
}

} // namespace deformvolume
