// SPDX-License-Identifier: BSD-3-Clause
#ifndef TenNodeCells_h
#define TenNodeCells_h

#include "FilterTesting.h"

#include <vtkCellType.h>
#include <vtkIdList.h>

#include <algorithm>
#include <map>
#include <vector>

namespace filterTesting
{

/// Replaces the tetrahedra of a mesh by ten-node tetrahedra with straight edges. separated: the
/// cells share no nodes.
inline vtkSmartPointer<vtkUnstructuredGrid> MakeTenNodes(
  vtkUnstructuredGrid* linear, bool separated = false)
{
  // The end points of the edges whose middles are the nodes 4 to 9.
  constexpr int edges[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  std::map<std::array<vtkIdType, 3>, vtkIdType> known;
  for (vtkIdType cell = 0; cell < linear->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> corners;
    linear->GetCellPoints(cell, corners);
    const auto add = [&](vtkIdType a, vtkIdType b)
    {
      const auto [low, high] = std::minmax(a, b);
      const auto found =
        known.emplace(std::array<vtkIdType, 3>{ { separated ? cell : 0, low, high } },
          points->GetNumberOfPoints());
      if (found.second)
      {
        const glm::dvec3 middle = 0.5 * (GetPoint(linear, a) + GetPoint(linear, b));
        points->InsertNextPoint(&middle.x);
      }
      return found.first->second;
    };
    std::vector<vtkIdType> ids;
    for (vtkIdType i = 0; i < 4; ++i)
    {
      ids.push_back(add(corners->GetId(i), corners->GetId(i)));
    }
    for (const auto& edge : edges)
    {
      ids.push_back(add(corners->GetId(edge[0]), corners->GetId(edge[1])));
    }
    grid->InsertNextCell(VTK_QUADRATIC_TETRA, 10, ids.data());
  }
  grid->SetPoints(points);
  return grid;
}

} // namespace filterTesting

#endif
