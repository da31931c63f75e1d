// SPDX-License-Identifier: BSD-3-Clause
#include "CellSplit.h"

#include "CellNumbers.h"

#include <algorithm>

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
