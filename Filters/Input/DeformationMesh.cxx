// SPDX-License-Identifier: BSD-3-Clause
#include "DeformationMesh.h"

#include "Error.h"
#include "VectorArray.h"

#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <limits>

namespace deformvolume
{

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
  std::vector<VectorMemory>* memories, const FloatTaker& takeFloats)
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
        "Displacement", name, memories ? &last[part] : nullptr,
        takeFloats ? [&](vtkIdType first, const float* vectors, vtkIdType count)
          { return takeFloats(next + first, vectors, count); }
                   : FloatTaker());
    }
    next += points;
  }
}

Stamp GetPointsStamp(const MeshParts& parts)
{
  Stamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    stamp.emplace_back(grid, grid->vtkObject::GetMTime());
    vtkPoints* points = grid->GetPoints();
    stamp.emplace_back(points, points ? points->GetMTime() : 0);
    stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(grid->GetNumberOfPoints()));
  }
  return stamp;
}

Stamp GetPointVectorsStamp(const MeshParts& parts)
{
  Stamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    stamp.emplace_back(grid, grid->vtkObject::GetMTime());
    vtkPointData* pointData = grid->GetPointData();
    stamp.emplace_back(nullptr, pointData->GetMTime());
    for (int i = 0; i < pointData->GetNumberOfArrays(); ++i)
    {
      stamp.emplace_back(
        nullptr, static_cast<vtkMTimeType>(pointData->GetAbstractArray(i)->GetNumberOfTuples()));
    }
    // There is one vector for each point: where points come or go, vectors are looked at anew.
    stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(grid->GetNumberOfPoints()));
  }
  return stamp;
}

} // namespace deformvolume
