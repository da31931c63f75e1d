// SPDX-License-Identifier: BSD-3-Clause
#include "CellSplit.h"

#include "vtkCell3D.h"
#include "vtkCellType.h"
#include "vtkHexagonalPrism.h"
#include "vtkHexahedron.h"
#include "vtkNew.h"
#include "vtkPentagonalPrism.h"
#include "vtkPyramid.h"
#include "vtkWedge.h"

#include <algorithm>

namespace deformvolume
{

namespace
{

template <typename CellT>
CellFaces ReadFaces()
{
  vtkNew<CellT> cell;
  CellFaces faces;
  for (int face = 0; face < cell->GetNumberOfFaces(); ++face)
  {
    const vtkIdType* points = nullptr;
    const vtkIdType count = cell->GetFacePoints(face, points);
    faces.emplace_back(points, points + count);
  }
  return faces;
}

} // namespace

const CellFaces* GetCellFaces(int cellType)
{
  static const CellFaces hexahedron = ReadFaces<vtkHexahedron>();
  static const CellFaces wedge = ReadFaces<vtkWedge>();
  static const CellFaces pyramid = ReadFaces<vtkPyramid>();
  static const CellFaces pentagonalPrism = ReadFaces<vtkPentagonalPrism>();
  static const CellFaces hexagonalPrism = ReadFaces<vtkHexagonalPrism>();
  switch (cellType)
  {
    case VTK_HEXAHEDRON:
      return &hexahedron;
    case VTK_WEDGE:
      return &wedge;
    case VTK_PYRAMID:
      return &pyramid;
    case VTK_PENTAGONAL_PRISM:
      return &pentagonalPrism;
    case VTK_HEXAGONAL_PRISM:
      return &hexagonalPrism;
    default:
      return nullptr;
  }
}

int GetNumberOfCellPoints(int cellType)
{
  switch (cellType)
  {
    case VTK_TETRA:
      return 4;
    case VTK_PYRAMID:
      return 5;
    case VTK_WEDGE:
      return 6;
    case VTK_HEXAHEDRON:
    case VTK_VOXEL:
      return 8;
    case VTK_PENTAGONAL_PRISM:
      return 10;
    case VTK_HEXAGONAL_PRISM:
      return 12;
    case VTK_QUADRATIC_TETRA:
      return 10;
    case VTK_QUADRATIC_LINEAR_WEDGE:
      return 12;
    case VTK_QUADRATIC_PYRAMID:
      return 13;
    case VTK_QUADRATIC_WEDGE:
      return 15;
    case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
      return 18;
    case VTK_TRIQUADRATIC_PYRAMID:
      return 19;
    case VTK_QUADRATIC_HEXAHEDRON:
      return 20;
    case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
      return 24;
    case VTK_TRIQUADRATIC_HEXAHEDRON:
      return 27;
    default:
      return 0;
  }
}

void SplitCell(const std::vector<std::int32_t>& nodes, const CellFaces& faces,
  std::vector<Tetrahedron>& tetrahedra)
{
  const std::int32_t apex = *std::min_element(nodes.begin(), nodes.end());
  const auto node = [&](const std::vector<int>& face, std::size_t i)
  { return nodes[static_cast<std::size_t>(face[i % face.size()])]; };
  for (const std::vector<int>& face : faces)
  {
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < face.size(); ++i)
    {
      lowest = node(face, i) < node(face, lowest) ? i : lowest;
    }
    if (face.empty() || node(face, lowest) == apex)
    {
      continue;
    }
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
    {
      tetrahedra.push_back(
        { { apex, node(face, lowest), node(face, lowest + i), node(face, lowest + i + 1) } });
    }
  }
}

} // namespace deformvolume
