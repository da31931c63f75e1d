// SPDX-License-Identifier: BSD-3-Clause
#include "VectorField.h"

#include "Error.h"
#include "FieldGeometry.h"
#include "ParallelFor.h"
#include "VectorBounds.h"
#include "VectorConversion.h"

#include <glm/common.hpp>

#include <atomic>

namespace deformvolume
{

namespace
{

constexpr std::size_t VectorsPerPart = 512;

// notFinite: the first vector that is not finite. count: the number of vectors.
void CheckFinite(std::size_t notFinite, std::size_t count)
{
  if (notFinite < count)
  {
    throw Error("Vector " + std::to_string(notFinite) +
      " of the displacement field is not finite. Remove NaN and infinity from it.");
  }
}

} // namespace

void VectorField::Replace(const ImageGeometry& grid, const VectorView& vectors, bool isInverse,
  const std::shared_ptr<DeviceVectors>& shared)
{
  const std::int64_t points = GetNumberOfPoints(grid.PointExtent);
  if (points == 0)
  {
    throw Error("The displacement field is empty: its extent is " +
      DescribeExtent(grid.PointExtent) + ". Give at least one point on each axis.");
  }
  CheckTransform(grid, "the displacement field");
  if (vectors.Count != static_cast<std::size_t>(points))
  {
    throw Error("The displacement field has " + std::to_string(points) + " points, but " +
      std::to_string(vectors.Count) + " vectors. Give one vector for each point.");
  }
  this->Grid = grid;
  this->Vectors = vectors;
  this->Inverse = isInverse;
  this->Shared = shared;
  this->IsOld = true;
}

void VectorField::Set(const ImageGeometry& grid, const VectorView& vectors, bool isInverse)
{
  this->Replace(grid, vectors, isInverse, nullptr);
}

void VectorField::Set(const ImageGeometry& grid, const std::shared_ptr<DeviceVectors>& vectors)
{
  if (this->Shared != vectors || this->Grid != grid)
  {
    this->Replace(grid, { nullptr, false, vectors->GetNumberOfPoints() }, false, vectors);
  }
}

void VectorField::Update(const ImageGeometry& volume, const OutputMap& toOutput)
{
  const bool isSame = !this->IsOld && volume == this->Volume && toOutput == this->ToOutput;
  const std::uint64_t revision = this->Shared ? this->Shared->GetRevision() : 0;
  if (isSame && revision == this->Revision)
  {
    return;
  }
  this->IsOld = true; // in case of an exception
  if (!isSame || !this->InPlace)
  {
    this->Locate(volume, toOutput);
  }
  if (!this->InPlace)
  {
    this->Convert(volume, toOutput);
  }
  this->IsOld = false;
  this->Volume = volume;
  this->ToOutput = toOutput;
  this->Revision = revision;
  ++this->Version;
}

void VectorField::Locate(const ImageGeometry& volume, const OutputMap& toOutput)
{
  const Extent& points = this->Grid.PointExtent;
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Dimensions[static_cast<std::size_t>(axis)] = static_cast<int>(GetSize(points, axis));
  }
  this->IndexToField = GetIndexToField(this->Grid, volume, this->Inverse ? &toOutput : nullptr);
  this->InPlace.reset();
  this->ScannedRevision = 0;
  if (this->Shared && GetFieldStride(volume.PointExtent, this->IndexToField, this->Dimensions) == 1)
  {
    const glm::dmat3 transform = GetToDisplacement(volume, toOutput, 1.0);
    for (std::size_t i = 0; i < 9; ++i)
    {
      this->ToDisplacement[i] = transform[static_cast<int>(i % 3)][static_cast<int>(i / 3)];
    }
    this->InPlace = this->Shared;
    std::vector<float>().swap(this->Displacements);
  }
}

void VectorField::Convert(const ImageGeometry& volume, const OutputMap& toOutput)
{
  if (this->Shared)
  {
    this->Vectors.Data = this->Shared->Read();
  }
  std::vector<std::size_t> taken;
  if (!this->Inverse)
  {
    taken = this->TakeVoxels(volume.PointExtent);
  }
  const std::size_t count = taken.empty() ? this->Vectors.Count : taken.size();
  const glm::dmat3 toDisplacement = GetToDisplacement(volume, toOutput, 1.0);
  this->Displacements.resize(3 * count);
  std::atomic<std::size_t> notFinite{ this->Vectors.Count };
  std::atomic<bool> tooFar{ false };
  ParallelForParts(count, VectorsPerPart,
    [&](std::size_t begin, std::size_t end)
    {
      std::array<glm::dvec3, VectorsPerPart> vectors;
      for (std::size_t i = begin; i < end; ++i)
      {
        const std::size_t point = taken.empty() ? i : taken[i];
        vectors[i - begin] = this->Vectors.Get(point);
        if (!IsFiniteVector(vectors[i - begin]))
        {
          Lower(notFinite, point);
        }
      }
      if (!ConvertVectors(
            toDisplacement, vectors.data(), end - begin, &this->Displacements[3 * begin]))
      {
        tooFar = true;
      }
    });
  CheckFinite(notFinite, this->Vectors.Count);
  if (tooFar)
  {
    ThrowTooFar();
  }
}

WorldField VectorField::GetWorldField()
{
  if (this->Shared)
  {
    this->Vectors.Data = this->Shared->Read();
  }
  std::atomic<std::size_t> notFinite{ this->Vectors.Count };
  ParallelForParts(this->Vectors.Count, VectorsPerPart,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        if (!IsFiniteVector(this->Vectors.Get(i)))
        {
          Lower(notFinite, i);
        }
      }
    });
  CheckFinite(notFinite, this->Vectors.Count);
  WorldField field = MakeWorldField(this->Grid);
  if (this->Vectors.AreDoubles)
  {
    field.Doubles = static_cast<const double*>(this->Vectors.Data);
  }
  else
  {
    field.Floats = static_cast<const float*>(this->Vectors.Data);
  }
  return field;
}

std::vector<std::size_t> VectorField::TakeVoxels(const Extent& voxels)
{
  std::vector<std::size_t> taken;
  const int stride = GetFieldStride(voxels, this->IndexToField, this->Dimensions);
  if (stride == 1)
  {
    return taken;
  }
  const auto get = [&](int axis, int voxel) // index of its point on an axis
  {
    const auto first = static_cast<std::int64_t>(this->IndexToField[4 * axis + 3]);
    return std::int64_t{ stride } * voxel + first;
  };
  taken.reserve(static_cast<std::size_t>(GetNumberOfPoints(voxels)));
  ForEachPoint(voxels,
    [&](int x, int y, int z)
    {
      const std::int64_t row = get(2, z) * this->Dimensions[1] + get(1, y);
      taken.push_back(static_cast<std::size_t>(row * this->Dimensions[0] + get(0, x)));
    });
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    this->Dimensions[axis] = static_cast<int>(GetSize(voxels, static_cast<int>(axis)));
    this->IndexToField[5 * axis] = 1.0;
    this->IndexToField[4 * axis + 3] = -voxels[2 * axis];
  }
  return taken;
}

DisplacementField VectorField::GetShape(const OutsideVoxels& outside) const
{
  DisplacementField field;
  field.Dimensions = this->Dimensions;
  field.IndexToField = this->IndexToField;
  if (this->InPlace)
  {
    field.ToDisplacement = this->ToDisplacement;
  }
  SetOutside(outside, glm::abs(this->Grid.Spacing), field);
  return field;
}

DisplacementField VectorField::Get(const OutsideVoxels& outside) const
{
  DisplacementField field = this->GetShape(outside);
  field.Vectors = this->InPlace ? this->InPlace->Read() : this->Displacements.data();
  return field;
}

std::optional<IndexBounds> VectorField::FindSharedBounds(const OutsideVoxels& outside)
{
  const VoxelGrid voxelGrid{ this->Volume.PointExtent, this->ToOutput, {} };
  if (!this->InPlace || !AreVoxelsPoints(voxelGrid, this->GetShape(outside)))
  {
    return {};
  }
  if (!this->InPlace->AreInHostMemory())
  {
    return FindDeformedBounds(voxelGrid, this->GetShape(outside), *this->InPlace);
  }
  std::optional<PointRanges> changes;
  if (this->ScannedRevision != 0)
  {
    changes = this->InPlace->GetChanges(this->ScannedRevision);
  }
  const FieldCheckResult state =
    this->Scan.Check(voxelGrid, this->Get(outside), changes ? &*changes : nullptr);
  this->ScannedRevision = this->Revision;
  return state.IsUsable ? std::optional<IndexBounds>(state.Bounds) : std::nullopt;
}

} // namespace deformvolume
