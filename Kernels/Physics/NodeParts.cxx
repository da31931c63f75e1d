// SPDX-License-Identifier: BSD-3-Clause
#include "NodeParts.h"

#include "CountedLists.h"
#include "DisjointSets.h"
#include "ParallelFor.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

constexpr std::size_t NodesOfPart = 1024;

} // namespace

NodeParts FindNodeParts(const std::vector<Tetrahedron>& tetrahedra, const FaceNeighbors& neighbors,
  const std::vector<unsigned char>& isSplit, const std::vector<unsigned char>& isWanted)
{
  // The corners at each wanted node, in ascending order.
  std::vector<std::size_t> begins;
  std::vector<std::size_t> corners;
  MakeLists(
    isWanted.size(),
    [&](const auto& take)
    {
      for (std::size_t corner = 0; corner < 4 * tetrahedra.size(); ++corner)
      {
        const auto node = static_cast<std::size_t>(tetrahedra[corner / 4][corner % 4]);
        if (isWanted[node] != 0)
        {
          take(node, corner);
        }
      }
    },
    begins, corners);
  NodeParts parts;
  parts.PartOfCorner.assign(4 * tetrahedra.size(), 0);
  parts.NumberOfCopies.assign(isWanted.size(), 0);
  ParallelForParts(isWanted.size(), NodesOfPart,
    [&](std::size_t first, std::size_t last)
    {
      DisjointSets<std::size_t> sets;
      for (std::size_t node = first; node < last; ++node)
      {
        if (isWanted[node] == 0)
        {
          continue;
        }
        const std::size_t* const begin = corners.data() + begins[node];
        const std::size_t* const end = corners.data() + begins[node + 1];
        const auto count = static_cast<std::size_t>(end - begin);
        sets.Reset(count);
        for (std::size_t i = 0; i < count; ++i)
        {
          const std::size_t t = begin[i] / 4;
          for (std::size_t face = 4 * t; face < 4 * t + 4; ++face)
          {
            const std::size_t next = neighbors.GetNext(face);
            const bool isAtNode = tetrahedra[t][face % 4] != static_cast<std::int32_t>(node);
            if (isAtNode && next != face && isSplit[face] == 0)
            {
              sets.Unite(
                i, static_cast<std::size_t>(std::lower_bound(begin, end, next / 4 * 4) - begin));
            }
          }
        }
        // The root of a set is its lowest corner.
        std::int32_t number = 0;
        for (std::size_t i = 0; i < count; ++i)
        {
          const std::size_t root = sets.Find(i);
          parts.PartOfCorner[begin[i]] = root == i ? number++ : parts.PartOfCorner[begin[root]];
        }
        parts.NumberOfCopies[node] = number - 1;
      }
    });
  return parts;
}

} // namespace deformvolume
