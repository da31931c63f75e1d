// SPDX-License-Identifier: BSD-3-Clause
#include "FaceNeighbors.h"

#include "AbortCheck.h"
#include "CountedLists.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace deformvolume
{
namespace
{

// A face in the list of the faces with the same lowest node.
struct Entry
{
  std::int32_t Middle;
  std::int32_t Highest;
  std::uint32_t Face;

  bool operator<(const Entry& other) const
  {
    return std::tie(this->Middle, this->Highest, this->Face) <
      std::tie(other.Middle, other.Highest, other.Face);
  }
};

std::array<std::int32_t, 3> GetSortedNodes(const Tetrahedron& tetrahedron, std::size_t k)
{
  std::int32_t a = tetrahedron[k == 0 ? 1 : 0];
  std::int32_t b = tetrahedron[k <= 1 ? 2 : 1];
  std::int32_t c = tetrahedron[k <= 2 ? 3 : 2];
  std::tie(a, b) = std::minmax({ a, b });
  std::tie(b, c) = std::minmax({ b, c });
  std::tie(a, b) = std::minmax({ a, b });
  return { { a, b, c } };
}

} // namespace

FaceNeighbors::FaceNeighbors(
  const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes, AbortCheck* abortCheck)
  : Next(4 * tetrahedra.size())
{
  AbortCheck none(nullptr);
  AbortCheck& given = abortCheck ? *abortCheck : none;
  // Each node has a list of the faces of which it is the lowest node. The lists are short, so
  // sorting them is fast.
  std::vector<std::size_t> begins;
  std::vector<Entry> entries;
  Grow(given, entries, this->Next.size());
  MakeLists(
    numberOfNodes,
    [&](const auto& take)
    {
      ForItems(given, tetrahedra.size(),
        [&](std::size_t t)
        {
          for (std::size_t k = 0; k < 4; ++k)
          {
            const std::array<std::int32_t, 3> nodes = GetSortedNodes(tetrahedra[t], k);
            take(static_cast<std::size_t>(nodes[0]),
              Entry{ nodes[1], nodes[2], static_cast<std::uint32_t>(4 * t + k) });
          }
        });
    },
    begins, entries);
  ForItemsInParallel(given, numberOfNodes,
    [&](std::size_t node)
    {
      std::size_t begin = begins[node];
      const std::size_t end = begins[node + 1];
      std::sort(entries.begin() + static_cast<std::ptrdiff_t>(begin),
        entries.begin() + static_cast<std::ptrdiff_t>(end));
      for (std::size_t i = begin; i < end; ++i)
      {
        const bool isLast = i + 1 == end || entries[i + 1].Middle != entries[i].Middle ||
          entries[i + 1].Highest != entries[i].Highest;
        this->Next[entries[i].Face] = entries[isLast ? begin : i + 1].Face;
        begin = isLast ? i + 1 : begin;
      }
    });
}

} // namespace deformvolume
