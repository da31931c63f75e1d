// SPDX-License-Identifier: BSD-3-Clause
#include "CellLattices.h"

#include <cstddef>
#include <map>
#include <memory>

namespace deformvolume
{

namespace
{

using LatticePoint = std::array<int, 3>;

// The nodes of a lattice, numbered in the order in which they are added.
class Lattice
{
public:
  void Add(const LatticePoint& point)
  {
    this->Nodes.emplace(point, static_cast<int>(this->Nodes.size()));
  }

  // Adds the nodes between two lattice points that are `steps` steps apart.
  void AddBetween(const LatticePoint& first, const LatticePoint& last, int steps)
  {
    for (int step = 1; step < steps; ++step)
    {
      this->Add(Mix<2>({ { first, last } }, { { steps - step, step } }, steps));
    }
  }

  // Adds all nodes of a triangle with `steps` steps along its edges.
  void AddTriangle(const std::array<LatticePoint, 3>& corners, int steps)
  {
    if (steps == 0)
    {
      this->Add(corners[0]);
      return;
    }
    for (const LatticePoint& corner : corners)
    {
      this->Add(corner);
    }
    for (std::size_t edge = 0; edge < 3; ++edge)
    {
      this->AddBetween(corners[edge], corners[(edge + 1) % 3], steps);
    }
    this->AddWithin(corners, steps);
  }

  // Adds the nodes within a triangle, which form a smaller triangle.
  void AddWithin(const std::array<LatticePoint, 3>& corners, int steps)
  {
    if (steps >= 3)
    {
      std::array<LatticePoint, 3> inner;
      for (std::size_t i = 0; i < 3; ++i)
      {
        std::array<int, 3> weights{ { 1, 1, 1 } };
        weights[i] = steps - 2;
        inner[i] = Mix(corners, weights, steps);
      }
      this->AddTriangle(inner, steps - 3);
    }
  }

  void AddTetrahedron(const std::array<LatticePoint, 4>& corners, int steps)
  {
    if (steps == 0)
    {
      this->Add(corners[0]);
      return;
    }
    for (const LatticePoint& corner : corners)
    {
      this->Add(corner);
    }
    static const std::size_t edges[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 },
      { 2, 3 } };
    for (const auto& edge : edges)
    {
      this->AddBetween(corners[edge[0]], corners[edge[1]], steps);
    }
    static const std::size_t faces[4][3] = { { 0, 1, 3 }, { 2, 3, 1 }, { 0, 3, 2 }, { 0, 2, 1 } };
    for (const auto& face : faces)
    {
      this->AddWithin({ { corners[face[0]], corners[face[1]], corners[face[2]] } }, steps);
    }
    if (steps >= 4)
    {
      std::array<LatticePoint, 4> inner;
      for (std::size_t i = 0; i < 4; ++i)
      {
        std::array<int, 4> weights{ { 1, 1, 1, 1 } };
        weights[i] = steps - 3;
        inner[i] = Mix(corners, weights, steps);
      }
      this->AddTetrahedron(inner, steps - 4);
    }
  }

  // Returns the number of the node, or -1 if there is none.
  int Get(const LatticePoint& point) const
  {
    const auto found = this->Nodes.find(point);
    return found == this->Nodes.end() ? -1 : found->second;
  }

private:
  // Returns the weighted mean of lattice points. sum: of the weights. The mean must be a lattice
  // point.
  template <std::size_t Count>
  static LatticePoint Mix(const std::array<LatticePoint, Count>& latticePoints,
    const std::array<int, Count>& weights, int sum)
  {
    LatticePoint mixed{ { 0, 0, 0 } };
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      for (std::size_t i = 0; i < Count; ++i)
      {
        mixed[axis] += weights[i] * latticePoints[i][axis];
      }
      mixed[axis] /= sum;
    }
    return mixed;
  }

  std::map<LatticePoint, int> Nodes;
};

NodeAt MakeNodeAt(const std::shared_ptr<Lattice>& lattice)
{
  return [lattice](int i, int j, int k) { return lattice->Get({ { i, j, k } }); };
}

} // namespace

NodeAt NumberHexahedron(const std::array<int, 3>& degrees)
{
  const auto lattice = std::make_shared<Lattice>();
  const auto [x, y, z] = degrees;
  const std::array<std::array<int, 2>, 4> ring{ { { { 0, 0 } }, { { x, 0 } }, { { x, y } },
    { { 0, y } } } };
  for (const int k : { 0, z })
  {
    for (const auto& corner : ring)
    {
      lattice->Add({ { corner[0], corner[1], k } });
    }
  }
  for (const int k : { 0, z })
  {
    // VTK lists the nodes of these edges in the direction of the axes, not around the face.
    lattice->AddBetween({ { 0, 0, k } }, { { x, 0, k } }, x);
    lattice->AddBetween({ { x, 0, k } }, { { x, y, k } }, y);
    lattice->AddBetween({ { 0, y, k } }, { { x, y, k } }, x);
    lattice->AddBetween({ { 0, 0, k } }, { { 0, y, k } }, y);
  }
  for (const auto& corner : ring)
  {
    lattice->AddBetween({ { corner[0], corner[1], 0 } }, { { corner[0], corner[1], z } }, z);
  }
  for (const int i : { 0, x })
  {
    for (int k = 1; k < z; ++k)
    {
      lattice->AddBetween({ { i, 0, k } }, { { i, y, k } }, y);
    }
  }
  for (const int j : { 0, y })
  {
    for (int k = 1; k < z; ++k)
    {
      lattice->AddBetween({ { 0, j, k } }, { { x, j, k } }, x);
    }
  }
  for (const int k : { 0, z })
  {
    for (int j = 1; j < y; ++j)
    {
      lattice->AddBetween({ { 0, j, k } }, { { x, j, k } }, x);
    }
  }
  for (int k = 1; k < z; ++k)
  {
    for (int j = 1; j < y; ++j)
    {
      lattice->AddBetween({ { 0, j, k } }, { { x, j, k } }, x);
    }
  }
  return MakeNodeAt(lattice);
}

NodeAt NumberWedge(int degree, int layers)
{
  const auto lattice = std::make_shared<Lattice>();
  const int n = degree;
  const std::array<std::array<int, 2>, 3> ring{ { { { 0, 0 } }, { { n, 0 } }, { { 0, n } } } };
  const auto at = [&](std::size_t corner, int k) -> LatticePoint {
    return { { ring[corner % 3][0], ring[corner % 3][1], k } };
  };
  // Adds the nodes within a triangle.
  const auto addTriangle = [&](int k)
  {
    for (int j = 1; j < n; ++j)
    {
      lattice->AddBetween({ { 0, j, k } }, { { n - j, j, k } }, n - j);
    }
  };
  for (const int k : { 0, layers })
  {
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      lattice->Add(at(corner, k));
    }
  }
  for (const int k : { 0, layers })
  {
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      lattice->AddBetween(at(corner, k), at(corner + 1, k), n);
    }
  }
  for (std::size_t corner = 0; corner < 3; ++corner)
  {
    lattice->AddBetween(at(corner, 0), at(corner, layers), layers);
  }
  addTriangle(0);
  addTriangle(layers);
  for (std::size_t corner = 0; corner < 3; ++corner)
  {
    for (int k = 1; k < layers; ++k)
    {
      lattice->AddBetween(at(corner, k), at(corner + 1, k), n);
    }
  }
  for (int k = 1; k < layers; ++k)
  {
    addTriangle(k);
  }
  return MakeNodeAt(lattice);
}

NodeAt NumberTetrahedron(int degree)
{
  const auto lattice = std::make_shared<Lattice>();
  lattice->AddTetrahedron(
    { { { { 0, 0, 0 } }, { { degree, 0, 0 } }, { { 0, degree, 0 } }, { { 0, 0, degree } } } },
    degree);
  return MakeNodeAt(lattice);
}

} // namespace deformvolume
