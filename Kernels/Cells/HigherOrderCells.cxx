// SPDX-License-Identifier: BSD-3-Clause
#include "HigherOrderCells.h"

#include "CellLattices.h"
#include "CellNumbers.h"

#include <algorithm>

namespace deformvolume
{

namespace
{

// Returns the faces of a cell type: corners in order around the face, mid-edge nodes in the same
// order, and the center node of the face if there is one.
const CellFaces& GetQuadraticFaces(int cellType)
{
  static const CellFaces& tetrahedron = *new CellFaces{ { 0, 1, 3, 4, 8, 7 }, { 1, 2, 3, 5, 9, 8 },
    { 2, 0, 3, 6, 7, 9 }, { 0, 2, 1, 6, 5, 4 } };
  static const CellFaces& hexahedron = *new CellFaces{ { 0, 4, 7, 3, 16, 15, 19, 11 },
    { 1, 2, 6, 5, 9, 18, 13, 17 }, { 0, 1, 5, 4, 8, 17, 12, 16 }, { 3, 7, 6, 2, 19, 14, 18, 10 },
    { 0, 3, 2, 1, 11, 10, 9, 8 }, { 4, 5, 6, 7, 12, 13, 14, 15 } };
  static const CellFaces& wedge = *new CellFaces{ { 0, 1, 2, 6, 7, 8 }, { 3, 5, 4, 11, 10, 9 },
    { 0, 3, 4, 1, 12, 9, 13, 6 }, { 1, 4, 5, 2, 13, 10, 14, 7 }, { 2, 5, 3, 0, 14, 11, 12, 8 } };
  static const CellFaces& pyramid = *new CellFaces{ { 0, 3, 2, 1, 8, 7, 6, 5 },
    { 0, 1, 4, 5, 10, 9 }, { 1, 2, 4, 6, 11, 10 }, { 2, 3, 4, 7, 12, 11 }, { 3, 0, 4, 8, 9, 12 } };
  static const CellFaces& triQuadraticPyramid =
    *new CellFaces{ { 0, 3, 2, 1, 8, 7, 6, 5, 13 }, { 0, 1, 4, 5, 10, 9, 14 },
      { 1, 2, 4, 6, 11, 10, 15 }, { 2, 3, 4, 7, 12, 11, 16 }, { 3, 0, 4, 8, 9, 12, 17 } };
  // The quadratic Lagrange tetrahedron of 15 nodes, with center nodes of the faces and of the cell.
  static const CellFaces& tetrahedronOf15 = *new CellFaces{ { 0, 1, 3, 4, 8, 7, 11 },
    { 2, 3, 1, 9, 8, 5, 12 }, { 0, 3, 2, 7, 9, 6, 13 }, { 0, 2, 1, 6, 5, 4, 10 } };
  switch (cellType)
  {
    case cellNumbers::QuadraticTetrahedron:
      return tetrahedron;
    case cellNumbers::QuadraticHexahedron:
      return hexahedron;
    case cellNumbers::QuadraticWedge:
      return wedge;
    case cellNumbers::QuadraticPyramid:
      return pyramid;
    case cellNumbers::TriQuadraticPyramid:
      return triQuadraticPyramid;
    default:
      return tetrahedronOf15;
  }
}

CellParts MakeParts(int cellType)
{
  switch (cellType)
  {
    case cellNumbers::QuadraticTetrahedron:
    {
      CellParts parts = SplitSerendipity(GetQuadraticFaces(cellType));
      // The tetrahedron without its corners is an octahedron. No choice among its three diagonals
      // is symmetric. So it is split around a derived node in the center, whose weights are the
      // values of the shape functions there.
      parts.back().CenterWeights.assign(4, -0.125);
      parts.back().CenterWeights.resize(10, 0.25);
      return parts;
    }
    case cellNumbers::QuadraticHexahedron:
      return SplitSerendipity(GetQuadraticFaces(cellType));
    case cellNumbers::QuadraticWedge:
      return SplitSerendipity(GetQuadraticFaces(cellType));
    case cellNumbers::QuadraticPyramid:
      return SplitSerendipity(GetQuadraticFaces(cellType));
    case cellNumbers::TriQuadraticPyramid:
      return SplitRoundCenter(GetQuadraticFaces(cellType), 18);
    case cellNumbers::TriQuadraticHexahedron:
      return SplitHexahedron({ { 2, 2, 2 } }, NumberHexahedron({ { 2, 2, 2 } }));
    case cellNumbers::QuadraticLinearWedge:
      return SplitWedge(2, 1, NumberWedge(2, 1));
    case cellNumbers::BiQuadraticQuadraticWedge:
      return SplitWedge(2, 2, NumberWedge(2, 2));
    default: // cellNumbers::BiQuadraticQuadraticHexahedron, which has no node (1, 1, k)
      return SplitRings(NumberHexahedron({ { 2, 2, 2 } }));
  }
}

// Returns the degree for which a cell has this number of points; 0 if there is none.
template <typename Count>
int FindDegree(std::int64_t numberOfPoints, const Count& count)
{
  int degree = 1;
  while (count(degree) < numberOfPoints)
  {
    ++degree;
  }
  return count(degree) == numberOfPoints ? degree : 0;
}

CellParts MakeLagrangeTetrahedron(std::int64_t numberOfPoints)
{
  if (numberOfPoints == 15) // quadratic, with center nodes of the faces and of the cell
  {
    return SplitRoundCenter(GetQuadraticFaces(cellNumbers::LagrangeTetrahedron), 14);
  }
  const int degree = FindDegree(
    numberOfPoints, [](std::int64_t n) -> std::int64_t { return (n + 1) * (n + 2) * (n + 3) / 6; });
  if (degree == 2)
  {
    return MakeParts(cellNumbers::QuadraticTetrahedron); // the nodes are the same
  }
  return SplitTetrahedron(degree, NumberTetrahedron(degree));
}

CellParts MakeLagrangeHexahedron(std::int64_t numberOfPoints, const std::array<int, 3>* degrees)
{
  std::array<int, 3> order;
  order.fill(FindDegree(
    numberOfPoints, [](std::int64_t n) -> std::int64_t { return (n + 1) * (n + 1) * (n + 1); }));
  if (degrees)
  {
    order = *degrees;
  }
  const auto size = [&](int axis) { return static_cast<std::int64_t>(order[axis]) + 1; };
  if (*std::min_element(order.begin(), order.end()) < 1 || size(0) > numberOfPoints ||
    size(1) > numberOfPoints || size(2) > numberOfPoints ||
    size(0) * size(1) * size(2) != numberOfPoints)
  {
    return {};
  }
  return SplitHexahedron(order, NumberHexahedron(order));
}

CellParts MakeLagrangeWedge(std::int64_t numberOfPoints, const std::array<int, 3>* degrees)
{
  if (numberOfPoints == 21) // VTK treats it as quadratic, even if degrees are given
  {
    return SplitWedgeOf21();
  }
  const int degree = FindDegree(
    numberOfPoints, [](std::int64_t n) -> std::int64_t { return (n + 1) * (n + 1) * (n + 2) / 2; });
  std::array<int, 3> order{ { degree, degree, degree } };
  if (degrees)
  {
    order = *degrees;
  }
  const std::int64_t side = order[0];
  const std::int64_t layers = order[2];
  if (side < 1 || order[1] != order[0] || layers < 1 || side > numberOfPoints ||
    layers > numberOfPoints || (side + 1) * (side + 2) / 2 * (layers + 1) != numberOfPoints)
  {
    return {};
  }
  return SplitWedge(order[0], order[2], NumberWedge(order[0], order[2]));
}

} // namespace

bool HigherOrderCells::Contain(int cellType)
{
  switch (cellType)
  {
    case cellNumbers::LagrangeTetrahedron:
    case cellNumbers::LagrangeHexahedron:
    case cellNumbers::LagrangeWedge:
      return true;
    default:
      return GetNumberOfCellPoints(cellType) > 0 && cellType >= cellNumbers::QuadraticTetrahedron;
  }
}

const std::vector<std::array<int, 3>>& HigherOrderCells::GetMidSides(int cellType)
{
  using Edges = std::vector<std::array<int, 3>>;
  static const Edges& none = *new Edges;
  static const Edges& tetrahedron = *new Edges{ { { 0, 1, 4 } }, { { 1, 2, 5 } }, { { 2, 0, 6 } },
    { { 0, 3, 7 } }, { { 1, 3, 8 } }, { { 2, 3, 9 } } };
  static const Edges& hexahedron = *new Edges{ { { 0, 1, 8 } }, { { 1, 2, 9 } }, { { 3, 2, 10 } },
    { { 0, 3, 11 } }, { { 4, 5, 12 } }, { { 5, 6, 13 } }, { { 7, 6, 14 } }, { { 4, 7, 15 } },
    { { 0, 4, 16 } }, { { 1, 5, 17 } }, { { 3, 7, 19 } }, { { 2, 6, 18 } } };
  static const Edges& wedge =
    *new Edges{ { { 0, 1, 6 } }, { { 1, 2, 7 } }, { { 2, 0, 8 } }, { { 3, 4, 9 } },
      { { 4, 5, 10 } }, { { 5, 3, 11 } }, { { 0, 3, 12 } }, { { 1, 4, 13 } }, { { 2, 5, 14 } } };
  static const Edges& linearWedge = *new Edges(wedge.begin(), wedge.begin() + 6);
  static const Edges& pyramid = *new Edges{ { { 0, 1, 5 } }, { { 1, 2, 6 } }, { { 2, 3, 7 } },
    { { 3, 0, 8 } }, { { 0, 4, 9 } }, { { 1, 4, 10 } }, { { 2, 4, 11 } }, { { 3, 4, 12 } } };
  switch (cellType)
  {
    case cellNumbers::QuadraticTetrahedron:
      return tetrahedron;
    case cellNumbers::QuadraticHexahedron:
    case cellNumbers::TriQuadraticHexahedron:
    case cellNumbers::BiQuadraticQuadraticHexahedron:
      return hexahedron;
    case cellNumbers::QuadraticWedge:
    case cellNumbers::BiQuadraticQuadraticWedge:
      return wedge;
    case cellNumbers::QuadraticLinearWedge:
      return linearWedge;
    case cellNumbers::QuadraticPyramid:
    case cellNumbers::TriQuadraticPyramid:
      return pyramid;
    default:
      return none;
  }
}

bool HigherOrderCells::IsBezier(int cellType)
{
  return cellType == cellNumbers::BezierTetrahedron || cellType == cellNumbers::BezierHexahedron ||
    cellType == cellNumbers::BezierWedge || cellType == cellNumbers::BezierPyramid;
}

const CellParts& HigherOrderCells::GetParts(
  int cellType, std::int64_t numberOfPoints, const std::array<int, 3>* degrees)
{
  const std::array<int, 3> none{ { 0, 0, 0 } };
  const bool hasDegrees = degrees &&
    (cellType == cellNumbers::LagrangeHexahedron || cellType == cellNumbers::LagrangeWedge);
  const auto known =
    this->Known.try_emplace({ { cellType, numberOfPoints }, hasDegrees ? *degrees : none });
  CellParts& parts = known.first->second;
  if (known.second)
  {
    switch (cellType)
    {
      case cellNumbers::LagrangeTetrahedron:
        parts = MakeLagrangeTetrahedron(numberOfPoints);
        break;
      case cellNumbers::LagrangeHexahedron:
        parts = MakeLagrangeHexahedron(numberOfPoints, degrees);
        break;
      case cellNumbers::LagrangeWedge:
        parts = MakeLagrangeWedge(numberOfPoints, degrees);
        break;
      default:
        if (numberOfPoints == GetNumberOfCellPoints(cellType))
        {
          parts = MakeParts(cellType);
        }
    }
  }
  return parts;
}

} // namespace deformvolume
