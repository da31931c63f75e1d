// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRestRegions_h
#define DeformVolumeRestRegions_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "Extent.h"
#include "IndexBounds.h"
#include "Tetrahedron.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Tells which voxels of a volume can land in a part of the output. The volume is divided into
/// regions, and the bounds of each are found after the deformation; they are never too small.
class DEFORMVOLUME_EXPORT RestRegions
{
public:
  /// Of a mesh whose voxels outside are discarded. voxelGrid: of the whole volume; restPoints: in
  /// continuous indices of the volume; displacements: three floats a node, in output voxels.
  RestRegions(const VoxelGrid& voxelGrid, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements);

  /// Of a displacement field.
  RestRegions(const VoxelGrid& voxelGrid, const DisplacementField& field);

  /// Whether the deformation moves any voxel.
  bool HasVoxels() const;

  /// The voxels of the volume that are needed to make a part of the output as the whole would be:
  /// all cells that can land there, and their neighbours, in whole rows along x, as the kernels
  /// want them. Two voxels or more on each axis even where nothing lands there.
  Extent Find(const Extent& part) const;

private:
  explicit RestRegions(const VoxelGrid& voxelGrid);
  std::int64_t GetNumberOfRegions() const;
  /// The voxels of the region at a place, the upper end being shared with the next region.
  Extent GetVoxels(const int* place) const;
  void AddTetrahedron(const Tetrahedron& tetrahedron, const std::vector<glm::dvec3>& restPoints,
    const float* displacements);

  const Extent Volume;
  const OutputTransform Transform;
  int Size = 8; // cells of a region on an axis
  int Count[3] = { 0, 0, 0 };
  std::vector<IndexBounds> Bounds; // x varies fastest
};

} // namespace deformvolume

#endif
