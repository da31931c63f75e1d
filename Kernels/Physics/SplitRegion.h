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

/// The tetrahedra that a cut along a sheet can affect: the tetrahedra near the sheet, and all
/// tetrahedra that share a node with them. The tetrahedra and nodes of the region are numbered from
/// 0, in the order of the mesh.
class SplitRegion
{
public:
  SplitRegion(const std::vector<glm::dvec3>& positions, const std::vector<Tetrahedron>& tetrahedra,
    const MeshSteps& steps, const SheetCrossings& crossings);

  std::size_t GetNumberOfTetrahedra() const { return this->Numbers.size(); }
  std::size_t GetNumberOfNodes() const { return this->Nodes.size(); }

  /// The tetrahedra, with node numbers of the region.
  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Tetrahedra; }
  /// The number of a tetrahedron in the mesh.
  std::size_t GetNumber(std::size_t tetrahedron) const { return this->Numbers[tetrahedron]; }
  /// The tetrahedron with a number of the mesh; GetNumberOfTetrahedra() if it is not in the region.
  std::size_t Find(std::size_t number) const;
  /// The number of a node in the mesh.
  std::int32_t GetNode(std::size_t node) const { return this->Nodes[node]; }

  /// Whether a tetrahedron is near the sheet. If the sheet crosses the segment between the
  /// centroids of two tetrahedra with a common face, at least one of the two is near.
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
