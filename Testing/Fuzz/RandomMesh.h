// SPDX-License-Identifier: BSD-3-Clause
// Random deformation meshes.
#ifndef Fuzz_RandomMesh_h
#define Fuzz_RandomMesh_h

#include "Random.h"

#include <vtkImageData.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <ostream>

namespace fuzz
{

/// Returns a mesh at rest around or in a volume: a lattice of tetrahedra or of mixed linear cells,
/// or random tetrahedra, with nodes and cells in random order. Sometimes cells are flat, inverted,
/// duplicate or ignored, and points are not used by any cell. Rarely the mesh is an error.
vtkSmartPointer<vtkUnstructuredGrid> MakeMesh(
  vtkImageData* volume, Random& random, std::ostream& log);

/// Returns a lattice with a node at each voxel.
vtkSmartPointer<vtkUnstructuredGrid> MakeVoxelMesh(vtkImageData* volume);

/// Distributes the cells of a mesh to several blocks. Some blocks are empty or are not meshes.
vtkSmartPointer<vtkMultiBlockDataSet> MakeBlocks(vtkUnstructuredGrid* mesh, Random& random);

/// Adds points or cells, replaces or reorders cells, moves nodes or splits them, in place.
void EditCells(vtkUnstructuredGrid* mesh, Random& random, std::ostream& log);

} // namespace fuzz

#endif
