// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCopiedBox_h
#define DeformVolumeCopiedBox_h

#include <algorithm>
#include <array>
#include <cstddef>

namespace deformvolume
{

/// A box to copy between a device buffer and host memory, in bytes. It is a part of a larger box on
/// both sides, as in clEnqueueReadBufferRect.
struct CopiedBox
{
  using Bytes = std::array<std::size_t, 3>; // bytes of a row, rows, planes
  struct Location
  {
    Bytes Origin;      // of the box in the larger box
    std::size_t Row;   // row pitch
    std::size_t Plane; // plane pitch

    std::size_t GetOffset(const Bytes& shift = {}) const
    {
      return this->Origin[0] + shift[0] + (this->Origin[1] + shift[1]) * this->Row +
        (this->Origin[2] + shift[2]) * this->Plane;
    }
  };

  Bytes Size;
  Location OnDevice;
  Location OnHost;

  /// Makes a box of contiguous bytes. offset: in the device buffer.
  static CopiedBox MakeRange(std::size_t offset, std::size_t bytes)
  {
    return { { { bytes, 1, 1 } }, { { { offset, 0, 0 } }, bytes, bytes },
      { { { 0, 0, 0 } }, bytes, bytes } };
  }

  std::size_t GetBytes() const { return this->Size[0] * this->Size[1] * this->Size[2]; }
  bool IsRange() const { return this->Size[1] == 1 && this->Size[2] == 1; }

  /// Returns the part that begins at `begin` and has the given size, clipped to the box.
  CopiedBox GetPart(const Bytes& begin, const Bytes& size) const
  {
    CopiedBox part = *this;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      part.Size[axis] = std::min(size[axis], this->Size[axis] - begin[axis]);
      part.OnDevice.Origin[axis] += begin[axis];
      part.OnHost.Origin[axis] += begin[axis];
    }
    return part;
  }

  /// Merges rows, and then planes, that are contiguous on both sides: fewer and longer rows are
  /// copied faster.
  void Join()
  {
    for (int times = 0; times < 2; ++times)
    {
      const std::size_t row = this->Size[0];
      const bool isWhole = (row == this->OnDevice.Row && row == this->OnHost.Row);
      if (this->Size[1] > 1 && !isWhole)
      {
        return;
      }
      this->Size = { { row * this->Size[1], this->Size[2], 1 } };
      for (Location* const location : { &this->OnDevice, &this->OnHost })
      {
        location->Origin = { { location->Origin[0] + location->Origin[1] * location->Row,
          location->Origin[2], 0 } };
        location->Row = location->Plane;
      }
    }
  }
};

} // namespace deformvolume

#endif
