// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaskChanges_h
#define DeformVolumeMaskChanges_h

#include "Extent.h"
#include "PointRanges.h"

#include <array>
#include <vector>

namespace deformvolume
{

/// What a mask of the vertices or the cells of a voxel grid can be read as: one byte each, of which
/// some bits count.
struct MaskValues
{
  const unsigned char* Bytes = nullptr; // null: all are usual
  unsigned char Bits = 255;
  unsigned char Usual = 0; // what bytes, with these bits, usually are

  unsigned char Get(std::size_t place) const
  {
    return this->Bytes ? this->Bytes[place] & this->Bits : this->Usual;
  }
};

/// Where two masks of so many vertices or cells on each axis differ: boxes of local indices that do
/// not overlap, each as small as one within 64 x 4 x 4 of them can be. written: ranges of places;
/// elsewhere the masks are the same, for certain. Null: they may differ anywhere.
std::vector<Extent> FindMaskChanges(const std::array<int, 3>& size, const MaskValues& last,
  const MaskValues& next, const PointRanges* written = nullptr);

/// Copies the bits that count of a box, from a mask to another of the same size.
void CopyMask(
  const std::array<int, 3>& size, const Extent& box, const MaskValues& from, unsigned char* to);

} // namespace deformvolume

#endif
