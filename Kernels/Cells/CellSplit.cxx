// SPDX-License-Identifier: BSD-3-Clause
#include "CellSplit.h"

#include "CellNumbers.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

namespace deformvolume
{

// Tables of this folder are not destroyed, as a program may end with calls from destructors of its
// own.
const CellFaces* GetCellFaces(int cellType)
{
  static const CellFaces& hexahedron = *new CellFaces{ { 0, 4, 7, 3 }, { 1, 2, 6, 5 },
    { 0, 1, 5, 4 }, { 3, 7, 6, 2 }, { 0, 3, 2, 1 }, { 4, 5, 6, 7 } };
  static const CellFaces& wedge =
    *new CellFaces{ { 0, 1, 2 }, { 3, 5, 4 }, { 0, 3, 4, 1 }, { 1, 4, 5, 2 }, { 2, 5, 3, 0 } };
  static const CellFaces& pyramid =
    *new CellFaces{ { 0, 3, 2, 1 }, { 0, 1, 4 }, { 1, 2, 4 }, { 2, 3, 4 }, { 3, 0, 4 } };
  static const CellFaces& pentagonalPrism = *new CellFaces{ { 0, 4, 3, 2, 1 }, { 5, 6, 7, 8, 9 },
    { 0, 1, 6, 5 }, { 1, 2, 7, 6 }, { 2, 3, 8, 7 }, { 3, 4, 9, 8 }, { 4, 0, 5, 9 } };
  static const CellFaces& hexagonalPrism =
    *new CellFaces{ { 0, 5, 4, 3, 2, 1 }, { 6, 7, 8, 9, 10, 11 }, { 0, 1, 7, 6 }, { 1, 2, 8, 7 },
      { 2, 3, 9, 8 }, { 3, 4, 10, 9 }, { 4, 5, 11, 10 }, { 5, 0, 6, 11 } };
  switch (cellType)
  {
    case cellNumbers::Hexahedron:
      return &hexahedron;
    case cellNumbers::Wedge:
      return &wedge;
    case cellNumbers::Pyramid:
      return &pyramid;
    case cellNumbers::PentagonalPrism:
      return &pentagonalPrism;
    case cellNumbers::HexagonalPrism:
      return &hexagonalPrism;
    default:
      return nullptr;
  }
}

int GetNumberOfCellPoints(int cellType)
{
  switch (cellType)
  {
    case cellNumbers::Tetrahedron:
      return 4;
    case cellNumbers::Pyramid:
      return 5;
    case cellNumbers::Wedge:
      return 6;
    case cellNumbers::Hexahedron:
    case cellNumbers::Voxel:
      return 8;
    case cellNumbers::PentagonalPrism:
      return 10;
    case cellNumbers::HexagonalPrism:
      return 12;
    case cellNumbers::QuadraticTetrahedron:
      return 10;
    case cellNumbers::QuadraticLinearWedge:
      return 12;
    case cellNumbers::QuadraticPyramid:
      return 13;
    case cellNumbers::QuadraticWedge:
      return 15;
    case cellNumbers::BiQuadraticQuadraticWedge:
      return 18;
    case cellNumbers::TriQuadraticPyramid:
      return 19;
    case cellNumbers::QuadraticHexahedron:
      return 20;
    case cellNumbers::BiQuadraticQuadraticHexahedron:
      return 24;
    case cellNumbers::TriQuadraticHexahedron:
      return 27;
    default:
      return 0;
  }
}

bool OrientFaces(CellFaces& faces)
{
  struct Use
  {
    std::size_t Face;
    bool Ascending;
  };
  std::map<std::pair<int, int>, std::vector<Use>> edges;
  for (std::size_t f = 0; f < faces.size(); ++f)
  {
    for (std::size_t i = 0; i < faces[f].size(); ++i)
    {
      const int a = faces[f][i];
      const int b = faces[f][(i + 1) % faces[f].size()];
      edges[std::minmax(a, b)].push_back({ f, a < b });
    }
  }
  std::vector<std::vector<std::pair<std::size_t, bool>>> neighbors(faces.size());
  for (const auto& edge : edges)
  {
    const std::vector<Use>& uses = edge.second;
    if (uses.size() != 2 || edge.first.first == edge.first.second)
    {
      return false;
    }
    const bool isSame = uses[0].Ascending != uses[1].Ascending;
    neighbors[uses[0].Face].emplace_back(uses[1].Face, isSame);
    neighbors[uses[1].Face].emplace_back(uses[0].Face, isSame);
  }
  std::vector<int> senses(faces.size(), 0);
  std::vector<std::size_t> waiting{ 0 };
  senses[0] = 1;
  while (!waiting.empty())
  {
    const std::size_t face = waiting.back();
    waiting.pop_back();
    for (const auto& [other, isSame] : neighbors[face])
    {
      const int sense = isSame ? senses[face] : -senses[face];
      if (senses[other] == 0)
      {
        senses[other] = sense;
        waiting.push_back(other);
      }
      else if (senses[other] != sense)
      {
        return false;
      }
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f)
  {
    if (senses[f] == 0)
    {
      return false;
    }
    if (senses[f] < 0)
    {
      std::reverse(faces[f].begin(), faces[f].end());
    }
  }
  return true;
}

void SplitCell(
  const std::vector<CellNode>& nodes, const CellFaces& faces, std::vector<Tetrahedron>& tetrahedra)
{
  const std::int32_t apex = std::min_element(nodes.begin(), nodes.end())->Number;
  const auto node = [&](const std::vector<int>& face, std::size_t i) -> const CellNode&
  { return nodes[static_cast<std::size_t>(face[i % face.size()])]; };
  for (const std::vector<int>& face : faces)
  {
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < face.size(); ++i)
    {
      lowest = node(face, i) < node(face, lowest) ? i : lowest;
    }
    if (face.empty() || node(face, lowest).Number == apex)
    {
      continue;
    }
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
    {
      tetrahedra.push_back({ { apex, node(face, lowest).Number, node(face, lowest + i).Number,
        node(face, lowest + i + 1).Number } });
    }
  }
}

} // namespace deformvolume
