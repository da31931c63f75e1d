// SPDX-License-Identifier: BSD-3-Clause
#include "SlidingNodes.h"

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>

namespace deformvolume
{

SlidingNodes::SlidingNodes(const ElasticBody& body)
{
  for (std::size_t node = 0; node < body.SlidingNormals.size(); ++node)
  {
    const glm::dvec3& normal = body.SlidingNormals[node];
    if (normal != glm::dvec3(0.0))
    {
      this->Normals.resize(body.Points.size(), glm::dvec3(0.0));
      this->Normals[node] = glm::normalize(normal);
      this->Nodes.push_back(static_cast<std::int32_t>(node));
    }
  }
}

void SlidingNodes::Project(std::vector<glm::dvec3>& vectors) const
{
  for (const std::int32_t number : this->Nodes)
  {
    const auto node = static_cast<std::size_t>(number);
    vectors[node] = this->Project(node, vectors[node]);
  }
}

void SlidingNodes::Constrain(BlockMatrix& matrix) const
{
  const BlockPattern& pattern = matrix.GetPattern();
  for (const std::int32_t number : this->Nodes)
  {
    const auto node = static_cast<std::size_t>(number);
    const glm::dvec3& normal = this->Normals[node];
    const glm::dmat3 projection = glm::dmat3(1.0) - glm::outerProduct(normal, normal);
    for (std::int32_t block = pattern.Rows[node]; block < pattern.Rows[node + 1]; ++block)
    {
      const glm::dmat3 own = glm::make_mat3(matrix.GetBlock(block));
      glm::dmat3 result = projection * own;
      if (block == pattern.Diagonal[node])
      {
        const double mean = (own[0][0] + own[1][1] + own[2][2]) / 3.0;
        result = result * projection + mean * glm::outerProduct(normal, normal);
      }
      else
      {
        const std::int32_t mirrored = pattern.Mirrored[static_cast<std::size_t>(block)];
        const glm::dmat3 other = glm::dmat3(glm::make_mat3(matrix.GetBlock(mirrored))) * projection;
        std::copy_n(glm::value_ptr(other), BlockMatrix::BlockSize, matrix.GetBlock(mirrored));
      }
      std::copy_n(glm::value_ptr(result), BlockMatrix::BlockSize, matrix.GetBlock(block));
    }
  }
}

} // namespace deformvolume
