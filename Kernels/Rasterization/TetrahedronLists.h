// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronLists_h
#define DeformVolumeTetrahedronLists_h

#include "EntryLists.h"
#include "ListBuffers.h"
#include "RangeLists.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

class WorkDevice;

/// For each tile of the output the tetrahedra of the deformation mesh that may hold some of its
/// voxels, upright ones first, then inverted ones, each in ascending order (TetrahedronBinning.cl).
class TetrahedronLists
{
public:
  /// Lists them. tetrahedra, positions: of the mesh. Returns how many tetrahedra are inverted.
  /// Throws an Error where the deformation is beyond what can be rasterised.
  std::int64_t Make(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    const RasterParameters& parameters);

  /// For each tile where its list begins, in the lists.
  const cl::Buffer& GetBegins() const { return this->Buffers.Begins; }
  const cl::Buffer& GetLists() const { return this->Buffers.Lists; }

  /// Bytes on the device, and those that it needs there, as far as is known beforehand.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(
    WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles);

private:
  /// Throws an Error where tetrahedra are too large. Returns how many are inverted.
  std::int64_t CheckCounters(WorkDevice& device) const;

  ListBuffers Buffers;
  RangeLists Ranges;  // for processors
  EntryLists Entries; // for other devices
};

} // namespace deformvolume

#endif
