// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellComparison_h
#define DeformVolumeCellComparison_h

#include "DeformationMesh.h"
#include "Tetrahedron.h"

#include <optional>
#include <vector>

namespace deformvolume
{

/// State of the cells of a part of a mesh when they were read.
struct CellMemory
{
  Stamp Arrays; // arrays of the cells, without the connectivity
  const void* Connectivity = nullptr;
  vtkMTimeType Time = 0; // modification time of the connectivity
};

std::vector<CellMemory> GetCellMemories(const MeshParts& parts);

/// Compares the cells of a mesh with tetrahedra that were read from it before. Returns those with
/// other nodes, in ascending order. Returns nothing if a comparison of memory does not suffice: for
/// cells other than tetrahedra, another number of cells, ghost cells, uncommon layouts, nodes that
/// do not exist, or so many changes that reading the cells is faster. memories: the
/// result of GetCellMemories() when the tetrahedra were read. If a log of the connectivity
/// (vtkArrayChanges) has the cells that were written since then, only these cells are compared.
/// With empty memories, all cells are compared.
std::optional<std::vector<TetrahedronChange>> FindDifferences(const MeshParts& parts,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<CellMemory>& memories);

} // namespace deformvolume

#endif
