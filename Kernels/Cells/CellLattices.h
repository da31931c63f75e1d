// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellLattices_h
#define DeformVolumeCellLattices_h

#include "CellParts.h" // for NodeAt

#include <array>

namespace deformvolume
{

///@{
/// The order in which cells with a lattice of nodes list these, as VTK does it for Lagrange cells:
/// corners, then the nodes within the edges, within the faces and within the cell. The quadratic
/// cells that have a lattice of 3 nodes on an axis list theirs in the same order.

/// degrees: steps of the lattice along the axes.
NodeAt NumberHexahedron(const std::array<int, 3>& degrees);
/// degree: steps along the edges of the triangles; layers: between these.
NodeAt NumberWedge(int degree, int layers);
NodeAt NumberTetrahedron(int degree);
///@}

} // namespace deformvolume

#endif
