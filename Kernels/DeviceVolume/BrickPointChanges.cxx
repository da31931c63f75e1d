// SPDX-License-Identifier: BSD-3-Clause
// The parts of BrickPoints for changes of the mesh and for sets of bricks.
#include "BrickPoints.h"

#include "ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <mutex>

namespace deformvolume
{

BrickPoints::PreviousNodes::PreviousNodes(const std::vector<TetrahedronChange>& changes)
{
  this->Users.reserve(4 * changes.size());
  for (std::size_t i = 0; i < changes.size(); ++i)
  {
    for (const std::int32_t node : changes[i].Before)
    {
      this->Users.emplace_back(node, static_cast<std::uint32_t>(i));
    }
  }
  std::sort(this->Users.begin(), this->Users.end());
  this->Users.erase(std::unique(this->Users.begin(), this->Users.end()), this->Users.end());
  this->NumbersOfNodes.resize(changes.size());
  this->Used.Clear(
    this->Users.empty() ? 0 : static_cast<std::size_t>(this->Users.back().first) + 1);
  for (const auto& user : this->Users)
  {
    ++this->NumbersOfNodes[user.second];
    this->Used.Add(static_cast<std::size_t>(user.first));
  }
}

std::vector<BrickPoints::ChangesOfBrick> BrickPoints::FindBricks(
  const PreviousNodes& nodes, const std::function<bool(std::size_t)>& isNear) const
{
  const std::size_t bricks = this->Begins.size();
  std::vector<ChangesOfBrick> found;
  std::mutex mutex;
  constexpr std::size_t step = 64;
  ParallelForParts(bricks, step,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<int> seen(nodes.NumbersOfNodes.size(), 0);
      for (std::size_t brick = begin; brick < end; ++brick)
      {
        if (!isNear(brick))
        {
          continue;
        }
        std::vector<std::size_t> touched;
        std::vector<std::size_t> whole;
        this->AnyRange(brick,
          [&](std::size_t first, std::size_t past)
          {
            // A fast test: most ranges have none of these nodes.
            if (!nodes.Used.HasAnyOf(first, past))
            {
              return false;
            }
            for (auto user = std::lower_bound(nodes.Users.begin(), nodes.Users.end(),
                   std::make_pair(static_cast<std::int32_t>(first), std::uint32_t{ 0 }));
                 user != nodes.Users.end() && static_cast<std::size_t>(user->first) < past; ++user)
            {
              touched.push_back(user->second);
              if (++seen[user->second] == nodes.NumbersOfNodes[user->second])
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
  const std::vector<ChangesOfBrick>& bricks, const std::vector<TetrahedronChange>& changes)
{
  this->Added.resize(this->Begins.size());
  std::atomic<std::size_t> number{ 0 };
  ParallelForItems(
    bricks.size(), 1, [&](std::size_t i) { number += this->AddPoints(bricks[i], changes); });
  this->NumberOfAdded += number;
}

std::size_t BrickPoints::AddPoints(
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
  std::vector<std::int32_t>& added = this->Added[brick.first];
  const auto first = this->Ranges.begin() + static_cast<std::ptrdiff_t>(this->Begins[brick.first]);
  const auto past = this->Ranges.begin() + static_cast<std::ptrdiff_t>(this->Ends[brick.first]);
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
    }
  }
  return added.size() - before;
}

BrickPoints BrickPoints::Join(const std::vector<std::vector<std::size_t>>& sets) const
{
  BrickPoints joined;
  if (!this->Boxes.empty())
  {
    joined.FieldSize = this->FieldSize;
    for (const std::vector<std::size_t>& bricks : sets)
    {
      Extent all = EmptyExtent;
      for (const std::size_t brick : bricks)
      {
        Include(all, this->Boxes[brick]);
      }
      joined.Boxes.push_back(all);
    }
    return joined;
  }
  for (const std::vector<std::size_t>& bricks : sets)
  {
    std::vector<Range> all;
    for (const std::size_t brick : bricks)
    {
      this->AnyRange(brick,
        [&](std::size_t begin, std::size_t end)
        {
          all.push_back({ static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end) });
          return false;
        });
    }
    std::sort(
      all.begin(), all.end(), [](const Range& a, const Range& b) { return a.Begin < b.Begin; });
    joined.Begins.push_back(joined.Ranges.size());
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
    joined.Ends.push_back(joined.Ranges.size());
  }
  return joined;
}

} // namespace deformvolume
