// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSlidingNodes_h
#define DeformVolumeSlidingNodes_h

#include "BlockMatrix.h"
#include "ElasticBody.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace deformvolume
{

/// The nodes of a body that slide in a plane, and what that does to vectors and matrices.
class SlidingNodes
{
public:
  explicit SlidingNodes(const ElasticBody& body);

  /// The part of a vector at a node that lies in its plane: all of it where the node does not
  /// slide.
  glm::dvec3 Project(std::size_t node, const glm::dvec3& vector) const
  {
    return this->Normals.empty()
      ? vector
      : vector - glm::dot(this->Normals[node], vector) * this->Normals[node];
  }
  void Project(std::vector<glm::dvec3>& vectors) const;

  /// Leaves of a matrix what acts within the planes. Along the normals it has the mean stiffness of
  /// the node, so that it has an inverse.
  void Constrain(BlockMatrix& matrix) const;

private:
  std::vector<glm::dvec3> Normals; // of length 1, or 0; empty: no node slides
  std::vector<std::int32_t> Nodes;
};

} // namespace deformvolume

#endif
