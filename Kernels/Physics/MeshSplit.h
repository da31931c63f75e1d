// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshSplit_h
#define DeformVolumeMeshSplit_h

#include "DeformVolumeExport.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The numbers of two tetrahedra, in ascending order.
using TetrahedronPair = std::array<std::int32_t, 2>;

/// A deformation mesh that was cut along faces of its tetrahedra.
struct MeshSplit
{
  /// All tetrahedra, in their old order, with their new nodes.
  std::vector<Tetrahedron> Tetrahedra;
  /// For each copied node, the node that it is a copy of. Copies are appended to the old nodes.
  std::vector<std::int32_t> Origins;
  /// The tetrahedra that have a new node, in ascending order.
  std::vector<std::size_t> Changed;
  /// The number of faces that this cut split.
  std::int64_t NumberOfFaces = 0;
  /// The pairs of tetrahedra whose common face was split, by this cut or an earlier one, but which
  /// still share all three nodes of that face. They lie where a cut ends. Ascending; pass them to
  /// the next cut of the mesh.
  std::vector<TetrahedronPair> StillConnected;
};

/// Cuts a deformation mesh along those of its faces that are nearest to a sheet.
///
/// A face between two tetrahedra is split if the sheet crosses the segment between the centroids of
/// the two an odd number of times. The sheet may be open, folded and self-intersecting. If the
/// sheet separates two parts of the mesh, the split faces separate them as well. Positions are
/// rounded to 2^-19 of the longest side of the mesh. Crossings of rounded positions are decided
/// exactly, also if the sheet passes through centroids or nodes, or along faces. The order and the
/// orientation of the triangles do not matter.
///
/// The tetrahedra around a node of a split face form parts, which are connected through faces that
/// are not split. The part with the lowest tetrahedron keeps the node, and each other part gets a
/// copy. Copies are numbered by nodes, then by the lowest tetrahedron of each part. Where the sheet
/// ends inside the mesh, the tetrahedra around a node are still connected, so the node is not
/// copied. Tetrahedra that shared only such a node or an edge, and no face, before the cut are
/// separated as well: otherwise they could connect the two sides of the cut. Other nodes do not
/// change.
///
/// A split face whose two tetrahedra still share all three nodes is listed in StillConnected. Pass
/// that list to the next cut: a cut that continues an earlier one then opens these faces too,
/// however short both cuts are. Positions are rounded independently for each cut, so the sheets of
/// two such cuts should overlap slightly.
///
/// positions: of all nodes, in the state that the sheet refers to, for example the deformed one.
/// sheetTriangles: three point numbers each; triangles without area split nothing. unparted: from
/// earlier cuts of this mesh.
///
/// Throws an Error if a tetrahedron refers to a node that does not exist or has a position that is
/// not finite; if a triangle refers to a point that does not exist, is not finite, or is farther
/// away than a million lengths of the mesh; or if an unparted pair refers to a tetrahedron that
/// does not exist.
///
/// The run time is that of a few passes over all tetrahedra, and of tests of the tetrahedra near
/// the sheet. Faces of more than two tetrahedra are not split.
DEFORMVOLUME_EXPORT MeshSplit SplitMesh(const std::vector<glm::dvec3>& positions,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<glm::dvec3>& sheetPoints,
  const std::vector<std::array<std::int64_t, 3>>& sheetTriangles,
  const std::vector<TetrahedronPair>& unparted = {});

} // namespace deformvolume

#endif
