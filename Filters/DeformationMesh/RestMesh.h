// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRestMesh_h
#define DeformVolumeRestMesh_h

#include "CellComparison.h"
#include "DeformationMesh.h"
#include "DerivedNodes.h"
#include "ImageGeometry.h"
#include "MeshStamp.h"
#include "Tetrahedron.h"
#include "VectorArray.h"

#include <glm/vec3.hpp>

#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace deformvolume
{

struct DeformationSource;

/// The tetrahedra of the deformation mesh, and its nodes at rest in continuous indices of the
/// volume. Reads again only what is not as it was, and says what that is. Content decides: a mesh
/// that is another object with the same cells and rest positions changes nothing.
///
/// What a tetrahedron is at rest, its shape, and which nodes it names, its connectivity, change by
/// themselves: where a node is split, tetrahedra get other nodes in the places of the old ones.
class RestMesh
{
public:
  /// shape: what port 1 has; rest: what has the rest positions, the same unless there is a port 2.
  /// Throws an Error where they cannot be used, or are not two configurations of one mesh.
  void Read(const MeshParts& shape, const MeshParts& rest, const DeformationSource& source);

  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Tetrahedra; }
  /// Those of the grids, and behind them the derived ones.
  const std::vector<glm::dvec3>& GetPoints() const { return this->Points; }
  const DerivedNodes& GetDerivedNodes() const { return this->Derived; }

  /// Changes with the shape of the tetrahedra at rest, and with their number.
  std::uint64_t GetShapeVersion() const { return this->ShapeVersion; }
  /// Changes with the shape, and with the nodes of tetrahedra and the number of nodes.
  std::uint64_t GetConnectivityVersion() const { return this->ConnectivityVersion; }
  /// The tetrahedra that have got other nodes since a version of the connectivity, while the shape
  /// was the same, each once. Nothing where that is not known any more.
  std::optional<std::vector<TetrahedronChange>> GetChanges(std::uint64_t version) const;

  /// Whether the last call of Read() found all nodes that there were before where they were.
  bool HasKeptPoints() const { return this->KeptPoints; }

  /// Cells that were ignored, in words for a warning; "" without such.
  const std::string& GetIgnoredCells() const { return this->IgnoredCells; }
  /// Quadratic cells with a node far from the middle of its edge, in words; "" without such.
  const std::string& GetFarMidSides() const { return this->FarMidSides; }

private:
  using Changes = std::vector<TetrahedronChange>;

  /// What the cells are found to be: how they differ, or all of them.
  struct CellReading
  {
    std::optional<Changes> Differences;  // where there are as many as before
    std::vector<Tetrahedron> All;        // where there is nothing in the former, or not that alone
    std::optional<DerivedNodes> Derived; // where they are others than there are
    std::string Ignored;
    std::string FarMidSides;
  };

  CellReading ReadCells(const MeshParts& shape, const MeshParts& rest, const DerivedNodes* derived,
    const MeshStamp& restCells, const MeshStamp& shapeCells);
  /// How the cells differ, where a comparison can tell that. sameRest, sameShape: whether both are
  /// as they were; shared: whether both are the same.
  std::optional<Changes> CompareCells(const MeshParts& shape, const MeshParts& rest, bool sameRest,
    bool sameShape, bool shared) const;
  /// Whether cells are as many tetrahedra as there are, in the places of these.
  bool HaveSameShape(const CellReading& cells) const;
  /// before: how many nodes there were. Returns false where nothing had to be read.
  bool ReadPoints(const MeshParts& rest, const DeformationSource& source, std::size_t before);
  /// before: how many nodes there were. kept: set to false where one of these is elsewhere now.
  void ReadMovedPoints(const MeshParts& rest, const DeformationSource& source, std::size_t before,
    std::atomic<bool>& kept);
  /// nodes: how many the grids have.
  void UpdateDerivedPoints(std::size_t nodes);
  void SetConnectivity(Changes&& changes);
  void SetShape(CellReading&& cells);

  std::vector<Tetrahedron> Tetrahedra;
  std::vector<glm::dvec3> Points;
  DerivedNodes Derived;
  NodeFaults PointFaults;
  std::string IgnoredCells;
  std::string FarMidSides;
  std::uint64_t ShapeVersion = 0;
  std::uint64_t ConnectivityVersion = 0;
  bool ShapeIsOld = false; // a reading that failed has left other points than that of the version
  bool KeptPoints = false;

  // The last changes of the connectivity, each with the version that it led to, and the version
  // before the first one.
  std::deque<std::pair<std::uint64_t, Changes>> Log;
  std::uint64_t LogBegin = 0;

  // What the above was read from.
  MeshStamp RestCells;
  MeshStamp ShapeCells;
  std::vector<CellMemory> RestCellMemories; // of each part
  MeshStamp PointsStamp;
  ImageGeometry Volume;
  std::vector<VectorMemory> PointMemories; // of each part
};

} // namespace deformvolume

#endif
