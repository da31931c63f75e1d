// SPDX-License-Identifier: BSD-3-Clause
#include "MeshCells.h"

#include "CellSplit.h"
#include "CellTypes.h"
#include "Error.h"
#include "HigherOrderCells.h"
#include "MaskArray.h"
#include "PolyhedronFaces.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkUnstructuredGrid.h"

#include <array>
#include <map>

namespace deformvolume
{

namespace
{

void CheckPoint(vtkIdType point, vtkIdType numberOfPoints, vtkIdType cell)
{
  if (point < 0 || point >= numberOfPoints)
  {
    throw Error("Cell " + std::to_string(cell) + " of the deformation mesh uses point " +
      std::to_string(point) + ", and there are only " + std::to_string(numberOfPoints) +
      " points. Mend the cells of the mesh.");
  }
}

[[noreturn]] void ThrowBadCell(
  vtkIdType cell, int type, vtkIdType count, const std::string& complaint)
{
  throw Error("Cell " + std::to_string(cell) + " of the deformation mesh is a " +
    GetCellClassName(type) + " with " + std::to_string(count) + " points" + complaint +
    ". Mend the cells of the mesh.");
}

// What would have to be read beyond the end of an array, once it is followed.
void CheckStructure(vtkUnstructuredGrid* grid)
{
  const vtkIdType numberOfCells = grid->GetNumberOfCells();
  vtkDataArray* types = GetCellTypes(grid);
  const vtkIdType numberOfTypes = types ? types->GetNumberOfTuples() : 0;
  if (numberOfTypes < numberOfCells)
  {
    throw Error("The deformation mesh has " + std::to_string(numberOfCells) + " cells, but " +
      std::to_string(numberOfTypes) + " cell types. Mend the cells of the mesh.");
  }
  if (!grid->GetCells()->IsValid())
  {
    throw Error("The offsets of the deformation mesh's cells do not fit their connectivity. Mend "
                "the cells of the mesh.");
  }
}

// A polyhedron brings its own faces. Its points may be listed in any order, so positions are
// looked up by id.
void SplitPolyhedron(vtkUnstructuredGrid* grid, vtkIdType cell, vtkIdType count,
  std::int32_t firstNode, std::vector<Tetrahedron>& tetrahedra)
{
  PolyhedronFaces faces;
  bool complete = ReadPolyhedronFaces(grid, cell, faces) && faces.size() >= 4;
  std::vector<std::int32_t> nodes;
  CellFaces positionsOfFaces;
  std::map<vtkIdType, int> positions;
  for (const std::vector<vtkIdType>& points : faces)
  {
    complete &= points.size() >= 3;
    std::vector<int> face;
    for (const vtkIdType point : points)
    {
      CheckPoint(point, grid->GetNumberOfPoints(), cell);
      const auto inserted = positions.emplace(point, static_cast<int>(nodes.size()));
      if (inserted.second)
      {
        nodes.push_back(firstNode + static_cast<std::int32_t>(point));
      }
      face.push_back(inserted.first->second);
    }
    positionsOfFaces.push_back(face);
  }
  if (!complete)
  {
    ThrowBadCell(cell, VTK_POLYHEDRON, count, " and incomplete faces");
  }
  SplitCell(nodes, positionsOfFaces, tetrahedra);
}

// The degrees of Lagrange cells along their axes, one tuple for each cell of the mesh; null where
// they follow from the numbers of points.
vtkDataArray* FindDegrees(vtkUnstructuredGrid* grid)
{
  vtkDataArray* degrees = grid->GetCellData()->GetHigherOrderDegrees();
  if (degrees &&
    (degrees->GetNumberOfComponents() != 3 ||
      degrees->GetNumberOfTuples() != grid->GetNumberOfCells()))
  {
    throw Error("The higher order degrees of the deformation mesh's cells are " +
      std::to_string(degrees->GetNumberOfTuples()) + " tuples of " +
      std::to_string(degrees->GetNumberOfComponents()) + " components for " +
      std::to_string(grid->GetNumberOfCells()) +
      " cells. Give them three components and one tuple for each cell.");
  }
  return degrees;
}

// nodes: of the cell.
void SplitHigherOrderCell(vtkUnstructuredGrid* grid, vtkIdType cell, int type,
  const std::vector<std::int32_t>& nodes, HigherOrderCells& cells,
  std::vector<Tetrahedron>& tetrahedra)
{
  std::array<int, 3> degrees{ { 0, 0, 0 } };
  vtkDataArray* array = FindDegrees(grid);
  for (int axis = 0; axis < 3 && array; ++axis)
  {
    const double degree = array->GetComponent(cell, axis);
    degrees[axis] = degree >= 1.0 && degree < 1e6 ? static_cast<int>(degree) : 0;
  }
  const auto count = static_cast<vtkIdType>(nodes.size());
  const CellParts& parts = cells.GetParts(type, count, array ? &degrees : nullptr);
  if (parts.empty())
  {
    ThrowBadCell(cell, type, count, ", which does not fit its degree");
  }
  std::vector<std::int32_t> some;
  for (const CellPart& part : parts)
  {
    some.clear();
    for (const int node : part.Nodes)
    {
      some.push_back(nodes[static_cast<std::size_t>(node)]);
    }
    SplitCell(some, part.Faces, tetrahedra);
  }
}

void ReadPart(vtkUnstructuredGrid* grid, std::int32_t firstNode,
  std::vector<Tetrahedron>& tetrahedra, std::map<int, vtkIdType>& ignored)
{
  ByteArray* ghosts = FindMask(grid->GetCellData(), vtkDataSetAttributes::GhostArrayName(),
    grid->GetNumberOfCells(), "cell", "deformation mesh");
  constexpr unsigned char skipped =
    vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL;
  const vtkIdType numberOfCells = grid->GetNumberOfCells();
  const vtkIdType numberOfPoints = grid->GetNumberOfPoints();
  CheckStructure(grid);
  HigherOrderCells higherOrderCells;
  std::vector<std::int32_t> nodes;
  for (vtkIdType cell = 0; cell < numberOfCells; ++cell)
  {
    if (ghosts && (ghosts->GetValue(cell) & skipped))
    {
      continue;
    }
    int type = grid->GetCellType(cell);
    vtkIdType count = 0;
    const vtkIdType* points = nullptr;
    grid->GetCells()->GetCellAtId(cell, count, points);
    for (vtkIdType i = 0; i < count; ++i)
    {
      CheckPoint(points[i], numberOfPoints, cell);
    }
    const int needed = GetNumberOfCellPoints(type);
    if (needed > 0 && count != needed)
    {
      ThrowBadCell(cell, type, count, " instead of " + std::to_string(needed));
    }
    if (type == VTK_TETRA)
    {
      tetrahedra.emplace_back();
      for (int i = 0; i < 4; ++i)
      {
        tetrahedra.back()[i] = firstNode + static_cast<std::int32_t>(points[i]);
      }
      continue;
    }
    if (type == VTK_POLYHEDRON)
    {
      SplitPolyhedron(grid, cell, count, firstNode, tetrahedra);
      continue;
    }
    nodes.resize(static_cast<std::size_t>(count));
    for (vtkIdType i = 0; i < count; ++i)
    {
      nodes[i] = firstNode + static_cast<std::int32_t>(points[i]);
    }
    if (type == VTK_VOXEL)
    {
      std::swap(nodes[2], nodes[3]);
      std::swap(nodes[6], nodes[7]);
      type = VTK_HEXAHEDRON;
    }
    if (const CellFaces* faces = GetCellFaces(type))
    {
      SplitCell(nodes, *faces, tetrahedra);
    }
    else if (HigherOrderCells::Contain(type))
    {
      SplitHigherOrderCell(grid, cell, type, nodes, higherOrderCells, tetrahedra);
    }
    else if (HigherOrderCells::IsBezier(type))
    {
      ThrowBadCell(cell, type, count,
        ". The points of Bezier cells control their shape and do not lie on it: convert the mesh "
        "to Lagrange or to linear cells");
    }
    else
    {
      ++ignored[type];
    }
  }
}

} // namespace

MeshCells ReadCells(const MeshParts& parts)
{
  MeshCells cells;
  std::map<int, vtkIdType> ignored;
  std::size_t numberOfCells = 0;
  for (vtkUnstructuredGrid* grid : parts)
  {
    numberOfCells += static_cast<std::size_t>(grid->GetNumberOfCells());
  }
  cells.Tetrahedra.reserve(numberOfCells);
  std::int32_t firstNode = 0;
  for (vtkUnstructuredGrid* grid : parts)
  {
    if (grid->GetNumberOfCells() > 0)
    {
      ReadPart(grid, firstNode, cells.Tetrahedra, ignored);
    }
    firstNode += static_cast<std::int32_t>(grid->GetNumberOfPoints());
  }
  for (const auto& entry : ignored)
  {
    cells.Ignored += (cells.Ignored.empty() ? "" : ", ") + std::to_string(entry.second) + " " +
      GetCellClassName(entry.first);
  }
  return cells;
}

} // namespace deformvolume
