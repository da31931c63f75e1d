// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshBounds_h
#define DeformVolumeMeshBounds_h

#include "BlockBounds.h"
#include "DeformVolumeExport.h"
#include "IndexBounds.h"
#include "Tetrahedron.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Bounds of the part of the volume that lies inside a deformation mesh, after the deformation.
/// Tight: tetrahedra that the surface of the volume cuts are clipped to it, since a tetrahedron's
/// map is affine. Of a tetrahedron inside the volume the nodes tell the bounds.
///
/// Keeps the bounds of blocks of nodes and of clipped tetrahedra, so that only those are computed
/// again that have changed.
///
/// voxelGrid: the volume's voxels and their output indices at rest. restPoints: the nodes at rest
/// in continuous indices of the volume. displacements: of the nodes, three floats each, in output
/// voxels.
class DEFORMVOLUME_EXPORT MeshBounds
{
public:
  /// Another mesh or another voxel grid: everything is computed again.
  void SetMesh(const VoxelGrid& voxelGrid, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra);

  /// Some tetrahedra have got other nodes in the same places, and there may be more nodes, or
  /// fewer. restPoints and tetrahedra: as they are now, after all changes that were not told.
  void ChangeConnectivity(const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const std::vector<TetrahedronChange>& changes);

  /// restPoints and tetrahedra: those that were set. changes: all other displacements are those of
  /// the last call for this mesh, if there was one; null: any may have changed.
  IndexBounds Compute(const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
    const PointRanges* changes = nullptr);

private:
  void FindRestBounds(const std::vector<glm::dvec3>& restPoints, std::size_t block);
  IndexBounds ComputeNodes(const std::vector<glm::dvec3>& restPoints, const float* displacements,
    const std::vector<unsigned char>& changed);
  /// There are so many nodes now, or have been.
  void Resize(std::size_t numberOfNodes);
  /// A tetrahedron inside the volume has come, or has gone: so many more uses of its nodes.
  void Use(const Tetrahedron& tetrahedron, std::uint32_t uses);
  void CountUses(
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

  VoxelGrid Shape;
  std::vector<unsigned char> Wanted;           // nodes of tetrahedra inside the volume
  std::vector<std::uint32_t> Uses;             // by how many of these, from the first change on
  std::vector<std::int32_t> ClippedTetrahedra; // in ascending order
  std::vector<IndexBounds> RestBounds;         // of each block of wanted nodes, scaled
  BlockBounds NodeBounds;                      // of each block of nodes
  std::vector<IndexBounds> ClippedBounds;      // of each block of clipped tetrahedra
  ///@{
  /// Blocks whose bounds are those of other tetrahedra.
  std::vector<unsigned char> StaleNodes;
  std::vector<unsigned char> StaleClipped;
  ///@}
  bool IsComputed = false;
};

/// The same, at once.
DEFORMVOLUME_EXPORT IndexBounds ComputeDeformedBounds(const VoxelGrid& voxelGrid,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements);

} // namespace deformvolume

#endif
