// SPDX-License-Identifier: BSD-3-Clause
#include "FieldParameters.h"

#include "Error.h"
#include "Extent.h"
#include "ParallelFor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

namespace deformvolume
{
namespace
{

// Sets SameGrid and Offset: whether all voxels are points of the field.
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

} // namespace

void CheckHasPoints(const DisplacementField& field)
{
  const std::int64_t points = GetNumberOfPoints(field);
  if (points == 0 || !field.Vectors)
  {
    throw Error("The displacement field is empty: it has " + std::to_string(points) + " points" +
      (field.Vectors ? "." : ", and its vectors are null."));
  }
}

FieldParameters MakeMatrixParameters(const DisplacementField& field)
{
  FieldParameters parameters = {};
  parameters.IsMapped = !HasDisplacements(field);
  for (int i = 0; i < 9; ++i)
  {
    const double factor = GetFactor(field, i);
    std::uint64_t bits = 0;
    std::memcpy(&bits, &factor, sizeof(bits));
    parameters.ToDisplacement[2 * i] = static_cast<unsigned int>(bits);
    parameters.ToDisplacement[2 * i + 1] = static_cast<unsigned int>(bits >> 32);
  }
  return parameters;
}

FieldParameters MakeFieldParameters(const DisplacementField& field, const VoxelGrid& voxelGrid)
{
  FieldParameters parameters = MakeMatrixParameters(field);
  std::transform(field.IndexToField.begin(), field.IndexToField.end(), parameters.IndexToField,
    [](double element) { return static_cast<float>(element); });
  // The kernels use indices relative to the first voxel of the whole volume. Large structured
  // indices are not exact in floats, and a part must round like the whole.
  const Extent& extent = voxelGrid.VertexExtent;
  const Extent& whole = GetWholeExtent(voxelGrid);
  for (int row = 0; row < 3; ++row)
  {
    const double* m = &field.IndexToField[4 * row];
    parameters.IndexToField[4 * row + 3] =
      static_cast<float>(m[0] * whole[0] + m[1] * whole[2] + m[2] * whole[4] + m[3]);
    parameters.First[row] = extent[2 * row] - whole[2 * row];
  }
  std::copy_n(field.Dimensions.begin(), 3, parameters.Dimensions);
  parameters.Extrapolate = field.Extrapolate;
  std::transform(field.Fading.begin(), field.Fading.end(), parameters.Fading,
    [](double step) { return static_cast<float>(step); });
  SetSameGrid(parameters, extent);
  return parameters;
}

void MapVectors(
  const DisplacementField& field, const std::array<std::size_t, 2>& range, float* displacements)
{
  ParallelForItems(range[1] - range[0], 1 << 16,
    [&](std::size_t i)
    {
      const std::size_t point = range[0] + i;
      const std::array<float, 3> displacement =
        GetDisplacement(field, static_cast<std::int64_t>(point));
      std::copy(displacement.begin(), displacement.end(), displacements + 3 * point);
    });
}

std::vector<float> MapVectors(const DisplacementField& field)
{
  const auto points = static_cast<std::size_t>(GetNumberOfPoints(field));
  std::vector<float> displacements(3 * points);
  MapVectors(field, { { 0, points } }, displacements.data());
  return displacements;
}

} // namespace deformvolume
