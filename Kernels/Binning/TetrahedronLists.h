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

class MemoryBudget;
class WorkDevice;

/// Returns parameters with the tiles of a slab of the output.
RasterParameters MakeTiles(const Extent& slab, std::size_t numberOfTetrahedra);

/// Sets the map from the output to the volume in parameters.
void SetInverse(const VoxelGrid& grid, RasterParameters& parameters);

/// Lists for each tile of the output the tetrahedra of the deformation mesh that may contain voxels
/// of the tile: first upright tetrahedra, then inverted tetrahedra, each in ascending order
/// (TetrahedronBinning.cl).
class TetrahedronLists
{
public:
  /// Counts over all tetrahedra, listed or not. Overstretched tetrahedra are too large for edge
  /// functions (DEFORMVOLUME_LARGEST_TETRAHEDRON) and in no list.
  struct Counts
  {
    std::int64_t Inverted;
    std::int64_t Overstretched;
  };
  /// Makes the lists. tetrahedra, positions: of the mesh. Throws MemoryError if the budget does not
  /// suffice for them: tetrahedra that overlap many tiles need more than GetMemoryNeeded().
  Counts Make(WorkDevice& device, MemoryBudget& budget, const cl::Buffer& tetrahedra,
    const cl::Buffer& positions, const RasterParameters& parameters);

  /// Returns the indices at which each tile's list begins in GetLists().
  const cl::Buffer& GetBegins() const { return this->Buffers.Begins; }
  const cl::Buffer& GetLists() const { return this->Buffers.Lists; }

  /// Return the memory on the device, in bytes, and an estimate of the memory needed.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(
    WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles);

private:
  ListBuffers Buffers;
  RangeLists Ranges;  // for CPUs
  EntryLists Entries; // for other devices
};

} // namespace deformvolume

#endif
