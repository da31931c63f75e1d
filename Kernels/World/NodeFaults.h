// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNodeFaults_h
#define DeformVolumeNodeFaults_h

#include "Tetrahedron.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Nodes of a mesh whose position or vector cannot be used. They count as zero, and are an error
/// only where a tetrahedron uses them. Several threads may mark different nodes at a time.
class NodeFaults
{
public:
  /// What is wrong with a node.
  enum Kind : unsigned char
  {
    None,
    NotFinite,
    TooFar,
    Missing
  };

  /// There are so many nodes; new ones have no fault.
  void Resize(std::size_t count) { this->Kinds.resize(count, None); }
  /// There are no nodes.
  void Reset()
  {
    this->Kinds.clear();
    this->Any = false;
  }
  /// A node has a fault.
  void Mark(std::int64_t node, Kind kind)
  {
    this->Kinds[static_cast<std::size_t>(node)] = kind;
    this->Any.store(true, std::memory_order_relaxed);
  }
  /// Nodes are about to be read again.
  void Clear(std::int64_t first, std::int64_t count)
  {
    if (this->Any.load(std::memory_order_relaxed))
    {
      std::fill_n(this->Kinds.begin() + first, count, None);
    }
  }
  /// False: no node has a fault.
  bool MayHaveAny() const { return this->Any; }
  /// The fault of a node, or None.
  Kind Get(std::int64_t node) const
  {
    return static_cast<Kind>(this->Kinds[static_cast<std::size_t>(node)]);
  }

  /// The first faulty node that some tetrahedra use, or -1.
  std::int64_t FindUsed(const std::vector<Tetrahedron>& tetrahedra) const
  {
    std::int64_t found = -1;
    for (const Tetrahedron& tetrahedron : tetrahedra)
    {
      if (!this->Any)
      {
        break;
      }
      for (const std::int32_t node : tetrahedron)
      {
        // Nodes behind these are derived from others.
        if (static_cast<std::size_t>(node) < this->Kinds.size() && this->Kinds[node] != None &&
          (found < 0 || node < found))
        {
          found = node;
        }
      }
    }
    return found;
  }

private:
  std::vector<unsigned char> Kinds;
  std::atomic<bool> Any{ false };
};

} // namespace deformvolume

#endif
