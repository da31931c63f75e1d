// SPDX-License-Identifier: BSD-3-Clause
#include "MeshCells.h"

#include "CellSplit.h"
#include "CellTypes.h"
#include "Error.h"
#include "HigherOrderCells.h"
#include "MaskArray.h"
#include "PolyhedronFaces.h"
#include "PolyhedronSplit.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

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
      " points. Correct the cells of the mesh.");
  }
}

[[noreturn]] void ThrowBadCell(
  vtkIdType cell, int type, vtkIdType count, const std::string& complaint)
{
  throw Error("Cell " + std::to_string(cell) + " of the deformation mesh is a " +
    GetCellName(type) + " with " + std::to_string(count) + " points" + complaint +
    ". Correct the cells of the mesh.");
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
      std::to_string(numberOfTypes) + " cell types. Correct the cells of the mesh.");
  }
  if (!grid->GetCells()->IsValid())
  {
    throw Error(
      "The offsets of the deformation mesh's cells do not fit their connectivity. Correct "
      "the cells of the mesh.");
  }
}

// Where the nodes of a mesh are, found one by one: few cells need it.
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
  std::vector<vtkIdType> Ends; // of the nodes of each
  double Rounding = std::numeric_limits<double>::epsilon();
};

// What is read of a mesh.
struct Reading
{
  explicit Reading(const MeshParts& rest)
    : Positions(rest)
  {
  }

  MeshCells Cells;
  std::int32_t NumberOfNodes = 0; // of all grids
  vtkIdType NumberOfNamed = 0;    // derived nodes that cells name
  NodePositions Positions;
  HigherOrderCells HigherOrder;
  std::map<int, vtkIdType> Ignored;
  vtkIdType NumberOfQuadraticCells = 0;
  vtkIdType NumberOfFarMidSides = 0;

  // Returns the number of a new node.
  std::int32_t AddNode(const std::vector<std::int32_t>& nodes, const std::vector<double>& weights)
  {
    const std::size_t number =
      static_cast<std::size_t>(this->NumberOfNodes) + this->Cells.Derived.GetCount();
    if (number >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    {
      throw Error("The deformation mesh has more than 2,147,483,647 nodes, with those in the "
                  "middle of its cells. Use a coarser one.");
    }
    this->Cells.Derived.Add(nodes, weights);
    return static_cast<std::int32_t>(number);
  }
};

// A polyhedron brings its own faces. Its points may be listed in any order, so positions are
// looked up by id.
void ReadPolyhedron(vtkUnstructuredGrid* grid, vtkIdType cell, vtkIdType count,
  std::int32_t firstNode, Reading& reading)
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
  std::vector<glm::dvec3> points;
  for (const std::int32_t node : nodes)
  {
    points.push_back(reading.Positions.Get(node));
  }
  PolyhedronSplit split;
  if (!SplitPolyhedron(nodes, positionsOfFaces, points, reading.Positions.GetRounding(), split))
  {
    throw Error("Cell " + std::to_string(cell) + " of the deformation mesh is a concave " +
      GetCellName(VTK_POLYHEDRON) + " with " + std::to_string(nodes.size()) +
      " points, and no point inside sees all of its faces. Divide it into convex or star-shaped "
      "cells.");
  }
  std::vector<Tetrahedron>& tetrahedra = reading.Cells.Tetrahedra;
  tetrahedra.insert(tetrahedra.end(), split.Tetrahedra.begin(), split.Tetrahedra.end());
  if (!split.CenterWeights.empty())
  {
    const std::int32_t center = reading.AddNode(nodes, split.CenterWeights);
    for (const std::array<std::int32_t, 3>& triangle : split.Triangles)
    {
      tetrahedra.push_back({ { center, triangle[0], triangle[1], triangle[2] } });
    }
  }
}

// Whether all nodes in the middle of edges are about there. The middle of an arc of 120 degrees is
// farther by 0.29 of the length between its ends, a quarter point is by 0.25, and the middle of
// another edge is by 0.5 where all edges have one length.
bool HasNearMidSides(int type, const std::vector<std::int32_t>& nodes, Reading& reading)
{
  constexpr double most = 0.3;
  for (const std::array<int, 3>& edge : reading.HigherOrder.GetMidSides(type))
  {
    const auto at = [&](int i)
    { return reading.Positions.Get(nodes[static_cast<std::size_t>(edge[i])]); };
    const glm::dvec3 first = at(0);
    const glm::dvec3 second = at(1);
    if (glm::distance(at(2), 0.5 * (first + second)) > most * glm::distance(first, second))
    {
      return false;
    }
  }
  return true;
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
  const std::vector<std::int32_t>& nodes, Reading& reading)
{
  std::array<int, 3> degrees{ { 0, 0, 0 } };
  vtkDataArray* array = FindDegrees(grid);
  for (int axis = 0; axis < 3 && array; ++axis)
  {
    const double degree = array->GetComponent(cell, axis);
    degrees[axis] = degree >= 1.0 && degree < 1e6 ? static_cast<int>(degree) : 0;
  }
  const auto count = static_cast<vtkIdType>(nodes.size());
  const CellParts& parts = reading.HigherOrder.GetParts(type, count, array ? &degrees : nullptr);
  if (parts.empty())
  {
    ThrowBadCell(cell, type, count, ", which does not fit its degree");
  }
  std::vector<Tetrahedron>& tetrahedra = reading.Cells.Tetrahedra;
  std::vector<std::int32_t> some;
  for (const CellPart& part : parts)
  {
    some.clear();
    for (const int node : part.Nodes)
    {
      some.push_back(nodes[static_cast<std::size_t>(node)]);
    }
    if (part.CenterWeights.empty())
    {
      SplitCell(some, part.Faces, tetrahedra);
      continue;
    }
    const std::int32_t center = reading.AddNode(nodes, part.CenterWeights);
    for (const std::vector<int>& face : part.Faces)
    {
      tetrahedra.push_back({ { center, some[static_cast<std::size_t>(face[0])],
        some[static_cast<std::size_t>(face[1])], some[static_cast<std::size_t>(face[2])] } });
    }
  }
  reading.NumberOfQuadraticCells += reading.HigherOrder.GetMidSides(type).empty() ? 0 : 1;
  reading.NumberOfFarMidSides += HasNearMidSides(type, nodes, reading) ? 0 : 1;
}

void ReadPart(vtkUnstructuredGrid* grid, std::int32_t firstNode, Reading& reading)
{
  std::vector<Tetrahedron>& tetrahedra = reading.Cells.Tetrahedra;
  ByteArray* ghosts = FindMask(grid->GetCellData(), vtkDataSetAttributes::GhostArrayName(),
    grid->GetNumberOfCells(), "cell", "deformation mesh");
  constexpr unsigned char skipped =
    vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL;
  const vtkIdType numberOfCells = grid->GetNumberOfCells();
  const vtkIdType numberOfPoints = grid->GetNumberOfPoints() + reading.NumberOfNamed;
  CheckStructure(grid);
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
      ReadPolyhedron(grid, cell, count, firstNode, reading);
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
      SplitHigherOrderCell(grid, cell, type, nodes, reading);
    }
    else if (HigherOrderCells::IsBezier(type))
    {
      ThrowBadCell(cell, type, count,
        ". The points of Bezier cells control their shape and do not lie on it: convert the mesh "
        "to Lagrange or to linear cells");
    }
    else
    {
      ++reading.Ignored[type];
    }
  }
}

} // namespace

MeshCells ReadCells(const MeshParts& parts, const MeshParts& rest, const DerivedNodes* derived)
{
  std::size_t numberOfCells = 0;
  vtkIdType numberOfNodes = 0;
  for (vtkUnstructuredGrid* grid : parts)
  {
    numberOfCells += static_cast<std::size_t>(grid->GetNumberOfCells());
    numberOfNodes += grid->GetNumberOfPoints();
  }
  Reading reading(rest);
  reading.NumberOfNodes = static_cast<std::int32_t>(numberOfNodes);
  MeshCells& cells = reading.Cells;
  if (derived)
  {
    cells.Derived = *derived;
    reading.NumberOfNamed = static_cast<vtkIdType>(derived->GetCount());
  }
  cells.Tetrahedra.reserve(numberOfCells);
  std::int32_t firstNode = 0;
  for (vtkUnstructuredGrid* grid : parts)
  {
    if (grid->GetNumberOfCells() > 0)
    {
      ReadPart(grid, firstNode, reading);
    }
    firstNode += static_cast<std::int32_t>(grid->GetNumberOfPoints());
  }
  for (const auto& entry : reading.Ignored)
  {
    cells.Ignored += (cells.Ignored.empty() ? "" : ", ") + std::to_string(entry.second) + " " +
      GetCellName(entry.first);
  }
  if (reading.NumberOfFarMidSides > 0)
  {
    cells.FarMidSides = std::to_string(reading.NumberOfFarMidSides) + " of " +
      std::to_string(reading.NumberOfQuadraticCells);
  }
  return std::move(cells);
}

} // namespace deformvolume
