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

/// The nodes of a mesh whose position or vector cannot be used. Such a position or vector is
/// replaced by zeros, and is an error only if a tetrahedron uses the node. Several threads may mark
/// different nodes at the same time.
class NodeFaults
{
public:
  /// The kind of a fault.
  enum Kind : unsigned char
  {
    None,
    NotFinite,
    TooFar,
    Missing
  };

  /// Sets the number of nodes. New nodes have no fault.
  void Resize(std::size_t count) { this->Kinds.resize(count, None); }
  /// Removes all nodes.
  void Reset()
  {
    this->Kinds.clear();
    this->Any = false;
  }
  /// Sets the fault of a node.
  void Mark(std::int64_t node, Kind kind)
  {
    this->Kinds[static_cast<std::size_t>(node)] = kind;
    this->Any.store(true, std::memory_order_relaxed);
  }
  /// Removes the faults of `count` nodes from `first` on, before these nodes are read again.
  void Clear(std::int64_t first, std::int64_t count)
  {
    if (this->Any.load(std::memory_order_relaxed))
    {
      std::fill_n(this->Kinds.begin() + first, count, None);
    }
  }
  /// Whether a node may have a fault. If false, no node has one.
  bool MayHaveAny() const { return this->Any; }
  /// Returns the fault of a node, or None.
  Kind Get(std::int64_t node) const
  {
    return static_cast<Kind>(this->Kinds[static_cast<std::size_t>(node)]);
  }

  /// Returns the lowest faulty node that one of the tetrahedra uses, or -1.
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
        // Nodes with higher numbers are derived nodes, which have no faults of their own.
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
