// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellSplit_h
#define DeformVolumeCellSplit_h

#include "DeformVolumeExport.h"
#include "Tetrahedron.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The faces of a cell, each by positions in the cell's list of points, in order round the face.
using CellFaces = std::vector<std::vector<int>>;

/// The faces of a linear three-dimensional type of cells (cellNumbers) of fixed shape other than
/// tetrahedra and voxels (whose points, once 2 and 3, and 6 and 7 are swapped, are those of
/// hexahedra); null for all other types.
DEFORMVOLUME_EXPORT const CellFaces* GetCellFaces(int cellType);

/// How many points a cell of a linear or quadratic three-dimensional type of fixed shape has;
/// 0 for all other types.
DEFORMVOLUME_EXPORT int GetNumberOfCellPoints(int cellType);

/// Splits a convex cell into tetrahedra between its own points and appends them.
///
/// The node of the lowest index is joined to the faces that it is no part of, and each of these is
/// cut by the lines from its own lowest node. The cut of a face therefore follows from its nodes
/// alone, and cells that share a face agree on it.
void SplitCell(const std::vector<std::int32_t>& nodes, const CellFaces& faces,
  std::vector<Tetrahedron>& tetrahedra);

} // namespace deformvolume

#endif
