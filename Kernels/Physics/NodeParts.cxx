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

class PartFinder
{
public:
  PartFinder(const std::vector<Tetrahedron>& tetrahedra, const FaceNeighbors& neighbors,
    const std::vector<unsigned char>& isSplit)
    : Tetrahedra(tetrahedra)
    , Neighbors(neighbors)
    , IsSplit(isSplit)
  {
  }

  // Sets partOfCorner for the corners [begin, end), which are all corners at one node, in ascending
  // order. Returns the number of parts.
  std::int32_t Find(const std::size_t* begin, const std::size_t* end, std::int32_t* partOfCorner)
  {
    const auto count = static_cast<std::size_t>(end - begin);
    this->Sets.Reset(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      this->JoinNeighbors(begin, end, i);
    }
    // The root of a set is its lowest corner.
    std::int32_t parts = 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      const std::size_t root = this->Sets.Find(i);
      partOfCorner[begin[i]] = root == i ? parts++ : partOfCorner[begin[root]];
    }
    return parts;
  }

private:
  void JoinNeighbors(const std::size_t* begin, const std::size_t* end, std::size_t i)
  {
    const std::size_t t = begin[i] / 4;
    const std::int32_t node = this->Tetrahedra[t][begin[i] % 4];
    for (std::size_t k = 0; k < 4; ++k)
    {
      const std::size_t face = 4 * t + k;
      const std::size_t next = this->Neighbors.GetNext(face);
      if (this->Tetrahedra[t][k] == node || next == face || this->IsSplit[face] != 0)
      {
        continue;
      }
      const std::size_t* other = std::lower_bound(begin, end, next / 4 * 4);
      this->Sets.Unite(i, static_cast<std::size_t>(other - begin));
    }
  }

  const std::vector<Tetrahedron>& Tetrahedra;
  const FaceNeighbors& Neighbors;
  const std::vector<unsigned char>& IsSplit;
  DisjointSets<std::size_t> Sets;
};

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
      PartFinder finder(tetrahedra, neighbors, isSplit);
      for (std::size_t node = first; node < last; ++node)
      {
        if (isWanted[node] != 0)
        {
          parts.NumberOfCopies[node] =
            finder.Find(corners.data() + begins[node], corners.data() + begins[node + 1],
              parts.PartOfCorner.data()) -
            1;
        }
      }
    });
  return parts;
}

} // namespace deformvolume
