// SPDX-License-Identifier: BSD-3-Clause
#include "WorldMesh.h"

#include "Error.h"
#include "ParallelFor.h"
#include "VectorConversion.h"

#include <utility>

namespace deformvolume
{

namespace
{

constexpr std::size_t NodesAtATime = 512;

// Copies vectors. Vectors that are not finite are marked, and replaced by zeros.
void CopyVectors(const VectorView& from, std::vector<glm::dvec3>& to, NodeFaults& faults)
{
  to.resize(from.Count);
  faults.Reset();
  faults.Resize(from.Count);
  ParallelForItems(from.Count, NodesAtATime,
    [&](std::size_t i)
    {
      to[i] = from.Get(i);
      if (!IsFinite(to[i]))
      {
        to[i] = glm::dvec3(0.0);
        faults.Mark(static_cast<std::int64_t>(i), NodeFaults::NotFinite);
      }
    });
}

void CheckFaults(
  const NodeFaults& faults, const std::vector<Tetrahedron>& tetrahedra, const std::string& kind)
{
  const std::int64_t node = faults.FindUsed(tetrahedra);
  if (node < 0)
  {
    return;
  }
  if (faults.Get(node) == NodeFaults::TooFar)
  {
    ThrowTooFar();
  }
  throw Error(kind + " " + std::to_string(node) +
    " of the deformation mesh is not finite, and cells use it. Remove NaN and infinity from it.");
}

} // namespace

void WorldMesh::Set(const VectorView& points, MeshCells&& cells)
{
  CopyVectors(points, this->WorldPoints, this->PointFaults);
  this->PointsAreFloats = !points.AreDoubles;
  this->Cells = std::move(cells);
  this->WorldVectors.clear();
  this->VectorsAreSet = false;
  this->PointsAreOld = true;
  this->DisplacementsAreOld = true;
}

void WorldMesh::SetVectors(const VectorView& vectors)
{
  if (vectors.Count != this->WorldPoints.size())
  {
    throw Error("There are " + std::to_string(vectors.Count) +
      " displacements, but the deformation mesh has " + std::to_string(this->WorldPoints.size()) +
      " points. Give one displacement for each point.");
  }
  CopyVectors(vectors, this->WorldVectors, this->VectorFaults);
  this->VectorsAreSet = true;
  this->DisplacementsAreOld = true;
}

void WorldMesh::Update(const ImageGeometry& volume, const OutputMap& toOutput)
{
  if (this->PointsAreOld || volume != this->Volume)
  {
    this->UpdatePoints(volume);
    this->PointsAreOld = false;
    this->DisplacementsAreOld = true;
    this->Volume = volume;
  }
  if (this->DisplacementsAreOld || toOutput != this->ToOutput)
  {
    this->DisplacementsAreOld = true; // in case of an exception
    this->UpdateDisplacements(toOutput);
    this->DisplacementsAreOld = false;
    this->ToOutput = toOutput;
  }
}

void WorldMesh::CheckVectors() const
{
  if (!this->VectorsAreSet)
  {
    throw Error("The deformation mesh has no displacements. Set one for each of its points.");
  }
  CheckFaults(this->VectorFaults, this->Cells.Tetrahedra, "Displacement");
}

std::vector<glm::dvec3> WorldMesh::AddDerived(std::vector<glm::dvec3> vectors) const
{
  for (std::size_t i = 0; i < this->Cells.Derived.GetCount(); ++i)
  {
    vectors.push_back(this->Cells.Derived.Sum(
      i, [&](std::int32_t node) { return vectors[static_cast<std::size_t>(node)]; }));
  }
  return vectors;
}

std::vector<glm::dvec3> WorldMesh::GetWorldPoints() const
{
  CheckFaults(this->PointFaults, this->Cells.Tetrahedra, "Point");
  return this->AddDerived(this->WorldPoints);
}

std::vector<glm::dvec3> WorldMesh::GetWorldDisplacements() const
{
  this->CheckVectors();
  return this->AddDerived(this->WorldVectors);
}

void WorldMesh::UpdatePoints(const ImageGeometry& volume)
{
  this->PointsAreOld = true;
  CheckFaults(this->PointFaults, this->Cells.Tetrahedra, "Point");
  std::vector<glm::dvec3> points(this->WorldPoints.size());
  const glm::dmat4 transform = volume.GetWorldToIndex();
  ParallelForItems(points.size(), NodesAtATime,
    [&](std::size_t i)
    { points[i] = glm::dvec3(transform * glm::dvec4(this->WorldPoints[i], 1.0)); });
  this->Points = this->AddDerived(std::move(points));
  ++this->ShapeVersion;
}

void WorldMesh::UpdateDisplacements(const OutputMap& toOutput)
{
  this->CheckVectors();
  ++this->VectorsVersion;
  this->SetDisplacements(
    this->WorldVectors.size(),
    [&](const VectorTaker& take)
    {
      ParallelForParts(this->WorldVectors.size(), NodesAtATime,
        [&](std::size_t begin, std::size_t end)
        {
          take(static_cast<std::int64_t>(begin), &this->WorldVectors[begin],
            static_cast<std::int64_t>(end - begin));
        });
      CheckFaults(this->Faults, this->Cells.Tetrahedra, "Displacement");
    },
    GetToDisplacement(this->Volume, toOutput, 1.0), &this->Cells.Derived);
}

} // namespace deformvolume
