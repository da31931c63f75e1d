// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEntryLists_h
#define DeformVolumeEntryLists_h

#include "ListBuffers.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// Makes the lists of tetrahedra for each tile on a device with many work-items, by sorting the
/// entries of all lists (EntryLists.cl).
class EntryLists
{
public:
  /// Finds the tiles of each tetrahedron, and the counters. Returns the total length of the lists.
  std::uint64_t Count(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    const RasterParameters& p, ListBuffers& buffers);
  void Fill(WorkDevice& device, const RasterParameters& p, ListBuffers& buffers, cl_uint length);

  /// Return the memory on the device, in bytes, and the memory needed for lists of this length.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(std::uint64_t numberOfTetrahedra, std::uint64_t length);

private:
  /// Replaces each number by the sum of all numbers before it (exclusive prefix sum). Returns the
  /// index in Sums of the total.
  std::size_t AddBefore(WorkDevice& device, const cl::Buffer& numbers, cl_uint count);
  /// Sorts the entries by their keys, which are less than twice the number of tiles.
  void Sort(WorkDevice& device, cl_uint tiles, ListBuffers& buffers, cl_uint entries);

  cl::Buffer EntryBegins; // the first entry of each tetrahedron
  cl::Buffer Sums;        // sums of ranges of numbers, then the total
  cl::Buffer Keys;        // the key of each entry in the lists
  cl::Buffer SortedKeys;
  cl::Buffer SortedLists;
  cl::Buffer Digits; // the number of entries with each digit, for each range
};

} // namespace deformvolume

#endif
