// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSlidingNodes_h
#define DeformVolumeSlidingNodes_h

#include "BlockMatrix.h"
#include "ElasticBody.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The nodes of a body that slide in a plane, or along the line where two meet, and what that does
/// to vectors and matrices.
class SlidingNodes
{
public:
  explicit SlidingNodes(const ElasticBody& body);

  /// The part of a vector at a node that it can follow: all of it where the node does not slide.
  glm::dvec3 Project(std::size_t node, const glm::dvec3& vector) const
  {
    const std::int32_t place = this->Places.empty() ? -1 : this->Places[node];
    return place < 0 ? vector : this->Projections[static_cast<std::size_t>(place)] * vector;
  }
  void Project(std::vector<glm::dvec3>& vectors) const;

  /// Leaves of a matrix what acts where nodes can go. Along the normals it has the mean stiffness
  /// of the node, so that it has an inverse.
  void Constrain(BlockMatrix& matrix) const;

private:
  // Of each node its place below; -1: it does not slide. Empty: none does.
  std::vector<std::int32_t> Places;
  std::vector<std::size_t> Nodes;
  std::vector<glm::dmat3> Projections;
};

} // namespace deformvolume

#endif
