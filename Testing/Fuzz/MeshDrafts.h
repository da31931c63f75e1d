// SPDX-License-Identifier: BSD-3-Clause
// Nodes and cells from which a mesh is made.
#ifndef Fuzz_MeshDrafts_h
#define Fuzz_MeshDrafts_h

#include "Random.h"

#include <vtkType.h>

#include <glm/vec3.hpp>

#include <array>
#include <ostream>
#include <vector>

namespace fuzz
{

struct Cell
{
  int Type;
  std::vector<vtkIdType> Points;
};

// Nodes, in indices of the volume, and cells.
struct Draft
{
  std::vector<glm::dvec3> Nodes;
  std::vector<Cell> Cells;
};

/// Returns a lattice of tetrahedra or of other linear cells in a box, sometimes with jittered
/// nodes.
Draft MakeLattice(const std::array<double, 6>& box, Random& random, std::ostream& log);

/// Returns a few tetrahedra of any shape, also flat ones.
Draft MakeTetrahedra(const std::array<double, 6>& box, Random& random, std::ostream& log);

/// Adds cells and nodes that are unusual, but not an error.
void AddOddities(Draft& draft, Random& random, std::ostream& log);

/// Adds cells or nodes that are an error.
void AddErrors(Draft& draft, Random& random, std::ostream& log);

/// Puts nodes and cells in random order.
void Shuffle(Draft& draft, Random& random);

} // namespace fuzz

#endif
