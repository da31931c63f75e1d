// SPDX-License-Identifier: BSD-3-Clause
#include "BrickPoints.h"

#include "ParallelFor.h"
#include "PointSet.h"
#include "Processors.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <mutex>

namespace deformvolume
{
namespace
{

// What a brick's vertices are found to need.
struct Needs
{
  std::vector<std::int32_t> Nodes;
  double Excess = 0.0;

  // Weights of the first three nodes of a vertex.
  template <typename T>
  void AddWeights(T a, T b, T c)
  {
    const double excess = std::max(0.0, -double(a)) + std::max(0.0, -double(b)) +
      std::max(0.0, -double(c)) + std::max(0.0, double(a) + double(b) + double(c) - 1.0);
    // The negation catches NaN as well.
    if (!(excess <= this->Excess))
    {
      this->Excess = std::isfinite(excess) ? excess : std::numeric_limits<double>::infinity();
    }
  }
};

} // namespace

// visit(vertices, needs, add): calls add(tetrahedron) for those that the vertices are linked to.
template <typename Visit>
void BrickPoints::Collect(const BrickGrid& grid, const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes, Visit&& visit)
{
  const std::size_t bricks = grid.GetNumberOfBricks();
  std::vector<Needs> needs(bricks);
  const std::size_t parts = std::min(static_cast<std::size_t>(GetProcessorShare()), bricks);
  // For each part the last brick, plus 1, that had a tetrahedron or a node.
  std::vector<std::vector<std::uint32_t>> seenTetrahedra(
    parts, std::vector<std::uint32_t>(numberOfTetrahedra));
  std::vector<std::vector<std::uint32_t>> seenNodes(
    parts, std::vector<std::uint32_t>(numberOfNodes));
  for (std::size_t brick = 0; brick < bricks; ++brick)
  {
    needs[brick].Nodes.reserve(64);
  }
  const auto collect = [&](std::size_t part)
  {
    for (std::size_t brick = part; brick < bricks; brick += parts)
    {
      const auto mark = static_cast<std::uint32_t>(brick + 1);
      const auto add = [&](std::int32_t tetrahedron)
      {
        if (seenTetrahedra[part][tetrahedron] != mark)
        {
          seenTetrahedra[part][tetrahedron] = mark;
          for (const std::int32_t place : tetrahedra[tetrahedron])
          {
            const std::int32_t node = place / DEFORMVOLUME_NODE_PLACES;
            if (seenNodes[part][node] != mark)
            {
              seenNodes[part][node] = mark;
              needs[brick].Nodes.push_back(node);
            }
          }
        }
      };
      visit(grid.GetVertices(brick, BrickReach), needs[brick], add);
    }
  };
  ParallelForParts(parts, 1, [&](std::size_t part, std::size_t) { collect(part); });
  this->Begins.assign(1, 0);
  for (Needs& need : needs)
  {
    std::sort(need.Nodes.begin(), need.Nodes.end());
    for (const std::int32_t node : need.Nodes)
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
    this->Begins.push_back(this->Ranges.size());
    this->Excess.push_back(need.Excess);
  }
}

BrickPoints BrickPoints::FromLinks(const BrickGrid& grid, const VertexLink* links,
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
{
  BrickPoints points;
  points.Collect(grid, tetrahedra, numberOfTetrahedra, numberOfNodes,
    [&](const Extent& vertices, Needs& needs, const auto& add)
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
              needs.AddWeights(row[x].Weights[0], row[x].Weights[1], row[x].Weights[2]);
            }
          }
        }
      }
    });
  return points;
}

BrickPoints BrickPoints::FromRuns(const BrickGrid& grid, const VertexRun* runs,
  const std::uint32_t* rowBegins, const double* rest, const std::int32_t* owners,
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
{
  BrickPoints points;
  points.Collect(grid, tetrahedra, numberOfTetrahedra, numberOfNodes,
    [&](const Extent& vertices, Needs& needs, const auto& add)
    {
      for (std::int64_t z = vertices[4]; z <= vertices[5]; ++z)
      {
        for (std::int64_t y = vertices[2]; y <= vertices[3]; ++y)
        {
          const std::int64_t row = z * grid.Size[1] + y;
          for (std::uint32_t r = rowBegins[row]; r < rowBegins[row + 1]; ++r)
          {
            const int end = r + 1 < rowBegins[row + 1] ? runs[r + 1].Begin - 1 : grid.Size[0] - 1;
            const int first = std::max(runs[r].Begin, vertices[0]);
            const int last = std::min(end, vertices[1]);
            if (runs[r].Tetrahedron < 0 || first > last)
            {
              continue;
            }
            add(owners[runs[r].Tetrahedron]);
            // Along a run weights are affine: the extremes are at its ends.
            const double* record = rest + 15 * static_cast<std::size_t>(runs[r].Tetrahedron);
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
              needs.AddWeights(weights[0], weights[1], weights[2]);
            }
          }
        }
      }
    });
  return points;
}

BrickPoints BrickPoints::FromField(const BrickGrid& grid, const FieldParameters& field)
{
  BrickPoints points;
  std::copy_n(field.Dimensions, 3, points.FieldSize.begin());
  for (std::size_t brick = 0; brick < grid.GetNumberOfBricks(); ++brick)
  {
    const Extent vertices = grid.GetVertices(brick, BrickReach);
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
      // The device finds the place with the precision of float: a quarter of a cell is more than it
      // misses, for the fields that fit into memory.
      constexpr double margin = 0.25;
      const double end = field.Dimensions[axis] - 1;
      box[2 * axis] = static_cast<int>(std::min(std::max(std::floor(low - margin), 0.0), end));
      box[2 * axis + 1] = static_cast<int>(std::min(std::max(std::ceil(high + margin), 0.0), end));
    }
    points.Boxes.push_back(box);
  }
  return points;
}

std::vector<BrickPoints::ChangesOfBrick> BrickPoints::FindBricks(
  const std::vector<TetrahedronChange>& changes,
  const std::function<bool(std::size_t)>& isNear) const
{
  // Which of the changes each node had a part in, and how many nodes each change has.
  std::vector<std::pair<std::int32_t, std::uint32_t>> users;
  users.reserve(4 * changes.size());
  for (std::size_t i = 0; i < changes.size(); ++i)
  {
    for (const std::int32_t node : changes[i].Before)
    {
      users.emplace_back(node, static_cast<std::uint32_t>(i));
    }
  }
  std::sort(users.begin(), users.end());
  users.erase(std::unique(users.begin(), users.end()), users.end());
  std::vector<int> nodesOfChange(changes.size(), 0);
  PointSet used;
  used.Clear(users.empty() ? 0 : static_cast<std::size_t>(users.back().first) + 1);
  for (const auto& user : users)
  {
    ++nodesOfChange[user.second];
    used.Add(static_cast<std::size_t>(user.first));
  }
  const std::size_t bricks = this->Begins.size() - 1;
  std::vector<ChangesOfBrick> found;
  std::mutex mutex;
  constexpr std::size_t step = 256;
  ParallelForParts(bricks, step,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<int> seen(changes.size(), 0);
      for (std::size_t brick = begin; brick < end; ++brick)
      {
        if (!isNear(brick))
        {
          continue;
        }
        std::vector<std::size_t> touched;
        std::vector<std::size_t> whole;
        this->AnyOf(brick,
          [&](std::size_t first, std::size_t past)
          {
            // Most ranges have none of these nodes.
            if (!used.HasAnyOf(first, past))
            {
              return false;
            }
            for (auto user = std::lower_bound(users.begin(), users.end(),
                   std::make_pair(static_cast<std::int32_t>(first), std::uint32_t{ 0 }));
                 user != users.end() && static_cast<std::size_t>(user->first) < past; ++user)
            {
              touched.push_back(user->second);
              if (++seen[user->second] == nodesOfChange[user->second])
              {
                whole.push_back(user->second);
              }
            }
            return false;
          });
        for (const std::size_t change : touched)
        {
          seen[change] = 0;
        }
        if (!whole.empty())
        {
          const std::lock_guard<std::mutex> lock(mutex);
          found.emplace_back(brick, std::move(whole));
        }
      }
    });
  return found;
}

void BrickPoints::AddPoints(
  const ChangesOfBrick& brick, const std::vector<TetrahedronChange>& changes)
{
  std::vector<std::int32_t> nodes;
  for (const std::size_t i : brick.second)
  {
    const TetrahedronChange& change = changes[i];
    std::copy_if(change.After.begin(), change.After.end(), std::back_inserter(nodes),
      [&](std::int32_t node) {
        return std::find(change.Before.begin(), change.Before.end(), node) == change.Before.end();
      });
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  this->Added.resize(this->Begins.size() - 1);
  std::vector<std::int32_t>& added = this->Added[brick.first];
  const auto first = this->Ranges.begin() + static_cast<std::ptrdiff_t>(this->Begins[brick.first]);
  const auto past =
    this->Ranges.begin() + static_cast<std::ptrdiff_t>(this->Begins[brick.first + 1]);
  const std::size_t before = added.size();
  for (const std::int32_t node : nodes)
  {
    const auto range = std::upper_bound(
      first, past, node, [](std::int32_t point, const Range& other) { return point < other.End; });
    const bool isThere = (range != past && range->Begin <= node) ||
      std::find(added.begin(), added.begin() + static_cast<std::ptrdiff_t>(before), node) !=
        added.begin() + static_cast<std::ptrdiff_t>(before);
    if (!isThere)
    {
      added.push_back(node);
      ++this->NumberOfAdded;
    }
  }
}

BrickPoints BrickPoints::Join(
  const std::vector<std::size_t>& groups, std::size_t numberOfGroups) const
{
  BrickPoints joined;
  if (!this->Boxes.empty())
  {
    joined.FieldSize = this->FieldSize;
    joined.Boxes.resize(numberOfGroups, Extent{ { 0, -1, 0, -1, 0, -1 } });
    for (std::size_t brick = 0; brick < groups.size(); ++brick)
    {
      Include(joined.Boxes[groups[brick]], this->Boxes[brick]);
    }
    return joined;
  }
  std::vector<std::vector<Range>> ranges(numberOfGroups);
  for (std::size_t brick = 0; brick < groups.size(); ++brick)
  {
    std::vector<Range>& all = ranges[groups[brick]];
    all.insert(all.end(), this->Ranges.begin() + static_cast<std::ptrdiff_t>(this->Begins[brick]),
      this->Ranges.begin() + static_cast<std::ptrdiff_t>(this->Begins[brick + 1]));
  }
  joined.Begins.assign(1, 0);
  for (std::vector<Range>& all : ranges)
  {
    std::sort(
      all.begin(), all.end(), [](const Range& a, const Range& b) { return a.Begin < b.Begin; });
    for (const Range& range : all)
    {
      if (joined.Ranges.size() > joined.Begins.back() && joined.Ranges.back().End >= range.Begin)
      {
        joined.Ranges.back().End = std::max(joined.Ranges.back().End, range.End);
      }
      else
      {
        joined.Ranges.push_back(range);
      }
    }
    joined.Begins.push_back(joined.Ranges.size());
  }
  return joined;
}

} // namespace deformvolume
