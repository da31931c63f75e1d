// SPDX-License-Identifier: BSD-3-Clause
#include "DeformationMesh.h"

#include "CellSplit.h"
#include "VectorArray.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCellTypes.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdTypeArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <limits>
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
  const char* className = vtkCellTypes::GetClassNameFromTypeId(type);
  throw Error("Cell " + std::to_string(cell) + " of the deformation mesh is a " +
    (className ? className : "cell of unknown type") + " with " + std::to_string(count) +
    " points" + complaint + ". Mend the cells of the mesh.");
}

// What would have to be read beyond the end of an array, once it is followed.
void CheckStructure(vtkUnstructuredGrid* grid)
{
  const vtkIdType numberOfCells = grid->GetNumberOfCells();
  const vtkUnsignedCharArray* types = grid->GetCellTypesArray();
  const vtkIdType numberOfTypes = types ? types->GetNumberOfValues() : 0;
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
  vtkIdTypeArray* stream = grid->GetFaces();
  vtkIdTypeArray* locations = grid->GetFaceLocations();
  const vtkIdType length = stream ? stream->GetNumberOfValues() : 0;
  vtkIdType next =
    locations && cell < locations->GetNumberOfValues() ? locations->GetValue(cell) : -1;
  const auto check = [&](bool complete)
  {
    if (!complete)
    {
      ThrowBadCell(cell, VTK_POLYHEDRON, count, " and incomplete faces");
    }
  };
  const auto read = [&]
  {
    check(next >= 0 && next < length);
    return stream->GetValue(next++);
  };
  std::vector<std::int32_t> nodes;
  CellFaces faces;
  std::map<vtkIdType, int> positions;
  const vtkIdType numberOfFaces = read();
  check(numberOfFaces >= 4);
  for (vtkIdType i = 0; i < numberOfFaces; ++i)
  {
    std::vector<int> face;
    const vtkIdType size = read();
    check(size >= 3);
    for (vtkIdType left = size; left > 0; --left)
    {
      const vtkIdType point = read();
      CheckPoint(point, grid->GetNumberOfPoints(), cell);
      const auto inserted = positions.emplace(point, static_cast<int>(nodes.size()));
      if (inserted.second)
      {
        nodes.push_back(firstNode + static_cast<std::int32_t>(point));
      }
      face.push_back(inserted.first->second);
    }
    faces.push_back(face);
  }
  SplitCell(nodes, faces, tetrahedra);
}

void ReadPart(vtkUnstructuredGrid* grid, std::int32_t firstNode,
  std::vector<Tetrahedron>& tetrahedra, std::map<int, vtkIdType>& ignored)
{
  const auto ghosts = vtkUnsignedCharArray::SafeDownCast(
    grid->GetCellData()->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()));
  constexpr unsigned char skipped =
    vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL;
  const vtkIdType numberOfCells = grid->GetNumberOfCells();
  const vtkIdType numberOfPoints = grid->GetNumberOfPoints();
  CheckStructure(grid);
  std::vector<std::int32_t> nodes;
  for (vtkIdType cell = 0; cell < numberOfCells; ++cell)
  {
    if (ghosts && cell < ghosts->GetNumberOfTuples() && (ghosts->GetValue(cell) & skipped))
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
    else
    {
      ++ignored[type];
    }
  }
}

} // namespace

MeshParts FindGrids(vtkDataObject* object)
{
  MeshParts parts;
  if (const auto grid = vtkUnstructuredGrid::SafeDownCast(object))
  {
    parts.push_back(grid);
  }
  else if (const auto composite = vtkCompositeDataSet::SafeDownCast(object))
  {
    const auto leaves = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
    for (leaves->InitTraversal(); !leaves->IsDoneWithTraversal(); leaves->GoToNextItem())
    {
      if (const auto leaf = vtkUnstructuredGrid::SafeDownCast(leaves->GetCurrentDataObject()))
      {
        parts.push_back(leaf);
      }
    }
  }
  return parts;
}

MeshParts GetMeshParts(vtkDataObject* object, const std::string& name)
{
  MeshParts parts = FindGrids(object);
  if (parts.empty() && vtkCompositeDataSet::SafeDownCast(object))
  {
    throw Error("The composite dataset that is the " + name +
      " holds no vtkUnstructuredGrid. Connect one with tetrahedra.");
  }
  if (parts.empty())
  {
    throw Error("There is no " + name + ". Connect a vtkUnstructuredGrid with tetrahedra.");
  }
  if (GetNumberOfNodes(parts) == 0)
  {
    throw Error("The " + name + " has no points. Connect a vtkUnstructuredGrid with tetrahedra.");
  }
  if (GetNumberOfNodes(parts) > std::numeric_limits<std::int32_t>::max())
  {
    throw Error("The " + name + " has more than 2,147,483,647 points. Connect a coarser one.");
  }
  return parts;
}

std::size_t GetNumberOfNodes(const MeshParts& parts)
{
  std::size_t nodes = 0;
  for (vtkUnstructuredGrid* grid : parts)
  {
    nodes += static_cast<std::size_t>(grid->GetNumberOfPoints());
  }
  return nodes;
}

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
    const char* className = vtkCellTypes::GetClassNameFromTypeId(entry.first);
    cells.Ignored += (cells.Ignored.empty() ? "" : ", ") + std::to_string(entry.second) + " " +
      (className ? className : "unknown");
  }
  return cells;
}

std::vector<glm::dvec3> ReadPoints(const MeshParts& parts, const std::string& name)
{
  std::vector<glm::dvec3> points(GetNumberOfNodes(parts));
  glm::dvec3* next = points.data();
  for (vtkUnstructuredGrid* grid : parts)
  {
    if (grid->GetNumberOfPoints() > 0)
    {
      ReadVectors(
        grid->GetPoints()->GetData(),
        [next](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
        { std::copy_n(vectors, count, next + first); },
        "Point", name);
      next += grid->GetNumberOfPoints();
    }
  }
  return points;
}

vtkDataArray* FindVectors(vtkDataSet* dataSet, const ArraySelector& selector,
  const std::string& wanted, const std::string& name)
{
  vtkDataArray* array = selector(dataSet);
  if (!array)
  {
    const char* const alternative = vtkUnstructuredGrid::SafeDownCast(dataSet)
      ? ", or connect a rest configuration to input port 2 where the mesh is deformed already."
      : ".";
    throw Error("The " + name + " has no " + wanted +
      ". Choose the displacements with SetInputArrayToProcess(0, 1, 0, "
      "vtkDataObject::FIELD_ASSOCIATION_POINTS, name)" +
      alternative);
  }
  if (array->GetNumberOfComponents() != 3)
  {
    throw Error("The displacements of the " + name + ", " + wanted + ", have " +
      std::to_string(array->GetNumberOfComponents()) +
      " components. Choose an array with three components.");
  }
  if (array->GetNumberOfTuples() != dataSet->GetNumberOfPoints())
  {
    throw Error("The displacements of the " + name + ", " + wanted + ", have " +
      std::to_string(array->GetNumberOfTuples()) + " tuples for " +
      std::to_string(dataSet->GetNumberOfPoints()) +
      " points. Choose an array with one tuple for each point.");
  }
  return array;
}

void ReadPointVectors(const MeshParts& parts, const ArraySelector& selector,
  const std::string& wanted, const std::string& name, const VectorTaker& take,
  std::vector<VectorMemory>* memories)
{
  std::vector<VectorMemory> none;
  std::vector<VectorMemory>& last = memories ? *memories : none;
  last.resize(parts.size());
  vtkIdType next = 0;
  for (std::size_t part = 0; part < parts.size(); ++part)
  {
    vtkUnstructuredGrid* grid = parts[part];
    const vtkIdType points = grid->GetNumberOfPoints();
    if (points == 0 || last[part].Place != next)
    {
      last[part] = VectorMemory();
      last[part].Place = next;
    }
    if (points > 0)
    {
      ReadVectors(
        FindVectors(grid, selector, wanted, name),
        [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
        { take(next + first, vectors, count); },
        "Displacement", name, memories ? &last[part] : nullptr);
    }
    next += points;
  }
}

Stamp GetCellsStamp(const MeshParts& parts)
{
  Stamp stamp;
  const auto add = [&](vtkObject* object)
  { stamp.emplace_back(object, object ? object->GetMTime() : 0); };
  for (vtkUnstructuredGrid* grid : parts)
  {
    // The time of the grid itself: cells that are inserted leave no trace in those of its parts.
    stamp.emplace_back(grid, grid->vtkObject::GetMTime());
    stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(grid->GetNumberOfCells()));
    vtkCellArray* cells = grid->GetCells();
    add(cells);
    add(cells ? cells->GetConnectivityArray() : nullptr);
    add(cells ? cells->GetOffsetsArray() : nullptr);
    add(grid->GetCellTypesArray());
    add(grid->GetCellData()->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()));
    // The node numbers of a part follow from the sizes of the parts before it.
    stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(grid->GetNumberOfPoints()));
  }
  return stamp;
}

Stamp GetPointsStamp(const MeshParts& parts)
{
  Stamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    stamp.emplace_back(grid, grid->vtkObject::GetMTime());
    vtkPoints* points = grid->GetPoints();
    stamp.emplace_back(points, points ? points->GetMTime() : 0);
  }
  return stamp;
}

Stamp GetPointVectorsStamp(const MeshParts& parts)
{
  Stamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    stamp.emplace_back(grid, grid->vtkObject::GetMTime());
    stamp.emplace_back(nullptr, grid->GetPointData()->GetMTime());
  }
  return stamp;
}

} // namespace deformvolume
