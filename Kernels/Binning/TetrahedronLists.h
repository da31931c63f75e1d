// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronLists_h
#define DeformVolumeTetrahedronLists_h

#include "EntryLists.h"
#include "Extent.h"
#include "ListBuffers.h"
#include "RangeLists.h"
#include "VoxelGrid.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

class WorkDevice;

/// The tiles of a slab of the output, for so many tetrahedra.
RasterParameters MakeTiles(const Extent& slab, std::size_t numberOfTetrahedra);

/// Sets what leads from the output to the volume.
void SetInverse(const VoxelGrid& grid, RasterParameters& parameters);

/// For each tile of the output the tetrahedra of the deformation mesh that may hold some of its
/// voxels, upright ones first, then inverted ones, each in ascending order (TetrahedronBinning.cl).
class TetrahedronLists
{
public:
  /// Of all tetrahedra, listed or not. Those that span more output voxels than edge functions allow
  /// (DEFORMVOLUME_LARGEST_TETRAHEDRON) are overstretched, and in no list.
  struct Counts
  {
    std::int64_t Inverted;
    std::int64_t Overstretched;
  };
  /// Lists them. tetrahedra, positions: of the mesh.
  Counts Make(WorkDevice& device, const cl::Buffer& tetrahedra, const cl::Buffer& positions,
    const RasterParameters& parameters);

  /// For each tile where its list begins, in the lists.
  const cl::Buffer& GetBegins() const { return this->Buffers.Begins; }
  const cl::Buffer& GetLists() const { return this->Buffers.Lists; }

  /// Bytes on the device, and those that it needs there, as far as is known beforehand.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(
    WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles);

private:
  ListBuffers Buffers;
  RangeLists Ranges;  // for processors
  EntryLists Entries; // for other devices
};

} // namespace deformvolume

#endif
