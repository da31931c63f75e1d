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

/// Where the boundary of a deformation mesh, or of a displacement field, passes through a volume.
///
/// A voxel outside the mesh has no deformed position, so the cells of the sampling mesh that the
/// boundary crosses cannot be resampled by their vertices. They are resampled by the tetrahedra of
/// the deformation mesh that meet them instead (BoundaryCells). Cells beside them are resampled by
/// their vertices, and tetrahedra fill what may remain uncovered between the two.
struct MeshBoundary
{
  /// A tetrahedron of the deformation mesh, or a part of a large one.
  struct Piece
  {
    /// Its number in the mesh.
    std::int32_t Tetrahedron;
    /// Of each corner the weights of the tetrahedron's nodes, which add up to 1. Of a field: the
    /// continuous index of the field in the first three.
    std::array<std::array<float, 4>, 4> Weights;
    /// The corners at rest, in continuous indices of the volume, positively oriented.
    std::array<glm::dvec3, 4> Rest;
  };

  /// The cells that the boundary crosses, and these with their neighbours: numbers
  /// (z * (cells on y) + y) * (cells on x) + x counted from the first cell of the volume, in
  /// ascending order.
  std::vector<std::int64_t> Crossed;
  /// These cells and their neighbours, numbered alike, in ascending order.
  std::vector<std::int64_t> Near;
  /// What meets cells of Near.
  std::vector<Piece> Pieces;
  /// Whether the boundary crosses no cell.
  bool IsEmpty() const { return this->Near.empty(); }
};

/// Finds the boundary of a mesh: the faces that have tetrahedra on one side only. Faces with
/// tetrahedra on both sides are inside the mesh, also where these have different nodes in one
/// place. Faces on the border of the whole volume or beyond it do not count.
///
/// part: the voxels that cells are counted in; whole: those of the volume that they are a part of.
/// restPoints: in continuous indices of the volume.
DEFORMVOLUME_EXPORT MeshBoundary FindMeshBoundary(const Extent& part, const Extent& whole,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

/// Whether FindMeshBoundary finds any for a whole volume.
DEFORMVOLUME_EXPORT bool HasMeshBoundary(const Extent& volume,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

/// The boundary of a field that does not extrapolate: its pieces are tetrahedra of about four
/// voxels, in which it is taken to be linear. Where a side of the field lies on voxels there is
/// none, as cells end there by themselves.
MeshBoundary FindFieldBoundary(
  const Extent& part, const Extent& whole, const DisplacementField& field);

} // namespace deformvolume

#endif
