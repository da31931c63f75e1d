// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRangeLists_h
#define DeformVolumeRangeLists_h

#include "ListBuffers.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// Makes the lists of the tetrahedra in each tile on a processor: a few work-items count and list
/// ranges of tetrahedra (RangeLists.cl).
class RangeLists
{
public:
  /// Finds the boxes of the mesh, the counters, and where lists begin. Returns how long these are.
  std::uint64_t Count(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    const RasterParameters& p, ListBuffers& buffers);
  void Fill(WorkDevice& device, const RasterParameters& p, const ListBuffers& buffers);

  /// Bytes on the device, and those that it needs for so many tiles.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(
    WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles);

private:
  std::uint64_t FindPlaces(
    WorkDevice& device, std::size_t ranges, std::size_t tiles, const ListBuffers& buffers);

  cl::Buffer Places; // of each range of tetrahedra in the lists
};

} // namespace deformvolume

#endif
