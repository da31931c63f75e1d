// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSplitRegion_h
#define DeformVolumeSplitRegion_h

#include "SheetCrossings.h"
#include "SnappedPoint.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The tetrahedra that a cut along a sheet has to do with: those near it, and all that have a node
/// of these. They and their nodes have numbers of their own here, in the order of those of the
/// mesh.
class SplitRegion
{
public:
  SplitRegion(const std::vector<glm::dvec3>& positions, const std::vector<Tetrahedron>& tetrahedra,
    const MeshSteps& steps, const SheetCrossings& crossings);

  std::size_t GetNumberOfTetrahedra() const { return this->Numbers.size(); }
  std::size_t GetNumberOfNodes() const { return this->Nodes.size(); }

  /// With the nodes of the region.
  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Tetrahedra; }
  /// What number a tetrahedron has in the mesh.
  std::size_t GetNumber(std::size_t tetrahedron) const { return this->Numbers[tetrahedron]; }
  /// The tetrahedron of a number of the mesh; GetNumberOfTetrahedra() where it is not in the
  /// region.
  std::size_t Find(std::size_t number) const;
  /// What number a node has in the mesh.
  std::int32_t GetNode(std::size_t node) const { return this->Nodes[node]; }

  /// Of two tetrahedra that share a face, the segment between the centroids of which the sheet
  /// crosses, one is near at least.
  bool IsNear(std::size_t tetrahedron) const { return this->Near[tetrahedron] != 0; }
  const SnappedPoint& GetCentroid(std::size_t tetrahedron) const
  {
    return this->Centroids[tetrahedron];
  }

private:
  void NumberNodes(const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes);

  std::vector<std::size_t> Numbers;
  std::vector<std::int32_t> Nodes;
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<unsigned char> Near;
  std::vector<SnappedPoint> Centroids;
};

} // namespace deformvolume

#endif
