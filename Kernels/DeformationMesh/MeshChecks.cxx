// SPDX-License-Identifier: BSD-3-Clause
#include "MeshChecks.h"

#include "Error.h"
#include "KernelParameters.h"

#include <string>

namespace deformvolume
{

void CheckMesh(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
{
  if (!numberOfTetrahedra || !numberOfNodes || !tetrahedra)
  {
    throw Error("The deformation mesh is empty: it has " + std::to_string(numberOfTetrahedra) +
      " tetrahedra and " + std::to_string(numberOfNodes) + " nodes. Both are needed.");
  }
  static_assert(DEFORMVOLUME_NODE_STRIDE == 2, "The limit is 2^31 / DEFORMVOLUME_NODE_STRIDE.");
  if (numberOfNodes > std::size_t{ 1 } << 30)
  {
    throw Error("The deformation mesh has " + std::to_string(numberOfNodes) +
      " nodes, but at most 2^30 are possible. Use a coarser mesh.");
  }
  CheckTetrahedra(tetrahedra, 0, numberOfTetrahedra, numberOfNodes);
}

void CheckTetrahedra(
  const Tetrahedron* tetrahedra, std::size_t begin, std::size_t end, std::size_t numberOfNodes)
{
  for (std::size_t t = begin; t < end; ++t)
  {
    for (const std::int32_t node : tetrahedra[t])
    {
      if (node < 0 || static_cast<std::size_t>(node) >= numberOfNodes)
      {
        throw Error("Tetrahedron " + std::to_string(t) +
          " of the deformation mesh refers to node " + std::to_string(node) +
          ", but the mesh has only " + std::to_string(numberOfNodes) + " nodes.");
      }
    }
  }
}

void CheckLinks(const VertexLink* links, std::int64_t count, std::size_t numberOfTetrahedra)
{
  for (std::int64_t i = 0; i < count; ++i)
  {
    if (links[i].Tetrahedron >= 0 &&
      static_cast<std::size_t>(links[i].Tetrahedron) >= numberOfTetrahedra)
    {
      throw Error("Voxel " + std::to_string(i) + " is linked to tetrahedron " +
        std::to_string(links[i].Tetrahedron) + ", but the mesh has only " +
        std::to_string(numberOfTetrahedra) + " tetrahedra.");
    }
  }
}

} // namespace deformvolume
