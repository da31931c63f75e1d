// SPDX-License-Identifier: BSD-3-Clause
// How VolumeDeformer takes a displacement field.
#include "VolumeDeformer.h"

#include "KernelText.h"
#include "ParallelFor.h"
#include "VolumeDeformerInternals.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace deformvolume
{
namespace
{

/// Finds out whether the voxels are points of a field.
void SetSameGrid(FieldParameters& field, const Extent& extent)
{
  field.SameGrid = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int column = 0; column < 3; ++column)
    {
      field.SameGrid &= field.IndexToField[4 * axis + column] == (axis == column ? 1.0F : 0.0F);
    }
    const float offset = field.IndexToField[4 * axis + 3] + static_cast<float>(field.First[axis]);
    field.SameGrid &= offset == std::floor(offset) && offset >= 0.0F &&
      offset + static_cast<float>(GetSize(extent, axis)) <=
        static_cast<float>(field.Dimensions[axis]);
    field.Offset[axis] = field.SameGrid ? static_cast<int>(offset) : 0;
  }
}

FieldParameters MakeFieldParameters(const DisplacementField& field, const VoxelGrid& voxelGrid)
{
  FieldParameters parameters = {};
  std::transform(field.IndexToField.begin(), field.IndexToField.end(), parameters.IndexToField,
    [](double element) { return static_cast<float>(element); });
  // The kernels count from the first voxel of the whole volume: large structured indices do not fit
  // into a float, and a part must round as the whole does.
  const Extent& extent = voxelGrid.VertexExtent;
  const Extent& whole =
    GetNumberOfPoints(voxelGrid.WholeExtent) > 0 ? voxelGrid.WholeExtent : extent;
  for (int row = 0; row < 3; ++row)
  {
    const double* m = &field.IndexToField[4 * row];
    parameters.IndexToField[4 * row + 3] =
      static_cast<float>(m[0] * whole[0] + m[1] * whole[2] + m[2] * whole[4] + m[3]);
    parameters.First[row] = extent[2 * row] - whole[2 * row];
  }
  parameters.IsMapped = !HasDisplacements(field);
  for (int i = 0; i < 9; ++i)
  {
    const double factor = GetFactor(field, i);
    std::uint64_t bits = 0;
    std::memcpy(&bits, &factor, sizeof(bits));
    parameters.ToDisplacement[2 * i] = static_cast<unsigned int>(bits);
    parameters.ToDisplacement[2 * i + 1] = static_cast<unsigned int>(bits >> 32);
  }
  std::copy_n(field.Dimensions.begin(), 3, parameters.Dimensions);
  parameters.Extrapolate = field.Extrapolate;
  SetSameGrid(parameters, extent);
  return parameters;
}

std::vector<float> MapVectors(const DisplacementField& field)
{
  const auto points = static_cast<std::size_t>(GetNumberOfPoints(field));
  std::vector<float> displacements(3 * points);
  ParallelForParts(points, 1 << 16,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t point = begin; point < end; ++point)
      {
        const std::array<float, 3> displacement =
          GetDisplacement(field, static_cast<std::int64_t>(point));
        std::copy(displacement.begin(), displacement.end(), displacements.begin() + 3 * point);
      }
    });
  return displacements;
}

std::uint64_t GetBytes(const DisplacementField& field)
{
  return static_cast<std::uint64_t>(GetNumberOfPoints(field)) * 3 * sizeof(float);
}

} // namespace

bool VolumeDeformer::Internals::CanReadInPlace(
  const DisplacementField& field, const FieldParameters& parameters)
{
  const OpenCLContext& context = this->GetContext();
  if (!field.Owner || !parameters.SameGrid || !HasDouble(context) ||
    !CanWorkInPlace(context, field.Vectors, sizeof(float)) ||
    GetBytes(field) > this->GetAllocationLimit())
  {
    return false;
  }
  // It may be an array of the volume, too, and lies in one piece.
  const BufferInPlace array = this->GetMesh().FindOverlapping(field.Vectors, GetBytes(field));
  return array.Bytes == 0 ||
    (array.IsOver(field.Vectors, GetBytes(field)) && this->GetMesh().GetChunks().size() == 1);
}

BufferInPlace VolumeDeformer::Internals::GetFieldInPlace() const
{
  return this->FieldInPlace.Owner
    ? BufferInPlace{ this->FieldInPlace.Vectors, GetBytes(this->FieldInPlace), this->FieldVectors }
    : BufferInPlace();
}

void VolumeDeformer::Internals::SetFieldInPlace(const DisplacementField& field)
{
  this->Update.MoveAll();
  this->LastVectorsSent = false;
  const BufferInPlace array = this->GetMesh().FindOverlapping(field.Vectors, GetBytes(field));
  this->FieldVectors = array.Buffer; // that of before may lie over the same memory
  if (!array.Buffer())
  {
    // The kernels only read them.
    this->FieldVectors = MakeBufferOver(
      *this->Context, CL_MEM_READ_ONLY, const_cast<float*>(field.Vectors), GetBytes(field));
  }
  this->FieldInPlace = field; // only now no buffer lies over the memory of the last one
}

void VolumeDeformer::Internals::ForgetField()
{
  this->FieldVectors = cl::Buffer();
  this->FieldInPlace = DisplacementField();
}

std::size_t CountPoints(const DisplacementField& field)
{
  const auto points = static_cast<std::size_t>(GetNumberOfPoints(field));
  if (points == 0 || !field.Vectors)
  {
    throw Error("The displacement field is empty.");
  }
  return points;
}

void VolumeDeformer::SetDisplacementField(
  const DisplacementField& field, const PointRanges* changes)
{
  const std::size_t points = CountPoints(field);
  this->Impl->Send(
    [&]
    {
      const FieldParameters parameters =
        MakeFieldParameters(field, this->Impl->GetMesh().GetVoxelGrid());
      const bool isMapped = !HasDisplacements(field);
      DeviceVolume& mesh = this->Impl->GetMesh();
      this->Impl->Rasterizer.Clear();
      if (mesh.HasMesh())
      {
        mesh.ForgetMesh();
      }
      this->Impl->ForgetNodes();
      this->Impl->NumberOfNodes = points;
      const bool same = this->Impl->FieldVectors() &&
        std::equal(
          parameters.IndexToField, parameters.IndexToField + 12, this->Impl->Field.IndexToField) &&
        std::equal(
          parameters.Dimensions, parameters.Dimensions + 3, this->Impl->Field.Dimensions) &&
        parameters.Extrapolate == this->Impl->Field.Extrapolate;
      if (!same)
      {
        this->Impl->Update.ForgetMapping();
        mesh.ForgetState();
      }
      if (this->Impl->CanReadInPlace(field, parameters))
      {
        this->Impl->Field = parameters;
        this->Impl->SetFieldInPlace(field);
        return;
      }
      if (this->Impl->FieldInPlace.Owner)
      {
        this->Impl->ForgetField();
      }
      const PointRanges* news = this->Impl->LastVectorsSent &&
          GetMemory(this->Impl->FieldVectors) == 4 * points * sizeof(float) &&
          std::equal(parameters.Dimensions, parameters.Dimensions + 3, this->Impl->Field.Dimensions)
        ? changes
        : nullptr;
      this->Impl->LastVectorsSent = false;
      const std::vector<float> displacements = isMapped ? MapVectors(field) : std::vector<float>();
      const float* vectors = isMapped ? displacements.data() : field.Vectors;
      Internals::CheckVectors(vectors, points, "point", news);
      if (4 * points * sizeof(float) > this->Impl->GetAllocationLimit())
      {
        throw Error("The displacement field is larger than the device can hold in one piece. Use a "
                    "coarser field or another device.");
      }
      this->Impl->Field = parameters;
      this->Impl->SendVectors(vectors, points, {}, this->Impl->FieldVectors, news);
      this->Impl->LastVectorsSent = true;
    });
}

} // namespace deformvolume
