// SPDX-License-Identifier: BSD-3-Clause
#include "ElasticSession.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace deformvolume
{
namespace
{

bool IsSame(const ElasticMaterial& a, const ElasticMaterial& b)
{
  return a.YoungModulus == b.YoungModulus && a.PoissonRatio == b.PoissonRatio &&
    a.Density == b.Density;
}

bool HasSameMesh(const ElasticBody& a, const ElasticBody& b)
{
  return a.Points == b.Points && a.Tetrahedra == b.Tetrahedra;
}

bool IsSame(const ElasticBody& a, const ElasticBody& b)
{
  return HasSameMesh(a, b) && a.Fixed == b.Fixed &&
    std::equal(a.Materials.begin(), a.Materials.end(), b.Materials.begin(), b.Materials.end(),
      [](const auto& one, const auto& other) { return IsSame(one, other); });
}

// Appends copies of some values, if there are any.
template <typename Value>
void AppendCopies(std::vector<Value>& values, const std::vector<std::int32_t>& origins)
{
  if (!values.empty())
  {
    values.reserve(values.size() + origins.size());
    for (const std::int32_t origin : origins)
    {
      values.push_back(values[static_cast<std::size_t>(origin)]);
    }
  }
}

Stamp GetDataStamp(vtkUnstructuredGrid* grid)
{
  return { { grid->GetPoints(), grid->GetPoints()->GetMTime() },
    { grid->GetCells(), grid->GetCells()->GetMTime() },
    { grid->GetPointData(), grid->GetPointData()->GetMTime() },
    { grid->GetCellData(), grid->GetCellData()->GetMTime() } };
}

} // namespace

bool ElasticSession::Update(ElasticSimulation& simulation, vtkUnstructuredGrid* grid,
  const BodySettings& settings, const std::function<bool()>& progress)
{
  const Stamp stamp = GetBodyStamp(grid);
  this->Exists = this->Exists && &simulation == this->Simulation && simulation.HasBody();
  if (this->Exists && stamp == this->BodyStamp &&
    IsSame(settings.Material, this->Settings.Material) &&
    settings.UnitLength == this->Settings.UnitLength)
  {
    return false;
  }
  BodyMesh read = ReadBody(grid, settings);
  const bool keepsState = this->Exists && HasSameMesh(read.Body, this->Whole.Body);
  const bool isLost = this->WasLost || (this->Exists && !keepsState && this->HasMoved);
  BodyMesh mesh = keepsState ? this->WithCuts(read) : read;
  if (!keepsState || !IsSame(read.Body, this->Whole.Body))
  {
    try
    {
      simulation.SetBody(mesh.Body, keepsState, progress);
    }
    catch (...)
    {
      // All is as it was, unless the last body has gone.
      this->WasLost = this->WasLost || (this->Exists && this->HasMoved && !simulation.HasBody());
      throw;
    }
  }
  if (!keepsState)
  {
    this->Cuts.clear();
    ++this->CutsVersion;
    this->Sheet = WorldSheet();
    this->Time = 0.0;
    this->HasMoved = false;
  }
  this->Whole = std::move(read);
  this->Mesh = std::move(mesh);
  this->BodyStamp = stamp;
  this->Settings = settings;
  this->Simulation = &simulation;
  this->Exists = true;
  this->WasLost = false;
  return isLost;
}

BodyMesh ElasticSession::WithCuts(const BodyMesh& whole) const
{
  BodyMesh mesh = whole;
  if (!this->Cuts.empty())
  {
    const AppliedCut& cut = this->Cuts.back();
    mesh.Body.Tetrahedra = cut.Tetrahedra;
    AppendCopies(mesh.Body.Points, cut.Origins);
    AppendCopies(mesh.Body.Fixed, cut.Origins);
    AppendCopies(mesh.Forces, cut.Origins);
    AppendCopies(mesh.IsUsed, cut.Origins);
  }
  return mesh;
}

void ElasticSession::Cut(const WorldSheet& sheet)
{
  if (sheet == this->Sheet)
  {
    return;
  }
  if (!sheet.IsEmpty())
  {
    std::vector<glm::dvec3> positions = this->Mesh.Body.Points;
    ElasticSimulation::State before = this->Simulation->GetState();
    std::transform(positions.begin(), positions.end(), before.Displacements.begin(),
      positions.begin(),
      [](const glm::dvec3& point, const glm::dvec3& displacement) { return point + displacement; });
    std::vector<glm::dvec3> points = sheet.Points;
    for (glm::dvec3& point : points)
    {
      point *= this->Settings.UnitLength;
    }
    MeshSplit split = SplitMesh(positions, this->Mesh.Body.Tetrahedra, points, sheet.Triangles,
      this->Cuts.empty() ? std::vector<TetrahedronPair>() : this->Cuts.back().Unparted);
    if (split.NumberOfFaces > 0)
    {
      AppliedCut cut;
      const std::vector<std::int32_t> appended = split.Origins;
      cut.Origins = this->Cuts.empty() ? std::vector<std::int32_t>() : this->Cuts.back().Origins;
      cut.Origins.insert(cut.Origins.end(), appended.begin(), appended.end());
      cut.Tetrahedra = std::move(split.Tetrahedra);
      cut.Unparted = std::move(split.Unparted);
      cut.NumberOfFaces = split.NumberOfFaces;
      cut.Before = std::move(before);
      this->Cuts.push_back(std::move(cut));
      ++this->CutsVersion;
      try
      {
        BodyMesh mesh = this->WithCuts(this->Whole);
        this->Simulation->SplitNodes(mesh.Body, appended);
        this->Mesh = std::move(mesh);
      }
      catch (...)
      {
        this->Lose();
        throw;
      }
    }
  }
  this->Sheet = sheet;
}

void ElasticSession::TakeBackNewCuts(std::size_t left)
{
  if (left < this->Cuts.size())
  {
    this->RemoveCuts(left);
    this->Sheet = WorldSheet();
  }
}

void ElasticSession::Lose()
{
  this->WasLost = this->WasLost || this->HasMoved;
  this->Exists = false;
}

void ElasticSession::RemoveCuts(std::size_t left)
{
  if (this->Exists && left < this->Cuts.size())
  {
    const ElasticSimulation::State before = std::move(this->Cuts[left].Before);
    this->Cuts.resize(left);
    ++this->CutsVersion;
    this->Mesh = this->WithCuts(this->Whole);
    this->Simulation->Return(this->Mesh.Body, before);
  }
}

std::int64_t ElasticSession::GetNumberOfSplitFaces() const
{
  return std::accumulate(this->Cuts.begin(), this->Cuts.end(), std::int64_t{ 0 },
    [](std::int64_t sum, const AppliedCut& cut) { return sum + cut.NumberOfFaces; });
}

void ElasticSession::Reset()
{
  if (this->Exists)
  {
    this->Simulation->Reset();
  }
  this->Time = 0.0;
  this->HasMoved = false;
}

vtkUnstructuredGrid* ElasticSession::GetGrid(vtkUnstructuredGrid* grid)
{
  if (this->Cuts.empty())
  {
    this->CutGrid = nullptr;
    return grid;
  }
  const Stamp stamp = GetDataStamp(grid);
  if (this->CutGrid && stamp == this->CutGridStamp && this->CutsOfGrid == this->CutsVersion)
  {
    return this->CutGrid;
  }
  // Appended nodes are copies of others in all that the grid tells of them.
  const std::vector<std::int32_t>& origins = this->Cuts.back().Origins;
  const vtkIdType before = grid->GetNumberOfPoints();
  const auto after = before + static_cast<vtkIdType>(origins.size());
  const auto getOrigin = [&](vtkIdType node)
  {
    while (node >= before) // a copy, perhaps of one that an earlier cut has made
    {
      node = origins[static_cast<std::size_t>(node - before)];
    }
    return node;
  };
  auto made = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(grid->GetPoints()->GetDataType());
  points->SetNumberOfPoints(after);
  made->GetPointData()->CopyAllOn();
  made->GetPointData()->CopyAllocate(grid->GetPointData(), after);
  for (vtkIdType node = 0; node < after; ++node)
  {
    points->SetPoint(node, grid->GetPoint(getOrigin(node)));
    made->GetPointData()->CopyData(grid->GetPointData(), getOrigin(node), node);
  }
  made->SetPoints(points);
  made->Allocate(grid->GetNumberOfCells());
  std::size_t tetrahedron = 0;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    grid->GetCells()->GetCellAtId(cell, size, ids);
    if (grid->GetCellType(cell) == VTK_TETRA)
    {
      const Tetrahedron& nodes = this->Mesh.Body.Tetrahedra[tetrahedron++];
      const vtkIdType cut[4] = { nodes[0], nodes[1], nodes[2], nodes[3] };
      made->InsertNextCell(VTK_TETRA, 4, cut);
    }
    else
    {
      made->InsertNextCell(grid->GetCellType(cell), size, ids);
    }
  }
  made->GetCellData()->ShallowCopy(grid->GetCellData());
  made->GetFieldData()->ShallowCopy(grid->GetFieldData());
  this->CutGrid = made;
  this->CutGridStamp = stamp;
  this->CutsOfGrid = this->CutsVersion;
  return made;
}

} // namespace deformvolume
