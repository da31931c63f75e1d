// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRangeLists_h
#define DeformVolumeRangeLists_h

#include "ListBuffers.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// Makes the lists of tetrahedra for each tile on a CPU: a few work-items count and list ranges of
/// tetrahedra (RangeLists.cl).
class RangeLists
{
public:
  /// Finds the tiles of each tetrahedron, the counters, and the indices at which lists begin.
  /// Returns the total length of the lists.
  std::uint64_t Count(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    const RasterParameters& p, ListBuffers& buffers);
  void Fill(WorkDevice& device, const RasterParameters& p, const ListBuffers& buffers);

  /// Return the memory on the device, in bytes, and the memory needed for this number of tiles.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(
    WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles);

private:
  std::uint64_t FindRangeBegins(
    WorkDevice& device, std::size_t ranges, std::size_t tiles, const ListBuffers& buffers);

  cl::Buffer RangeBegins; // index at which each range of tetrahedra writes, for each tile
};

} // namespace deformvolume

#endif
