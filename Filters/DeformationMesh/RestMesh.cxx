// SPDX-License-Identifier: BSD-3-Clause
#include "RestMesh.h"

#include "DeformationSource.h"
#include "Error.h"
#include "MeshCells.h"

#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <atomic>

namespace deformvolume
{

namespace
{

// Without a mesh at rest, the points of the deformation mesh are at rest.
bool IsRestMade(const DeformationSource& source)
{
  return source.Rest ? source.RestIsMade : source.ShapeIsMade;
}

// Lists the tetrahedra with other nodes. Returns nothing if the numbers of tetrahedra differ.
std::optional<std::vector<TetrahedronChange>> FindDifferences(
  const std::vector<Tetrahedron>& before, const std::vector<Tetrahedron>& after)
{
  if (before.size() != after.size())
  {
    return {};
  }
  std::vector<TetrahedronChange> differences;
  for (std::size_t t = 0; t < before.size(); ++t)
  {
    if (before[t] != after[t])
    {
      differences.push_back({ static_cast<std::int32_t>(t), before[t], after[t] });
    }
  }
  return differences;
}

// Whether all nodes of the tetrahedra are less than count.
bool AreNodes(const std::vector<Tetrahedron>& tetrahedra, std::size_t count)
{
  return std::all_of(tetrahedra.begin(), tetrahedra.end(),
    [count](const Tetrahedron& nodes)
    { return static_cast<std::size_t>(*std::max_element(nodes.begin(), nodes.end())) < count; });
}

} // namespace

void RestMesh::Read(const MeshParts& shape, const MeshParts& rest, const DeformationSource& source)
{
  const MeshStamp restCells = MeshStamp::OfCells(rest, IsRestMade(source));
  const MeshStamp shapeCells = MeshStamp::OfCells(shape, source.ShapeIsMade);
  CellReading cells = this->ReadCells(shape, rest, source, restCells, shapeCells);
  const std::size_t nodes = GetNumberOfNodes(rest);
  const std::size_t nodesBefore = this->Points.size() - this->Derived.GetCount();
  const bool hasFailed = this->ShapeIsOld;
  this->RestCells = this->ShapeCells = MeshStamp(); // equal no other stamps if a call below throws
  // The indices of derived nodes follow those of all other nodes.
  const bool keepsDerived = !cells.Derived ||
    (*cells.Derived == this->Derived && (this->Derived.GetCount() == 0 || nodes == nodesBefore));
  if (!keepsDerived)
  {
    this->ShapeIsOld = true;
    this->Points.resize(nodesBefore);
    this->Derived = DerivedNodes();
  }
  const bool haveRead = this->ReadPoints(rest, source, nodesBefore);
  // After a failure, what was computed from the points may be older than the points.
  this->KeptPoints = this->KeptPoints && !hasFailed;
  const bool isSameShape = !this->ShapeIsOld && this->KeptPoints && this->HaveSameShape(cells);
  if (cells.Derived)
  {
    this->Derived = std::move(*cells.Derived);
  }
  this->Points.resize(nodes + this->Derived.GetCount());
  if (!keepsDerived || haveRead)
  {
    this->UpdateDerivedPoints(nodes);
  }
  if (!isSameShape)
  {
    ++this->ShapeVersion;
    ++this->ConnectivityVersion;
    this->LastChanges.reset();
  }
  else if (!cells.Differences->empty() || nodes != nodesBefore)
  {
    ++this->ConnectivityVersion;
    this->LastChanges = std::move(cells.Differences);
  }
  if (!cells.All.empty())
  {
    this->Tetrahedra = std::move(cells.All);
  }
  this->IgnoredCells = cells.Ignored;
  this->WrongOrder = cells.WrongOrder;
  // After a failure the points that tetrahedra use may have been removed already.
  if ((nodes < nodesBefore || hasFailed) && !AreNodes(this->Tetrahedra, this->Points.size()))
  {
    this->ShapeIsOld = true;
    deformvolume::ReadCells(
      rest, rest, source.Derived, nullptr, &shape); // throws an Error that says what is wrong
    throw Error(
      "The deformation mesh has cells that use points that do not exist. Correct the cells of the "
      "mesh.");
  }
  this->ShapeIsOld = true; // stays true if the check throws
  CheckPoints(rest, source.Rest ? REST_NAME : MESH_NAME, this->PointFaults, this->Tetrahedra);
  this->ShapeIsOld = false;
  this->CellsDependOnPoints = cells.DependOnPoints;
  this->RestCells = restCells;
  this->ShapeCells = shapeCells;
}

bool RestMesh::HavePointsChanged(const MeshParts& rest, const DeformationSource& source) const
{
  if (!(source.Volume == this->Volume) ||
    GetNumberOfNodes(rest) + this->Derived.GetCount() != this->Points.size())
  {
    return true;
  }
  if (MeshStamp::OfPoints(rest, IsRestMade(source)).IsThatOf(this->PointsStamp))
  {
    return false;
  }
  const glm::dmat4 transform = source.Volume.GetWorldToIndex();
  std::atomic<bool> have{ false };
  const glm::dvec3* last = this->Points.data();
  for (vtkUnstructuredGrid* grid : rest)
  {
    if (grid->GetNumberOfPoints() == 0)
    {
      continue;
    }
    ReadVectors(
      grid->GetPoints()->GetData(),
      [&](vtkIdType begin, const glm::dvec3* points, vtkIdType count)
      {
        for (vtkIdType i = 0; i < count; ++i)
        {
          if (glm::dvec3(transform * glm::dvec4(points[i], 1.0)) != last[begin + i])
          {
            have.store(true, std::memory_order_relaxed);
          }
        }
      },
      "Point", "", nullptr, [](vtkIdType) {}); // a point that is not finite was read as zeros
    last += grid->GetNumberOfPoints();
  }
  return have;
}

RestMesh::CellReading RestMesh::ReadCells(const MeshParts& shape, const MeshParts& rest,
  const DeformationSource& source, const MeshStamp& restCells, const MeshStamp& shapeCells)
{
  CellReading reading;
  reading.Ignored = this->IgnoredCells;
  reading.WrongOrder = this->WrongOrder;
  reading.DependOnPoints = this->CellsDependOnPoints;
  const bool isSameRest = restCells.IsThatOf(this->RestCells) &&
    (!this->CellsDependOnPoints || !this->HavePointsChanged(rest, source));
  const auto readRest = [&]
  {
    MeshCells cells = deformvolume::ReadCells(rest, rest, source.Derived, nullptr, &shape);
    if (cells.Tetrahedra.empty())
    {
      throw Error("The deformation mesh has no tetrahedra" +
        (cells.Ignored.empty() ? std::string() : ", but " + cells.Ignored) +
        ". Use a mesh of three-dimensional cells that can be split into tetrahedra, and that are "
        "not hidden by vtkGhostType or vtkValidPointMask.");
    }
    reading.Ignored = cells.Ignored;
    reading.WrongOrder = cells.WrongOrder;
    reading.DependOnPoints = cells.DependOnPoints;
    reading.Derived = std::move(cells.Derived);
    reading.Differences = FindDifferences(this->Tetrahedra, cells.Tetrahedra);
    reading.All = std::move(cells.Tetrahedra);
  };
  if (isSameRest)
  {
    reading.Differences = Changes();
  }
  else
  {
    readRest();
  }
  const bool isSameShape = shapeCells.IsThatOf(this->ShapeCells) ||
    (shapeCells.HasArraysOf(restCells) && this->ShapeCells.HasArraysOf(this->RestCells));
  if (isSameRest ? isSameShape : shapeCells.HasArraysOf(restCells))
  {
    return reading;
  }
  const std::vector<Tetrahedron> tetrahedra =
    deformvolume::ReadCells(shape, rest, source.Derived, nullptr, &rest).Tetrahedra;
  if (isSameRest && tetrahedra != this->Tetrahedra)
  {
    readRest(); // other cells of the deformation mesh may be hidden than before
  }
  if (tetrahedra != (reading.All.empty() ? this->Tetrahedra : reading.All))
  {
    throw Error("The cells of the deformation mesh are not those of the mesh at rest. "
                "Use one mesh, at rest and deformed.");
  }
  return reading;
}

void RestMesh::UpdateDerivedPoints(std::size_t nodes)
{
  for (std::size_t i = 0; i < this->Derived.GetCount(); ++i)
  {
    this->Points[nodes + i] =
      this->Derived.Sum(i, [&](std::int32_t node) { return this->Points[node]; });
  }
}

bool RestMesh::ReadPoints(
  const MeshParts& rest, const DeformationSource& source, std::size_t before)
{
  this->KeptPoints = true;
  const MeshStamp stamp = MeshStamp::OfPoints(rest, IsRestMade(source));
  if (stamp.IsThatOf(this->PointsStamp) && source.Volume == this->Volume)
  {
    return false;
  }
  this->PointsStamp = MeshStamp(); // equals no other stamp if a call below throws
  if (!(source.Volume == this->Volume))
  {
    this->PointMemories.clear();
  }
  const std::size_t sizeBefore = this->Points.size();
  // Keep removed points: tetrahedra of the last version still use them.
  this->Points.resize(std::max(sizeBefore, GetNumberOfNodes(rest)));
  this->PointFaults.Resize(GetNumberOfNodes(rest));
  std::atomic<bool> kept{ true };
  try
  {
    this->ReadMovedPoints(rest, source, before, kept);
  }
  catch (...)
  {
    this->ShapeIsOld |= !kept;
    this->Points.resize(sizeBefore);
    this->PointMemories.clear();
    throw;
  }
  this->KeptPoints = kept;
  this->PointsStamp = stamp;
  this->Volume = source.Volume;
  return true;
}

void RestMesh::ReadMovedPoints(const MeshParts& rest, const DeformationSource& source,
  std::size_t before, std::atomic<bool>& kept)
{
  const glm::dmat4 transform = source.Volume.GetWorldToIndex();
  this->PointMemories.resize(rest.size());
  vtkIdType first = 0;
  for (std::size_t part = 0; part < rest.size(); ++part)
  {
    VectorMemory& memory = this->PointMemories[part];
    const vtkIdType count = rest[part]->GetNumberOfPoints();
    if (count == 0 || memory.FirstNumber != first)
    {
      memory = VectorMemory();
      memory.FirstNumber = first;
    }
    if (count > 0)
    {
      ReadVectors(
        rest[part]->GetPoints()->GetData(),
        [&](vtkIdType begin, const glm::dvec3* points, vtkIdType some)
        {
          this->PointFaults.Clear(first + begin, some);
          for (vtkIdType i = 0; i < some; ++i)
          {
            const auto node = static_cast<std::size_t>(first + begin + i);
            const glm::dvec3 point(transform * glm::dvec4(points[i], 1.0));
            if (node < before && point != this->Points[node])
            {
              kept.store(false, std::memory_order_relaxed);
            }
            this->Points[node] = point;
          }
        },
        "Point", "", &memory,
        [&](vtkIdType point) { this->PointFaults.Mark(first + point, NodeFaults::NotFinite); });
    }
    first += count;
  }
}

bool RestMesh::HaveSameShape(const CellReading& cells) const
{
  return cells.Differences &&
    std::all_of(cells.Differences->begin(), cells.Differences->end(),
      [&](const TetrahedronChange& change)
      {
        bool inPlace = true;
        for (int k = 0; k < 4; ++k)
        {
          inPlace &= this->Points[change.Before[k]] == this->Points[change.After[k]];
        }
        return inPlace;
      });
}

std::optional<std::vector<TetrahedronChange>> RestMesh::GetChanges(std::uint64_t version) const
{
  if (version == this->ConnectivityVersion)
  {
    return Changes();
  }
  return version + 1 == this->ConnectivityVersion ? this->LastChanges : std::nullopt;
}

} // namespace deformvolume
