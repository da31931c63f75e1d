// SPDX-License-Identifier: BSD-3-Clause
#include "Deformation.h"

#include "ParallelFor.h"
#include "VectorArray.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

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
const char* const FIELD = "displacement field on input port 1";

// Products of matrices and their inverses miss the simple numbers that are meant, and then the
// last row of voxels is outside a field of the same extent. The grain is far below a voxel.
double DropRoundingError(double value)
{
  constexpr double grain = 4294967296.0;
  return std::round(value * grain) / grain;
}

} // namespace

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

DisplacementField Deformation::GetField(bool extrapolate) const
{
  DisplacementField field;
  field.Dimensions = this->FieldDimensions;
  field.Vectors = this->Vectors.data();
  field.IndexToField = this->IndexToField;
  field.Extrapolate = extrapolate;
  return field;
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
  this->ReadTetrahedra(shape, rest);
  this->ReadRestPoints(rest, source);

  Stamp stamp = source.Rest ? GetPointsStamp(shape) : GetPointVectorsStamp(shape);
  if (source.Rest)
  {
    const Stamp restStamp = GetPointsStamp(rest);
    stamp.insert(stamp.end(), restStamp.begin(), restStamp.end());
  }
  // The two ways to give displacements never count as the same.
  stamp.emplace_back(nullptr, source.Rest ? 1 : 0);
  if (this->VectorsAreCurrent(stamp, source, false))
  {
    return;
  }
  const std::size_t count = GetNumberOfNodes(shape);
  if (source.Rest)
  {
    this->Memories.clear();
    std::vector<glm::dvec3> vectors = ReadPoints(shape, MESH);
    const std::vector<glm::dvec3> start = ReadPoints(rest, REST);
    const auto read = [&](const VectorTaker& take)
    {
      ParallelFor(0, static_cast<vtkIdType>(count), 0,
        [&](vtkIdType begin, vtkIdType end)
        {
          for (vtkIdType i = begin; i < end; ++i)
          {
            vectors[i] -= start[i];
          }
          take(begin, vectors.data() + begin, end - begin);
        });
    };
    this->SetVectors(count, read, 1.0, source);
  }
  else
  {
    this->SetVectors(
      count,
      [&](const VectorTaker& take)
      { ReadPointVectors(shape, source.Selector, source.Wanted, MESH, take, &this->Memories); },
      source.DisplacementScale, source);
  }
  this->Field = false;
  this->VectorsStamp = stamp;
}

void Deformation::ReadTetrahedra(const MeshParts& shape, const MeshParts& rest)
{
  Stamp stamp = GetCellsStamp(rest);
  const Stamp shapeStamp = GetCellsStamp(shape);
  const bool shared = stamp == shapeStamp;
  stamp.insert(stamp.end(), shapeStamp.begin(), shapeStamp.end());
  if (stamp == this->CellsStamp)
  {
    return;
  }
  MeshCells cells = ReadCells(rest);
  if (cells.Tetrahedra.empty())
  {
    throw Error("The deformation mesh has no tetrahedra" +
      (cells.Ignored.empty() ? std::string() : ", but " + cells.Ignored) +
      ". Connect a mesh of linear three-dimensional cells, for example from "
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
  this->CellsStamp = stamp;
}

void Deformation::ReadRestPoints(const MeshParts& rest, const DeformationSource& source)
{
  const Stamp stamp = GetPointsStamp(rest);
  if (stamp == this->RestStamp && source.Volume == this->RestVolume)
  {
    return;
  }
  std::vector<glm::dvec3> points = ReadPoints(rest, source.Rest ? REST : MESH);
  const glm::dmat4 transform = source.Volume.GetWorldToIndex();
  ParallelFor(0, static_cast<vtkIdType>(points.size()), 0,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin; i < end; ++i)
      {
        points[i] = glm::dvec3(transform * glm::dvec4(points[i], 1.0));
      }
    });
  if (points != this->RestPoints)
  {
    this->RestPoints = std::move(points);
    ++this->RestVersion;
  }
  this->RestStamp = stamp;
  this->RestVolume = source.Volume;
}

void Deformation::ReadField(vtkImageData* image, const DeformationSource& source)
{
  Stamp stamp{ { image, image->GetMTime() }, { nullptr, image->GetPointData()->GetMTime() } };
  if (this->VectorsAreCurrent(stamp, source, true))
  {
    return;
  }
  if (image->GetNumberOfPoints() == 0)
  {
    throw Error("The displacement field on input port 1 is empty. Connect a vtkImageData with a "
                "point array of three components.");
  }
  const ImageGeometry geometry = GetGeometry(image);
  CheckTransform(geometry, "the displacement field on input port 1");
  vtkDataArray* array = FindVectors(image, source.Selector, source.Wanted, FIELD);
  // Nothing is remembered: a field may have as many points as the volume has voxels.
  this->Memories.clear();
  this->SetVectors(
    static_cast<std::size_t>(image->GetNumberOfPoints()),
    [&](const VectorTaker& take) { ReadVectors(array, take, "Vector", FIELD); },
    source.DisplacementScale, source);

  image->GetDimensions(this->FieldDimensions.data());
  const glm::dmat4 toField = geometry.GetWorldToIndex() * source.Volume.GetIndexToWorld();
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      const double first = column == 3 ? geometry.PointExtent[2 * row] : 0.0;
      this->IndexToField[4 * row + column] = DropRoundingError(toField[column][row] - first);
    }
  }
  this->Field = true;
  this->VectorsStamp = stamp;
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
  glm::dmat3 transform(source.Volume.GetWorldToIndex());
  for (int column = 0; column < 3; ++column)
  {
    transform[column] *= source.Scale * factor;
  }
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
  this->VectorsSource = source;
  // Only compared, never called or read through again.
  this->VectorsSource.Shape = nullptr;
  this->VectorsSource.Rest = nullptr;
  this->VectorsSource.Selector = nullptr;
}

} // namespace deformvolume
