// SPDX-License-Identifier: BSD-3-Clause
// Meshes of many tetrahedra, and edits of their nodes and cells as in cuts and in refinement.
#ifndef Fuzz_TetrahedronEdits_h
#define Fuzz_TetrahedronEdits_h

#include "Random.h"

#include <vtkImageData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <ostream>

namespace fuzz
{

/// Returns a lattice around a volume which is so fine that a node moves a small part of the volume.
vtkSmartPointer<vtkUnstructuredGrid> MakeFineLattice(
  vtkImageData* volume, Random& random, std::ostream& log);

/// Splits or joins nodes, refines or removes tetrahedra of a mesh with displacements, in place.
/// Returns false for meshes with other cells.
bool EditTetrahedra(vtkUnstructuredGrid* mesh, Random& random, std::ostream& log);

} // namespace fuzz

#endif
