// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDerivedNodes_h
#define DeformVolumeDerivedNodes_h

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Nodes that the grids of a mesh do not have. Positions and displacements of each are sums of
/// those of nodes that they have, times weights whose sum is 1. They are numbered behind the nodes
/// of all grids.
struct DerivedNodes
{
  /// Of each the end of its nodes and their weights in the lists of all.
  std::vector<std::uint64_t> Ends;
  /// The nodes of all sums, one derived node after the other.
  std::vector<std::int32_t> Nodes;
  /// Their weights.
  std::vector<double> Weights;

  /// How many derived nodes there are.
  std::size_t GetCount() const { return this->Ends.size(); }

  /// Adds a derived node: the weighted sum of these nodes.
  void Add(const std::vector<std::int32_t>& nodes, const std::vector<double>& weights)
  {
    this->Nodes.insert(this->Nodes.end(), nodes.begin(), nodes.end());
    this->Weights.insert(this->Weights.end(), weights.begin(), weights.end());
    this->Ends.push_back(this->Nodes.size());
  }

  /// The weighted sum for a derived node. get(node): the vector of a node of the grids.
  template <typename Get>
  glm::dvec3 Sum(std::size_t derived, const Get& get) const
  {
    glm::dvec3 sum(0.0);
    for (std::size_t i = derived == 0 ? 0 : this->Ends[derived - 1]; i < this->Ends[derived]; ++i)
    {
      sum += this->Weights[i] * glm::dvec3(get(this->Nodes[i]));
    }
    return sum;
  }

  /// Whether all sums are equal.
  bool operator==(const DerivedNodes& other) const
  {
    return this->Ends == other.Ends && this->Nodes == other.Nodes && this->Weights == other.Weights;
  }
};

} // namespace deformvolume

#endif
