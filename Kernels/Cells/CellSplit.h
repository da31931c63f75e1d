// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellSplit_h
#define DeformVolumeCellSplit_h

#include "DeformVolumeExport.h"
#include "Tetrahedron.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The faces of a cell: the points of each face, as indices in the cell's list of points, in order
/// around the face.
using CellFaces = std::vector<std::vector<int>>;

/// Returns the faces of a hexahedron, wedge, pyramid, pentagonal prism or hexagonal prism
/// (cellNumbers). Null for all other types. For a voxel, swap points 2 and 3, and points 6 and 7,
/// and use the faces of a hexahedron.
DEFORMVOLUME_EXPORT const CellFaces* GetCellFaces(int cellType);

/// Returns the number of points of a linear or quadratic three-dimensional cell type with a fixed
/// number of points. 0 for all other types.
DEFORMVOLUME_EXPORT int GetNumberOfCellPoints(int cellType);

/// A node of a cell. The order of the nodes decides how cells are split.
struct CellNode
{
  /// The lowest number of a node with the same position at rest.
  std::int32_t Place;
  /// Index in the mesh.
  std::int32_t Number;

  /// Coincident nodes are in the order of their numbers.
  bool operator<(const CellNode& other) const
  {
    return this->Place != other.Place ? this->Place < other.Place : this->Number < other.Number;
  }
};

/// Orients all faces consistently. Returns false if an edge does not belong to exactly two faces,
/// or if there is no consistent orientation.
bool OrientFaces(CellFaces& faces);

/// Splits a convex cell into tetrahedra between its own points, and appends these. If the faces are
/// oriented consistently, so are the tetrahedra.
///
/// The lowest node is connected to all faces that do not contain it. Each of these faces is split
/// into a fan of triangles around its own lowest node. So the split of a face depends only on its
/// nodes, and cells that share a face split it in the same way, also if each of them has nodes of
/// its own at the same positions.
void SplitCell(
  const std::vector<CellNode>& nodes, const CellFaces& faces, std::vector<Tetrahedron>& tetrahedra);

} // namespace deformvolume

#endif
