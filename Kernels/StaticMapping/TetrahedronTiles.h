// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronTiles_h
#define DeformVolumeTetrahedronTiles_h

#include "Extent.h"
#include "Tetrahedron.h"
#include "TileGrid.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Lists of the tetrahedra in each tile of a volume. One thread links all voxels of a tile, so no
/// locks are needed.
class TetrahedronTiles : public TileGrid
{
public:
  /// Sorts tetrahedra into tiles. A tetrahedron belongs to each tile with a voxel in its bounding
  /// box. margin: distance by which bounding boxes are enlarged, in voxels. Throws Error if a node
  /// is more than 2^31 voxels away from index 0.
  TetrahedronTiles(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, double margin);
  /// The tetrahedra of a tile, in ascending order.
  struct List
  {
    const std::int32_t* First;
    const std::int32_t* Last;
    const std::int32_t* begin() const { return this->First; }
    const std::int32_t* end() const { return this->Last; }
  };
  List GetTetrahedra(std::int64_t tile) const
  {
    return { this->Bins.data() + this->Offsets[tile], this->Bins.data() + this->Offsets[tile + 1] };
  }

  /// Total length of all lists. A tetrahedron in several tiles counts several times.
  std::int64_t GetNumberOfEntries() const { return static_cast<std::int64_t>(this->Bins.size()); }

  /// Number of flat tetrahedra, including tetrahedra outside the volume. The lists contain flat
  /// tetrahedra, too.
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->FlatTetrahedra; }

private:
  /// ranges: the tiles of each tetrahedron.
  void MakeLists(const std::vector<Range>& ranges);

  // The tetrahedra of tile i are Bins[Offsets[i]] to Bins[Offsets[i + 1]].
  std::vector<std::int64_t> Offsets;
  std::vector<std::int32_t> Bins;
  std::int64_t FlatTetrahedra = 0;
};

} // namespace deformvolume

#endif
