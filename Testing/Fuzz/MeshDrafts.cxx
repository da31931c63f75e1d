// SPDX-License-Identifier: BSD-3-Clause
#include "MeshDrafts.h"

#include <vtkCellType.h>

#include <limits>
#include <numeric>

namespace fuzz
{

namespace
{

// The corners of a cube in the order of vtkHexahedron.
std::array<vtkIdType, 8> GetCube(int x, int y, int z, const std::array<int, 3>& nodes)
{
  const auto at = [&](int i, int j, int k)
  { return static_cast<vtkIdType>(((z + k) * nodes[1] + y + j) * nodes[0] + x + i); };
  return { { at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0), at(0, 0, 1), at(1, 0, 1),
    at(1, 1, 1), at(0, 1, 1) } };
}

void AddFiveTetrahedra(const std::array<vtkIdType, 8>& c, bool odd, Draft& draft)
{
  const int even[5][4] = { { 0, 1, 3, 4 }, { 1, 2, 3, 6 }, { 1, 4, 5, 6 }, { 3, 4, 6, 7 },
    { 1, 3, 4, 6 } };
  const int mirrored[5][4] = { { 1, 0, 2, 5 }, { 0, 3, 2, 7 }, { 0, 5, 4, 7 }, { 2, 5, 7, 6 },
    { 0, 2, 5, 7 } };
  for (const auto& corners : odd ? mirrored : even)
  {
    draft.Cells.push_back(
      { VTK_TETRA, { c[corners[0]], c[corners[1]], c[corners[2]], c[corners[3]] } });
  }
}

void AddPyramids(const std::array<vtkIdType, 8>& c, Draft& draft)
{
  glm::dvec3 center(0.0);
  for (const vtkIdType corner : c)
  {
    center += 0.125 * draft.Nodes[static_cast<std::size_t>(corner)];
  }
  const auto apex = static_cast<vtkIdType>(draft.Nodes.size());
  draft.Nodes.push_back(center);
  for (const auto& face : { std::array<int, 4>{ { 0, 1, 2, 3 } }, { { 4, 7, 6, 5 } },
         { { 0, 4, 5, 1 } }, { { 1, 5, 6, 2 } }, { { 2, 6, 7, 3 } }, { { 3, 7, 4, 0 } } })
  {
    draft.Cells.push_back(
      { VTK_PYRAMID, { c[face[0]], c[face[1]], c[face[2]], c[face[3]], apex } });
  }
}

void AddCube(const std::array<vtkIdType, 8>& c, int kind, bool odd, Draft& draft)
{
  switch (kind)
  {
    case 1:
      draft.Cells.push_back({ VTK_HEXAHEDRON, { c.begin(), c.end() } });
      break;
    case 2:
      draft.Cells.push_back({ VTK_VOXEL, { c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6] } });
      break;
    case 3:
      draft.Cells.push_back({ VTK_WEDGE, { c[0], c[1], c[3], c[4], c[5], c[7] } });
      draft.Cells.push_back({ VTK_WEDGE, { c[1], c[2], c[3], c[5], c[6], c[7] } });
      break;
    case 4:
      AddPyramids(c, draft);
      break;
    case 5:
      draft.Cells.push_back({ VTK_POLYHEDRON, { c.begin(), c.end() } });
      break;
    default:
      AddFiveTetrahedra(c, odd, draft);
  }
}

} // namespace

Draft MakeLattice(const std::array<double, 6>& box, Random& random, std::ostream& log)
{
  const std::array<int, 3> nodes{ { random.Int(2, 5), random.Int(2, 5), random.Int(2, 5) } };
  Draft draft;
  const double jitter = random.Pick({ 0.0, 0.0, 0.2, 0.6 });
  // One type of cells, or (6) a mixture of types.
  const int kind = random.Chance(0.5) ? 0 : random.Int(1, 6);
  log << "lattice of cells " << kind << ", jitter " << jitter;
  for (int z = 0; z < nodes[2]; ++z)
  {
    for (int y = 0; y < nodes[1]; ++y)
    {
      for (int x = 0; x < nodes[0]; ++x)
      {
        const std::array<int, 3> index{ { x, y, z } };
        glm::dvec3 node;
        for (int axis = 0; axis < 3; ++axis)
        {
          const double step = (box[2 * axis + 1] - box[2 * axis]) / (nodes[axis] - 1);
          node[axis] = box[2 * axis] + step * (index[axis] + jitter * random.Real(-0.5, 0.5));
        }
        draft.Nodes.push_back(node);
      }
    }
  }
  for (int z = 0; z + 1 < nodes[2]; ++z)
  {
    for (int y = 0; y + 1 < nodes[1]; ++y)
    {
      for (int x = 0; x + 1 < nodes[0]; ++x)
      {
        AddCube(GetCube(x, y, z, nodes), kind == 6 ? random.Int(0, 5) : kind, (x + y + z) % 2 != 0,
          draft);
      }
    }
  }
  return draft;
}

Draft MakeTetrahedra(const std::array<double, 6>& box, Random& random, std::ostream& log)
{
  const int count = random.Int(1, 12);
  log << count << " random tetrahedra";
  Draft draft;
  for (int i = random.Int(4, 4 + 3 * count); i > 0; --i)
  {
    draft.Nodes.emplace_back(
      random.Real(box[0], box[1]), random.Real(box[2], box[3]), random.Real(box[4], box[5]));
  }
  for (int i = 0; i < count; ++i)
  {
    Cell cell{ VTK_TETRA, {} };
    for (int k = 0; k < 4; ++k)
    {
      cell.Points.push_back(random.Int(0, static_cast<int>(draft.Nodes.size()) - 1));
    }
    draft.Cells.push_back(cell);
  }
  return draft;
}

void AddOddities(Draft& draft, Random& random, std::ostream& log)
{
  const int last = static_cast<int>(draft.Nodes.size()) - 1;
  for (int i = random.Int(1, 4); i > 0 && !draft.Cells.empty(); --i)
  {
    const auto some =
      static_cast<std::size_t>(random.Int(0, static_cast<int>(draft.Cells.size()) - 1));
    Cell cell = draft.Cells[some];
    const int kind = random.Int(0, 5);
    log << ", oddity " << kind;
    switch (kind)
    {
      case 0: // a duplicate cell
        draft.Cells.push_back(cell);
        break;
      case 1: // an inverted cell
        if (cell.Type == VTK_TETRA)
        {
          std::swap(draft.Cells[some].Points[0], draft.Cells[some].Points[1]);
        }
        break;
      case 2: // a flat cell
        draft.Cells.push_back({ VTK_TETRA, { 0, 1, last, last } });
        break;
      case 3: // a point that no cell uses
        draft.Nodes.emplace_back(random.Real(-30.0, 30.0), 1.0, 2.0);
        break;
      case 4: // a cell of fewer dimensions
        draft.Cells.push_back({ VTK_TRIANGLE, { 0, 1, last } });
        draft.Cells.push_back({ VTK_VERTEX, { last } });
        break;
      default:
        draft.Cells[some] = { VTK_EMPTY_CELL, {} };
    }
  }
}

void AddErrors(Draft& draft, Random& random, std::ostream& log)
{
  const int kind = random.Int(0, 4);
  log << ", error " << kind;
  switch (kind)
  {
    case 0:
      draft.Cells.push_back(
        { VTK_TETRA, { 0, 1, 2, static_cast<vtkIdType>(draft.Nodes.size()) + random.Int(0, 9) } });
      break;
    case 1:
      draft.Cells.push_back({ VTK_TETRA, { 0, -random.Int(1, 9), 2, 3 } });
      break;
    case 2:
      draft.Nodes[random.Bits() % draft.Nodes.size()].y = random.Pick(
        { std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() });
      break;
    case 3:
      draft.Cells.push_back({ random.Pick({ VTK_HEXAHEDRON, VTK_WEDGE, VTK_TETRA }), { 0, 1, 2 } });
      break;
    default:
      draft.Cells.clear();
  }
}

void Shuffle(Draft& draft, Random& random)
{
  random.Shuffle(draft.Cells);
  std::vector<vtkIdType> order(draft.Nodes.size());
  std::iota(order.begin(), order.end(), 0);
  random.Shuffle(order);
  std::vector<glm::dvec3> nodes(draft.Nodes.size());
  for (std::size_t node = 0; node < nodes.size(); ++node)
  {
    nodes[static_cast<std::size_t>(order[node])] = draft.Nodes[node];
  }
  draft.Nodes = nodes;
  for (Cell& cell : draft.Cells)
  {
    for (vtkIdType& point : cell.Points)
    {
      if (point >= 0 && point < static_cast<vtkIdType>(order.size()))
      {
        point = order[static_cast<std::size_t>(point)];
      }
    }
  }
}

} // namespace fuzz
