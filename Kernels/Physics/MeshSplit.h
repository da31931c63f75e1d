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

/// Two tetrahedra by their numbers, the lower one first.
using TetrahedronPair = std::array<std::int32_t, 2>;

/// A deformation mesh after a cut along faces of its tetrahedra.
struct MeshSplit
{
  /// As many as before, in the same order.
  std::vector<Tetrahedron> Tetrahedra;
  /// Of each node that has been appended the node that it is a copy of.
  std::vector<std::int32_t> Origins;
  /// The tetrahedra that have got other nodes, ascending.
  std::vector<std::size_t> Changed;
  /// The faces that this cut has split.
  std::int64_t NumberOfFaces = 0;
  /// The pairs of tetrahedra whose common face has been split, by this cut or an earlier one, but
  /// which still have its three nodes in common: where a cut ends, there is nothing yet that could
  /// part. Ascending; for the next cut of the mesh.
  std::vector<TetrahedronPair> Unparted;
};

/// Cuts a deformation mesh along its own faces, as near to a sheet as they are.
///
/// A face between two tetrahedra is split where the sheet crosses the segment between the centroids
/// of the two an odd number of times. So the sheet may be open, fold and cross itself; where it
/// has both sides of the mesh apart, the split faces have them apart too. It is decided exactly,
/// after positions have been rounded to 2^-19 of the longest side of the mesh: also for a sheet
/// that passes through centroids or nodes, or along faces. Neither the order of the triangles nor
/// their orientation matters.
///
/// A node of a split face gets a copy for each part of its tetrahedra that holds together by faces
/// which are not split: the part with the lowest tetrahedron keeps the node, the others get copies,
/// in the order of the nodes, then of the lowest tetrahedron of each part. Where the sheet ends
/// inside the mesh, all tetrahedra of a node still hold together around that end, and the node
/// remains one. Tetrahedra that touch at such a node or at an edge only, having had no faces to
/// hold them together there before, part as well: otherwise they could hold both sides of a cut
/// together. Other nodes remain as they are.
///
/// A split face of which the two tetrahedra still have all three nodes in common is listed in
/// Unparted. Give that list to the next cut, so that a cut which goes on where another ended,
/// however short both are, opens such faces too. As positions are rounded anew for each cut, sheets
/// of cuts that go on should overlap a little.
///
/// positions: of all nodes, where the sheet is, for example the deformed ones. sheetTriangles:
/// three numbers of points each; those without area split nothing. unparted: of earlier cuts of
/// this mesh.
///
/// Throws an Error where a tetrahedron has a node that is none, a node of it has no finite
/// position, a triangle has a point that is none or is not finite or is more than a million times
/// as far away as the mesh is long, or an unparted pair has a tetrahedron that is none.
///
/// It takes a few passes over the tetrahedra, and work for those near the sheet. Faces of more than
/// two tetrahedra are not split.
DEFORMVOLUME_EXPORT MeshSplit SplitMesh(const std::vector<glm::dvec3>& positions,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<glm::dvec3>& sheetPoints,
  const std::vector<std::array<std::int64_t, 3>>& sheetTriangles,
  const std::vector<TetrahedronPair>& unparted = {});

} // namespace deformvolume

#endif
