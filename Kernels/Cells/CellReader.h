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

/// The tetrahedra of a deformation mesh, and what is said of the cells that they were made from.
struct MeshCells
{
  /// The tetrahedra, cell after cell.
  std::vector<Tetrahedron> Tetrahedra;
  /// Nodes that some tetrahedra have besides those of the mesh, numbered behind these.
  DerivedNodes Derived;
  /// Cells that are not three-dimensional, or of a type that is not known, in words for a warning;
  /// "" without such.
  std::string Ignored;
  /// Quadratic cells with a node that is far from the middle of its edge, in words for a warning;
  /// "" without such.
  std::string FarMidSides;
};

/// Warnings of ignored cells and of far nodes (MeshCells).
DEFORMVOLUME_EXPORT std::vector<std::string> GetCellWarnings(
  const std::string& ignored, const std::string& farMidSides);

/// Throws an Error of a cell of the deformation mesh with so many points.
[[noreturn]] DEFORMVOLUME_EXPORT void ThrowBadCell(
  std::int64_t cell, int type, std::int64_t count, const std::string& complaint);

/// Throws an Error where a cell of the deformation mesh uses a point that is not there.
DEFORMVOLUME_EXPORT void CheckCellPoint(
  std::int64_t point, std::int64_t numberOfPoints, std::int64_t cell);

/// Takes the cells of a deformation mesh, one after the other: tetrahedra, and those that other
/// three-dimensional cells (cellNumbers) are split into. The nodes of quadratic and Lagrange cells
/// all become nodes of tetrahedra.
class DEFORMVOLUME_EXPORT CellReader
{
public:
  /// Where a node is at rest. Few cells need it.
  using Positions = std::function<glm::dvec3(std::int32_t node)>;

  /// rounding: the relative error of positions.
  CellReader(std::int32_t numberOfNodes, Positions positions, double rounding);

  /// Reserves memory for so many tetrahedra.
  void Reserve(std::size_t numberOfTetrahedra)
  {
    this->Cells.Tetrahedra.reserve(numberOfTetrahedra);
  }
  /// Derived nodes that cells name already.
  void SetDerived(const DerivedNodes& derived) { this->Cells.Derived = derived; }

  /// Throws an Error where a cell of this type has another number of points.
  static void CheckSize(std::int64_t cell, int type, std::int64_t count);

  /// Adds a tetrahedron as it is.
  void AddTetrahedron(const Tetrahedron& nodes) { this->Cells.Tetrahedra.push_back(nodes); }
  /// A cell of another type than Polyhedron. nodes: of the mesh, in the order of the cell. degrees:
  /// of a Lagrange cell along its axes; null: they follow from the number of nodes. Throws an Error
  /// where it has a wrong number of nodes, and where it is a Bezier cell.
  void Add(std::int64_t cell, int type, const std::vector<std::int32_t>& nodes,
    const std::array<int, 3>* degrees);
  /// The nodes of each face, in order round it.
  using PolyhedronFaces = std::vector<std::vector<std::int32_t>>;
  /// A polyhedron, which brings its own faces. count: of its points, for errors. areComplete:
  /// whether all faces could be read. Throws an Error where some are missing, and where it cannot
  /// be split.
  void AddPolyhedron(
    std::int64_t cell, std::int64_t count, const PolyhedronFaces& faces, bool areComplete);

  /// All that has been made. The reader is not used any more then.
  MeshCells Finish();

private:
  std::int32_t AddNode(const std::vector<std::int32_t>& nodes, const std::vector<double>& weights);
  void AddHigherOrder(std::int64_t cell, int type, const std::vector<std::int32_t>& nodes,
    const std::array<int, 3>* degrees);
  bool HasNearMidSides(int type, const std::vector<std::int32_t>& nodes) const;

  const std::int32_t NumberOfNodes;
  const Positions GetPosition;
  const double Rounding;
  MeshCells Cells;
  HigherOrderCells HigherOrder;
  std::map<int, std::int64_t> Ignored;
  std::int64_t NumberOfQuadraticCells = 0;
  std::int64_t NumberOfFarMidSides = 0;
};

} // namespace deformvolume

#endif
