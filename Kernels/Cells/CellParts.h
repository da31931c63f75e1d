// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellParts_h
#define DeformVolumeCellParts_h

#include "CellSplit.h" // for CellFaces

#include <array>
#include <functional>
#include <vector>

namespace deformvolume
{

/// A convex part of a cell.
struct CellPart
{
  /// The nodes, as indices in the cell's list of points.
  std::vector<int> Nodes;
  /// The faces, as indices in Nodes.
  CellFaces Faces;
  /// If the part is split around a derived node, the weights of all nodes of the cell for the
  /// derived node; otherwise empty. If not empty, the faces are triangles.
  std::vector<double> CenterWeights;
};
/// The parts of a cell.
using CellParts = std::vector<CellPart>;

/// Returns the index, in a cell's list of points, of the node at a lattice point of the cell; -1 if
/// there is no node.
using NodeAt = std::function<int(int i, int j, int k)>;

///@{
/// Divide a cell into parts. SplitCell() then splits each part into tetrahedra. The tetrahedra use
/// all nodes of the cell. Cells that share a face split it in the same way:
/// - A face with a node at each lattice point is divided into the triangles or quadrilaterals of
///   the lattice. These are split as in linear cells.
/// - A quadrilateral without a center node is divided into four corner triangles and the
///   quadrilateral of its mid-edge nodes, which is split as in linear cells.
/// - A triangle with mid-edge nodes and a center node is divided into three corner triangles and
///   the triangle of its mid-edge nodes, which is split into three.

/// A cell with nodes at corners and mid-edges only (serendipity). faces: nodes in VTK's order:
/// corners in order around the face, then the mid-edge nodes in the same order. The parts are one
/// pyramid at each corner, and one part between all mid-edge nodes.
CellParts SplitSerendipity(const CellFaces& faces);

/// A cell with mid-edge nodes, a center node, and a center node of each face, which is the last
/// node of the face.
CellParts SplitRoundCenter(const CellFaces& faces, int center);

/// A cell with a lattice of nodes. degrees: number of steps of the lattice along each axis. degree:
/// number of steps along the edges of the triangles. layers: number of steps between the triangles.
CellParts SplitHexahedron(const std::array<int, 3>& degrees, const NodeAt& at);
CellParts SplitWedge(int degree, int layers, const NodeAt& at);
CellParts SplitTetrahedron(int degree, const NodeAt& at);

/// A hexahedron with a lattice of 3 x 3 x 3 nodes without the three nodes (1, 1, k).
CellParts SplitRings(const NodeAt& at);

/// VTK's quadratic wedge of 21 nodes, with center nodes of its triangles, of its quadrilaterals and
/// of the cell.
CellParts SplitWedgeOf21();
///@}

} // namespace deformvolume

#endif
