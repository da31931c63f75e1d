// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellLattices_h
#define DeformVolumeCellLattices_h

#include "CellParts.h" // for NodeAt

#include <array>

namespace deformvolume
{

///@{
/// Numbers the nodes of cells with a lattice of nodes in the order of VTK's Lagrange cells:
/// corners, then nodes within edges, within faces and within the cell. Quadratic cells with a
/// lattice of 3 nodes on an axis have the same order.

/// degrees: number of steps of the lattice along each axis.
NodeAt NumberHexahedron(const std::array<int, 3>& degrees);
/// degree: number of steps along the edges of the triangles. layers: number of steps between the
/// triangles.
NodeAt NumberWedge(int degree, int layers);
NodeAt NumberTetrahedron(int degree);
///@}

} // namespace deformvolume

#endif
