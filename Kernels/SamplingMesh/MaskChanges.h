// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaskChanges_h
#define DeformVolumeMaskChanges_h

#include "Extent.h"
#include "PointRanges.h"

#include <array>
#include <vector>

namespace deformvolume
{

/// A mask of the vertices or cells of a voxel grid: some bits of one byte per vertex or cell.
struct MaskValues
{
  const unsigned char* Bytes = nullptr; // null: all values are Usual
  unsigned char Bits = 255;             // the bits that belong to the mask
  unsigned char Usual = 0;              // the value of a vertex or cell without a mask

  unsigned char Get(std::size_t index) const
  {
    return this->Bytes ? this->Bytes[index] & this->Bits : this->Usual;
  }
};

/// Finds the differences between two masks. Returns boxes of local indices: the bounding box of the
/// differences in each cuboid of 64 x 4 x 4 vertices or cells that has any. size: vertices or cells
/// on each axis. written: ranges outside which the masks are known to be equal; null: the masks may
/// differ anywhere.
std::vector<Extent> FindMaskChanges(const std::array<int, 3>& size, const MaskValues& last,
  const MaskValues& next, const PointRanges* written = nullptr);

/// Copies the values of a box from one mask to another of the same size.
void CopyMask(
  const std::array<int, 3>& size, const Extent& box, const MaskValues& from, unsigned char* to);

} // namespace deformvolume

#endif
