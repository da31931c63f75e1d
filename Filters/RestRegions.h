// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRestRegions_h
#define DeformVolumeRestRegions_h

#include "IndexBounds.h"
#include "VolumeDeformer.h" // for Extent, Lattice, Tetrahedron, DisplacementField

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Tells which voxels of a volume can land in a part of the output. The volume is divided into
/// bricks, and the bounds of each are found after the deformation; they are never too small.
class RestRegions
{
public:
  /// Of a mesh whose voxels outside are discarded. lattice: of the whole volume; restPoints: in
  /// continuous indices of the volume; displacements: three floats a node, in output voxels.
  RestRegions(const Lattice& lattice, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements);

  /// Of a displacement field.
  RestRegions(const Lattice& lattice, const DisplacementField& field);

  /// Whether the deformation moves any voxel.
  bool HasVoxels() const;

  /// The voxels of the volume that are needed to make a part of the output as the whole would be:
  /// all cells that can land there, and their neighbours, in whole rows along x, as the kernels
  /// want them. Two voxels or more on each axis even where nothing lands there.
  Extent Find(const Extent& part) const;

private:
  explicit RestRegions(const Lattice& lattice);
  std::int64_t GetNumberOfBricks() const;
  /// The voxels of the brick at a place, the upper end being shared with the next brick.
  Extent GetVoxels(const int* place) const;
  void AddTetrahedron(const Tetrahedron& tetrahedron, const std::vector<glm::dvec3>& restPoints,
    const float* displacements);

  const Extent Volume;
  const glm::dvec3 Scale;
  int Size = 8; // cells of a brick on an axis
  int Count[3] = { 0, 0, 0 };
  std::vector<IndexBounds> Bounds; // x varies fastest
};

} // namespace deformvolume

#endif
