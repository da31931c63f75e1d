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

/// A mesh at rest round or in a volume: a lattice of tetrahedra or of mixed linear cells, or random
/// tetrahedra, with nodes and cells in any order; perhaps with cells that are flat, inverted,
/// doubled or ignored, and with points that none uses. Now and then one that is an error.
vtkSmartPointer<vtkUnstructuredGrid> MakeMesh(
  vtkImageData* volume, Random& random, std::ostream& log);

/// A lattice with a node at each voxel.
vtkSmartPointer<vtkUnstructuredGrid> MakeVoxelMesh(vtkImageData* volume);

/// The cells of a mesh, dealt out to several blocks; some blocks are empty or no meshes.
vtkSmartPointer<vtkMultiBlockDataSet> MakeBlocks(vtkUnstructuredGrid* mesh, Random& random);

/// Adds points or cells, replaces or reorders cells, moves nodes or splits them, in place.
void EditCells(vtkUnstructuredGrid* mesh, Random& random, std::ostream& log);

} // namespace fuzz

#endif
