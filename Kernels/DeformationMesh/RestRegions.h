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

/// Finds the voxels of a volume that can lie in a part of the output. The volume is divided into
/// regions, with the bounds of each region after the deformation. The bounds are never too small.
class DEFORMVOLUME_EXPORT RestRegions
{
public:
  /// For a mesh with OutsideVoxels::Modes::Discard. voxelGrid: of the whole volume. restPoints: in
  /// continuous indices of the volume. displacements: three floats per node, in output voxels.
  RestRegions(const VoxelGrid& voxelGrid, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements);

  /// For a displacement field.
  RestRegions(const VoxelGrid& voxelGrid, const DisplacementField& field);

  /// Whether any voxel has a deformed position.
  bool HasVoxels() const;

  /// Returns the voxels of the volume that are needed to compute a part of the output exactly as in
  /// the whole output: all cells that can lie there, and their neighbors. The extent has complete
  /// rows along x, which the kernels need. It has at least two voxels on each axis, even if no cell
  /// lies there.
  Extent Find(const Extent& part) const;

private:
  explicit RestRegions(const VoxelGrid& voxelGrid);
  std::int64_t GetNumberOfRegions() const;
  /// Returns the voxels of a region. Neighboring regions share the voxels between them.
  Extent GetVoxels(std::int64_t region) const;
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
