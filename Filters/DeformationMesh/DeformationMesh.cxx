// SPDX-License-Identifier: BSD-3-Clause
#include "DeformationMesh.h"

#include "Error.h"
#include "VectorArray.h"

#include "vtkCellData.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

namespace deformvolume
{

namespace
{

// The part that a node of a mesh belongs to, and the index of the node in this part.
std::pair<std::size_t, vtkIdType> FindNode(const MeshParts& parts, vtkIdType node)
{
  std::size_t part = 0;
  while (part + 1 < parts.size() && node >= parts[part]->GetNumberOfPoints())
  {
    node -= parts[part]->GetNumberOfPoints();
    ++part;
  }
  return { part, node };
}

[[noreturn]] void ThrowNotFinite(
  const MeshParts& parts, vtkIdType node, const std::string& kind, const std::string& name)
{
  const auto [part, number] = FindNode(parts, node);
  throw Error(kind + " " + std::to_string(number) + " of " + DescribePart(parts, part, name) +
    " is not finite, and cells use it. Remove NaN and infinity from it, or mark its point as "
    "hidden in " +
    vtkDataSetAttributes::GhostArrayName() + ", so that these cells are left out.");
}

// Lists the arrays with a number of components, or all of them; "" if there are none.
std::string ListArrays(vtkDataSetAttributes* data, const char* title, int components = 0)
{
  std::string names;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    const char* name = data->GetArrayName(i);
    if (components == 0 || data->GetAbstractArray(i)->GetNumberOfComponents() == components)
    {
      names += (names.empty() ? title : ", ") + ('"' + std::string(name ? name : "") + '"');
    }
  }
  return names.empty() ? names : names + ". ";
}

std::string ListArrays(vtkDataSet* dataSet)
{
  const std::string points = ListArrays(dataSet->GetPointData(), "Its point arrays: ");
  const std::string cells = ListArrays(dataSet->GetCellData(), "Cell arrays are not used: ", 3);
  return (points.empty() ? "It has no point arrays. " : points) + cells +
    (cells.empty()
        ? ""
        : "To use one, convert it with vtkCellDataToPointData, in ParaView with Cell Data "
          "to Point Data. ");
}

void MarkMissing(vtkIdType first, vtkIdType count, const VectorTaker& take, NodeFaults& faults)
{
  const std::array<glm::dvec3, 512> zeros{};
  for (vtkIdType done = 0; done < count;)
  {
    const vtkIdType some = std::min<vtkIdType>(zeros.size(), count - done);
    take(first + done, zeros.data(), some);
    done += some;
  }
  for (vtkIdType node = first; node < first + count; ++node)
  {
    faults.Mark(node, NodeFaults::Missing);
  }
}

} // namespace

std::string DescribeIgnored(const MeshParts& parts)
{
  return parts.Ignored.empty() ? ""
                               : "These blocks of the deformation are image data, and not part of "
                                 "the mesh: " +
      parts.Ignored + ". Convert them to unstructured grids (vtkAppendFilter).";
}

std::string DescribePart(const MeshParts& parts, std::size_t part, const std::string& name)
{
  return (parts.Blocks.empty() ? "" : parts.Blocks[part] + " of ") + "the " + name;
}

void CheckParts(const MeshParts& parts, vtkDataObject* object, const std::string& name)
{
  const std::string connect =
    ". Connect a vtkUnstructuredGrid with tetrahedra, a vtkStructuredGrid, "
    "a vtkExplicitStructuredGrid or a vtkRectilinearGrid" +
    std::string(name == MESH_NAME ? ", or vtkImageData as a displacement field." : ".");
  if (parts.empty() && !parts.Ignored.empty())
  {
    throw Error("The composite dataset that is the " + name +
      " holds no mesh, but image data: " + parts.Ignored +
      ". Extract one image from the composite dataset and connect it, or merge the blocks to a "
      "vtkUnstructuredGrid (vtkAppendFilter, in ParaView Merge Blocks).");
  }
  if (parts.empty() && vtkCompositeDataSet::SafeDownCast(object))
  {
    throw Error("The composite dataset that is the " + name +
      " holds no vtkUnstructuredGrid, vtkStructuredGrid, vtkExplicitStructuredGrid or "
      "vtkRectilinearGrid. Connect one with three-dimensional cells.");
  }
  if (parts.empty())
  {
    throw Error(
      (object ? "The " + name + " is a " + object->GetClassName() : "There is no " + name) +
      connect);
  }
  if (GetNumberOfNodes(parts) == 0)
  {
    throw Error("The " + name + " has no points" + connect);
  }
  if (GetNumberOfNodes(parts) > std::numeric_limits<std::int32_t>::max())
  {
    throw Error("The " + name + " has more than 2,147,483,647 points. Use a coarser mesh.");
  }
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

std::vector<glm::dvec3> ReadPoints(
  const MeshParts& parts, const std::string& name, const std::vector<Tetrahedron>& tetrahedra)
{
  std::vector<glm::dvec3> points(GetNumberOfNodes(parts));
  NodeFaults faults;
  faults.Resize(points.size());
  glm::dvec3* next = points.data();
  for (vtkUnstructuredGrid* grid : parts)
  {
    if (grid->GetNumberOfPoints() > 0)
    {
      ReadVectors(
        grid->GetPoints()->GetData(),
        [next](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
        { std::copy_n(vectors, count, next + first); },
        "Point", name, nullptr,
        [&](vtkIdType point) { faults.Mark(next - points.data() + point, NodeFaults::NotFinite); });
      next += grid->GetNumberOfPoints();
    }
  }
  CheckPoints(parts, name, faults, tetrahedra);
  return points;
}

void CheckPoints(const MeshParts& parts, const std::string& name, const NodeFaults& faults,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const vtkIdType node = faults.FindUsed(tetrahedra);
  if (node >= 0)
  {
    ThrowNotFinite(parts, node, "Point", name);
  }
}

vtkDataArray* FindVectors(vtkDataSet* dataSet, const ArraySelector& selector,
  const std::string& wanted, const std::string& name)
{
  vtkDataArray* array = selector(dataSet);
  if (!array)
  {
    const char* const alternative = vtkUnstructuredGrid::SafeDownCast(dataSet)
      ? ", or connect the mesh at rest if this mesh is deformed already."
      : ".";
    std::string what = name;
    what.front() = static_cast<char>(std::toupper(what.front()));
    throw Error(what + " has no " + wanted + ". " + ListArrays(dataSet) +
      "Choose the displacements with SetInputArrayToProcess()" + alternative);
  }
  if (array->GetNumberOfComponents() != 3)
  {
    throw Error("The displacements of " + name + ", " + wanted + ", have " +
      std::to_string(array->GetNumberOfComponents()) +
      " components. Choose an array with three components.");
  }
  if (array->GetNumberOfTuples() != dataSet->GetNumberOfPoints())
  {
    throw Error("The displacements of " + name + ", " + wanted + ", have " +
      std::to_string(array->GetNumberOfTuples()) + " tuples for " +
      std::to_string(dataSet->GetNumberOfPoints()) +
      " points. Choose an array with one tuple for each point.");
  }
  return array;
}

bool HaveVectors(vtkDataSet* dataSet, vtkDataArray* vectors)
{
  return vectors && vectors->GetNumberOfComponents() == 3 &&
    vectors->GetNumberOfTuples() == dataSet->GetNumberOfPoints();
}

void ReadPointVectors(const MeshParts& parts, const ArraySelector& selector, NodeFaults& faults,
  const VectorTaker& take, std::vector<VectorMemory>* memories)
{
  std::vector<VectorMemory> none;
  std::vector<VectorMemory>& last = memories ? *memories : none;
  last.resize(parts.size());
  vtkIdType next = 0;
  for (std::size_t part = 0; part < parts.size(); ++part)
  {
    vtkUnstructuredGrid* grid = parts[part];
    const vtkIdType points = grid->GetNumberOfPoints();
    vtkDataArray* array = points > 0 ? selector(grid) : nullptr;
    const bool isUsable = HaveVectors(grid, array);
    if (!isUsable || last[part].FirstNumber != next)
    {
      last[part] = VectorMemory();
      last[part].FirstNumber = next;
    }
    if (!isUsable)
    {
      MarkMissing(next, points, take, faults);
    }
    else
    {
      ReadVectors(
        array,
        [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
        { take(next + first, vectors, count); },
        "Displacement", "", memories ? &last[part] : nullptr,
        [&](vtkIdType point) { faults.Mark(next + point, NodeFaults::NotFinite); });
    }
    next += points;
  }
}

void CheckPointVectors(const MeshParts& parts, const ArraySelector& selector,
  const std::string& wanted, const std::string& name, const NodeFaults& faults,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const vtkIdType node = faults.FindUsed(tetrahedra);
  if (node < 0)
  {
    return;
  }
  if (faults.Get(node) == NodeFaults::Missing)
  {
    const std::size_t part = FindNode(parts, node).first;
    FindVectors(parts[part], selector, wanted, DescribePart(parts, part, name));
  }
  if (faults.Get(node) == NodeFaults::NotFinite)
  {
    ThrowNotFinite(parts, node, "Displacement", name);
  }
}

Stamp GetPointsStamp(const MeshParts& parts)
{
  Stamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    stamp.emplace_back(grid, grid->vtkObject::GetMTime());
    AddPoints(stamp, grid->GetPoints());
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
      AddArray(stamp, pointData->GetAbstractArray(i));
    }
    // There is one vector for each point, so that vectors have to be read again if the number of
    // points changes.
    stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(grid->GetNumberOfPoints()));
  }
  return stamp;
}

} // namespace deformvolume
