// SPDX-License-Identifier: BSD-3-Clause
#include "BrickPoints.h"

#include "ParallelFor.h"
#include "Processors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformvolume
{

// The nodes that move the vertices of a brick, and the largest excess of their weights
// (GetNegativeWeightSum()).
struct BrickPoints::BrickNodes
{
  std::vector<std::int32_t> Nodes;
  double NegativeWeightSum = 0.0;

  // Adds the weights of the first three nodes of a vertex.
  template <typename T>
  void AddWeights(T a, T b, T c)
  {
    const double excess = std::max(0.0, -double(a)) + std::max(0.0, -double(b)) +
      std::max(0.0, -double(c)) + std::max(0.0, double(a) + double(b) + double(c) - 1.0);
    // The negated comparison is true for NaN, too.
    if (!(excess <= this->NegativeWeightSum))
    {
      this->NegativeWeightSum =
        std::isfinite(excess) ? excess : std::numeric_limits<double>::infinity();
    }
  }
};

namespace
{

template <typename Use>
void ForNodes(const Tetrahedron& nodeOffsets, Use&& use)
{
  for (const std::int32_t nodeOffset : nodeOffsets)
  {
    use(nodeOffset / DEFORMVOLUME_NODE_STRIDE);
  }
}

// Tests whether an element is new to a brick. Stores for each element the number of the last brick
// to which the element was added, plus 1.
class BrickMarks
{
public:
  explicit BrickMarks(std::size_t count)
    : Last(count)
  {
  }
  bool Add(std::int32_t element, std::size_t brick)
  {
    std::uint32_t& last = this->Last[static_cast<std::size_t>(element)];
    const auto mark = static_cast<std::uint32_t>(brick + 1);
    const bool isNew = last != mark;
    last = mark;
    return isNew;
  }

private:
  std::vector<std::uint32_t> Last;
};

} // namespace

void BrickPoints::Append(const BrickNodes& brickNodes)
{
  this->Begins.push_back(this->Ranges.size());
  for (const std::int32_t node : brickNodes.Nodes)
  {
    if (this->Ranges.size() > this->Begins.back() && this->Ranges.back().End == node)
    {
      ++this->Ranges.back().End;
    }
    else
    {
      this->Ranges.push_back({ node, node + 1 });
    }
  }
  this->Ends.push_back(this->Ranges.size());
  this->NegativeWeightSum.push_back(brickNodes.NegativeWeightSum);
}

// visit(vertices, brickNodes, add) must call add(tetrahedron) for each tetrahedron to which
// vertices are linked.
template <typename Visit>
void BrickPoints::Collect(const BrickGrid& grid, const Mesh& mesh, Visit&& visit)
{
  const std::size_t bricks = grid.GetNumberOfBricks();
  std::vector<BrickNodes> found(bricks);
  const std::size_t parts = std::min(static_cast<std::size_t>(GetProcessorShare()), bricks);
  const auto collect = [&](std::size_t part)
  {
    BrickMarks tetrahedra(mesh.NumberOfTetrahedra);
    BrickMarks nodes(mesh.NumberOfNodes);
    for (std::size_t brick = part; brick < bricks; brick += parts)
    {
      BrickNodes& brickNodes = found[brick];
      brickNodes.Nodes.reserve(64);
      const auto add = [&](std::int32_t tetrahedron)
      {
        if (tetrahedra.Add(tetrahedron, brick))
        {
          ForNodes(mesh.Tetrahedra[tetrahedron],
            [&](std::int32_t node)
            {
              if (nodes.Add(node, brick))
              {
                brickNodes.Nodes.push_back(node);
              }
            });
        }
      };
      visit(grid.GetVertices(brick, grid.Halo), brickNodes, add);
      if (!mesh.Boundary.empty())
      {
        std::for_each(mesh.Boundary[brick].begin(), mesh.Boundary[brick].end(), add);
      }
      std::sort(brickNodes.Nodes.begin(), brickNodes.Nodes.end());
    }
  };
  ParallelForItems(parts, 1, collect);
  for (const BrickNodes& nodes : found)
  {
    this->Append(nodes);
  }
}

BrickPoints BrickPoints::FromLinks(const BrickGrid& grid, const VertexLink* links, const Mesh& mesh)
{
  BrickPoints points;
  points.Collect(grid, mesh,
    [&](const Extent& vertices, BrickNodes& brickNodes, const auto& add)
    {
      for (std::int64_t z = vertices[4]; z <= vertices[5]; ++z)
      {
        for (std::int64_t y = vertices[2]; y <= vertices[3]; ++y)
        {
          const VertexLink* row = links + (z * grid.Size[1] + y) * grid.Size[0];
          for (int x = vertices[0]; x <= vertices[1]; ++x)
          {
            if (row[x].Tetrahedron >= 0)
            {
              add(row[x].Tetrahedron);
              brickNodes.AddWeights(row[x].Weights[0], row[x].Weights[1], row[x].Weights[2]);
            }
          }
        }
      }
    });
  return points;
}

BrickPoints BrickPoints::FromRuns(const BrickGrid& grid, const Runs& runs, const Mesh& mesh)
{
  BrickPoints points;
  points.Collect(grid, mesh,
    [&](const Extent& vertices, BrickNodes& brickNodes, const auto& add)
    {
      for (std::int64_t z = vertices[4]; z <= vertices[5]; ++z)
      {
        for (std::int64_t y = vertices[2]; y <= vertices[3]; ++y)
        {
          const std::uint32_t* const range = runs.RowRanges + 2 * (z * grid.Size[1] + y);
          const VertexRun* const pastRun = runs.First + range[1];
          for (const VertexRun* run = runs.First + range[0]; run != pastRun; ++run)
          {
            const int end = run + 1 != pastRun ? run[1].Begin - 1 : grid.Size[0] - 1;
            const int first = std::max(run->Begin, vertices[0]);
            const int last = std::min(end, vertices[1]);
            if (run->Tetrahedron < 0 || first > last)
            {
              continue;
            }
            add(runs.Owners[run->Tetrahedron]);
            // Weights are affine along a run, so the extremes are at its ends.
            const double* record =
              runs.Rest + DEFORMVOLUME_REST_NUMBERS * static_cast<std::size_t>(run->Tetrahedron);
            for (const int x : { first, last })
            {
              const double offset[3] = { x - record[0], double(y) - record[1],
                double(z) - record[2] };
              double weights[3];
              for (int k = 0; k < 3; ++k)
              {
                const double* gradient = record + 6 + 3 * k;
                weights[k] = record[3 + k] + gradient[0] * offset[0] + gradient[1] * offset[1] +
                  gradient[2] * offset[2];
              }
              brickNodes.AddWeights(weights[0], weights[1], weights[2]);
            }
          }
        }
      }
    });
  return points;
}

BrickPoints BrickPoints::FromField(
  const BrickGrid& grid, const FieldParameters& field, const std::vector<Extent>& boundary)
{
  BrickPoints points;
  std::copy_n(field.Dimensions, 3, points.FieldSize.begin());
  points.Fades = field.Fading[0] > 0.0F;
  for (std::size_t brick = 0; brick < grid.GetNumberOfBricks(); ++brick)
  {
    const Extent vertices = grid.GetVertices(brick, grid.Halo);
    Extent box;
    for (int axis = 0; axis < 3; ++axis)
    {
      const float* row = field.IndexToField + 4 * axis;
      double low = row[3];
      double high = row[3];
      for (int k = 0; k < 3; ++k)
      {
        const double ends[2] = { double(row[k]) * (vertices[2 * k] + field.First[k]),
          double(row[k]) * (vertices[2 * k + 1] + field.First[k]) };
        low += std::min(ends[0], ends[1]);
        high += std::max(ends[0], ends[1]);
      }
      // The device computes positions in single precision. For fields that fit into memory, the
      // error is below this margin.
      constexpr double margin = 0.25;
      const double end = field.Dimensions[axis] - 1;
      box[2 * axis] = static_cast<int>(std::min(std::max(std::floor(low - margin), 0.0), end));
      box[2 * axis + 1] = static_cast<int>(std::min(std::max(std::ceil(high + margin), 0.0), end));
    }
    if (!boundary.empty() && GetNumberOfPoints(boundary[brick]) > 0)
    {
      Include(box, boundary[brick]);
    }
    points.Boxes.push_back(box);
  }
  return points;
}

} // namespace deformvolume
