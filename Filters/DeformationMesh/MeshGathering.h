// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshGathering_h
#define DeformVolumeMeshGathering_h

#include "DeformationSource.h"
#include "DerivedNodes.h"
#include "Ranks.h"

#include "vtkSmartPointer.h"

#include <set>
#include <string>

class vtkUnstructuredGrid;

namespace deformvolume
{

class RestMesh;

/// Gathers a deformation mesh of which each rank has a piece, so that every rank has the whole
/// mesh. The pieces follow each other in the order of the ranks, without ghost cells. If every rank
/// already has the same whole mesh, that mesh is used. The result is kept until the piece of any
/// rank changes.
class MeshGathering
{
public:
  /// Returns a source with the whole mesh. Returns `source` itself if it is a displacement field,
  /// which every rank has as a whole, or if there is one process. joins: whether tetrahedra of
  /// different ranks use the same node where each rank has a copy of it, with the same position at
  /// rest and the same displacement. Throws the same Error on all ranks. Collective.
  DeformationSource Gather(const Ranks& ranks, const DeformationSource& source, bool joins);

  /// Describes the ignored cells of the first piece that has some; "": there are none.
  const std::string& GetIgnoredCells() const { return this->IgnoredCells; }
  /// See RestMesh::GetWrongOrder(): of the first piece that has such cells.
  const std::string& GetWrongOrder() const { return this->WrongOrder; }

private:
  struct Piece;

  /// places: CellNode::Place of each node of the piece; null: it has tetrahedra only.
  Piece Read(const DeformationSource& source, const std::vector<std::int32_t>* places) const;
  void Make(const Piece& whole, bool withRest);

  Stamp PieceStamp; // empty: there is no mesh
  std::string Choice;
  bool Joined = false; // whether copies of nodes have been joined
  vtkSmartPointer<vtkUnstructuredGrid> Shape;
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  DerivedNodes
    Derived; // used by the cells of Shape and Rest; their indices follow those of the points
  std::string IgnoredCells;
  std::string WrongOrder;
};

/// Adds warnings about cells of a mesh that are ignored, or that are probably wrong.
void AddCellWarnings(
  const RestMesh& mesh, const MeshGathering& gathering, std::set<std::string>& warnings);

} // namespace deformvolume

#endif
