// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshCells_h
#define DeformVolumeMeshCells_h

#include "CellReader.h"      // for MeshCells
#include "DeformationMesh.h" // for MeshParts

namespace deformvolume
{

/// Reads the tetrahedra of a mesh, and splits its other three-dimensional cells into tetrahedra.
/// All nodes of quadratic and Lagrange cells become nodes of tetrahedra. Cells that vtkGhostType
/// marks as hidden or duplicate are skipped, and so are those with a hidden point. rest: the same
/// mesh with its points at rest, on which splits depend (MeshCells::DependOnPoints). derived: the
/// derived nodes that the cells of a single grid use already; else null. places: CellNode::Place of
/// each node, among the nodes of all ranks; null: among those of this mesh. other: another
/// configuration of the mesh, whose hidden cells are skipped, too; or null. Throws an Error if a
/// cell has a wrong number of points, points that do not exist or incomplete faces, is a Bezier
/// cell, or is a polyhedron that cannot be split.
MeshCells ReadCells(const MeshParts& parts, const MeshParts& rest,
  const DerivedNodes* derived = nullptr, const std::vector<std::int32_t>* places = nullptr,
  const MeshParts* other = nullptr);

} // namespace deformvolume

#endif
