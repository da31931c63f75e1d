// SPDX-License-Identifier: BSD-3-Clause
#include "MaskChanges.h"

#include "KernelParameters.h"
#include "ParallelFor.h"

#include <algorithm>
#include <iterator>
#include <mutex>

namespace deformvolume
{
namespace
{

std::size_t CountCuboids(int size, int cuboid)
{
  return static_cast<std::size_t>((size + cuboid - 1) / cuboid);
}

// The loops have no branches, so that compilers vectorize them.
bool AreDifferent(
  const MaskValues& last, const MaskValues& next, std::size_t begin, std::size_t count)
{
  unsigned char differences = 0;
  if (last.Bytes && next.Bytes)
  {
    for (std::size_t i = begin; i < begin + count; ++i)
    {
      differences = static_cast<unsigned char>(
        differences | ((last.Bytes[i] & last.Bits) ^ (next.Bytes[i] & next.Bits)));
    }
    return differences != 0;
  }
  const MaskValues& mask = last.Bytes ? last : next;
  for (std::size_t i = begin; mask.Bytes && i < begin + count; ++i)
  {
    differences =
      static_cast<unsigned char>(differences | ((mask.Bytes[i] & mask.Bits) ^ mask.Usual));
  }
  return differences != 0;
}

// The row of cuboids along x at one y and z.
class CuboidRow
{
public:
  CuboidRow(const std::array<int, 3>& size, std::size_t number)
    : Size(size)
    , Boxes(CountCuboids(size[0], DEFORMVOLUME_CUBOID_X), EmptyExtent)
  {
    const std::size_t rows = CountCuboids(size[1], DEFORMVOLUME_CUBOID_Y);
    this->Y = static_cast<int>(number % rows) * DEFORMVOLUME_CUBOID_Y;
    this->Z = static_cast<int>(number / rows) * DEFORMVOLUME_CUBOID_Z;
    this->EndY = std::min(this->Y + DEFORMVOLUME_CUBOID_Y, size[1]);
    this->EndZ = std::min(this->Z + DEFORMVOLUME_CUBOID_Z, size[2]);
  }

  void Compare(const MaskValues& last, const MaskValues& next)
  {
    for (int z = this->Z; z < this->EndZ; ++z)
    {
      const auto rows = static_cast<std::size_t>(this->EndY - this->Y);
      const auto width = static_cast<std::size_t>(this->Size[0]);
      const std::size_t begin = this->GetIndex(this->Y, z);
      if (!AreDifferent(last, next, begin, rows * width))
      {
        continue;
      }
      for (int y = this->Y; y < this->EndY; ++y)
      {
        this->CompareRow(last, next, y, z);
      }
    }
  }

  const std::vector<Extent>& GetBoxes() const { return this->Boxes; }

private:
  std::size_t GetIndex(int y, int z) const
  {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(this->Size[1]) +
             static_cast<std::size_t>(y)) *
      static_cast<std::size_t>(this->Size[0]);
  }

  void CompareRow(const MaskValues& last, const MaskValues& next, int y, int z)
  {
    const std::size_t index = this->GetIndex(y, z);
    for (std::size_t cuboid = 0; cuboid < this->Boxes.size(); ++cuboid)
    {
      int first = static_cast<int>(cuboid) * DEFORMVOLUME_CUBOID_X;
      int end = std::min(first + DEFORMVOLUME_CUBOID_X, this->Size[0]);
      if (!AreDifferent(last, next, index + static_cast<std::size_t>(first),
            static_cast<std::size_t>(end - first)))
      {
        continue;
      }
      const auto isSame = [&](int x)
      {
        const std::size_t i = index + static_cast<std::size_t>(x);
        return last.Get(i) == next.Get(i);
      };
      while (isSame(first))
      {
        ++first;
      }
      while (isSame(end - 1))
      {
        --end;
      }
      Include(this->Boxes[cuboid], { { first, end - 1, y, y, z, z } });
    }
  }

  const std::array<int, 3>& Size;
  std::vector<Extent> Boxes;
  int Y;
  int Z;
  int EndY;
  int EndZ;
};

// Finds the rows of cuboids that ranges touch; all rows if `written` is null.
std::vector<std::size_t> FindRows(const std::array<int, 3>& size, const PointRanges* written)
{
  const std::size_t rowsOfPlane = CountCuboids(size[1], DEFORMVOLUME_CUBOID_Y);
  std::vector<unsigned char> touched(
    rowsOfPlane * CountCuboids(size[2], DEFORMVOLUME_CUBOID_Z), written ? 0 : 1);
  const auto width = static_cast<std::size_t>(size[0]);
  const auto height = static_cast<std::size_t>(size[1]);
  const std::size_t end = width * height * static_cast<std::size_t>(size[2]);
  for (std::size_t i = 0; written && i < written->size(); ++i)
  {
    const auto& range = (*written)[i];
    for (std::size_t row = range[0] / width; row * width < std::min(range[1], end); ++row)
    {
      touched[row / height / DEFORMVOLUME_CUBOID_Z * rowsOfPlane +
        row % height / DEFORMVOLUME_CUBOID_Y] = 1;
    }
  }
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < touched.size(); ++row)
  {
    if (touched[row])
    {
      rows.push_back(row);
    }
  }
  return rows;
}

} // namespace

std::vector<Extent> FindMaskChanges(const std::array<int, 3>& size, const MaskValues& last,
  const MaskValues& next, const PointRanges* written)
{
  constexpr std::size_t step = 64;
  std::vector<Extent> changes;
  if (!last.Bytes && !next.Bytes)
  {
    return changes;
  }
  std::mutex mutex;
  const std::vector<std::size_t> rows = FindRows(size, written);
  ParallelForParts(rows.size(), step,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<Extent> found;
      for (std::size_t i = begin; i < end; ++i)
      {
        CuboidRow row(size, rows[i]);
        row.Compare(last, next);
        std::copy_if(row.GetBoxes().begin(), row.GetBoxes().end(), std::back_inserter(found),
          [](const Extent& box) { return box[0] <= box[1]; });
      }
      const std::lock_guard<std::mutex> lock(mutex);
      changes.insert(changes.end(), found.begin(), found.end());
    });
  return changes;
}

void CopyMask(
  const std::array<int, 3>& size, const Extent& box, const MaskValues& from, unsigned char* to)
{
  for (std::int64_t z = box[4]; z <= box[5]; ++z)
  {
    for (std::int64_t y = box[2]; y <= box[3]; ++y)
    {
      const std::int64_t row = (z * size[1] + y) * size[0];
      for (std::int64_t i = row + box[0]; i <= row + box[1]; ++i)
      {
        to[i] = from.Get(static_cast<std::size_t>(i));
      }
    }
  }
}

} // namespace deformvolume
