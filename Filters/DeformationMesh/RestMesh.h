// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRestMesh_h
#define DeformVolumeRestMesh_h

#include "DeformationMesh.h"
#include "DerivedNodes.h"
#include "ImageGeometry.h"
#include "MeshStamp.h"
#include "Tetrahedron.h"
#include "VectorArray.h"

#include <glm/vec3.hpp>

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{

struct DeformationSource;

/// The tetrahedra of the deformation mesh, and its nodes at rest in continuous indices of the
/// volume. Only arrays that have changed are read again. Versions change with the content: another
/// object with the same cells and rest positions changes no version.
///
/// The shape of a tetrahedron (its positions at rest) and its connectivity (the nodes that it uses)
/// have separate versions: if a node is split, tetrahedra get new nodes at the positions of the old
/// ones.
class RestMesh
{
public:
  /// Reads the mesh. shape: the deformation mesh. rest: the grids with the positions at rest, which
  /// are `shape` if there is no mesh at rest. Throws an Error if they cannot be used, or are
  /// not one mesh, at rest and deformed.
  void Read(const MeshParts& shape, const MeshParts& rest, const DeformationSource& source);

  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Tetrahedra; }
  /// The nodes of the grids, followed by the derived nodes.
  const std::vector<glm::dvec3>& GetPoints() const { return this->Points; }
  const DerivedNodes& GetDerivedNodes() const { return this->Derived; }

  /// Changes if the shape of a tetrahedron at rest or the number of tetrahedra changes.
  std::uint64_t GetShapeVersion() const { return this->ShapeVersion; }
  /// Changes if the shape, the nodes of a tetrahedron or the number of nodes changes.
  std::uint64_t GetConnectivityVersion() const { return this->ConnectivityVersion; }
  /// The tetrahedra that have other nodes than at a version of the connectivity, each once. Returns
  /// nothing unless this is the current version, or the one before and the shape is the same.
  std::optional<std::vector<TetrahedronChange>> GetChanges(std::uint64_t version) const;

  /// Whether the last call of Read() did not move any node that existed before.
  bool HasKeptPoints() const { return this->KeptPoints; }

  /// Describes ignored cells for a warning; "": no cells were ignored.
  const std::string& GetIgnoredCells() const { return this->IgnoredCells; }
  /// Describes cells whose nodes are probably not in VTK's order; "": there are none.
  const std::string& GetWrongOrder() const { return this->WrongOrder; }

private:
  using Changes = std::vector<TetrahedronChange>;

  /// Result of reading the cells: the differences from the last tetrahedra, or all tetrahedra.
  struct CellReading
  {
    std::optional<Changes> Differences;  // nothing: the number of tetrahedra has changed
    std::vector<Tetrahedron> All;        // empty: the cells were not read
    std::optional<DerivedNodes> Derived; // nothing: the cells were not read
    std::string Ignored;
    std::string WrongOrder;
    bool DependOnPoints = false;
  };

  CellReading ReadCells(const MeshParts& shape, const MeshParts& rest,
    const DeformationSource& source, const MeshStamp& restCells, const MeshStamp& shapeCells);
  /// Whether the nodes differ from the last ones in number or position.
  bool HavePointsChanged(const MeshParts& rest, const DeformationSource& source) const;
  /// Whether the cells are as many tetrahedra as before, with the same positions at rest.
  bool HaveSameShape(const CellReading& cells) const;
  /// before: number of nodes before. Returns false if nothing had to be read.
  bool ReadPoints(const MeshParts& rest, const DeformationSource& source, std::size_t before);
  /// before: number of nodes before. kept: set to false if one of these nodes has moved.
  void ReadMovedPoints(const MeshParts& rest, const DeformationSource& source, std::size_t before,
    std::atomic<bool>& kept);
  /// nodes: number of nodes of the grids.
  void UpdateDerivedPoints(std::size_t nodes);

  std::vector<Tetrahedron> Tetrahedra;
  std::vector<glm::dvec3> Points;
  DerivedNodes Derived;
  NodeFaults PointFaults;
  std::string IgnoredCells;
  std::string WrongOrder;
  std::uint64_t ShapeVersion = 0;
  std::uint64_t ConnectivityVersion = 0;
  bool ShapeIsOld = false; // a failed reading has left points that do not belong to ShapeVersion
  bool KeptPoints = false;
  bool CellsDependOnPoints = false; // see MeshCells

  // The changes from the last version of the connectivity to this one; nothing: the shape changed.
  std::optional<Changes> LastChanges;

  // Stamps of the inputs that the members above were read from.
  MeshStamp RestCells;
  MeshStamp ShapeCells;
  MeshStamp PointsStamp;
  ImageGeometry Volume;
  std::vector<VectorMemory> PointMemories; // of each part
};

} // namespace deformvolume

#endif
