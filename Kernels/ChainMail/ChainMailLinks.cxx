// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailLinks.h"

#include "ChainMailParameters.h"
#include "FiveTetrahedra.h"
#include "MaskChanges.h"
#include "ParallelFor.h"

#include <algorithm>
#include <array>

namespace deformvolume
{
namespace
{

constexpr unsigned char AllBits = DEFORMVOLUME_LINKS | DEFORMVOLUME_ELEMENT;

// The bits that a cell contributes to the voxel at one of its corners: the links that begin at the
// voxel, and DEFORMVOLUME_ELEMENT. Corners are numbered as in FiveTetrahedra.h. mirror: bits of the
// axes on which the index of the cell is odd.
class CornerTable
{
public:
  CornerTable()
  {
    constexpr unsigned int bits[3] = { 1, 4, 2 }; // bits of the axes in the number of a corner
    for (unsigned int mirror = 0; mirror < 8; ++mirror)
    {
      for (unsigned int active = 0; active < 32; ++active)
      {
        for (unsigned int t = 0; t < 5; ++t)
        {
          for (unsigned int i = 0; active >> t & 1 && i < 4; ++i)
          {
            const unsigned int corner = FiveTetrahedra[t][i] ^ mirror;
            unsigned char& found = this->Bits[mirror][active][corner];
            found |= DEFORMVOLUME_ELEMENT;
            for (const unsigned int other : FiveTetrahedra[t])
            {
              for (unsigned int axis = 0; axis < 3; ++axis)
              {
                const bool isNext =
                  !(corner & bits[axis]) && (other ^ mirror) == (corner | bits[axis]);
                found |= isNext ? static_cast<unsigned char>(1U << axis) : 0;
              }
            }
          }
        }
      }
    }
  }

  unsigned char Bits[8][32][8] = {};
};

} // namespace

std::vector<std::uint32_t> ChainMailLinks::Set(
  const ChainMailBlocks& blocks, const unsigned char* active)
{
  std::array<int, 3> cells = blocks.GetSize();
  for (int& size : cells)
  {
    --size;
  }
  const MaskValues last{ this->Active.empty() ? nullptr : this->Active.data(),
    DEFORMVOLUME_ALL_TETRAHEDRA, DEFORMVOLUME_ALL_TETRAHEDRA };
  const MaskValues next{ active, DEFORMVOLUME_ALL_TETRAHEDRA, DEFORMVOLUME_ALL_TETRAHEDRA };
  const std::vector<Extent> changes = FindMaskChanges(cells, last, next);
  std::vector<std::uint32_t> changed;
  for (const Extent& box : changes)
  {
    blocks.Append({ { box[0], box[1] + 1, box[2], box[3] + 1, box[4], box[5] + 1 } }, changed);
  }
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  if (!active)
  {
    std::vector<unsigned char>().swap(this->Active);
  }
  else if (!changes.empty())
  {
    if (this->Active.empty())
    {
      this->Active.assign(static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
          static_cast<std::size_t>(cells[2]),
        DEFORMVOLUME_ALL_TETRAHEDRA);
    }
    for (const Extent& box : changes)
    {
      CopyMask(cells, box, next, this->Active.data());
    }
  }
  return changed;
}

unsigned char ChainMailLinks::Find(const ChainMailBlocks& blocks, int x, int y, int z) const
{
  static const CornerTable table;
  const std::array<int, 3>& size = blocks.GetSize();
  if (this->Active.empty())
  {
    return static_cast<unsigned char>(DEFORMVOLUME_ELEMENT | (x + 1 < size[0] ? 1 : 0) |
      (y + 1 < size[1] ? 2 : 0) | (z + 1 < size[2] ? 4 : 0));
  }
  unsigned char found = 0;
  for (int corner = 0; corner < 8 && found != AllBits; ++corner)
  {
    const int cx = x - (corner & 1);
    const int cy = y - (corner >> 2);
    const int cz = z - (corner >> 1 & 1);
    if (cx < 0 || cy < 0 || cz < 0 || cx + 1 >= size[0] || cy + 1 >= size[1] || cz + 1 >= size[2])
    {
      continue;
    }
    const Extent& whole = blocks.GetExtent();
    const int mirror = DEFORMVOLUME_MIRROR(whole[0] + cx, whole[2] + cy, whole[4] + cz);
    const std::size_t cell = (static_cast<std::size_t>(cz) * static_cast<std::size_t>(size[1] - 1) +
                               static_cast<std::size_t>(cy)) *
        static_cast<std::size_t>(size[0] - 1) +
      static_cast<std::size_t>(cx);
    found |= table.Bits[mirror][this->Active[cell]][corner];
  }
  return found;
}

void ChainMailLinks::Write(
  const ChainMailBlocks& blocks, const std::vector<std::uint32_t>& list, unsigned char* bytes) const
{
  constexpr std::size_t step = 64;
  ParallelForItems(list.size(), step,
    [&](std::size_t i)
    {
      ForEachPoint(blocks.GetVoxels(list[i]),
        [&](int x, int y, int z)
        {
          unsigned char& byte = bytes[blocks.GetVoxelIndex(x, y, z)];
          byte = static_cast<unsigned char>((byte & ~AllBits) | this->Find(blocks, x, y, z));
        });
    });
}

} // namespace deformvolume
