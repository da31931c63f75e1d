// SPDX-License-Identifier: BSD-3-Clause
#include "CutReference.h"

#include <cmath>
#include <cstdlib>

namespace reference
{

CutReference::CutReference(const SamplingMesh& mesh, const std::vector<MeshTetrahedron>& tetrahedra)
  : Mesh(mesh)
{
  for (const MeshTetrahedron& tetrahedron : tetrahedra)
  {
    if (tetrahedron.Crossed)
    {
      this->CrossedVertices.insert(tetrahedron.Vertices.begin(), tetrahedron.Vertices.end());
    }
  }
  for (const MeshTetrahedron& tetrahedron : tetrahedra)
  {
    if (!tetrahedron.Active)
    {
      continue;
    }
    const bool divided = this->IsDivided(tetrahedron);
    for (const std::int64_t a : tetrahedron.Vertices)
    {
      for (const std::int64_t b : tetrahedron.Vertices)
      {
        this->Edges.insert({ a, b });
        if (!divided)
        {
          this->WholeEdges.insert({ a, b });
        }
        else if (this->GetSide(a) != this->GetSide(b))
        {
          this->Apart[a].insert(b);
        }
      }
    }
  }
}

bool CutReference::IsDivided(const MeshTetrahedron& tetrahedron) const
{
  if (!tetrahedron.Crossed || !tetrahedron.Active)
  {
    return false;
  }
  int negative = 0;
  for (const std::int64_t vertex : tetrahedron.Vertices)
  {
    negative += this->GetSide(vertex);
  }
  return negative > 0 && negative < 4;
}

std::int64_t CutReference::Continue(std::int64_t a, std::int64_t b) const
{
  const std::int64_t size[3] = { GetSize(this->Mesh.Voxels, 0), GetSize(this->Mesh.Voxels, 1),
    GetSize(this->Mesh.Voxels, 2) };
  const auto place = [&size](std::int64_t v) {
    return Position{ { v % size[0], v / size[0] % size[1], v / (size[0] * size[1]) } };
  };
  const Position first = place(a);
  const Position second = place(b);
  Position next{};
  for (int axis = 0; axis < 3; ++axis)
  {
    next[axis] = 2 * second[axis] - first[axis];
    if (next[axis] < 0 || next[axis] >= size[axis])
    {
      return -1;
    }
  }
  return (next[2] * size[1] + next[1]) * size[0] + next[0];
}

Position CutReference::GetPosition(std::int64_t vertex, int side) const
{
  const Position own = this->Mesh.Positions[vertex];
  const auto found = this->Apart.find(vertex);
  if (side == this->GetSide(vertex) || found == this->Apart.end())
  {
    return own;
  }
  // The positions that neighbors suggest, sorted by the reliability of their information.
  std::array<std::vector<Position>, 3> suggested;
  const auto add = [&](std::size_t list, std::int64_t near, std::int64_t from, std::int64_t to)
  {
    Position moved = this->Mesh.Displacements[near];
    for (int axis = 0; axis < 3; ++axis)
    {
      moved[axis] += this->Mesh.Displacements[to][axis] - this->Mesh.Displacements[from][axis];
    }
    suggested[list].push_back(moved);
  };
  const auto leads = [&](std::int64_t from, std::int64_t to, int sideOfBoth)
  {
    return to >= 0 && this->IsPlaced(to) && this->HasEdge(from, to) &&
      (this->CrossedVertices.count(to) == 0 || this->GetSide(to) == sideOfBoth);
  };
  for (const std::int64_t near : found->second)
  {
    if (this->WholeEdges.count({ vertex, near }) > 0)
    {
      return own;
    }
    if (!this->IsPlaced(near))
    {
      continue;
    }
    const std::int64_t far = this->Continue(vertex, near);
    const std::int64_t behind = this->Continue(near, vertex);
    if (leads(near, far, side))
    {
      add(0, near, far, near);
    }
    else if (leads(vertex, behind, 1 - side))
    {
      add(1, near, vertex, behind);
    }
    else
    {
      add(2, near, near, near);
    }
  }
  const std::vector<Position>& best = !suggested[0].empty() ? suggested[0]
    : !suggested[1].empty()                                 ? suggested[1]
                                                            : suggested[2];
  Position other{};
  bool near = true;
  for (int axis = 0; axis < 3; ++axis)
  {
    long double sum = 0.0L;
    for (const Position& moved : best)
    {
      sum += static_cast<long double>(moved[axis]);
    }
    const auto mean =
      static_cast<std::int64_t>(std::floor(sum / static_cast<long double>(best.size()) + 0.5L));
    other[axis] = own[axis] - this->Mesh.Displacements[vertex][axis] + mean;
    near = near && std::abs(other[axis] - own[axis]) <= 64;
  }
  return near ? own : other;
}

} // namespace reference
