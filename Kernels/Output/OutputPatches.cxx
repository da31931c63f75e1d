// SPDX-License-Identifier: BSD-3-Clause
#include "OutputPatches.h"

#include "Background.h"
#include "KernelParameters.h"
#include "ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>

namespace deformvolume
{
namespace
{

// Consecutive patches along x.
struct PatchRow
{
  std::uint32_t First;
  std::uint32_t Count;
};

// Calls body(voxel, voxels) for each row of voxels of the patches: the index of the first voxel in
// the output, and the number of voxels.
template <typename Body>
void ForPatchRows(const Extent& output, const PatchRow& patches, Body&& body)
{
  std::int64_t first[3];
  std::int64_t end[3];
  std::int64_t number = patches.First;
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::int64_t count = DEFORMVOLUME_PATCHES(GetSize(output, axis));
    const std::int64_t size = DEFORMVOLUME_PATCH * std::int64_t{ axis == 0 ? patches.Count : 1 };
    first[axis] = number % count * DEFORMVOLUME_PATCH;
    end[axis] = std::min(first[axis] + size, GetSize(output, axis));
    number /= count;
  }
  for (std::int64_t z = first[2]; z < end[2]; ++z)
  {
    for (std::int64_t y = first[1]; y < end[1]; ++y)
    {
      body((z * GetSize(output, 1) + y) * GetSize(output, 0) + first[0], end[0] - first[0]);
    }
  }
}

std::uint64_t CountCovered(const DeformRequest& request, const PatchRow& patches)
{
  std::uint64_t covered = 0;
  ForPatchRows(request.OutputExtent, patches,
    [&](std::int64_t voxel, std::int64_t voxels)
    {
      const signed char* row = request.Coverage + voxel;
      // Eight bytes at a time: the product adds up the bytes, which are 0 or 1, in its highest
      // byte.
      for (; voxels >= 8; voxels -= 8, row += 8)
      {
        std::uint64_t eight;
        std::memcpy(&eight, row, sizeof(eight));
        covered += eight * 0x0101010101010101U >> 56;
      }
      covered = std::accumulate(row, row + voxels, covered);
    });
  return covered;
}

template <typename T>
void FillBackground(
  const DeformRequest& request, const PatchRow& patches, void* values, int components, T background)
{
  ForPatchRows(request.OutputExtent, patches,
    [&](std::int64_t voxel, std::int64_t voxels) {
      std::fill_n(static_cast<T*>(values) + voxel * components, voxels * components, background);
    });
}

void ClearArray(
  const DeformRequest& request, const PatchRow& patches, void* values, const VolumeArray& array)
{
  DispatchElementType(array.Type,
    [&](auto zero)
    {
      FillBackground(
        request, patches, values, array.Components, ClampTo<decltype(zero)>(array.Background));
    });
}

// Joins consecutive patches of a row. patches: their numbers, in ascending order.
std::vector<PatchRow> FindRows(const Extent& output, const std::vector<std::uint32_t>& patches)
{
  const auto width = static_cast<std::uint32_t>(DEFORMVOLUME_PATCHES(GetSize(output, 0)));
  std::vector<PatchRow> rows;
  for (const std::uint32_t patch : patches)
  {
    if (!rows.empty() && rows.back().First + rows.back().Count == patch && patch % width != 0)
    {
      ++rows.back().Count;
    }
    else
    {
      rows.push_back({ patch, 1 });
    }
  }
  return rows;
}

// Calls body(row) for all rows of patches in parallel.
template <typename Body>
void ForPatches(const Extent& output, const std::vector<std::uint32_t>& patches, Body&& body)
{
  constexpr std::size_t step = 16;
  const std::vector<PatchRow> rows = FindRows(output, patches);
  ParallelForItems(rows.size(), step, [&](std::size_t i) { body(rows[i]); });
}

} // namespace

std::uint64_t CountCoveredInPatches(
  const DeformRequest& request, const std::vector<std::uint32_t>& patches)
{
  std::atomic<std::uint64_t> sum{ 0 };
  ForPatches(
    request.OutputExtent, patches, [&](const PatchRow& row) { sum += CountCovered(request, row); });
  return sum;
}

void CopyPatches(const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<std::uint32_t>& patches)
{
  const auto copy = [&](const PatchRow& row, void* to, const void* from, std::size_t size)
  {
    if (to == from)
    {
      return;
    }
    ForPatchRows(request.OutputExtent, row,
      [&](std::int64_t voxel, std::int64_t voxels)
      {
        const std::size_t offset = static_cast<std::size_t>(voxel) * size;
        std::memcpy(static_cast<char*>(to) + offset, static_cast<const char*>(from) + offset,
          static_cast<std::size_t>(voxels) * size);
      });
  };
  ForPatches(request.OutputExtent, patches,
    [&](const PatchRow& row)
    {
      for (std::size_t i = 0; i < arrays.size(); ++i)
      {
        copy(row, request.Outputs[i], request.LastOutputs[i], GetTupleSize(arrays[i]));
      }
      copy(row, request.Coverage, request.LastCoverage, 1);
    });
}

void ClearPatches(const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<std::uint32_t>& patches)
{
  ForPatches(request.OutputExtent, patches,
    [&](const PatchRow& row)
    {
      for (std::size_t i = 0; i < arrays.size(); ++i)
      {
        ClearArray(request, row, request.Outputs[i], arrays[i]);
      }
      FillBackground(request, row, request.Coverage, 1, std::int8_t{ 0 });
    });
}

} // namespace deformvolume
