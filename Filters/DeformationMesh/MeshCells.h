// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshCells_h
#define DeformVolumeMeshCells_h

#include "CellReader.h"      // for MeshCells
#include "DeformationMesh.h" // for MeshParts

namespace deformvolume
{

/// The tetrahedra of a mesh, and those that its other three-dimensional cells are split into: the
/// nodes of quadratic and Lagrange cells all become nodes of tetrahedra. Cells that vtkGhostType
/// marks as hidden or duplicate are left out. rest: the same mesh with its points at rest, on which
/// the split of concave polyhedra depends. derived: the derived nodes of a single grid whose cells
/// name them already; else null.
/// Throws an Error where a cell has a wrong number of points, points that are not there or
/// incomplete faces, where it is a Bezier cell, and where it is a polyhedron that cannot be split.
MeshCells ReadCells(
  const MeshParts& parts, const MeshParts& rest, const DerivedNodes* derived = nullptr);

} // namespace deformvolume

#endif
