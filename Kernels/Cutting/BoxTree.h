// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoxTree_h
#define DeformVolumeBoxTree_h

#include "SnappedPoint.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Finds those of many boxes that overlap another one.
class BoxTree
{
public:
  explicit BoxTree(std::vector<SnappedBox> boxes);
  /// getBox: the box of one of the items.
  template <typename Item, typename GetBox>
  BoxTree(const std::vector<Item>& items, const GetBox& getBox)
    : BoxTree(TransformItems(items, getBox))
  {
  }

  /// Appends the numbers of the boxes that overlap a box, in no certain order.
  void Find(const SnappedBox& box, std::vector<std::size_t>& numbers) const;
  /// Whether any of them does.
  bool Overlaps(const SnappedBox& box) const;

  const SnappedBox& GetBox(std::size_t number) const { return this->Boxes[number]; }

private:
  template <typename Item, typename GetBox>
  static std::vector<SnappedBox> TransformItems(
    const std::vector<Item>& items, const GetBox& getBox)
  {
    std::vector<SnappedBox> boxes(items.size());
    std::transform(items.begin(), items.end(), boxes.begin(), getBox);
    return boxes;
  }

  /// A box around some of the boxes: those between two places in Order, or two nodes.
  struct Node
  {
    SnappedBox Box;
    std::size_t Begin = 0;
    std::size_t End = 0;
    std::size_t Upper = 0; // the lower node is the next one; 0: a leaf
  };

  void Build(std::size_t begin, std::size_t end);
  /// Calls a function for the number of each box that overlaps, until it returns false.
  template <typename Visitor>
  void Visit(const SnappedBox& box, Visitor&& visitor) const;

  std::vector<SnappedBox> Boxes;
  std::vector<std::size_t> Order;
  std::vector<Node> Nodes;
};

} // namespace deformvolume

#endif
