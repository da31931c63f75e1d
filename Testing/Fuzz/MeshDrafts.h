// SPDX-License-Identifier: BSD-3-Clause
// Nodes and cells that become a mesh.
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

// What becomes a mesh: nodes as indices of the volume.
struct Draft
{
  std::vector<glm::dvec3> Nodes;
  std::vector<Cell> Cells;
};

/// A lattice of tetrahedra or of other linear cells in a box, perhaps with jittered nodes.
Draft MakeLattice(const std::array<double, 6>& box, Random& random, std::ostream& log);

/// A few tetrahedra of any shape, also flat ones.
Draft MakeTetrahedra(const std::array<double, 6>& box, Random& random, std::ostream& log);

/// Adds cells and nodes that are unusual, but not an error.
void AddOddities(Draft& draft, Random& random, std::ostream& log);

/// Adds something that is an error.
void AddErrors(Draft& draft, Random& random, std::ostream& log);

/// Puts nodes and cells in any order.
void Shuffle(Draft& draft, Random& random);

} // namespace fuzz

#endif
