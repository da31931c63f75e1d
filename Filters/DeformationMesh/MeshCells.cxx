// SPDX-License-Identifier: BSD-3-Clause
#include "MeshCells.h"

#include "CellTypes.h"
#include "Error.h"
#include "MaskArray.h"
#include "PolyhedronFaces.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace deformvolume
{

namespace
{

// Throws an Error if reading the cells would read beyond the end of an array.
void CheckStructure(vtkUnstructuredGrid* grid)
{
  const vtkIdType numberOfCells = grid->GetNumberOfCells();
  vtkDataArray* types = GetCellTypes(grid);
  const vtkIdType numberOfTypes = types ? types->GetNumberOfTuples() : 0;
  if (numberOfTypes < numberOfCells)
  {
    throw Error("The deformation mesh has " + std::to_string(numberOfCells) + " cells, but " +
      std::to_string(numberOfTypes) + " cell types. Correct the cells of the mesh.");
  }
  if (!grid->GetCells()->IsValid())
  {
    throw Error(
      "The offsets of the deformation mesh's cells do not fit their connectivity. Correct "
      "the cells of the mesh.");
  }
}

// Positions of the nodes of a mesh. They are read one by one, since tetrahedra need none.
class NodePositions
{
public:
  explicit NodePositions(const MeshParts& parts)
  {
    for (vtkUnstructuredGrid* grid : parts)
    {
      if (grid->GetNumberOfPoints() > 0)
      {
        this->Points.push_back(grid->GetPoints());
        this->Ends.push_back(
          (this->Ends.empty() ? 0 : this->Ends.back()) + grid->GetNumberOfPoints());
        if (grid->GetPoints()->GetDataType() == VTK_FLOAT)
        {
          this->Rounding = std::numeric_limits<float>::epsilon();
        }
      }
    }
  }

  glm::dvec3 Get(std::int32_t node) const
  {
    const auto end = std::upper_bound(this->Ends.begin(), this->Ends.end(), node);
    glm::dvec3 point(std::numeric_limits<double>::quiet_NaN());
    if (end != this->Ends.end())
    {
      const vtkIdType first = end == this->Ends.begin() ? 0 : *(end - 1);
      this->Points[static_cast<std::size_t>(end - this->Ends.begin())]->GetPoint(
        node - first, &point.x);
    }
    return point;
  }

  // The relative error of the positions.
  double GetRounding() const { return this->Rounding; }

private:
  std::vector<vtkPoints*> Points;
  std::vector<vtkIdType> Ends; // index after the last node of each
  double Rounding = std::numeric_limits<double>::epsilon();
};

void ReadPolyhedron(vtkUnstructuredGrid* grid, vtkIdType cell, vtkIdType count,
  std::int32_t firstNode, CellReader& reader)
{
  PolyhedronFaces read;
  const bool complete = ReadPolyhedronFaces(grid, cell, read);
  CellReader::PolyhedronFaces faces;
  for (const std::vector<vtkIdType>& points : read)
  {
    std::vector<std::int32_t> face;
    for (const vtkIdType point : points)
    {
      CheckCellPoint(point, grid->GetNumberOfPoints(), cell);
      face.push_back(firstNode + static_cast<std::int32_t>(point));
    }
    faces.push_back(face);
  }
  reader.AddPolyhedron(cell, count, faces, complete);
}

// The degrees of Lagrange cells along their axes, one tuple for each cell of the mesh; null if the
// degrees follow from the numbers of points.
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

// Reads the degrees of a cell. A degree that is not valid becomes 0.
std::array<int, 3> ReadDegrees(vtkDataArray* array, vtkIdType cell)
{
  std::array<int, 3> degrees{ { 0, 0, 0 } };
  for (int axis = 0; axis < 3; ++axis)
  {
    const double degree = array->GetComponent(cell, axis);
    degrees[axis] = degree >= 1.0 && degree < 1e6 ? static_cast<int>(degree) : 0;
  }
  return degrees;
}

// other: whose hidden cells are skipped, too. named: number of derived nodes that cells may use.
void ReadPart(vtkUnstructuredGrid* grid, vtkUnstructuredGrid* other, std::int32_t firstNode,
  vtkIdType named, CellReader& reader)
{
  const SkippedCells skipped(grid, "deformation mesh");
  const SkippedCells skippedInOther(other, "deformation mesh");
  const vtkIdType numberOfCells = grid->GetNumberOfCells();
  const vtkIdType numberOfPoints = grid->GetNumberOfPoints() + named;
  CheckStructure(grid);
  std::vector<std::int32_t> nodes;
  for (vtkIdType cell = 0; cell < numberOfCells; ++cell)
  {
    if (skipped.Contain(cell) || skippedInOther.Contain(cell))
    {
      continue;
    }
    const int type = grid->GetCellType(cell);
    vtkIdType count = 0;
    const vtkIdType* points = nullptr;
    grid->GetCells()->GetCellAtId(cell, count, points);
    for (vtkIdType i = 0; i < count; ++i)
    {
      CheckCellPoint(points[i], numberOfPoints, cell);
    }
    if (skipped.ContainPointOf(points, count) || skippedInOther.ContainPointOf(points, count))
    {
      continue;
    }
    CellReader::CheckSize(cell, type, count);
    if (type == VTK_TETRA)
    {
      Tetrahedron tetrahedron;
      for (int i = 0; i < 4; ++i)
      {
        tetrahedron[i] = firstNode + static_cast<std::int32_t>(points[i]);
      }
      reader.AddTetrahedron(tetrahedron);
      continue;
    }
    if (type == VTK_POLYHEDRON)
    {
      ReadPolyhedron(grid, cell, count, firstNode, reader);
      continue;
    }
    nodes.resize(static_cast<std::size_t>(count));
    for (vtkIdType i = 0; i < count; ++i)
    {
      nodes[i] = firstNode + static_cast<std::int32_t>(points[i]);
    }
    vtkDataArray* array = HigherOrderCells::Contain(type) ? FindDegrees(grid) : nullptr;
    const std::array<int, 3> degrees =
      array ? ReadDegrees(array, cell) : std::array<int, 3>{ { 0, 0, 0 } };
    reader.Add(cell, type, nodes, array ? &degrees : nullptr);
  }
}

} // namespace

MeshCells ReadCells(const MeshParts& parts, const MeshParts& rest, const DerivedNodes* derived,
  const std::vector<std::int32_t>* places, const MeshParts* other)
{
  std::size_t numberOfCells = 0;
  vtkIdType numberOfNodes = 0;
  for (vtkUnstructuredGrid* grid : parts)
  {
    numberOfCells += static_cast<std::size_t>(grid->GetNumberOfCells());
    numberOfNodes += grid->GetNumberOfPoints();
  }
  const NodePositions positions(rest);
  CellReader reader(
    static_cast<std::int32_t>(numberOfNodes),
    [&positions](std::int32_t node) { return positions.Get(node); }, positions.GetRounding());
  if (derived)
  {
    reader.SetDerived(*derived);
  }
  if (places)
  {
    reader.SetPlaces(*places);
  }
  reader.Reserve(numberOfCells);
  std::int32_t firstNode = 0;
  for (std::size_t part = 0; part < parts.size(); ++part)
  {
    vtkUnstructuredGrid* grid = parts[part];
    if (grid->GetNumberOfCells() > 0)
    {
      const bool hasOther = other && part < other->size() &&
        (*other)[part]->GetNumberOfCells() == grid->GetNumberOfCells();
      ReadPart(grid, hasOther ? (*other)[part] : grid, firstNode,
        derived ? static_cast<vtkIdType>(derived->GetCount()) : 0, reader);
    }
    firstNode += static_cast<std::int32_t>(grid->GetNumberOfPoints());
  }
  return reader.Finish();
}

} // namespace deformvolume
