// SPDX-License-Identifier: BSD-3-Clause
#include "VectorField.h"

#include "Error.h"
#include "FieldGeometry.h"
#include "ParallelFor.h"
#include "VectorBounds.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
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
      " of the displacement field is not finite. Remove NaN and infinity from it, or mark its "
      "point as undefined.");
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
  this->FieldSpacing = glm::abs(grid.Spacing);
  this->WorldVectors = vectors;
  this->Inverse = isInverse;
  this->Undefined = nullptr;
  this->UndefinedPoints.clear();
  this->Shared = shared;
  this->IsOld = true;
}

void VectorField::Set(const ImageGeometry& grid, const VectorView& vectors, bool isInverse,
  const unsigned char* undefined)
{
  this->Replace(grid, vectors, isInverse, nullptr);
  if (undefined && std::any_of(undefined, undefined + vectors.Count, [](int one) { return one; }))
  {
    this->Undefined = undefined;
  }
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
  ++this->VectorsVersion;
  if (!isSame || !this->OnDevice)
  {
    this->Locate(volume, toOutput);
  }
  if (!this->OnDevice)
  {
    this->Convert(volume, toOutput);
  }
  this->IsOld = false;
  this->Volume = volume;
  this->ToOutput = toOutput;
  this->Revision = revision;
}

void VectorField::Locate(const ImageGeometry& volume, const OutputMap& toOutput)
{
  const Extent& points = this->Grid.PointExtent;
  for (int axis = 0; axis < 3; ++axis)
  {
    this->FieldDimensions[static_cast<std::size_t>(axis)] = static_cast<int>(GetSize(points, axis));
  }
  this->IndexToField = GetIndexToField(this->Grid, volume, this->Inverse ? &toOutput : nullptr);
  this->OnDevice.reset();
  this->ScannedRevision = 0;
  if (this->Shared &&
    GetFieldStride(volume.PointExtent, this->IndexToField, this->FieldDimensions) <= 1)
  {
    this->MatrixOnDevice = GetRows(GetToDisplacement(volume, toOutput, 1.0));
    this->OnDevice = this->Shared;
    std::vector<float>().swap(this->Vectors);
  }
}

void VectorField::Convert(const ImageGeometry& volume, const OutputMap& toOutput)
{
  if (this->Shared)
  {
    this->WorldVectors.Data = this->Shared->Read();
  }
  std::vector<std::size_t> taken;
  if (!this->Inverse)
  {
    taken = this->TakeVoxels(volume.PointExtent);
  }
  const std::size_t count = taken.empty() ? this->WorldVectors.Count : taken.size();
  this->UndefinedPoints.resize(this->Undefined ? count : 0);
  for (std::size_t i = 0; i < this->UndefinedPoints.size(); ++i)
  {
    this->UndefinedPoints[i] = this->Undefined[taken.empty() ? i : taken[i]];
  }
  this->Faults.Reset();
  this->SetDisplacements(
    count,
    [&](const VectorTaker& take)
    {
      std::atomic<std::size_t> notFinite{ this->WorldVectors.Count };
      ParallelForParts(count, VectorsPerPart,
        [&](std::size_t begin, std::size_t end)
        {
          std::array<glm::dvec3, VectorsPerPart> vectors;
          for (std::size_t i = begin; i < end; ++i)
          {
            const std::size_t point = taken.empty() ? i : taken[i];
            vectors[i - begin] =
              this->IsUndefined(point) ? glm::dvec3(0.0) : this->WorldVectors.Get(point);
            if (!IsFinite(vectors[i - begin]))
            {
              Lower(notFinite, point);
            }
          }
          take(static_cast<std::int64_t>(begin), vectors.data(),
            static_cast<std::int64_t>(end - begin));
        });
      CheckFinite(notFinite, this->WorldVectors.Count);
      if (this->Faults.MayHaveAny())
      {
        ThrowTooFar();
      }
    },
    GetToDisplacement(volume, toOutput, 1.0));
  if (this->Inverse)
  {
    this->EraseUndefinedVectors();
  }
}

WorldField VectorField::GetWorldField()
{
  if (this->Shared)
  {
    this->WorldVectors.Data = this->Shared->Read();
  }
  const std::size_t notFinite = FindFirst(this->WorldVectors.Count, VectorsPerPart,
    [&](std::size_t i) { return !this->IsUndefined(i) && !IsFinite(this->WorldVectors.Get(i)); });
  CheckFinite(notFinite, this->WorldVectors.Count);
  WorldField field = MakeWorldField(this->Grid);
  field.Undefined = this->Undefined;
  field.Vectors = this->WorldVectors;
  return field;
}

std::vector<std::size_t> VectorField::TakeVoxels(const Extent& voxels)
{
  std::vector<std::size_t> taken;
  const int stride = GetFieldStride(voxels, this->IndexToField, this->FieldDimensions);
  if (stride <= 1)
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
      const std::int64_t row = get(2, z) * this->FieldDimensions[1] + get(1, y);
      taken.push_back(static_cast<std::size_t>(row * this->FieldDimensions[0] + get(0, x)));
    });
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    this->FieldDimensions[axis] = static_cast<int>(GetSize(voxels, static_cast<int>(axis)));
    this->IndexToField[5 * axis] = 1.0;
    this->IndexToField[4 * axis + 3] = -voxels[2 * axis];
  }
  return taken;
}

std::optional<IndexBounds> VectorField::FindSharedBounds(const OutsideVoxels& outside)
{
  const VoxelGrid voxelGrid{ this->Volume.PointExtent, this->ToOutput, {} };
  if (!this->OnDevice || !AreVoxelsPoints(voxelGrid, this->GetFieldShape(outside)))
  {
    return {};
  }
  if (!this->OnDevice->AreInHostMemory())
  {
    return FindDeformedBounds(voxelGrid, this->GetFieldShape(outside), *this->OnDevice);
  }
  std::optional<PointRanges> changes;
  if (this->ScannedRevision != 0)
  {
    changes = this->OnDevice->GetChanges(this->ScannedRevision);
  }
  const FieldCheckResult state =
    this->Scan.Check(voxelGrid, this->GetField(outside), changes ? &*changes : nullptr);
  this->ScannedRevision = this->Revision;
  return state.IsUsable ? std::optional<IndexBounds>(state.Bounds) : std::nullopt;
}

} // namespace deformvolume
