// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoxTree_h
#define DeformVolumeBoxTree_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace deformvolume
{

/// A bounding volume hierarchy: finds the boxes that overlap a given box. Box is SnappedBox or
/// IndexBounds. Several threads may call const functions at the same time.
template <typename Box>
class BoxTree
{
public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box> boxes)
    : Boxes(std::move(boxes))
    , Order(this->Boxes.size())
  {
    std::iota(this->Order.begin(), this->Order.end(), std::size_t{ 0 });
    if (!this->Boxes.empty())
    {
      this->Build(0, this->Order.size());
    }
  }
  /// getBox(item) returns the box of an item.
  template <typename Item, typename GetBox>
  BoxTree(const std::vector<Item>& items, const GetBox& getBox)
    : BoxTree(TransformItems(items, getBox))
  {
  }

  /// Calls visitor(number) for each box that overlaps `box`, in unspecified order. number: index of
  /// the box. Stops when the visitor returns false.
  template <typename Visitor>
  void Visit(const Box& box, Visitor&& visitor) const
  {
    std::array<std::size_t, 128> rest; // the tree is balanced: its depth is at most 64
    std::size_t count = 0;
    if (!this->Nodes.empty())
    {
      rest[count++] = 0;
    }
    while (count > 0)
    {
      const std::size_t number = rest[--count];
      const Node& node = this->Nodes[number];
      if (!node.Bounds.Overlaps(box))
      {
        continue;
      }
      if (node.Upper != 0)
      {
        rest[count++] = node.Upper;
        rest[count++] = number + 1;
        continue;
      }
      for (std::size_t i = node.Begin; i < node.End; ++i)
      {
        if (this->Boxes[this->Order[i]].Overlaps(box) && !visitor(this->Order[i]))
        {
          return;
        }
      }
    }
  }

  /// Calls visitor(number) for the boxes that may be nearest, near ones first. getDistance(box)
  /// returns the distance of a box, and isTooFar(distance) whether the visitor need not see the
  /// boxes at this distance or beyond.
  template <typename GetDistance, typename IsTooFar, typename Visitor>
  void VisitNearest(
    const GetDistance& getDistance, const IsTooFar& isTooFar, Visitor&& visitor) const
  {
    struct Entry
    {
      std::size_t Node;
      double Distance;
    };
    std::array<Entry, 128> rest; // as in Visit()
    std::size_t count = 0;
    if (!this->Nodes.empty())
    {
      rest[count++] = { 0, 0.0 };
    }
    while (count > 0)
    {
      const Entry entry = rest[--count];
      const Node& node = this->Nodes[entry.Node];
      if (isTooFar(entry.Distance))
      {
        continue;
      }
      if (node.Upper == 0)
      {
        std::for_each(this->Order.begin() + static_cast<std::ptrdiff_t>(node.Begin),
          this->Order.begin() + static_cast<std::ptrdiff_t>(node.End), visitor);
        continue;
      }
      const auto enter = [&](std::size_t child) {
        return Entry{ child, getDistance(this->Nodes[child].Bounds) };
      };
      Entry near = enter(entry.Node + 1);
      Entry far = enter(node.Upper);
      if (far.Distance < near.Distance)
      {
        std::swap(near, far);
      }
      if (!isTooFar(far.Distance))
      {
        rest[count++] = far;
      }
      if (!isTooFar(near.Distance))
      {
        rest[count++] = near;
      }
    }
  }

  /// Appends the indices of the boxes that overlap `box`, in unspecified order.
  void Find(const Box& box, std::vector<std::size_t>& numbers) const
  {
    this->Visit(box,
      [&numbers](std::size_t number)
      {
        numbers.push_back(number);
        return true;
      });
  }

  /// Whether any box of the tree overlaps `box`.
  bool Overlaps(const Box& box) const
  {
    bool found = false;
    this->Visit(box,
      [&found](std::size_t)
      {
        found = true;
        return false;
      });
    return found;
  }

  const Box& GetBox(std::size_t number) const { return this->Boxes[number]; }

private:
  static constexpr std::size_t LeafSize = 4;

  template <typename Item, typename GetBox>
  static std::vector<Box> TransformItems(const std::vector<Item>& items, const GetBox& getBox)
  {
    std::vector<Box> boxes(items.size());
    std::transform(items.begin(), items.end(), boxes.begin(), getBox);
    return boxes;
  }

  /// Bounds of the boxes Order[Begin] to Order[End - 1].
  struct Node
  {
    Box Bounds;
    std::size_t Begin = 0;
    std::size_t End = 0;
    std::size_t Upper =
      0; // index of the second child, 0 in a leaf. The first child is the next node
  };

  void Build(std::size_t begin, std::size_t end)
  {
    const std::size_t number = this->Nodes.size();
    this->Nodes.emplace_back();
    Box box;
    for (std::size_t i = begin; i < end; ++i)
    {
      box.Add(this->Boxes[this->Order[i]]);
    }
    this->Nodes[number].Bounds = box;
    this->Nodes[number].Begin = begin;
    this->Nodes[number].End = end;
    if (end - begin <= LeafSize)
    {
      return;
    }
    const auto size = box.Max - box.Min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t index)
    { return this->Order.begin() + static_cast<std::ptrdiff_t>(index); };
    std::nth_element(at(begin), at(middle), at(end),
      [this, axis](std::size_t a, std::size_t b)
      {
        return this->Boxes[a].Min[axis] + this->Boxes[a].Max[axis] <
          this->Boxes[b].Min[axis] + this->Boxes[b].Max[axis];
      });
    this->Build(begin, middle);
    this->Nodes[number].Upper = this->Nodes.size();
    this->Build(middle, end);
  }

  std::vector<Box> Boxes;
  std::vector<std::size_t> Order;
  std::vector<Node> Nodes;
};

} // namespace deformvolume

#endif
