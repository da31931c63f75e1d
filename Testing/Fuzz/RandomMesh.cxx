// SPDX-License-Identifier: BSD-3-Clause
#include "RandomMesh.h"

#include "MeshDrafts.h"
#include "TetrahedronEdits.h"

#include "vtkLatticeTetrahedraSource.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <glm/vec3.hpp>

#include <array>

namespace fuzz
{

namespace
{

// Inserts a cube as a polyhedron.
void InsertPolyhedron(vtkUnstructuredGrid* mesh, const std::vector<vtkIdType>& c)
{
  std::vector<vtkIdType> faces;
  for (const auto& face : { std::array<int, 4>{ { 0, 3, 2, 1 } }, { { 4, 5, 6, 7 } },
         { { 0, 1, 5, 4 } }, { { 1, 2, 6, 5 } }, { { 2, 3, 7, 6 } }, { { 3, 0, 4, 7 } } })
  {
    faces.push_back(4);
    for (const int corner : face)
    {
      faces.push_back(c[static_cast<std::size_t>(corner)]);
    }
  }
  mesh->InsertNextCell(VTK_POLYHEDRON, 8, c.data(), 6, faces.data());
}

vtkSmartPointer<vtkUnstructuredGrid> Finish(
  const Draft& draft, vtkImageData* volume, Random& random)
{
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(random.Pick({ VTK_FLOAT, VTK_DOUBLE }));
  for (const glm::dvec3& node : draft.Nodes)
  {
    double position[3];
    volume->TransformContinuousIndexToPhysicalPoint(node.x, node.y, node.z, position);
    points->InsertNextPoint(position);
  }
  mesh->SetPoints(points);
  mesh->Allocate(static_cast<vtkIdType>(draft.Cells.size()) + 1);
  for (const Cell& cell : draft.Cells)
  {
    if (cell.Type == VTK_POLYHEDRON && cell.Points.size() == 8)
    {
      InsertPolyhedron(mesh, cell.Points);
    }
    else
    {
      mesh->InsertNextCell(
        cell.Type, static_cast<vtkIdType>(cell.Points.size()), cell.Points.data());
    }
  }
  return mesh;
}

void HideCells(vtkUnstructuredGrid* mesh, Random& random)
{
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    ghosts->InsertNextValue(static_cast<unsigned char>(random.Pick({ 0, 0, 0,
      int(vtkDataSetAttributes::DUPLICATECELL), int(vtkDataSetAttributes::HIDDENCELL) })));
  }
  mesh->GetCellData()->AddArray(ghosts);
}

} // namespace

vtkSmartPointer<vtkUnstructuredGrid> MakeMesh(
  vtkImageData* volume, Random& random, std::ostream& log)
{
  int extent[6];
  volume->GetExtent(extent);
  std::array<double, 6> box;
  // The mesh covers the whole volume and a margin, or a part of the volume.
  const bool all = random.Chance(0.6);
  for (int axis = 0; axis < 3; ++axis)
  {
    const double size = extent[2 * axis + 1] - extent[2 * axis];
    const double margin =
      all ? random.Pick({ 0.0, 0.5, 2.0 }) : -0.3 * size * random.Real(0.0, 1.0);
    box[2 * axis] = extent[2 * axis] - margin;
    box[2 * axis + 1] = extent[2 * axis + 1] + margin;
  }
  log << "mesh: ";
  Draft draft =
    random.Chance(0.75) ? MakeLattice(box, random, log) : MakeTetrahedra(box, random, log);
  if (random.Chance(0.2))
  {
    AddOddities(draft, random, log);
  }
  if (random.Chance(0.03))
  {
    AddErrors(draft, random, log);
  }
  if (random.Chance(0.3))
  {
    Shuffle(draft, random);
  }
  auto mesh = Finish(draft, volume, random);
  if (random.Chance(0.08))
  {
    HideCells(mesh, random);
  }
  log << '\n';
  return mesh;
}

vtkSmartPointer<vtkUnstructuredGrid> MakeVoxelMesh(vtkImageData* volume)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  source->SetInputData(volume);
  source->SetNumberOfNodes(volume->GetDimensions());
  source->EqualSpacingOff();
  source->Update();
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->ShallowCopy(source->GetOutput());
  return mesh;
}

vtkSmartPointer<vtkMultiBlockDataSet> MakeBlocks(vtkUnstructuredGrid* mesh, Random& random)
{
  auto blocks = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  const int count = random.Int(1, 3);
  for (int block = 0; block < count; ++block)
  {
    vtkNew<vtkUnstructuredGrid> part;
    vtkNew<vtkPoints> points;
    points->DeepCopy(mesh->GetPoints());
    part->SetPoints(points);
    part->GetPointData()->DeepCopy(mesh->GetPointData());
    part->Allocate(1);
    vtkNew<vtkIdList> ids;
    for (vtkIdType cell = block; cell < mesh->GetNumberOfCells(); cell += count)
    {
      if (mesh->GetCellType(cell) != VTK_POLYHEDRON)
      {
        mesh->GetCellPoints(cell, ids);
        part->InsertNextCell(mesh->GetCellType(cell), ids);
      }
    }
    blocks->SetBlock(static_cast<unsigned int>(2 * block), part);
  }
  if (random.Chance(0.3))
  {
    vtkNew<vtkPolyData> surface;
    blocks->SetBlock(1, surface);
  }
  if (random.Chance(0.3))
  {
    vtkNew<vtkUnstructuredGrid> nothing;
    blocks->SetBlock(static_cast<unsigned int>(2 * count), nothing);
  }
  return blocks;
}

void EditCells(vtkUnstructuredGrid* mesh, Random& random, std::ostream& log)
{
  const vtkIdType points = mesh->GetNumberOfPoints();
  // Only small meshes get edits that are an error or that change the whole mesh.
  const int kind = random.Int(points < 600 ? 0 : 3, 10);
  log << "cells, edit " << kind << '\n';
  if (points < 4)
  {
    return;
  }
  switch (kind)
  {
    case 0: // more points than displacements
      mesh->GetPoints()->InsertNextPoint(random.Real(-9.0, 9.0), 0.0, 0.0);
      mesh->GetPoints()->Modified();
      break;
    case 1:
    {
      vtkIdType ids[4];
      for (vtkIdType& id : ids)
      {
        id = static_cast<vtkIdType>(random.Bits() % static_cast<std::uint64_t>(points));
      }
      mesh->InsertNextCell(VTK_TETRA, 4, ids);
      break;
    }
    case 2:
      HideCells(mesh, random);
      break;
    case 3: // the same cells in other arrays
    {
      vtkNew<vtkUnstructuredGrid> copy;
      copy->DeepCopy(mesh);
      mesh->DeepCopy(copy);
      break;
    }
    default:
      if (EditTetrahedra(mesh, random, log))
      {
        break;
      }
      [[fallthrough]];
    case 4:
      if (vtkPoints* positions = mesh->GetPoints())
      {
        const auto node =
          static_cast<vtkIdType>(random.Bits() % static_cast<std::uint64_t>(points));
        double point[3];
        positions->GetPoint(node, point);
        point[random.Int(0, 2)] += random.Real(-1.0, 1.0);
        positions->SetPoint(node, point);
        positions->Modified();
      }
  }
  mesh->Modified();
}

} // namespace fuzz
