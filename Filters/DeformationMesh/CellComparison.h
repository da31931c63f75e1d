// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellComparison_h
#define DeformVolumeCellComparison_h

#include "DeformationMesh.h"
#include "Tetrahedron.h"

#include <optional>
#include <vector>

namespace deformvolume
{

/// How the cells of a part of a mesh were when they were read.
struct CellMemory
{
  Stamp Arrays; // those of the cells, without the connectivity
  const void* Connectivity = nullptr;
  vtkMTimeType Time = 0; // of the connectivity
};

std::vector<CellMemory> GetCellMemories(const MeshParts& parts);

/// Which of some tetrahedra have other nodes, where the cells of a mesh are those now; in ascending
/// order. Nothing where it takes more than a comparison of memory to say: other cells than
/// tetrahedra, another number of them, ghosts, uncommon layouts, nodes that are not there, or
/// changes of so many tetrahedra that they are read faster. memories: of when the tetrahedra were
/// these. Where a log of the connectivity (vtkArrayChanges) tells which cells have been written
/// since, only these are compared. Empty: all are.
std::optional<std::vector<TetrahedronChange>> FindDifferences(const MeshParts& parts,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<CellMemory>& memories);

} // namespace deformvolume

#endif
