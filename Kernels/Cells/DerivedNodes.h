// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDerivedNodes_h
#define DeformVolumeDerivedNodes_h

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Additional nodes that are not points of the grids of a mesh. The position and displacement of a
/// derived node are weighted sums of those of nodes of the grids. The weights add up to 1. The
/// indices of derived nodes follow those of the nodes of all grids.
struct DerivedNodes
{
  /// For each derived node, the end of its range in Nodes and Weights. A range begins at the end of
  /// the previous range.
  std::vector<std::uint64_t> Ends;
  /// The nodes of the sums of all derived nodes.
  std::vector<std::int32_t> Nodes;
  /// The weights of these nodes.
  std::vector<double> Weights;

  /// Number of derived nodes.
  std::size_t GetCount() const { return this->Ends.size(); }

  /// Adds a derived node, which is the weighted sum of the given nodes.
  void Add(const std::vector<std::int32_t>& nodes, const std::vector<double>& weights)
  {
    this->Nodes.insert(this->Nodes.end(), nodes.begin(), nodes.end());
    this->Weights.insert(this->Weights.end(), weights.begin(), weights.end());
    this->Ends.push_back(this->Nodes.size());
  }

  /// Returns the weighted sum for a derived node. get(node): returns the vector of a node of the
  /// grids.
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

  /// Whether all derived nodes are equal.
  bool operator==(const DerivedNodes& other) const
  {
    return this->Ends == other.Ends && this->Nodes == other.Nodes && this->Weights == other.Weights;
  }
};

} // namespace deformvolume

#endif
