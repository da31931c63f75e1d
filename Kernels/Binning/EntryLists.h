// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEntryLists_h
#define DeformVolumeEntryLists_h

#include "ListBuffers.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// Makes the lists of the tetrahedra in each tile on a device with many work-items, by sorting the
/// entries of all lists (EntryLists.cl).
class EntryLists
{
public:
  /// Finds the boxes of the mesh and the counters. Returns how long the lists are.
  std::uint64_t Count(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    const RasterParameters& p, ListBuffers& buffers);
  void Fill(WorkDevice& device, const RasterParameters& p, ListBuffers& buffers, cl_uint length);

  /// Bytes on the device, and those that it needs for lists of this length.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(std::uint64_t numberOfTetrahedra, std::uint64_t length);

private:
  /// Each number becomes the sum over those before it. Returns where that over all of them is in
  /// the sums.
  std::size_t AddBefore(WorkDevice& device, const cl::Buffer& numbers, cl_uint count);
  /// Sorts the entries by their keys, which are less than twice the number of tiles.
  void Sort(WorkDevice& device, cl_uint tiles, ListBuffers& buffers, cl_uint entries);

  cl::Buffer EntryBegins; // of each tetrahedron
  cl::Buffer Sums;        // of ranges of numbers, and that of all of them
  cl::Buffer Keys;        // of the entries in the lists
  cl::Buffer SortedKeys;
  cl::Buffer SortedLists;
  cl::Buffer Digits; // how many entries have them
};

} // namespace deformvolume

#endif
