// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellReader_h
#define DeformVolumeCellReader_h

#include "CellSplit.h" // for CellFaces
#include "DeformVolumeExport.h"
#include "DerivedNodes.h"
#include "HigherOrderCells.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace deformvolume
{

/// The tetrahedra of a deformation mesh, and the data for warnings about its cells.
struct MeshCells
{
  /// The tetrahedra, in the order of the cells.
  std::vector<Tetrahedron> Tetrahedra;
  /// Additional nodes of the tetrahedra. Their indices follow those of the nodes of the mesh.
  DerivedNodes Derived;
  /// Text for a warning: number and type of cells that are not three-dimensional or of an
  /// unsupported type. "" if there are none.
  std::string Ignored;
  /// Text for a warning: cells whose nodes are probably not in VTK's order. "" if there are none.
  std::string WrongOrder;
  /// Whether the split of a cell depends on the positions of nodes at rest.
  bool DependOnPoints = false;
};

/// Returns the warnings for MeshCells::Ignored and MeshCells::WrongOrder.
DEFORMVOLUME_EXPORT std::vector<std::string> GetCellWarnings(
  const std::string& ignored, const std::string& wrongOrder);

/// Throws an Error for a cell of the deformation mesh. count: number of its points. complaint: the
/// text after the number of points in the message.
[[noreturn]] DEFORMVOLUME_EXPORT void ThrowBadCell(
  std::int64_t cell, int type, std::int64_t count, const std::string& complaint);

/// Throws Error if a cell of the deformation mesh uses a point that does not exist.
DEFORMVOLUME_EXPORT void CheckCellPoint(
  std::int64_t point, std::int64_t numberOfPoints, std::int64_t cell);

/// Converts the cells of a deformation mesh to tetrahedra. Three-dimensional cells of other types
/// (cellNumbers) are split. All nodes of quadratic and Lagrange cells become nodes of tetrahedra.
class DEFORMVOLUME_EXPORT CellReader
{
public:
  /// Returns the position of a node at rest. Called if there are cells that are split.
  using Positions = std::function<glm::dvec3(std::int32_t node)>;

  /// rounding: relative error of positions.
  CellReader(std::int32_t numberOfNodes, Positions positions, double rounding);

  /// Reserves memory for tetrahedra.
  void Reserve(std::size_t numberOfTetrahedra)
  {
    this->Cells.Tetrahedra.reserve(numberOfTetrahedra);
  }
  /// Set CellNode::Place of each node. Otherwise they follow from the positions.
  void SetPlaces(const std::vector<std::int32_t>& places) { this->Places = places; }
  /// Set the derived nodes that the cells already use.
  void SetDerived(const DerivedNodes& derived) { this->Cells.Derived = derived; }

  /// Throws Error if cells of this type have a fixed number of points other than `count`.
  static void CheckSize(std::int64_t cell, int type, std::int64_t count);

  /// Adds a tetrahedron without a check.
  void AddTetrahedron(const Tetrahedron& nodes) { this->Cells.Tetrahedra.push_back(nodes); }
  /// Adds a cell of any type except Polyhedron. nodes: indices of the nodes in the mesh, in the
  /// order of the cell. degrees: the degrees of a Lagrange cell along its axes; null: derived from
  /// the number of nodes. Throws Error if the number of nodes is wrong, and for Bezier cells.
  void Add(std::int64_t cell, int type, const std::vector<std::int32_t>& nodes,
    const std::array<int, 3>* degrees);
  /// The nodes of each face, in order around the face.
  using PolyhedronFaces = std::vector<std::vector<std::int32_t>>;
  /// Adds a polyhedron. count: number of its points, for messages. areComplete: whether all faces
  /// could be read. Throws Error if faces are missing, or if the polyhedron cannot be split.
  void AddPolyhedron(
    std::int64_t cell, std::int64_t count, const PolyhedronFaces& faces, bool areComplete);

  /// Returns the result. Call no other function afterwards.
  MeshCells Finish();

private:
  const std::vector<CellNode>& GetNodes(const std::vector<std::int32_t>& numbers);
  std::int32_t AddNode(const std::vector<std::int32_t>& nodes, const std::vector<double>& weights);
  void AddHigherOrder(std::int64_t cell, int type, const std::vector<std::int32_t>& nodes,
    const std::array<int, 3>* degrees);
  bool HasNearMidSides(int type, const std::vector<std::int32_t>& nodes) const;
  void CountOverlap(const std::vector<std::size_t>& begins);

  const std::int32_t NumberOfNodes;
  const Positions GetPosition;
  const double Rounding;
  MeshCells Cells;
  HigherOrderCells HigherOrder;
  std::vector<std::int32_t> Places; // CellNode::Place of each node; may be empty until it is used
  std::vector<CellNode> Nodes;      // of a cell, kept to save allocations
  std::map<int, std::int64_t> Ignored;
  std::int64_t NumberOfQuadraticCells = 0;
  std::int64_t NumberOfFarMidSides = 0;
  std::int64_t NumberOfSplitCells = 0;
  std::int64_t NumberOfFoldedCells = 0;
};

} // namespace deformvolume

#endif
