// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronMatching.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace deformvolume
{

namespace
{

constexpr std::size_t MostReplaced = 8; // one tetrahedron in so many
constexpr std::size_t FewInPlace = 64;  // so many in place are a match without a search
constexpr std::int32_t None = -1;

using Tetrahedra = std::vector<Tetrahedron>;

// Adds a pair that are the same, behind all others.
void AddPair(std::size_t before, std::size_t after, std::vector<KeptTetrahedra>& kept)
{
  const auto first = static_cast<std::int32_t>(before);
  const auto second = static_cast<std::int32_t>(after);
  if (!kept.empty() && kept.back().Before + kept.back().Count == first &&
    kept.back().After + kept.back().Count == second)
  {
    ++kept.back().Count;
    return;
  }
  kept.push_back({ first, second, 1 });
}

// Finds tetrahedra by their nodes: each once, equal ones in ascending order.
class TetrahedronTable
{
public:
  TetrahedronTable(const Tetrahedra& tetrahedra, std::size_t begin, std::size_t end)
    : All(tetrahedra)
  {
    std::size_t size = 16;
    while (size < 2 * (end - begin))
    {
      size *= 2;
    }
    this->Places.resize(size, None);
    this->IsTaken.resize(size);
    for (std::size_t t = begin; t < end; ++t)
    {
      std::size_t place = this->GetPlace(tetrahedra[t]);
      while (this->Places[place] != None)
      {
        place = (place + 1) % size;
      }
      this->Places[place] = static_cast<std::int32_t>(t);
    }
  }

  std::int32_t Take(const Tetrahedron& tetrahedron)
  {
    std::size_t place = this->GetPlace(tetrahedron);
    for (; this->Places[place] != None; place = (place + 1) % this->Places.size())
    {
      if (!this->IsTaken[place] && this->All[this->Places[place]] == tetrahedron)
      {
        this->IsTaken[place] = 1;
        return this->Places[place];
      }
    }
    return None;
  }

private:
  std::size_t GetPlace(const Tetrahedron& tetrahedron) const
  {
    std::uint64_t hash = 0;
    for (const std::int32_t node : tetrahedron)
    {
      hash = (hash ^ static_cast<std::uint32_t>(node)) * 0x9E3779B97F4A7C15U;
      hash ^= hash >> 29;
    }
    return static_cast<std::size_t>(hash) % this->Places.size();
  }

  const Tetrahedra& All;
  std::vector<std::int32_t> Places;
  std::vector<unsigned char> IsTaken;
};

// Of numbers, some of which are none, the places of a longest sequence that ascends.
std::vector<std::size_t> FindLongestAscent(const std::vector<std::int32_t>& numbers)
{
  // For each length the place where a sequence of it ends lowest, and for each place the one
  // before it in the longest sequence that ends there.
  std::vector<std::size_t> ends;
  std::vector<std::size_t> previous(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
  {
    if (numbers[i] == None)
    {
      continue;
    }
    const auto end = std::lower_bound(ends.begin(), ends.end(), numbers[i],
      [&](std::size_t place, std::int32_t number) { return numbers[place] < number; });
    previous[i] = end == ends.begin() ? i : *(end - 1);
    if (end == ends.end())
    {
      ends.push_back(i);
    }
    else
    {
      *end = i;
    }
  }
  std::vector<std::size_t> ascent(ends.size());
  std::size_t place = ends.empty() ? 0 : ends.back();
  for (std::size_t i = ascent.size(); i > 0; --i)
  {
    ascent[i - 1] = place;
    place = previous[place];
  }
  return ascent;
}

} // namespace

std::optional<std::vector<KeptTetrahedra>> MatchTetrahedra(
  const Tetrahedra& before, const Tetrahedra& after)
{
  const std::size_t least = std::min(before.size(), after.size());
  const auto begin =
    static_cast<std::size_t>(std::mismatch(before.begin(),
                               before.begin() + static_cast<std::ptrdiff_t>(least), after.begin())
                               .first -
      before.begin());
  std::size_t tail = 0;
  while (tail < least - begin && before[before.size() - 1 - tail] == after[after.size() - 1 - tail])
  {
    ++tail;
  }
  const std::size_t beforeEnd = before.size() - tail;
  const std::size_t afterEnd = after.size() - tail;
  std::vector<KeptTetrahedra> kept;
  if (begin > 0)
  {
    kept.push_back({ 0, 0, static_cast<std::int32_t>(begin) });
  }
  const std::size_t shared = std::min(beforeEnd, afterEnd);
  std::size_t different = 0;
  for (std::size_t t = begin; t < shared; ++t)
  {
    different += before[t] != after[t] ? 1 : 0;
  }
  if (FewInPlace * different <= shared - begin)
  {
    for (std::size_t t = begin; t < shared; ++t)
    {
      if (before[t] == after[t])
      {
        AddPair(t, t, kept);
      }
    }
  }
  else
  {
    TetrahedronTable table(after, begin, afterEnd);
    std::vector<std::int32_t> found;
    for (std::size_t t = begin; t < beforeEnd; ++t)
    {
      found.push_back(table.Take(before[t]));
    }
    for (const std::size_t place : FindLongestAscent(found))
    {
      AddPair(begin + place, static_cast<std::size_t>(found[place]), kept);
    }
  }
  for (std::size_t t = 0; t < tail; ++t)
  {
    AddPair(beforeEnd + t, afterEnd + t, kept);
  }
  std::size_t count = 0;
  for (const KeptTetrahedra& some : kept)
  {
    count += static_cast<std::size_t>(some.Count);
  }
  if (before.size() + after.size() - 2 * count > before.size() / MostReplaced)
  {
    return {};
  }
  return kept;
}

} // namespace deformvolume
