// SPDX-License-Identifier: BSD-3-Clause
#include "ElasticSession.h"

#include "MeshStamp.h"
#include "MidSideNodes.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <initializer_list>
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
  return a.Points == b.Points && a.Tetrahedra == b.Tetrahedra && a.MidSides == b.MidSides;
}

bool IsSame(const ElasticBody& a, const ElasticBody& b)
{
  return HasSameMesh(a, b) && a.Fixed == b.Fixed && a.SlidingNormals == b.SlidingNormals &&
    a.SecondSlidingNormals == b.SecondSlidingNormals &&
    std::equal(a.Materials.begin(), a.Materials.end(), b.Materials.begin(), b.Materials.end(),
      [](const auto& one, const auto& other) { return IsSame(one, other); });
}

// Appends a copy of the value of each origin. Does nothing if there are no values.
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

// Divides the force of each split node equally among the node and its copies. whole: the number of
// nodes before all cuts. origins: the nodes that the copies after them were made from.
void ShareForces(
  std::vector<glm::dvec3>& forces, std::size_t whole, const std::vector<std::int32_t>& origins)
{
  std::vector<std::size_t> roots(forces.size());
  std::vector<int> shares(whole, 0);
  for (std::size_t node = 0; node < forces.size(); ++node)
  {
    roots[node] = node < whole ? node : roots[static_cast<std::size_t>(origins[node - whole])];
    ++shares[roots[node]];
  }
  for (std::size_t node = 0; node < forces.size(); ++node)
  {
    forces[node] /= shares[roots[node]];
  }
}

Stamp GetMeshStamp(vtkUnstructuredGrid* grid)
{
  Stamp stamp = GetCellArraysStamp({ grid });
  AddPoints(stamp, grid->GetPoints());
  return stamp;
}

Stamp GetDataStamp(vtkUnstructuredGrid* grid)
{
  Stamp stamp;
  for (vtkFieldData* data : std::initializer_list<vtkFieldData*>{
         grid->GetPointData(), grid->GetCellData(), grid->GetFieldData() })
  {
    stamp.emplace_back(data, data->GetMTime());
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      AddArray(stamp, data->GetAbstractArray(i));
    }
  }
  return stamp;
}

// Interpolates the point data of a node in the middle of an edge. The node is a ghost or hidden if
// both ends are.
void InterpolateInMiddle(
  vtkPointData* from, const std::array<std::int32_t, 2>& ends, vtkPointData* to, vtkIdType node)
{
  constexpr double middle = 0.5;
  to->InterpolateEdge(from, node, ends[0], ends[1], middle);
  const char* ghosts = vtkDataSetAttributes::GhostArrayName();
  auto* array = vtkArrayDownCast<vtkUnsignedCharArray>(from->GetAbstractArray(ghosts));
  auto* made = vtkArrayDownCast<vtkUnsignedCharArray>(to->GetAbstractArray(ghosts));
  if (array && made)
  {
    made->SetValue(
      node, static_cast<unsigned char>(array->GetValue(ends[0]) & array->GetValue(ends[1])));
  }
}

} // namespace

bool ElasticSession::Update(ElasticSimulation& simulation, vtkUnstructuredGrid* grid,
  const Stamp::value_type& written, const BodySettings& settings,
  const std::function<bool()>& progress)
{
  Stamp stamp = GetBodyStamp(grid);
  stamp.push_back(written);
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
      // Nothing has changed, unless the simulation has lost the last body.
      this->WasLost = this->WasLost || (this->Exists && this->HasMoved && !simulation.HasBody());
      throw;
    }
  }
  if (!keepsState)
  {
    this->Cuts.clear();
    ++this->MeshVersion;
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
    mesh.Body.MidSides = cut.MidSides;
    AppendCopies(mesh.Body.Points, cut.Origins);
    AppendCopies(mesh.Body.Fixed, cut.Origins);
    AppendCopies(mesh.Body.SlidingNormals, cut.Origins);
    AppendCopies(mesh.Body.SecondSlidingNormals, cut.Origins);
    AppendCopies(mesh.Forces, cut.Origins);
    ShareForces(mesh.Forces, whole.Body.Points.size(), cut.Origins);
    AppendCopies(mesh.PrescribedDisplacements, cut.Origins);
    AppendCopies(mesh.IsUsed, cut.Origins);
  }
  return mesh;
}

void ElasticSession::Cut(const WorldSheet& sheet, bool isAtRest)
{
  if (sheet == this->Sheet)
  {
    return;
  }
  if (!sheet.IsEmpty())
  {
    std::vector<glm::dvec3> positions = this->Mesh.Body.Points;
    ElasticSimulation::State before = this->Simulation->GetState();
    if (!isAtRest)
    {
      for (std::size_t node = 0; node < positions.size(); ++node)
      {
        positions[node] += before.Displacements[node];
      }
    }
    std::vector<glm::dvec3> points = sheet.Points;
    for (glm::dvec3& point : points)
    {
      point *= this->Settings.UnitLength;
    }
    MeshSplit split = SplitMesh(positions, this->Mesh.Body.Tetrahedra, points, sheet.Triangles,
      this->Cuts.empty() ? std::vector<TetrahedronPair>() : this->Cuts.back().StillConnected);
    if (split.NumberOfFaces > 0)
    {
      AppliedCut cut;
      std::vector<std::int32_t> appended = split.Origins;
      cut.MidSides = this->Mesh.Body.MidSides;
      if (!cut.MidSides.empty())
      {
        const std::vector<std::int32_t> copies = SplitMidSideNodes(split.Tetrahedra,
          static_cast<std::int32_t>(positions.size() + appended.size()), cut.MidSides);
        appended.insert(appended.end(), copies.begin(), copies.end());
      }
      cut.Origins = this->Cuts.empty() ? std::vector<std::int32_t>() : this->Cuts.back().Origins;
      cut.Origins.insert(cut.Origins.end(), appended.begin(), appended.end());
      cut.Tetrahedra = std::move(split.Tetrahedra);
      cut.StillConnected = std::move(split.StillConnected);
      cut.NumberOfFaces = split.NumberOfFaces;
      cut.Before = std::move(before);
      this->Cuts.push_back(std::move(cut));
      ++this->MeshVersion;
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

void ElasticSession::RevertNewCuts(std::size_t left)
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
    ++this->MeshVersion;
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
  // After a reset the body is at rest, also if cuts are removed.
  for (AppliedCut& cut : this->Cuts)
  {
    for (std::vector<glm::dvec3>* vectors : { &cut.Before.Displacements, &cut.Before.Velocities })
    {
      std::fill(vectors->begin(), vectors->end(), glm::dvec3(0.0));
    }
  }
  this->Time = 0.0;
  this->HasMoved = false;
}

std::size_t ElasticSession::GetOrigin(std::size_t node) const
{
  const std::size_t whole = this->Whole.Body.Points.size();
  while (node >= whole) // a copy, possibly of a copy that an earlier cut has made
  {
    node = static_cast<std::size_t>(this->Cuts.back().Origins[node - whole]);
  }
  return node;
}

void ElasticSession::FillMesh(vtkUnstructuredGrid* grid, vtkUnstructuredGrid* made) const
{
  const auto before = static_cast<std::size_t>(grid->GetNumberOfPoints());
  const std::size_t after = this->Mesh.Body.Points.size();
  vtkNew<vtkPoints> points;
  points->SetDataType(grid->GetPoints()->GetDataType());
  points->SetNumberOfPoints(static_cast<vtkIdType>(after));
  const auto getPoint = [&](std::size_t point)
  {
    glm::dvec3 position;
    grid->GetPoint(static_cast<vtkIdType>(point), &position.x);
    return position;
  };
  for (std::size_t node = 0; node < after; ++node)
  {
    const std::size_t origin = this->GetOrigin(node);
    glm::dvec3 position;
    if (origin < before)
    {
      position = getPoint(origin);
    }
    else
    {
      const std::array<std::int32_t, 2>& ends = this->Whole.MidSideEnds[origin - before];
      position = 0.5 *
        (getPoint(static_cast<std::size_t>(ends[0])) + getPoint(static_cast<std::size_t>(ends[1])));
    }
    points->SetPoint(static_cast<vtkIdType>(node), &position.x);
  }
  made->SetPoints(points);
  made->Allocate(grid->GetNumberOfCells());
  const int type = this->Mesh.Body.MidSides.empty() ? VTK_TETRA : VTK_QUADRATIC_TETRA;
  std::vector<vtkIdType> nodes;
  vtkNew<vtkIdList> faces;
  std::size_t tetrahedron = 0;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    if (tetrahedron < this->Mesh.Cells.size() && cell == this->Mesh.Cells[tetrahedron])
    {
      nodes.clear();
      this->Mesh.Body.ForNodes(tetrahedron++, [&](std::int32_t node) { nodes.push_back(node); });
      made->InsertNextCell(type, static_cast<vtkIdType>(nodes.size()), nodes.data());
    }
    else if (grid->GetCellType(cell) == VTK_POLYHEDRON)
    {
      grid->GetFaceStream(cell, faces);
      made->InsertNextCell(VTK_POLYHEDRON, faces);
    }
    else
    {
      vtkIdType size = 0;
      const vtkIdType* ids = nullptr;
      grid->GetCells()->GetCellAtId(cell, size, ids);
      made->InsertNextCell(grid->GetCellType(cell), size, ids);
    }
  }
}

void ElasticSession::FillPointData(vtkUnstructuredGrid* grid, vtkUnstructuredGrid* made) const
{
  const auto before = static_cast<std::size_t>(grid->GetNumberOfPoints());
  const BodyMesh& mesh = this->Mesh;
  vtkPointData* from = grid->GetPointData();
  vtkPointData* to = made->GetPointData();
  if (mesh.MidSideEnds.empty())
  {
    to->CopyAllOn();
    to->CopyAllocate(from, made->GetNumberOfPoints());
  }
  else
  {
    to->InterpolateAllocate(from, made->GetNumberOfPoints()); // leaves out ids of points
  }
  for (vtkIdType node = 0; node < made->GetNumberOfPoints(); ++node)
  {
    const std::size_t origin = this->GetOrigin(static_cast<std::size_t>(node));
    if (origin < before)
    {
      to->CopyData(from, static_cast<vtkIdType>(origin), node);
    }
    else
    {
      InterpolateInMiddle(from, mesh.MidSideEnds[origin - before], to, node);
    }
  }
  // For these arrays the values of the body are not the means of the two ends.
  const auto getArray = [to](const char* name)
  { return vtkArrayDownCast<vtkDataArray>(to->GetAbstractArray(name)); };
  const auto overwrite = [&](const char* name, const auto& getValue)
  {
    vtkDataArray* array = getArray(name);
    for (vtkIdType node = grid->GetNumberOfPoints(); array && node < array->GetNumberOfTuples();
         ++node)
    {
      const std::size_t origin = this->GetOrigin(static_cast<std::size_t>(node));
      for (int i = 0; origin >= before && i < array->GetNumberOfComponents(); ++i)
      {
        array->SetComponent(node, i, getValue(origin, i));
      }
    }
  };
  const ElasticBody& body = this->Whole.Body;
  overwrite(FixedName, [&](std::size_t node, int) { return body.IsFixed(node) ? 1.0 : 0.0; });
  overwrite(
    SlidingNormalName, [&](std::size_t node, int i) { return body.SlidingNormals[node][i]; });
  overwrite(SecondSlidingNormalName,
    [&](std::size_t node, int i) { return body.SecondSlidingNormals[node][i]; });
  // Forces are passed on to mid-side nodes, and cuts divide them.
  vtkDataArray* forces = mesh.Forces.empty() ? nullptr : getArray(ForceName);
  for (vtkIdType node = 0; forces && node < forces->GetNumberOfTuples(); ++node)
  {
    forces->SetTuple(node, &mesh.Forces[static_cast<std::size_t>(node)].x);
  }
}

vtkUnstructuredGrid* ElasticSession::GetGrid(vtkUnstructuredGrid* grid)
{
  if (this->Cuts.empty() && this->Mesh.HasNodesOfCells)
  {
    this->MadeGrid = nullptr;
    return grid;
  }
  const Stamp mesh = GetMeshStamp(grid);
  Stamp data = GetDataStamp(grid);
  data.push_back(this->BodyStamp.back()); // arrays may be written without a change of their times
  const bool keepsMesh =
    this->MadeGrid && mesh == this->MadeMeshStamp && this->MadeVersion == this->MeshVersion;
  if (keepsMesh && data == this->MadeDataStamp)
  {
    return this->MadeGrid;
  }
  auto made = vtkSmartPointer<vtkUnstructuredGrid>::New();
  if (keepsMesh)
  {
    made->CopyStructure(this->MadeGrid);
  }
  else
  {
    this->FillMesh(grid, made);
  }
  this->FillPointData(grid, made);
  made->GetCellData()->ShallowCopy(grid->GetCellData());
  made->GetFieldData()->ShallowCopy(grid->GetFieldData());
  this->MadeGrid = made;
  this->MadeMeshStamp = mesh;
  this->MadeDataStamp = data;
  this->MadeVersion = this->MeshVersion;
  return made;
}

} // namespace deformvolume
