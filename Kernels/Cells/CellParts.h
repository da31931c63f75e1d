// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellParts_h
#define DeformVolumeCellParts_h

#include "CellSplit.h" // for CellFaces

#include <array>
#include <functional>
#include <vector>

namespace deformvolume
{

/// A convex part of a cell: its nodes, by positions in the cell's list of points, and its faces, by
/// positions among these nodes.
struct CellPart
{
  /// The nodes, by their positions in the cell's list of points.
  std::vector<int> Nodes;
  /// The faces, by positions in Nodes.
  CellFaces Faces;
  /// Where the part is split round a node that the cell does not have: the weights of the cell's
  /// nodes there. The faces are triangles then.
  std::vector<double> CenterWeights;
};
/// The parts of a cell.
using CellParts = std::vector<CellPart>;

/// The position in a cell's list of points of the node at a point of the cell's lattice.
using NodeAt = std::function<int(int i, int j, int k)>;

///@{
/// The parts of a cell, such that SplitCell() of all of them gives tetrahedra between the nodes of
/// the cell, all of which count, and cells that share a face agree on it:
/// - a face with a node at each point of a lattice is cut into the triangles or quadrilaterals of
///   the lattice, and these are cut as those of linear cells;
/// - a quadrilateral without a node in its middle loses its corners, and the quadrilateral of its
///   mid-edge nodes is cut as that of a linear cell;
/// - a triangle with nodes in the middle of its edges and of itself loses its corners, and the
///   triangle of its mid-edge nodes is cut into three.

/// With nodes at corners and in the middle of edges only. faces: as VTK lists their nodes, corners
/// in order round the face, then the middles of the edges in the same order. Corners are cut off;
/// what is left has the mid-edge nodes.
CellParts SplitSerendipity(const CellFaces& faces);

/// With a node in its middle, too, and one in the middle of each face, the last of its list.
CellParts SplitRoundCenter(const CellFaces& faces, int center);

/// With a lattice of nodes. degrees: steps of the lattice along the axes; of wedges along the edges
/// of the triangles, and between them.
CellParts SplitHexahedron(const std::array<int, 3>& degrees, const NodeAt& at);
CellParts SplitWedge(int degree, int layers, const NodeAt& at);
CellParts SplitTetrahedron(int degree, const NodeAt& at);

/// A hexahedron with a lattice of 3 x 3 x 3 nodes, without the three at (1, 1, k).
CellParts SplitRings(const NodeAt& at);

/// VTK's quadratic wedge with nodes in the middle of its triangles, of its faces and of itself.
CellParts SplitWedgeOf21();
///@}

} // namespace deformvolume

#endif
