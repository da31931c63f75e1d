// SPDX-License-Identifier: BSD-3-Clause
#include "BodyReading.h"

#include "CellTypes.h"
#include "Error.h"
#include "HandlePlaces.h"
#include "IndexBounds.h"
#include "ShapedArray.h"
#include "VectorArray.h"

#include "vtkCell.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkGenericCell.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr const char* FIXED = "Fixed";
constexpr const char* FORCE = "Force";
constexpr const char* MESH = "rest mesh on input port 0";

vtkDataArray* FindMeshArray(
  vtkDataSetAttributes* attributes, const char* name, int components, vtkIdType tuples)
{
  return FindShapedArray(attributes, name, components, tuples, "array", std::string("the ") + MESH);
}

std::vector<glm::dvec3> ReadAll(vtkDataArray* array, double factor, const char* kind)
{
  std::vector<glm::dvec3> vectors(static_cast<std::size_t>(array->GetNumberOfTuples()));
  ReadVectors(
    array,
    [&](vtkIdType first, const glm::dvec3* read, vtkIdType number)
    {
      std::transform(read, read + number, vectors.begin() + first,
        [&](const glm::dvec3& vector) { return vector * factor; });
    },
    kind, MESH);
  return vectors;
}

int GetCellDimension(int type)
{
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  return cell ? cell->GetCellDimension() : 3;
}

void ReadMaterials(vtkUnstructuredGrid* grid, const BodySettings& settings, BodyMesh& mesh)
{
  const auto find = [&](const char* name)
  { return FindMeshArray(grid->GetCellData(), name, 1, grid->GetNumberOfCells()); };
  vtkDataArray* youngModulus = find(YoungModulusName);
  vtkDataArray* poissonRatio = find(PoissonRatioName);
  vtkDataArray* density = find(DensityName);
  mesh.Body.Materials = { settings.Material };
  if (!youngModulus && !poissonRatio && !density)
  {
    return;
  }
  mesh.Body.Materials.assign(mesh.Cells.size(), settings.Material);
  for (std::size_t t = 0; t < mesh.Cells.size(); ++t)
  {
    ElasticMaterial& material = mesh.Body.Materials[t];
    const auto read = [&](vtkDataArray* array, double& value)
    {
      if (array)
      {
        value = array->GetComponent(mesh.Cells[t], 0);
      }
    };
    read(youngModulus, material.YoungModulus);
    read(poissonRatio, material.PoissonRatio);
    read(density, material.Density);
  }
}

// Which nodes tetrahedra use, and the diagonal of the box of these.
void FindUsed(BodyMesh& mesh)
{
  mesh.IsUsed.assign(mesh.Body.Points.size(), 0);
  IndexBounds box;
  for (const Tetrahedron& tetrahedron : mesh.Body.Tetrahedra)
  {
    for (const std::int32_t node : tetrahedron)
    {
      mesh.IsUsed[static_cast<std::size_t>(node)] = 1;
      box.Add(mesh.Body.Points[static_cast<std::size_t>(node)]);
    }
  }
  mesh.Size = glm::distance(box.Min, box.Max);
}

// Adds the nodes that a place holds. isTaken: by another handle.
void Hold(const glm::dvec3& place, double radius, const glm::dvec3& displacement,
  const BodyMesh& mesh, std::vector<unsigned char>& isTaken, std::vector<HeldNode>& held)
{
  const ElasticBody& body = mesh.Body;
  const std::size_t before = held.size();
  const auto add = [&](std::size_t node)
  {
    if (isTaken[node] == 0 && !body.IsFixed(node))
    {
      isTaken[node] = 1;
      held.push_back({ static_cast<std::int32_t>(node), displacement });
    }
  };
  double least = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    const double distance = glm::distance(body.Points[node], place);
    if (distance < least && mesh.IsUsed[node] != 0)
    {
      least = distance;
      nearest = node;
    }
    if (radius > 0.0 && distance <= radius && mesh.IsUsed[node] != 0)
    {
      add(node);
    }
  }
  if (radius == 0.0)
  {
    add(nearest);
  }
  if (held.size() == before)
  {
    throw Error(radius > 0.0
        ? "A handle holds no node that could move: within its radius of its rest position there "
          "is "
          "none, or all of them are fixed or held by another handle. Use a larger radius, or "
          "another rest position."
        : "A handle holds no node that could move: the one that is nearest to its rest position "
          "is fixed, or held by another handle. Use another rest position, or a radius.");
  }
}

} // namespace

Stamp GetBodyStamp(vtkUnstructuredGrid* grid)
{
  Stamp stamp;
  const auto add = [&](vtkObject* object)
  { stamp.emplace_back(object, object ? object->GetMTime() : 0); };
  add(grid->GetPoints());
  add(grid->GetCells());
  add(GetCellTypes(grid));
  for (const char* name : { YoungModulusName, PoissonRatioName, DensityName })
  {
    add(grid->GetCellData()->GetAbstractArray(name));
  }
  for (const char* name : { FIXED, FORCE })
  {
    add(grid->GetPointData()->GetAbstractArray(name));
  }
  return stamp;
}

GridTetrahedra ReadTetrahedra(vtkUnstructuredGrid* grid)
{
  GridTetrahedra read;
  vtkDataArray* types = GetCellTypes(grid);
  const vtkIdType count = grid->GetNumberOfCells();
  if (count > 0 && (!types || types->GetNumberOfTuples() < count || !grid->GetCells()->IsValid()))
  {
    throw Error(std::string("The cells of the ") + MESH + " are incomplete.");
  }
  std::map<int, vtkIdType> others;
  for (vtkIdType cell = 0; cell < count; ++cell)
  {
    const int type = grid->GetCellType(cell);
    if (type != VTK_TETRA)
    {
      ++others[type];
      continue;
    }
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    grid->GetCells()->GetCellAtId(cell, size, points);
    Tetrahedron tetrahedron{};
    for (std::size_t i = 0; i < 4; ++i)
    {
      if (size != 4 || points[i] < 0 || points[i] >= grid->GetNumberOfPoints())
      {
        throw Error("Cell " + std::to_string(cell) + " of the " + MESH +
          " is a tetrahedron without four points of the mesh.");
      }
      tetrahedron[i] = static_cast<std::int32_t>(points[i]);
    }
    read.Tetrahedra.push_back(tetrahedron);
    read.Cells.push_back(cell);
  }
  for (const auto& [type, number] : others)
  {
    if (GetCellDimension(type) == 3)
    {
      throw Error("The " + std::string(MESH) + " has " + std::to_string(number) +
        " cells of the type " + GetCellName(type) +
        ". Split them into tetrahedra first, for example with vtkDataSetTriangleFilter.");
    }
  }
  return read;
}

BodyMesh ReadBody(vtkUnstructuredGrid* grid, const BodySettings& settings)
{
  BodyMesh mesh;
  const vtkIdType points = grid->GetNumberOfPoints();
  if (points > std::numeric_limits<std::int32_t>::max())
  {
    throw Error(std::string("The ") + MESH + " has more than 2,147,483,647 points.");
  }
  if (points > 0)
  {
    mesh.Body.Points = ReadAll(grid->GetPoints()->GetData(), settings.UnitLength, "Point");
  }
  GridTetrahedra read = ReadTetrahedra(grid);
  mesh.Body.Tetrahedra = std::move(read.Tetrahedra);
  mesh.Cells = std::move(read.Cells);
  ReadMaterials(grid, settings, mesh);
  if (vtkDataArray* fixed = FindMeshArray(grid->GetPointData(), FIXED, 1, points))
  {
    mesh.Body.Fixed.resize(mesh.Body.Points.size());
    for (vtkIdType i = 0; i < points; ++i)
    {
      mesh.Body.Fixed[static_cast<std::size_t>(i)] = fixed->GetComponent(i, 0) != 0.0 ? 1 : 0;
    }
  }
  if (vtkDataArray* force = FindMeshArray(grid->GetPointData(), FORCE, 3, points))
  {
    mesh.Forces = ReadAll(force, 1.0, FORCE);
  }
  CheckBody(mesh.Body);
  FindUsed(mesh);
  return mesh;
}

std::vector<HeldNode> ReadHandles(
  vtkPointSet* handles, double radius, const BodyMesh& mesh, const BodySettings& settings)
{
  std::vector<HeldNode> held;
  const HandlePlaces places = ReadHandlePlaces(handles, "mesh");
  std::vector<unsigned char> isTaken(mesh.Body.Points.size(), 0);
  for (std::size_t i = 0; i < places.Rest.size(); ++i)
  {
    const glm::dvec3 rest = places.Rest[i] * settings.UnitLength;
    const glm::dvec3 now = places.Now[i] * settings.UnitLength;
    Hold(rest, radius * settings.UnitLength, now - rest, mesh, isTaken, held);
  }
  return held;
}

} // namespace deformvolume
