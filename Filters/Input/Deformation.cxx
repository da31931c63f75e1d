// SPDX-License-Identifier: BSD-3-Clause
#include "Deformation.h"

#include "Error.h"
#include "MeshCells.h"
#include "ParallelFor.h"
#include "VectorArray.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <utility>

namespace deformvolume
{

namespace
{

const char* const MESH = "deformation mesh on input port 1";
const char* const REST = "rest configuration on input port 2";

// What is to be added to the points of one mesh to have those of another, part by part. memories:
// of the last reading, from the same points.
void ReadPointDifferences(const MeshParts& shape, const MeshParts& rest, const VectorTaker& take,
  std::vector<VectorMemory>& memories)
{
  const std::vector<glm::dvec3> starts = ReadPoints(rest, REST);
  memories.resize(shape.size());
  vtkIdType next = 0;
  for (std::size_t part = 0; part < shape.size(); ++part)
  {
    const vtkIdType count = shape[part]->GetNumberOfPoints();
    if (count == 0 || memories[part].Place != next)
    {
      memories[part] = VectorMemory();
      memories[part].Place = next;
    }
    if (count > 0)
    {
      ReadVectors(
        shape[part]->GetPoints()->GetData(),
        [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType some)
        {
          std::vector<glm::dvec3> moves(vectors, vectors + some);
          for (vtkIdType i = 0; i < some; ++i)
          {
            moves[i] -= starts[next + first + i];
          }
          take(next + first, moves.data(), some);
        },
        "Point", MESH, &memories[part]);
    }
    next += count;
  }
}

// The mesh at rest is the one on port 1 where port 2 has none.
bool IsRestMade(const DeformationSource& source)
{
  return source.Rest ? source.RestIsMade : source.ShapeIsMade;
}

std::vector<vtkIdType> GetNodesOfParts(const MeshParts& parts)
{
  std::vector<vtkIdType> nodes;
  for (vtkUnstructuredGrid* grid : parts)
  {
    nodes.push_back(grid->GetNumberOfPoints());
  }
  return nodes;
}

} // namespace

glm::dmat3 GetToDisplacement(const DeformationSource& source, double factor)
{
  glm::dmat3 transform(source.Volume.GetWorldToIndex());
  for (int column = 0; column < 3; ++column)
  {
    transform[column] *= source.Scale * factor;
  }
  return transform;
}

void Deformation::Read(const DeformationSource& source)
{
  if (const auto image = vtkImageData::SafeDownCast(source.Shape))
  {
    if (source.Rest)
    {
      throw Error("Input port 2 has a rest configuration, but port 1 has a displacement field, "
                  "which needs none. Disconnect port 2.");
    }
    this->ReadField(image, source);
  }
  else
  {
    this->ReadMesh(source);
  }
}

void Deformation::ReadMesh(const DeformationSource& source)
{
  const MeshParts shape = GetMeshParts(source.Shape, MESH);
  const MeshParts rest = source.Rest ? GetMeshParts(source.Rest, REST) : shape;
  if (GetNumberOfNodes(shape) != GetNumberOfNodes(rest))
  {
    throw Error("The deformation mesh on input port 1 has " +
      std::to_string(GetNumberOfNodes(shape)) +
      " points and the rest configuration on port 2 has " + std::to_string(GetNumberOfNodes(rest)) +
      ". Connect two configurations of one mesh.");
  }
  this->ReadTetrahedra(shape, rest, source);
  const bool sameRest = this->ReadRestPoints(rest, source);

  Stamp stamp = source.Rest ? GetPointsStamp(shape) : GetPointVectorsStamp(shape);
  if (source.Rest)
  {
    const Stamp restStamp = GetPointsStamp(rest);
    stamp.insert(stamp.end(), restStamp.begin(), restStamp.end());
  }
  // The two ways to give displacements never count as the same.
  const bool ofPoints = source.Rest != nullptr;
  stamp.emplace_back(nullptr, ofPoints ? 1 : 0);
  if (this->VectorsAreCurrent(stamp, source, false))
  {
    return;
  }
  if (this->MemoriesAreOfPoints != ofPoints || (ofPoints && !sameRest))
  {
    this->Memories.clear();
  }
  this->MemoriesAreOfPoints = ofPoints;
  this->SetVectors(
    GetNumberOfNodes(shape),
    [&](const VectorTaker& take)
    {
      if (ofPoints)
      {
        ReadPointDifferences(shape, rest, take, this->Memories);
      }
      else
      {
        ReadPointVectors(shape, source.Selector, source.Wanted, MESH, take, &this->Memories);
      }
    },
    ofPoints ? 1.0 : source.DisplacementScale, source);
  this->RememberVectors(stamp, source, false);
}

bool Deformation::HasSameCells(
  const MeshParts& parts, const MeshStamp& stamp, const MeshStamp& lastStamp) const
{
  if (stamp.IsThatOf(lastStamp))
  {
    return true;
  }
  return !this->Tetrahedra.empty() && this->IgnoredCells.empty() &&
    GetNodesOfParts(parts) == this->NodesOfParts && HasCells(parts, this->Tetrahedra);
}

void Deformation::ReadTetrahedra(
  const MeshParts& shape, const MeshParts& rest, const DeformationSource& source)
{
  const MeshStamp restCells = MeshStamp::OfCells(rest, IsRestMade(source));
  const MeshStamp shapeCells = MeshStamp::OfCells(shape, source.ShapeIsMade);
  const bool shared = shapeCells.HasArraysOf(restCells);
  if (!this->HasSameCells(rest, restCells, this->RestCells) ||
    !(shared || this->HasSameCells(shape, shapeCells, this->ShapeCells)))
  {
    this->RestCells = this->ShapeCells = MeshStamp(); // of nothing, where this fails
    MeshCells cells = ReadCells(rest);
    if (cells.Tetrahedra.empty())
    {
      throw Error("The deformation mesh has no tetrahedra" +
        (cells.Ignored.empty() ? std::string() : ", but " + cells.Ignored) +
        ". Connect a mesh of three-dimensional cells, for example from "
        "vtkLatticeTetrahedraSource, vtkTetGenMesher or vtkDelaunay3D.");
    }
    if (!shared && ReadCells(shape).Tetrahedra != cells.Tetrahedra)
    {
      throw Error("The cells of the deformation mesh on input port 1 are not those of the rest "
                  "configuration on port 2. Connect two configurations of one mesh.");
    }
    if (cells.Tetrahedra != this->Tetrahedra)
    {
      this->Tetrahedra = std::move(cells.Tetrahedra);
      ++this->RestVersion;
    }
    this->IgnoredCells = cells.Ignored;
    this->NodesOfParts = GetNodesOfParts(rest);
  }
  this->RestCells = restCells;
  this->ShapeCells = shapeCells;
}

bool Deformation::ReadRestPoints(const MeshParts& rest, const DeformationSource& source)
{
  const char* const name = source.Rest ? REST : MESH;
  const MeshStamp stamp = MeshStamp::OfPoints(rest, IsRestMade(source));
  const bool same = stamp.IsThatOf(this->RestStamp) && source.Volume == this->RestVolume;
  if (!same)
  {
    this->RestStamp = MeshStamp(); // of nothing, where this fails
    const glm::dmat4 transform = source.Volume.GetWorldToIndex();
    if (!HasPoints(rest, transform, this->RestPoints, name))
    {
      std::vector<glm::dvec3> points = ReadPoints(rest, name);
      ParallelFor(0, static_cast<vtkIdType>(points.size()), 0,
        [&](vtkIdType begin, vtkIdType end)
        {
          for (vtkIdType i = begin; i < end; ++i)
          {
            points[i] = glm::dvec3(transform * glm::dvec4(points[i], 1.0));
          }
        });
      this->RestPoints = std::move(points);
      ++this->RestVersion;
    }
  }
  this->RestStamp = stamp;
  this->RestVolume = source.Volume;
  return same;
}

bool Deformation::VectorsAreCurrent(
  const Stamp& stamp, const DeformationSource& source, bool field) const
{
  return this->Field == field && stamp == this->VectorsStamp &&
    source.Choice == this->VectorsSource.Choice && this->HasSameUnits(source);
}

bool Deformation::HasSameUnits(const DeformationSource& source) const
{
  const DeformationSource& last = this->VectorsSource;
  return source.DisplacementScale == last.DisplacementScale && source.Volume == last.Volume &&
    source.Scale == last.Scale;
}

PointRanges Deformation::GetChanges(std::uint64_t version) const
{
  PointRanges changes;
  if (this->FieldInPlace.Owner)
  {
    return { { { 0, static_cast<std::size_t>(GetNumberOfPoints(this->FieldInPlace)) } } };
  }
  const std::size_t count = this->Vectors.size() / 3;
  for (std::size_t block = 0; block < this->BlockVersions.size(); ++block)
  {
    if (this->BlockVersions[block] <= version)
    {
      continue;
    }
    const std::size_t begin = block * PointsPerBlock;
    if (changes.empty() || changes.back()[1] != begin)
    {
      changes.push_back({ { begin, begin } });
    }
    changes.back()[1] = std::min(begin + PointsPerBlock, count);
  }
  return changes;
}

void Deformation::SetVectors(std::size_t count, const std::function<void(const VectorTaker&)>& read,
  double factor, const DeformationSource& source)
{
  // Whatever fails from here on, the vectors are not those of any source.
  this->VectorsStamp.clear();
  this->FieldInPlace = DisplacementField();
  const std::uint64_t version = ++this->VectorsVersion;
  const std::size_t blocks = (count + PointsPerBlock - 1) / PointsPerBlock;
  const bool comparable = this->VectorsAreWhole && this->Vectors.size() == 3 * count;
  if (!comparable)
  {
    this->Vectors.resize(3 * count);
    this->BlockVersions.assign(blocks, version);
  }
  if (!comparable || !this->HasSameUnits(source))
  {
    this->Memories.clear();
  }
  this->VectorsAreWhole = false;
  const glm::dmat3 transform = GetToDisplacement(source, factor);
  std::vector<std::atomic<bool>> changed(blocks);
  std::atomic<bool> tooFar{ false };
  read(
    [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType number)
    {
      std::array<glm::dvec3, PointsPerBlock> moves;
      std::array<float, 3 * PointsPerBlock> displacements;
      auto point = static_cast<std::size_t>(first);
      const std::size_t end = point + static_cast<std::size_t>(number);
      while (point < end)
      {
        const std::size_t block = point / PointsPerBlock;
        const std::size_t some = std::min(end, (block + 1) * PointsPerBlock) - point;
        int near = 1; // without branches: there are millions of points
        for (std::size_t i = 0; i < some; ++i)
        {
          moves[i] = transform * vectors[i];
          const glm::dvec3 distance = glm::abs(moves[i]);
          // Not-a-number is not near either.
          near &= (distance.x <= LargestDisplacement ? 1 : 0) &
            (distance.y <= LargestDisplacement ? 1 : 0) &
            (distance.z <= LargestDisplacement ? 1 : 0);
        }
        if (!near)
        {
          tooFar = true;
          return;
        }
        for (std::size_t i = 0; i < some; ++i)
        {
          for (int axis = 0; axis < 3; ++axis)
          {
            displacements[3 * i + axis] = static_cast<float>(moves[i][axis]);
          }
        }
        float* last = this->Vectors.data() + 3 * point;
        if (std::memcmp(last, displacements.data(), 3 * some * sizeof(float)) != 0)
        {
          std::copy_n(displacements.begin(), 3 * some, last);
          changed[block].store(true, std::memory_order_relaxed);
        }
        vectors += some;
        point += some;
      }
    });
  if (tooFar)
  {
    throw Error("The deformation moves the volume by more than 16,383 output voxels. Check "
                "DisplacementScale, the output spacing, and that displacements and volume are in "
                "the same world units.");
  }
  for (std::size_t block = 0; block < blocks; ++block)
  {
    if (changed[block])
    {
      this->BlockVersions[block] = version;
    }
  }
  this->VectorsAreWhole = true;
}

void Deformation::RememberVectors(const Stamp& stamp, const DeformationSource& source, bool field)
{
  this->Field = field;
  this->VectorsStamp = stamp;
  this->VectorsSource = source;
  // Only compared, never called or read through again.
  this->VectorsSource.Shape = nullptr;
  this->VectorsSource.Rest = nullptr;
  this->VectorsSource.Selector = nullptr;
}

} // namespace deformvolume
