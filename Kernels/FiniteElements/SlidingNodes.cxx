// SPDX-License-Identifier: BSD-3-Clause
#include "SlidingNodes.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>

namespace deformvolume
{

SlidingNodes::SlidingNodes(const ElasticBody& body)
{
  const bool isEmpty = body.SlidingNormals.empty() && body.SecondSlidingNormals.empty();
  for (std::size_t node = 0; node < body.Points.size() && !isEmpty; ++node)
  {
    const auto [first, second] = GetSlidingNormals(body, node);
    if (first != glm::dvec3(0.0) || second != glm::dvec3(0.0))
    {
      this->Indices.resize(body.Points.size(), -1);
      this->Indices[node] = static_cast<std::int32_t>(this->Nodes.size());
      this->Nodes.push_back(node);
      this->Projections.push_back(
        glm::dmat3(1.0) - glm::outerProduct(first, first) - glm::outerProduct(second, second));
    }
  }
}

void SlidingNodes::Project(std::vector<glm::dvec3>& vectors) const
{
  for (std::size_t i = 0; i < this->Nodes.size(); ++i)
  {
    glm::dvec3& vector = vectors[this->Nodes[i]];
    vector = this->Projections[i] * vector;
  }
}

void SlidingNodes::Constrain(BlockMatrix& matrix) const
{
  const BlockPattern& pattern = matrix.GetPattern();
  const auto get = [&](std::int32_t block) -> glm::dmat3
  { return glm::make_mat3(matrix.GetBlock(block)); };
  const auto set = [&](std::int32_t block, const glm::dmat3& value)
  { std::copy_n(glm::value_ptr(value), BlockMatrix::BlockSize, matrix.GetBlock(block)); };
  for (std::size_t i = 0; i < this->Nodes.size(); ++i)
  {
    const std::size_t node = this->Nodes[i];
    const glm::dmat3& projection = this->Projections[i];
    for (std::int32_t block = pattern.Rows[node]; block < pattern.Rows[node + 1]; ++block)
    {
      if (block != pattern.Diagonal[node])
      {
        const std::int32_t mirrored = pattern.Mirrored[static_cast<std::size_t>(block)];
        set(block, projection * get(block));
        set(mirrored, get(mirrored) * projection);
        continue;
      }
      const glm::dmat3 own = get(block);
      const double mean = (own[0][0] + own[1][1] + own[2][2]) / 3.0;
      set(block, projection * own * projection + mean * (glm::dmat3(1.0) - projection));
    }
  }
}

} // namespace deformvolume
