// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshBounds_h
#define DeformVolumeMeshBounds_h

#include "DeformVolumeExport.h"
#include "IndexBounds.h"
#include "Tetrahedron.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Computes the bounds, after the deformation, of the part of the volume inside a deformation mesh.
/// The bounds are tight. For a tetrahedron inside the volume, the bounds are those of its nodes. A
/// tetrahedron that extends beyond the volume is clipped to the volume, since the map in a
/// tetrahedron is affine.
///
/// The bounds of blocks of nodes and of blocks of clipped tetrahedra are kept. Only blocks that
/// have changed are computed again.
///
/// voxelGrid: the voxels of the volume and their output indices at rest. restPoints: the nodes at
/// rest, in continuous indices of the volume. displacements: three floats per node, in output
/// voxels.
class DEFORMVOLUME_EXPORT MeshBounds
{
public:
  /// Set the mesh and the voxel grid. The next Compute() computes all bounds.
  void SetMesh(const VoxelGrid& voxelGrid, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra);

  /// Applies changes of the nodes of tetrahedra. The positions at rest must not change; the number
  /// of nodes may. restPoints: the current nodes. changes: all changes since the last call.
  void ChangeConnectivity(
    const std::vector<glm::dvec3>& restPoints, const std::vector<TetrahedronChange>& changes);

  /// Computes the bounds. restPoints and tetrahedra: the current nodes and tetrahedra. changes: the
  /// nodes whose displacements have changed since the last call for this mesh; null: any
  /// displacement may have changed.
  IndexBounds Compute(const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
    const PointRanges* changes = nullptr);

private:
  /// Resizes the data of nodes. Counts of removed nodes are kept for Use().
  void Resize(std::size_t numberOfNodes);
  /// Adds `uses` to the number of uses of the nodes of a tetrahedron inside the volume. -1 (as an
  /// unsigned number): the tetrahedron is removed; 1: it is added.
  void Use(const Tetrahedron& tetrahedron, std::uint32_t uses);

  VoxelGrid Shape;
  std::vector<std::uint32_t> Uses;             // tetrahedra inside the volume per node
  std::vector<std::int32_t> ClippedTetrahedra; // in ascending order
  std::vector<IndexBounds> NodeBounds;         // of each block of nodes
  std::vector<IndexBounds> ClippedBounds;      // of each block of clipped tetrahedra
  ///@{
  /// Nonzero for blocks whose tetrahedra have changed since their bounds were computed.
  std::vector<unsigned char> StaleNodes;
  std::vector<unsigned char> StaleClipped;
  ///@}
  bool IsComputed = false;
};

/// Computes the bounds of a deformed mesh once (MeshBounds).
DEFORMVOLUME_EXPORT IndexBounds ComputeDeformedBounds(const VoxelGrid& voxelGrid,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements);

} // namespace deformvolume

#endif
