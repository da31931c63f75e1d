// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronEdits.h"

#include "RandomDisplacements.h"
#include "WrittenTuples.h"

#include "vtkLatticeTetrahedraSource.h"

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkIdList.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <map>
#include <vector>

namespace fuzz
{

namespace
{

using Nodes = std::array<vtkIdType, 4>;

vtkIdType PickOne(vtkIdType count, Random& random)
{
  return static_cast<vtkIdType>(random.Bits() % static_cast<std::uint64_t>(count));
}

glm::dvec3 GetPosition(vtkUnstructuredGrid* mesh, vtkIdType node)
{
  glm::dvec3 position;
  mesh->GetPoint(node, &position.x);
  return position;
}

// Adds a node between some nodes, with a displacement near theirs.
vtkIdType AddNode(vtkUnstructuredGrid* mesh, const std::vector<vtkIdType>& between, Random& random)
{
  vtkDataArray* vectors = mesh->GetPointData()->GetArray(DISPLACEMENTS);
  glm::dvec3 position(0.0);
  glm::dvec3 move(random.Real(-0.3, 0.3), random.Real(-0.3, 0.3), random.Real(-0.3, 0.3));
  for (const vtkIdType node : between)
  {
    glm::dvec3 vector;
    vectors->GetTuple(node, &vector.x);
    position += GetPosition(mesh, node) / static_cast<double>(between.size());
    move += vector / static_cast<double>(between.size());
  }
  vectors->InsertNextTuple(&move.x);
  return mesh->GetPoints()->InsertNextPoint(&position.x);
}

Nodes GetTetrahedron(vtkUnstructuredGrid* mesh, vtkIdType cell)
{
  vtkNew<vtkIdList> ids;
  mesh->GetCellPoints(cell, ids);
  return { { ids->GetId(0), ids->GetId(1), ids->GetId(2), ids->GetId(3) } };
}

void ReplaceTetrahedron(vtkUnstructuredGrid* mesh, vtkIdType cell, const Nodes& nodes)
{
  mesh->GetCells()->ReplaceCellAtId(cell, 4, nodes.data());
  MarkWritten(mesh->GetCells()->GetConnectivityArray(), 4 * cell, 4 * cell + 3);
}

// Whether all cells are tetrahedra of existing nodes that have displacements.
bool AreTetrahedra(vtkUnstructuredGrid* mesh)
{
  vtkDataArray* vectors = mesh->GetPointData()->GetArray(DISPLACEMENTS);
  bool are = vectors && vectors->GetNumberOfTuples() == mesh->GetNumberOfPoints() &&
    mesh->GetNumberOfCells() > 4;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells() && are; ++cell)
  {
    vtkNew<vtkIdList> ids;
    mesh->GetCellPoints(cell, ids);
    are = mesh->GetCellType(cell) == VTK_TETRA && ids->GetNumberOfIds() == 4 &&
      std::all_of(ids->begin(), ids->end(),
        [&](vtkIdType id) { return id >= 0 && id < mesh->GetNumberOfPoints(); });
  }
  return are;
}

std::vector<Nodes> GetTetrahedra(vtkUnstructuredGrid* mesh)
{
  std::vector<Nodes> all;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    all.push_back(GetTetrahedron(mesh, cell));
  }
  return all;
}

void SetTetrahedra(vtkUnstructuredGrid* mesh, const std::vector<Nodes>& all)
{
  vtkNew<vtkCellArray> cells;
  for (const Nodes& nodes : all)
  {
    cells->InsertNextCell(4, nodes.data());
  }
  mesh->SetCells(VTK_TETRA, cells);
}

// Splits nodes near a node: the tetrahedra on one side of a plane through it get new nodes.
void SplitNodes(vtkUnstructuredGrid* mesh, Random& random)
{
  const glm::dvec3 center = GetPosition(mesh, PickOne(mesh->GetNumberOfPoints(), random));
  const double radius = random.Real(3.0, 22.0);
  const glm::dvec3 normal(random.Real(-1.0, 1.0), random.Real(-1.0, 1.0), random.Real(-1.0, 1.0));
  std::map<vtkIdType, vtkIdType> twins;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    Nodes nodes = GetTetrahedron(mesh, cell);
    glm::dvec3 middle(0.0);
    for (const vtkIdType node : nodes)
    {
      middle += 0.25 * GetPosition(mesh, node);
    }
    bool isChanged = false;
    for (vtkIdType& node : nodes)
    {
      if (glm::dot(middle - center, normal) > 0.0 &&
        glm::distance(GetPosition(mesh, node), center) <= radius)
      {
        if (!twins.count(node))
        {
          twins[node] = AddNode(mesh, { node }, random);
        }
        node = twins[node];
        isChanged = true;
      }
    }
    if (isChanged)
    {
      ReplaceTetrahedron(mesh, cell, nodes);
    }
  }
}

// Replaces coincident nodes by one of them in some tetrahedra.
void JoinNodes(vtkUnstructuredGrid* mesh, Random& random)
{
  std::map<std::array<double, 3>, vtkIdType> first;
  std::vector<vtkIdType> joined;
  for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
  {
    std::array<double, 3> position;
    mesh->GetPoint(node, position.data());
    joined.push_back(first.emplace(position, node).first->second);
  }
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    const Nodes before = GetTetrahedron(mesh, cell);
    Nodes nodes = before;
    std::transform(nodes.begin(), nodes.end(), nodes.begin(),
      [&](vtkIdType node) { return joined[static_cast<std::size_t>(node)]; });
    if (nodes != before && random.Chance(0.5))
    {
      ReplaceTetrahedron(mesh, cell, nodes);
    }
  }
}

// Replaces a tetrahedron by four. New ones are inserted at its index or appended.
void Refine(vtkUnstructuredGrid* mesh, std::vector<Nodes>& all, Random& random)
{
  const auto parent = static_cast<std::size_t>(PickOne(mesh->GetNumberOfCells(), random));
  const Nodes nodes = all[parent];
  const vtkIdType center = AddNode(mesh, { nodes.begin(), nodes.end() }, random);
  const bool isInserted = random.Chance(0.5);
  all[parent][0] = center;
  for (std::size_t k = 1; k < 4; ++k)
  {
    Nodes child = nodes;
    child[k] = center;
    all.insert(isInserted ? all.begin() + static_cast<std::ptrdiff_t>(parent) : all.end(), child);
  }
}

void Remove(std::vector<Nodes>& all, Random& random)
{
  const int count = random.Int(1, 4);
  const auto first = all.begin() + random.Int(0, static_cast<int>(all.size()) - count);
  all.erase(first, first + count);
}

} // namespace

vtkSmartPointer<vtkUnstructuredGrid> MakeFineLattice(
  vtkImageData* volume, Random& random, std::ostream& log)
{
  // The static mapping of the finest lattices has links, that of the coarser ones has runs.
  const int nodes = random.Pick({ 9, 12, 14, 25 });
  double bounds[6];
  volume->GetBounds(bounds);
  // In sizes of the volume. Some lattices are smaller than the volume.
  const double margin = random.Pick({ 0.0, 0.02, -0.1 });
  for (int axis = 0; axis < 3; ++axis)
  {
    const double added = margin * (bounds[2 * axis + 1] - bounds[2 * axis]);
    bounds[2 * axis] -= added;
    bounds[2 * axis + 1] += added;
  }
  log << "lattice of " << nodes << " nodes an axis, margin " << margin << '\n';
  vtkNew<vtkLatticeTetrahedraSource> source;
  source->SetNumberOfNodes(nodes, nodes, nodes);
  source->EqualSpacingOff();
  source->SetBounds(bounds);
  source->Update();
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->DeepCopy(source->GetOutput());
  return mesh;
}

bool EditTetrahedra(vtkUnstructuredGrid* mesh, Random& random, std::ostream& log)
{
  if (!AreTetrahedra(mesh))
  {
    return false;
  }
  const int kind = random.Int(0, 9);
  log << "tetrahedra, edit " << kind << '\n';
  if (kind < 5)
  {
    SplitNodes(mesh, random);
  }
  else if (kind < 7)
  {
    JoinNodes(mesh, random);
  }
  else if (kind == 7)
  {
    const vtkIdType cell = PickOne(mesh->GetNumberOfCells(), random);
    Nodes nodes = GetTetrahedron(mesh, cell);
    std::swap(nodes[0], nodes[1]);
    ReplaceTetrahedron(mesh, cell, nodes);
  }
  else
  {
    std::vector<Nodes> all = GetTetrahedra(mesh);
    if (kind == 8)
    {
      Refine(mesh, all, random);
    }
    else
    {
      Remove(all, random);
    }
    SetTetrahedra(mesh, all);
    if (random.Chance(0.5))
    {
      StartLog(mesh->GetCells()->GetConnectivityArray());
    }
  }
  mesh->GetCells()->Modified();
  mesh->GetPoints()->Modified();
  mesh->Modified();
  vtkDataArray* vectors = mesh->GetPointData()->GetArray(DISPLACEMENTS);
  if (!vtkArrayChanges::FindLog(vectors))
  {
    vectors->Modified();
  }
  return true;
}

} // namespace fuzz
