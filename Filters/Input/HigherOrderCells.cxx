// SPDX-License-Identifier: BSD-3-Clause
#include "HigherOrderCells.h"

#include "vtkBiQuadraticQuadraticHexahedron.h"
#include "vtkBiQuadraticQuadraticWedge.h"
#include "vtkCell.h"
#include "vtkCellType.h"
#include "vtkGenericCell.h"
#include "vtkHigherOrderHexahedron.h"
#include "vtkHigherOrderTetra.h"
#include "vtkHigherOrderWedge.h"
#include "vtkLagrangeTetra.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkQuadraticHexahedron.h"
#include "vtkQuadraticLinearWedge.h"
#include "vtkQuadraticPyramid.h"
#include "vtkQuadraticTetra.h"
#include "vtkQuadraticWedge.h"
#include "vtkSmartPointer.h"
#include "vtkTriQuadraticHexahedron.h"
#include "vtkTriQuadraticPyramid.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{

namespace
{

// The faces of a cell as VTK has them: corners in order round the face, nodes in the middle of the
// edges in the same order, and the node in the middle of the face where there is one.
CellFaces ReadFaces(vtkCell* cell)
{
  for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i)
  {
    cell->PointIds->SetId(i, i);
  }
  CellFaces faces;
  for (int i = 0; i < cell->GetNumberOfFaces(); ++i)
  {
    vtkIdList* ids = cell->GetFace(i)->GetPointIds();
    faces.emplace_back(ids->begin(), ids->end());
  }
  return faces;
}

// The nodes of a cell with a lattice, found where VTK says that they are.
template <typename CellT>
NodeAt ReadLattice(const std::array<int, 3>& degrees)
{
  vtkNew<CellT> cell;
  const double* coordinates = cell->GetParametricCoords();
  std::map<std::array<int, 3>, int> nodes;
  for (int node = 0; node < cell->GetNumberOfPoints(); ++node)
  {
    std::array<int, 3> place;
    for (int axis = 0; axis < 3; ++axis)
    {
      place[axis] = static_cast<int>(std::lround(coordinates[3 * node + axis] * degrees[axis]));
    }
    nodes[place] = node;
  }
  return [nodes](int i, int j, int k)
  {
    const auto found = nodes.find({ { i, j, k } });
    return found == nodes.end() ? -1 : found->second;
  };
}

CellParts MakeParts(int cellType)
{
  switch (cellType)
  {
    case VTK_QUADRATIC_TETRA:
    {
      CellParts parts = SplitSerendipity(ReadFaces(vtkNew<vtkQuadraticTetra>()));
      // What is left of the tetrahedron without its corners is an octahedron. None of its three
      // diagonals is better than the others: the values of the shape functions in the middle are.
      parts.back().CenterWeights.assign(4, -0.125);
      parts.back().CenterWeights.resize(10, 0.25);
      return parts;
    }
    case VTK_QUADRATIC_HEXAHEDRON:
      return SplitSerendipity(ReadFaces(vtkNew<vtkQuadraticHexahedron>()));
    case VTK_QUADRATIC_WEDGE:
      return SplitSerendipity(ReadFaces(vtkNew<vtkQuadraticWedge>()));
    case VTK_QUADRATIC_PYRAMID:
      return SplitSerendipity(ReadFaces(vtkNew<vtkQuadraticPyramid>()));
    case VTK_TRIQUADRATIC_PYRAMID:
      return SplitRoundCenter(ReadFaces(vtkNew<vtkTriQuadraticPyramid>()), 18);
    case VTK_TRIQUADRATIC_HEXAHEDRON:
      return SplitHexahedron(
        { { 2, 2, 2 } }, ReadLattice<vtkTriQuadraticHexahedron>({ { 2, 2, 2 } }));
    case VTK_QUADRATIC_LINEAR_WEDGE:
      return SplitWedge(2, 1, ReadLattice<vtkQuadraticLinearWedge>({ { 2, 2, 1 } }));
    case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
      return SplitWedge(2, 2, ReadLattice<vtkBiQuadraticQuadraticWedge>({ { 2, 2, 2 } }));
    default: // VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON: no node in the middle of any layer
      return SplitRings(ReadLattice<vtkBiQuadraticQuadraticHexahedron>({ { 2, 2, 2 } }));
  }
}

// The degree for which a cell has so many points; 0 for none.
template <typename Count>
int FindDegree(vtkIdType numberOfPoints, const Count& count)
{
  int degree = 1;
  while (count(degree) < numberOfPoints)
  {
    ++degree;
  }
  return count(degree) == numberOfPoints ? degree : 0;
}

CellParts MakeLagrangeTetrahedron(vtkIdType numberOfPoints)
{
  if (numberOfPoints == 15) // quadratic, with nodes in the middle of the faces and of the cell
  {
    vtkNew<vtkLagrangeTetra> cell;
    cell->GetPointIds()->SetNumberOfIds(15);
    cell->GetPoints()->SetNumberOfPoints(15);
    cell->Initialize();
    return SplitRoundCenter(ReadFaces(cell), 14);
  }
  const int degree = FindDegree(
    numberOfPoints, [](vtkIdType n) -> vtkIdType { return (n + 1) * (n + 2) * (n + 3) / 6; });
  if (degree == 2)
  {
    return MakeParts(VTK_QUADRATIC_TETRA); // which has the same nodes
  }
  return SplitTetrahedron(degree,
    [degree](int i, int j, int k)
    {
      const vtkIdType place[4] = { i, j, k, degree - i - j - k };
      return static_cast<int>(vtkHigherOrderTetra::Index(place, degree));
    });
}

CellParts MakeLagrangeHexahedron(vtkIdType numberOfPoints, const std::array<int, 3>* degrees)
{
  std::array<int, 3> order;
  order.fill(FindDegree(
    numberOfPoints, [](vtkIdType n) -> vtkIdType { return (n + 1) * (n + 1) * (n + 1); }));
  if (degrees)
  {
    order = *degrees;
  }
  const auto size = [&](int axis) { return static_cast<vtkIdType>(order[axis]) + 1; };
  if (*std::min_element(order.begin(), order.end()) < 1 || size(0) > numberOfPoints ||
    size(1) > numberOfPoints || size(2) > numberOfPoints ||
    size(0) * size(1) * size(2) != numberOfPoints)
  {
    return {};
  }
  return SplitHexahedron(order,
    [&order](int i, int j, int k)
    { return vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order.data()); });
}

CellParts MakeLagrangeWedge(vtkIdType numberOfPoints, const std::array<int, 3>* degrees)
{
  if (numberOfPoints == 21) // whatever the degrees: VTK takes it for quadratic
  {
    return SplitWedgeOf21();
  }
  const int degree = FindDegree(
    numberOfPoints, [](vtkIdType n) -> vtkIdType { return (n + 1) * (n + 1) * (n + 2) / 2; });
  std::array<int, 3> order{ { degree, degree, degree } };
  if (degrees)
  {
    order = *degrees;
  }
  const vtkIdType side = order[0];
  const vtkIdType layers = order[2];
  if (side < 1 || order[1] != order[0] || layers < 1 || side > numberOfPoints ||
    layers > numberOfPoints || (side + 1) * (side + 2) / 2 * (layers + 1) != numberOfPoints)
  {
    return {};
  }
  const std::array<int, 4> all{ { order[0], order[1], order[2],
    static_cast<int>(numberOfPoints) } };
  return SplitWedge(order[0], order[2],
    [&all](int i, int j, int k)
    { return vtkHigherOrderWedge::PointIndexFromIJK(i, j, k, all.data()); });
}

} // namespace

bool HigherOrderCells::Contain(int cellType)
{
  switch (cellType)
  {
    case VTK_LAGRANGE_TETRAHEDRON:
    case VTK_LAGRANGE_HEXAHEDRON:
    case VTK_LAGRANGE_WEDGE:
      return true;
    default:
      return GetNumberOfCellPoints(cellType) > 0 && cellType >= VTK_QUADRATIC_EDGE;
  }
}

const std::vector<std::array<int, 3>>& HigherOrderCells::GetMidSides(int cellType)
{
  const auto known = this->MidSides.try_emplace(cellType);
  if (known.second && GetNumberOfCellPoints(cellType) > 0)
  {
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(cellType));
    for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i)
    {
      cell->PointIds->SetId(i, i);
    }
    for (int i = 0; i < cell->GetNumberOfEdges(); ++i)
    {
      vtkIdList* ids = cell->GetEdge(i)->GetPointIds();
      if (ids->GetNumberOfIds() == 3)
      {
        known.first->second.push_back({ { static_cast<int>(ids->GetId(0)),
          static_cast<int>(ids->GetId(1)), static_cast<int>(ids->GetId(2)) } });
      }
    }
  }
  return known.first->second;
}

bool HigherOrderCells::IsBezier(int cellType)
{
  return cellType == VTK_BEZIER_TETRAHEDRON || cellType == VTK_BEZIER_HEXAHEDRON ||
    cellType == VTK_BEZIER_WEDGE || cellType == VTK_BEZIER_PYRAMID;
}

const CellParts& HigherOrderCells::GetParts(
  int cellType, vtkIdType numberOfPoints, const std::array<int, 3>* degrees)
{
  const std::array<int, 3> none{ { 0, 0, 0 } };
  const bool hasDegrees =
    degrees && (cellType == VTK_LAGRANGE_HEXAHEDRON || cellType == VTK_LAGRANGE_WEDGE);
  const auto known =
    this->Known.try_emplace({ { cellType, numberOfPoints }, hasDegrees ? *degrees : none });
  CellParts& parts = known.first->second;
  if (known.second)
  {
    switch (cellType)
    {
      case VTK_LAGRANGE_TETRAHEDRON:
        parts = MakeLagrangeTetrahedron(numberOfPoints);
        break;
      case VTK_LAGRANGE_HEXAHEDRON:
        parts = MakeLagrangeHexahedron(numberOfPoints, degrees);
        break;
      case VTK_LAGRANGE_WEDGE:
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
