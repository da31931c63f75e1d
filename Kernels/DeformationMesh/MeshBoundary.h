// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshBoundary_h
#define DeformVolumeMeshBoundary_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "Extent.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The boundary of a deformation mesh, or of a displacement field, within a volume.
///
/// A voxel outside the mesh has no deformed position. Therefore the cells of the sampling mesh that
/// the boundary crosses cannot be resampled by their vertices. They are resampled by the tetrahedra
/// of the deformation mesh that meet these cells (BoundaryCells). Neighboring cells are resampled
/// by their vertices. Tetrahedra of the deformation mesh fill the gaps that remain between the
/// crossed cells and their neighbors.
struct MeshBoundary
{
  /// A tetrahedron of the deformation mesh, or a part of a large one.
  struct Piece
  {
    /// Number of the tetrahedron in the mesh.
    std::int32_t Tetrahedron;
    /// For each corner of the piece, the weights of the nodes of the tetrahedron. The weights of a
    /// corner add up to 1. For a field, the first three are the continuous index of the corner in
    /// the field.
    std::array<std::array<float, 4>, 4> Weights;
    /// The corners at rest, in continuous indices of the volume, with positive orientation.
    std::array<glm::dvec3, 4> Rest;
  };

  /// The cells that the boundary crosses, in ascending order. Cell (x, y, z), counted from the
  /// first cell of the part, has the number (z * (cells on y) + y) * (cells on x) + x.
  std::vector<std::int64_t> Crossed;
  /// The crossed cells and their neighbors, with the same numbers, in ascending order.
  std::vector<std::int64_t> Near;
  /// The pieces that meet cells of Near.
  std::vector<Piece> Pieces;
  /// Whether the boundary crosses no cell.
  bool IsEmpty() const { return this->Near.empty(); }
};

/// Finds the boundary of a mesh: the faces that have tetrahedra on one side only. Two coincident
/// faces with tetrahedra on opposite sides are inside the mesh, even if they have different nodes.
/// Faces on the border of the whole volume or outside it are ignored.
///
/// part: extent of the voxels whose cells are numbered. whole: extent of the whole volume, which
/// contains the part. restPoints: in continuous indices of the volume.
DEFORMVOLUME_EXPORT MeshBoundary FindMeshBoundary(const Extent& part, const Extent& whole,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

/// Whether FindMeshBoundary() finds a boundary in a whole volume.
DEFORMVOLUME_EXPORT bool HasMeshBoundary(const Extent& volume,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

/// Finds the boundary of a field that does not extrapolate. Its pieces are tetrahedra of about four
/// voxels, in which displacements are approximated as linear. A side of the field that lies on
/// voxels is no boundary, since cells end there.
MeshBoundary FindFieldBoundary(
  const Extent& part, const Extent& whole, const DisplacementField& field);

} // namespace deformvolume

#endif
