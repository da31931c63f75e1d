// SPDX-License-Identifier: BSD-3-Clause
#include "CubicReference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>
#include <type_traits>

using namespace deformvolume;

namespace
{

// The kernel of Keys (1981) with a = -1/2, by the distance from a voxel.
long double GetKernel(long double distance)
{
  const long double d = std::fabs(distance);
  if (d < 1.0L)
  {
    return (1.5L * d - 2.5L) * d * d + 1.0L;
  }
  return d < 2.0L ? ((-0.5L * d + 2.5L) * d - 4.0L) * d + 2.0L : 0.0L;
}

std::array<std::int64_t, 3> GetPlace(std::int64_t number, const std::array<std::int64_t, 3>& size)
{
  return { { number % size[0], number / size[0] % size[1], number / (size[0] * size[1]) } };
}

std::array<std::int64_t, 3> GetSizes(const Extent& extent)
{
  return { { GetSize(extent, 0), GetSize(extent, 1), GetSize(extent, 2) } };
}

// The expected value of one component of an array at a sample: the sum of First and Difference.
// They are separate because extended precision cannot hold fractions of the largest integers. Error
// bounds the rounding errors of the kernels, which calculate in double precision.
struct Expected
{
  long double First = 0.0L;
  long double Difference = 0.0L;
  long double Error = 0.0L;
};

template <typename T>
Expected Interpolate(const DeformerCase& deformerCase, const reference::Containing& sample,
  const VolumeArray& array, int component)
{
  const std::array<std::int64_t, 3> size = GetSizes(deformerCase.VoxelGrid.VertexExtent);
  std::vector<std::pair<std::int64_t, long double>> weights;
  if (IsCubicCell(deformerCase, sample.Cell))
  {
    std::array<long double, 3> rest{};
    for (int k = 0; k < 4; ++k)
    {
      const std::array<std::int64_t, 3> vertex = GetPlace(sample.Vertices[k], size);
      for (int axis = 0; axis < 3; ++axis)
      {
        rest[axis] +=
          static_cast<long double>(sample.Numerators[k]) * static_cast<long double>(vertex[axis]);
      }
    }
    for (long double& index : rest)
    {
      index /= static_cast<long double>(sample.Denominator);
    }
    const std::array<std::int64_t, 3> cell =
      GetPlace(sample.Cell, { { size[0] - 1, size[1] - 1, size[2] - 1 } });
    for (int i = 0; i < 64; ++i)
    {
      const std::array<std::int64_t, 3> voxel{ { cell[0] + i % 4 - 1, cell[1] + i / 4 % 4 - 1,
        cell[2] + i / 16 - 1 } };
      long double weight = 1.0L;
      for (int axis = 0; axis < 3; ++axis)
      {
        weight *= GetKernel(rest[axis] - static_cast<long double>(voxel[axis]));
      }
      weights.emplace_back((voxel[2] * size[1] + voxel[1]) * size[0] + voxel[0], weight);
    }
  }
  else
  {
    for (int k = 0; k < 4; ++k)
    {
      weights.emplace_back(sample.Vertices[k],
        static_cast<long double>(sample.Numerators[k]) /
          static_cast<long double>(sample.Denominator));
    }
  }
  const T* values = static_cast<const T*>(array.Data);
  Expected expected;
  expected.First =
    static_cast<long double>(values[weights.front().first * array.Components + component]);
  long double largest = 0.0L;
  long double farthest = 0.0L;
  for (const auto& [voxel, weight] : weights)
  {
    const auto value = static_cast<long double>(values[voxel * array.Components + component]);
    expected.Difference += weight * (value - expected.First);
    largest = std::max(largest, std::fabs(value));
    farthest = std::max(farthest, std::fabs(value - expected.First));
  }
  // If the differences of 64-bit integers from one of them are small, the kernels add up these
  // differences instead of the integers.
  const bool byDifferences = std::is_integral<T>::value && sizeof(T) == 8 && farthest < 0x1p57L;
  // Bounds the rounding errors of a few dozen operations on weights and sums.
  expected.Error =
    128.0L * std::numeric_limits<double>::epsilon() * (byDifferences ? farthest : largest);
  return expected;
}

template <typename T>
std::string CompareValue(const Expected& expected, T value)
{
  const auto low = static_cast<long double>(std::numeric_limits<T>::lowest());
  const auto high = static_cast<long double>(std::numeric_limits<T>::max());
  const long double clamped =
    std::min(std::max(expected.Difference, low - expected.First), high - expected.First);
  const long double rounding = std::is_integral<T>::value
    ? 0.5L
    : 0.51L * std::numeric_limits<T>::epsilon() * std::fabs(expected.First + clamped);
  if (std::fabs(static_cast<long double>(value) - expected.First - clamped) <=
    rounding + expected.Error)
  {
    return "";
  }
  std::ostringstream message;
  message << std::setprecision(20) << +value << " instead of " << expected.First << " + "
          << clamped;
  return message.str();
}

template <typename T>
std::string CompareBits(T value, T wanted)
{
  return std::memcmp(&value, &wanted, sizeof(T)) == 0
    ? ""
    : std::to_string(value) + " instead of the bits of " + std::to_string(wanted);
}

template <typename T>
void ExpectArray(const DeformerCase& deformerCase, const reference::Result& reference,
  const VolumeArray& array, int index, const Deformed& deformed)
{
  const T* output = deformed.GetOutput<T>(index);
  const T* input = static_cast<const T*>(array.Data);
  std::int64_t failures = 0;
  for (std::size_t voxel = 0; voxel < reference.Voxels.size(); ++voxel)
  {
    const auto& containing = reference.Voxels[voxel];
    for (int component = 0; component < array.Components; ++component)
    {
      const T value = output[voxel * array.Components + component];
      const auto getInput = [&](std::int64_t vertex)
      { return input[vertex * array.Components + component]; };
      std::string message = "covered";
      if (containing.empty())
      {
        message = CompareBits(value, static_cast<T>(array.Background));
      }
      // Any of the tetrahedra that share a face may write a sample on it. Their values differ only
      // if one of their cells is interpolated cubically and another one linearly.
      for (const reference::Containing& sample : containing)
      {
        if (message.empty() || !sample.SharesSimplex(containing.front()))
        {
          continue;
        }
        message = array.Categorical ? CompareBits(value, getInput(sample.GetNearestVertex()))
          : sample.GetSingleVertex() >= 0
          ? CompareBits(value, getInput(sample.GetSingleVertex()))
          : CompareValue<T>(Interpolate<T>(deformerCase, sample, array, component), value);
      }
      if (!message.empty() && ++failures <= 3)
      {
        ADD_FAILURE() << "array " << index << " voxel " << voxel << " component " << component
                      << ": " << message;
      }
    }
  }
  EXPECT_EQ(failures, 0) << "number of wrong values of array " << index;
}

} // namespace

bool IsCubicCell(const DeformerCase& deformerCase, std::int64_t cell)
{
  const std::array<std::int64_t, 3> size = GetSizes(deformerCase.VoxelGrid.VertexExtent);
  const std::array<std::int64_t, 3> place =
    GetPlace(cell, { { size[0] - 1, size[1] - 1, size[2] - 1 } });
  for (int axis = 0; axis < 3; ++axis)
  {
    if (place[axis] < 1 || place[axis] + 2 >= size[axis])
    {
      return false;
    }
  }
  for (int i = 0; i < 64; ++i)
  {
    const std::array<std::int64_t, 3> at{ { place[0] + i % 4 - 1, place[1] + i / 4 % 4 - 1,
      place[2] + i / 16 - 1 } };
    const auto voxel = static_cast<std::size_t>((at[2] * size[1] + at[1]) * size[0] + at[0]);
    if ((!deformerCase.Unlinked.empty() && deformerCase.Unlinked[voxel]) ||
      (!deformerCase.Blanked.empty() && deformerCase.Blanked[voxel]) ||
      (!deformerCase.Distances.empty() && deformerCase.Distances[voxel] < 0.0F))
    {
      return false;
    }
    if (i % 4 == 3 || i / 4 % 4 == 3 || i / 16 == 3)
    {
      continue; // not the first voxel of one of the 27 cells
    }
    const auto number =
      static_cast<std::size_t>((at[2] * (size[1] - 1) + at[1]) * (size[0] - 1) + at[0]);
    if ((!deformerCase.Active.empty() && (deformerCase.Active[number] & 31) != 31) ||
      (!deformerCase.Crossed.empty() && (deformerCase.Crossed[number] & 31) != 0))
    {
      return false;
    }
  }
  return true;
}

std::int64_t ExpectEqualsCubicReference(const DeformerCase& deformerCase,
  const reference::Result& reference, const std::vector<VolumeArray>& arrays,
  const Deformed& deformed)
{
  std::int64_t cubic = 0;
  std::int64_t wrong = 0;
  for (std::size_t voxel = 0; voxel < reference.Voxels.size(); ++voxel)
  {
    const auto& containing = reference.Voxels[voxel];
    wrong += (deformed.Coverage[voxel] != 0) != !containing.empty();
    cubic += !containing.empty() && IsCubicCell(deformerCase, containing.front().Cell);
  }
  EXPECT_EQ(wrong, 0) << "voxels with wrong coverage";
  for (std::size_t array = 0; array < arrays.size(); ++array)
  {
    switch (arrays[array].Type)
    {
#define COMPARE_CASE(name, type, cl)                                                               \
  case ElementType::name:                                                                          \
    ExpectArray<type>(deformerCase, reference, arrays[array], static_cast<int>(array), deformed);  \
    break;
      DEFORMVOLUME_ELEMENT_TYPES(COMPARE_CASE)
#undef COMPARE_CASE
    }
  }
  return cubic;
}
