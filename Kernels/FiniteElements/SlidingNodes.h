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

/// The sliding nodes of a body, and the projections of vectors and matrices to their planes and
/// lines.
class SlidingNodes
{
public:
  explicit SlidingNodes(const ElasticBody& body);

  /// Projects a vector at a node to its plane or line. Does not change vectors at nodes that do not
  /// slide.
  glm::dvec3 Project(std::size_t node, const glm::dvec3& vector) const
  {
    const std::int32_t index = this->Indices.empty() ? -1 : this->Indices[node];
    return index < 0 ? vector : this->Projections[static_cast<std::size_t>(index)] * vector;
  }
  void Project(std::vector<glm::dvec3>& vectors) const;

  /// Projects a matrix on both sides. Along the normals it gets the mean stiffness of the node, so
  /// that it stays invertible.
  void Constrain(BlockMatrix& matrix) const;

private:
  // The index of each node in Nodes and Projections; -1: it does not slide. Empty: no node slides.
  std::vector<std::int32_t> Indices;
  std::vector<std::size_t> Nodes;
  std::vector<glm::dmat3> Projections;
};

} // namespace deformvolume

#endif
