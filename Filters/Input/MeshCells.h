// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshCells_h
#define DeformVolumeMeshCells_h

#include "DeformationMesh.h" // for MeshParts
#include "Tetrahedron.h"

#include <string>
#include <vector>

namespace deformvolume
{

struct MeshCells
{
  std::vector<Tetrahedron> Tetrahedra;
  /// Cells that are not three-dimensional, or of a type that is not known, in words for a warning;
  /// "" without such.
  std::string Ignored;
};

/// The tetrahedra of a mesh, and those that its other three-dimensional cells are split into: the
/// nodes of quadratic and Lagrange cells all become nodes of tetrahedra. Cells that vtkGhostType
/// marks as hidden or duplicate are left out.
/// Throws an Error where a cell has a wrong number of points, points that are not there or
/// incomplete faces, and where it is a Bezier cell.
MeshCells ReadCells(const MeshParts& parts);

} // namespace deformvolume

#endif
