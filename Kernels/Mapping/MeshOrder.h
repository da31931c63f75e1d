// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshOrder_h
#define DeformVolumeMeshOrder_h

#include "BrickGrid.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The numbers by which the device knows the nodes and the tetrahedra of a deformation mesh. They
/// are numbered as they are used first, so that what is used together lies together in memory,
/// however the mesh itself is numbered. What is not used comes last, in the order of the mesh.
struct MeshOrder
{
  /// The device's number of each tetrahedron, and of each node, of the mesh. Empty: its own.
  std::vector<std::int32_t> Tetrahedra;
  std::vector<std::int32_t> Nodes;

  static std::int32_t Get(const std::vector<std::int32_t>& numbers, std::size_t i)
  {
    return numbers.empty() ? static_cast<std::int32_t>(i) : numbers[i];
  }
  /// Of the tetrahedron of a link, which may be none.
  std::int32_t GetLinked(std::int32_t tetrahedron) const
  {
    return tetrahedron < 0 ? -1 : Get(this->Tetrahedra, static_cast<std::size_t>(tetrahedron));
  }
};

/// In the order in which bricks are worked on, each row by row.
MeshOrder FindOrder(const BrickGrid& bricks, const VertexLink* links, const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes);

/// In the order of the records of runs.
MeshOrder FindOrder(const VertexRuns& runs, const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes);

} // namespace deformvolume

#endif
