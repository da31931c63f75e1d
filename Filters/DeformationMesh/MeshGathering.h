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

/// Makes a deformation mesh of which each rank has a piece whole on every rank: pieces one after
/// the other in the order of ranks, ghost cells left out. A mesh that every rank has whole is taken
/// once. Keeps what it made until the piece of any rank changes.
class MeshGathering
{
public:
  /// Collective. The source of the whole mesh; a displacement field, which every rank has whole,
  /// and any source of a single process are given back as they are. Throws the same Error on all
  /// ranks.
  DeformationSource Gather(const Ranks& ranks, const DeformationSource& source);

  /// Cells of this rank's piece that were ignored, in words; "" without such.
  const std::string& GetIgnoredCells() const { return this->IgnoredCells; }
  /// See RestMesh.
  const std::string& GetFarMidSides() const { return this->FarMidSides; }

private:
  struct Piece;

  Piece Read(const DeformationSource& source) const;
  void Make(const Piece& whole, bool withRest);

  Stamp PieceStamp; // empty: there is no mesh
  std::string Choice;
  vtkSmartPointer<vtkUnstructuredGrid> Shape;
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  DerivedNodes Derived; // which the cells of both name, behind their points
  std::string IgnoredCells;
  std::string FarMidSides;
};

/// Adds what there is to say of cells of a mesh that are ignored, or look wrong.
void AddCellWarnings(
  const RestMesh& mesh, const MeshGathering& gathering, std::set<std::string>& warnings);

} // namespace deformvolume

#endif
