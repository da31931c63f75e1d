// SPDX-License-Identifier: BSD-3-Clause
#include "BoxTree.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr std::size_t LeafSize = 4;

} // namespace

BoxTree::BoxTree(std::vector<SnappedBox> boxes)
  : Boxes(std::move(boxes))
  , Order(this->Boxes.size())
{
  std::iota(this->Order.begin(), this->Order.end(), std::size_t{ 0 });
  if (!this->Boxes.empty())
  {
    this->Build(0, this->Order.size());
  }
}

void BoxTree::Build(std::size_t begin, std::size_t end)
{
  const std::size_t number = this->Nodes.size();
  this->Nodes.emplace_back();
  SnappedBox box;
  for (std::size_t i = begin; i < end; ++i)
  {
    box.Add(this->Boxes[this->Order[i]]);
  }
  this->Nodes[number].Box = box;
  this->Nodes[number].Begin = begin;
  this->Nodes[number].End = end;
  if (end - begin <= LeafSize)
  {
    return;
  }
  const SnappedPoint size = box.Max - box.Min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [this](std::size_t place)
  { return this->Order.begin() + static_cast<std::ptrdiff_t>(place); };
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

template <typename Visitor>
void BoxTree::Visit(const SnappedBox& box, Visitor&& visitor) const
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
    if (!node.Box.Overlaps(box))
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

void BoxTree::Find(const SnappedBox& box, std::vector<std::size_t>& numbers) const
{
  this->Visit(box,
    [&numbers](std::size_t number)
    {
      numbers.push_back(number);
      return true;
    });
}

bool BoxTree::Overlaps(const SnappedBox& box) const
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

} // namespace deformvolume
