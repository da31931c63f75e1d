// SPDX-License-Identifier: BSD-3-Clause
#include "MeshOrder.h"

#include <utility>

namespace deformvolume
{
namespace
{

constexpr std::int32_t Unused = -1;

// Gives numbers to things in the order in which they are named first.
class Numbering
{
public:
  explicit Numbering(std::size_t count)
    : Numbers(count, Unused)
  {
  }

  /// Whether it has had no number yet.
  bool Use(std::int32_t thing)
  {
    std::int32_t& number = this->Numbers[static_cast<std::size_t>(thing)];
    const bool isNew = number == Unused;
    number = isNew ? this->Next++ : number;
    return isNew;
  }

  std::vector<std::int32_t> Finish()
  {
    for (std::int32_t& number : this->Numbers)
    {
      number = number == Unused ? this->Next++ : number;
    }
    return std::move(this->Numbers);
  }

private:
  std::vector<std::int32_t> Numbers;
  std::int32_t Next = 0;
};

class MeshNumbering
{
public:
  MeshNumbering(
    const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
    : NodesOf(tetrahedra)
    , Tetrahedra(numberOfTetrahedra)
    , Nodes(numberOfNodes)
  {
  }

  void Use(std::int32_t tetrahedron)
  {
    if (this->Tetrahedra.Use(tetrahedron))
    {
      for (const std::int32_t node : this->NodesOf[tetrahedron])
      {
        this->Nodes.Use(node);
      }
    }
  }

  MeshOrder Finish() { return { this->Tetrahedra.Finish(), this->Nodes.Finish() }; }

private:
  const Tetrahedron* NodesOf;
  Numbering Tetrahedra;
  Numbering Nodes;
};

} // namespace

MeshOrder FindOrder(const BrickGrid& bricks, const VertexLink* links, const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
{
  MeshNumbering numbering(tetrahedra, numberOfTetrahedra, numberOfNodes);
  for (std::size_t brick = 0; brick < bricks.GetNumberOfBricks(); ++brick)
  {
    const Extent vertices = bricks.GetVertices(brick, 0);
    for (std::int64_t z = vertices[4]; z <= vertices[5]; ++z)
    {
      for (std::int64_t y = vertices[2]; y <= vertices[3]; ++y)
      {
        const VertexLink* row = links + (z * bricks.Size[1] + y) * bricks.Size[0];
        std::int32_t last = Unused;
        for (int x = vertices[0]; x <= vertices[1]; ++x)
        {
          const std::int32_t tetrahedron = row[x].Tetrahedron;
          if (tetrahedron >= 0 && tetrahedron != last)
          {
            numbering.Use(tetrahedron);
          }
          last = tetrahedron;
        }
      }
    }
  }
  return numbering.Finish();
}

MeshOrder FindOrder(const VertexRuns& runs, const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
{
  MeshNumbering numbering(tetrahedra, numberOfTetrahedra, numberOfNodes);
  for (const RestTetrahedron& record : runs.Tetrahedra)
  {
    numbering.Use(record.Tetrahedron);
  }
  return numbering.Finish();
}

} // namespace deformvolume
