// SPDX-License-Identifier: BSD-3-Clause
#include "DeformerCase.h"

#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <limits>
#include <sstream>
#include <type_traits>

using namespace deformvolume;

namespace
{

constexpr unsigned char GuardByte = 0xA5;
constexpr std::size_t GuardBytes = 64;

reference::Position GetRestPosition(const VoxelGrid& voxelGrid, int x, int y, int z)
{
  const std::array<int, 3> index{ { x, y, z } };
  reference::Position position{};
  for (int axis = 0; axis < 3; ++axis)
  {
    double exact = 256.0 * voxelGrid.ToOutput.Shift[axis];
    for (int column = 0; column < 3; ++column)
    {
      exact += 256.0 * voxelGrid.ToOutput.Get(axis, column) * index[column];
    }
    position[axis] = std::llround(exact);
    EXPECT_EQ(static_cast<double>(position[axis]), exact)
      << "the scale of the test makes positions inexact";
  }
  return position;
}

/// Converts a background as the deformer must: clamped to the range of the type.
template <typename T>
T ClampTo(double value)
{
  if constexpr (std::is_integral<T>::value)
  {
    if (value <= static_cast<double>(std::numeric_limits<T>::lowest()))
    {
      return std::numeric_limits<T>::lowest();
    }
    if (value >= static_cast<double>(std::numeric_limits<T>::max()))
    {
      return std::numeric_limits<T>::max();
    }
    return static_cast<T>(std::nearbyint(value));
  }
  return static_cast<T>(value);
}

/// Whether the values of an array may have been interpolated in single precision: by the kernel for
/// CPUs, or because the device has no double precision.
bool MayBeSinglePrecision(const VolumeArray& array, Resampling method)
{
  static const bool hasDouble = HasDoublePrecision();
  if (!hasDouble)
  {
    return !array.Categorical;
  }
  return method != Resampling::ExactByCell && !array.Categorical && array.Components == 1 &&
    (array.Type == ElementType::Float32 || GetElementSize(array.Type) <= 2);
}

/// The error of single precision, as a fraction of the largest value of the array. The error of a
/// weight is 2^-24 times a factor for the shape of the cell, which is more than a hundred in these
/// tests.
constexpr long double SinglePrecision = 1e-5L;

template <typename T>
long double GetLargest(const VolumeArray& array, std::int64_t voxels)
{
  long double largest = 0.0L;
  const T* values = static_cast<const T*>(array.Data);
  for (std::int64_t i = 0; i < voxels * array.Components; ++i)
  {
    const long double value = std::fabs(static_cast<long double>(values[i]));
    largest = std::isfinite(value) ? std::max(largest, value) : largest;
  }
  return largest;
}

/// Returns an empty text if value is right for a sample in this tetrahedron, otherwise the fault.
/// slack: an error that is allowed in addition to that of double precision.
template <typename T>
std::string CompareValue(const reference::Containing& winner, const VolumeArray& array,
  int component, T value, long double slack)
{
  const T* input = static_cast<const T*>(array.Data);
  const std::int64_t exact =
    array.Categorical ? winner.GetNearestVertex() : winner.GetSingleVertex();
  std::ostringstream message;
  if (exact >= 0)
  {
    const T source = input[exact * array.Components + component];
    if (std::memcmp(&source, &value, sizeof(T)) != 0)
    {
      message << +value << " instead of the bits of "
              << +input[exact * array.Components + component];
    }
    return message.str();
  }
  const long double expected = winner.Interpolate(input, array.Components, component);
  const long double magnitude = winner.Magnitude(input, array.Components, component);
  long double tolerance = 0.0L;
  long double difference = std::fabs(static_cast<long double>(value) - expected);
  if constexpr (std::is_floating_point<T>::value)
  {
    if (!std::isfinite(expected) || !std::isfinite(magnitude))
    {
      const bool same =
        std::isnan(expected) ? std::isnan(value) : static_cast<long double>(value) == expected;
      return same ? "" : std::to_string(value) + " instead of a value that is not finite";
    }
    // Half a unit in the last place of the result, and the error of a sum in double precision.
    tolerance = std::numeric_limits<T>::epsilon() * std::fabs(expected) * 0.51L +
      std::numeric_limits<double>::epsilon() * 4.0L * magnitude +
      std::numeric_limits<T>::denorm_min();
  }
  else if constexpr (sizeof(T) == 8)
  {
    long double largest = 0.0L;
    for (int k = 0; k < 4; ++k)
    {
      largest = std::max(largest,
        std::fabs(
          static_cast<long double>(input[winner.Vertices[k] * array.Components + component])));
    }
    tolerance = 0.5L + std::numeric_limits<double>::epsilon() * 4.0L * largest;
  }
  else
  {
    // Rounding to nearest. The slack allows for the error of a sum in double precision near one
    // half.
    tolerance = 0.5L + std::numeric_limits<double>::epsilon() * 8.0L * magnitude;
  }
  if (!(difference <= tolerance + slack))
  {
    message << std::setprecision(20) << +value << " instead of " << expected;
  }
  return message.str();
}

template <typename T>
void ExpectArrayEqualsReference(const reference::Result& reference, const VolumeArray& array,
  int index, const Deformed& deformed, std::int64_t inputVoxels)
{
  const long double slack = MayBeSinglePrecision(array, deformed.Method)
    ? SinglePrecision * GetLargest<T>(array, inputVoxels)
    : 0.0L;
  const T* output = deformed.GetOutput<T>(index);
  const T background = ClampTo<T>(array.Background);
  std::int64_t failures = 0;
  for (std::size_t voxel = 0; voxel < reference.Voxels.size(); ++voxel)
  {
    const auto& containing = reference.Voxels[voxel];
    for (int component = 0; component < array.Components; ++component)
    {
      const T value = output[voxel * array.Components + component];
      std::string message;
      if (containing.empty())
      {
        if (std::memcmp(&value, &background, sizeof(T)) != 0)
        {
          message = "expected the background value";
        }
      }
      else
      {
        message = CompareValue<T>(containing.front(), array, component, value, slack);
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

DeformerCase MakeCase(const Extent& extent, const OutputMap& toOutput,
  const std::function<glm::dvec3(const glm::dvec3&)>& deformation, int margin)
{
  DeformerCase made;
  made.VoxelGrid.VertexExtent = extent;
  made.VoxelGrid.ToOutput = toOutput;
  made.Displacements.reserve(GetNumberOfPoints(extent));
  std::array<std::int64_t, 3> low{};
  std::array<std::int64_t, 3> high{};
  low.fill(std::numeric_limits<std::int64_t>::max());
  high.fill(std::numeric_limits<std::int64_t>::lowest());
  ForEachPoint(extent,
    [&](int x, int y, int z)
    {
      const glm::dvec3 moved = deformation(glm::dvec3(x, y, z));
      const reference::Position rest = GetRestPosition(made.VoxelGrid, x, y, z);
      reference::Position displacement{};
      for (int axis = 0; axis < 3; ++axis)
      {
        const std::int64_t position = std::llround(256.0 * moved[axis]);
        displacement[axis] = position - rest[axis];
        low[axis] = std::min(low[axis], position);
        high[axis] = std::max(high[axis], position);
      }
      made.Displacements.push_back(displacement);
    });
  for (int axis = 0; axis < 3; ++axis)
  {
    made.Output[2 * axis] = static_cast<int>(std::floor(low[axis] / 256.0)) - margin;
    made.Output[2 * axis + 1] = static_cast<int>(std::ceil(high[axis] / 256.0)) + margin;
  }
  return made;
}

namespace
{

glm::dvec3 GetPoint(const Extent& extent, std::int64_t i)
{
  const std::int64_t x = GetSize(extent, 0);
  const std::int64_t y = GetSize(extent, 1);
  return glm::dvec3(extent[0] + i % x, extent[2] + i / x % y, extent[4] + i / (x * y));
}

} // namespace

void CutAtRandom(DeformerCase& made, unsigned int seed, unsigned int every)
{
  std::mt19937 random(seed);
  made.CutDistances.resize(made.GetNumberOfVoxels());
  for (float& distance : made.CutDistances)
  {
    distance = (static_cast<float>(random() % 65) - 32.0F) / 16.0F;
  }
  made.Crossed.assign(GetNumberOfCells(made.VoxelGrid.VertexExtent), 0);
  for (unsigned char& cell : made.Crossed)
  {
    cell = random() % every == 0 ? static_cast<unsigned char>(random() % 32) : 0;
  }
}

void CutAlong(DeformerCase& made, const std::function<double(const glm::dvec3&)>& distance,
  const std::function<bool(const glm::dvec3&)>& isWanted)
{
  const Extent& extent = made.VoxelGrid.VertexExtent;
  made.CutDistances.clear();
  for (std::int64_t i = 0; i < made.GetNumberOfVoxels(); ++i)
  {
    made.CutDistances.push_back(static_cast<float>(distance(GetPoint(extent, i))));
  }
  Extent cells = extent;
  for (int axis = 0; axis < 3; ++axis)
  {
    --cells[2 * axis + 1];
  }
  made.Crossed.clear();
  for (std::int64_t i = 0; i < GetNumberOfPoints(cells); ++i)
  {
    const glm::dvec3 first = GetPoint(cells, i);
    double low = 1e9;
    double high = -1e9;
    for (int corner = 0; corner < 8; ++corner)
    {
      const double d = distance(first + glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2));
      low = std::min(low, d);
      high = std::max(high, d);
    }
    made.Crossed.push_back(low < 0.0 && high >= 0.0 && isWanted(first) ? 31 : 0);
  }
}

reference::Result ResampleByReference(const DeformerCase& deformerCase)
{
  reference::SamplingMesh mesh;
  mesh.Voxels = deformerCase.VoxelGrid.VertexExtent;
  mesh.Active = deformerCase.Active;
  mesh.Distances = deformerCase.Distances;
  mesh.Crossed = deformerCase.Crossed;
  mesh.CutDistances = deformerCase.CutDistances;
  mesh.Displacements = deformerCase.Displacements;
  mesh.IsMirrored = deformerCase.VoxelGrid.ToOutput.GetDeterminant() < 0.0;
  std::size_t voxel = 0;
  ForEachPoint(mesh.Voxels,
    [&](int x, int y, int z)
    {
      reference::Position position = GetRestPosition(deformerCase.VoxelGrid, x, y, z);
      for (int axis = 0; axis < 3; ++axis)
      {
        position[axis] += deformerCase.Displacements[voxel][axis];
      }
      mesh.Positions.push_back(position);
      mesh.Present.push_back((deformerCase.Unlinked.empty() || !deformerCase.Unlinked[voxel]) &&
        (deformerCase.Blanked.empty() || deformerCase.Blanked[voxel] == 0));
      ++voxel;
    });
  return reference::Resample(mesh, deformerCase.Output);
}

std::vector<float> DeformerCase::GetDisplacements() const
{
  std::vector<float> displacements;
  displacements.reserve(3 * this->Displacements.size());
  for (const reference::Position& displacement : this->Displacements)
  {
    for (const std::int64_t component : displacement)
    {
      displacements.push_back(static_cast<float>(component) / 256.0F);
    }
  }
  return displacements;
}

void MoveByField(VolumeDeformer& deformer, const DeformerCase& deformerCase)
{
  ASSERT_TRUE(deformerCase.Unlinked.empty())
    << "a field with a point at each voxel links all voxels";
  const std::vector<float> displacements = deformerCase.GetDisplacements();
  DisplacementField field;
  for (int axis = 0; axis < 3; ++axis)
  {
    field.Dimensions[axis] = static_cast<int>(GetSize(deformerCase.VoxelGrid.VertexExtent, axis));
    field.IndexToField[4 * axis + 3] = -deformerCase.VoxelGrid.VertexExtent[2 * axis];
  }
  field.Vectors = displacements.data();
  deformer.SetDisplacementField(field);
}

void Load(VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<VolumeArray>& arrays, Route route)
{
  const std::size_t size = deformerCase.GetNumberOfVoxels();
  deformer.SetDevice("");
  deformer.SetVoxelGrid(deformerCase.VoxelGrid);
  deformer.SetArrays(arrays);
  deformer.SetBlanked(deformerCase.Blanked.empty() ? nullptr : deformerCase.Blanked.data());
  deformer.SetActiveTetrahedra(deformerCase.Active.empty() ? nullptr : deformerCase.Active.data());
  deformer.SetBoundaryDistances(
    deformerCase.Distances.empty() ? nullptr : deformerCase.Distances.data());
  deformer.SetCut(deformerCase.Crossed.empty() ? nullptr : deformerCase.Crossed.data(),
    deformerCase.Crossed.empty() ? nullptr : deformerCase.CutDistances.data());
  if (route == Route::Field)
  {
    MoveByField(deformer, deformerCase);
    return;
  }
  std::vector<Tetrahedron> tetrahedra(size);
  std::vector<VertexLink> links(size);
  for (std::size_t voxel = 0; voxel < size; ++voxel)
  {
    const int corner = GetCorner(static_cast<std::int64_t>(voxel));
    for (int k = 0; k < 4; ++k)
    {
      tetrahedra[voxel][k] = static_cast<std::int32_t>((voxel + size + k - corner) % size);
    }
    const bool unlinked = !deformerCase.Unlinked.empty() && deformerCase.Unlinked[voxel];
    links[voxel].Tetrahedron = unlinked ? -1 : static_cast<std::int32_t>(voxel);
    if (corner < 3)
    {
      links[voxel].Weights[corner] = 1.0F;
    }
  }
  if (route == Route::Runs)
  {
    deformer.SetMesh(tetrahedra.data(), size, size, MakeRuns(deformerCase));
  }
  else
  {
    deformer.SetMesh(tetrahedra.data(), size, size, links.data());
  }
  deformer.SetNodeDisplacements(deformerCase.GetDisplacements().data());
}

Deformed RunDeformer(VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<VolumeArray>& arrays, Resampling method, Interpolation interpolation)
{
  const std::size_t voxels = GetNumberOfPoints(deformerCase.Output);
  Deformed deformed;
  deformed.Method = method;
  DeformRequest request;
  request.Method = method;
  request.Interpolation = interpolation;
  request.OutputExtent = deformerCase.Output;
  std::vector<std::size_t> sizes;
  for (const VolumeArray& array : arrays)
  {
    sizes.push_back(voxels * array.Components * GetElementSize(array.Type));
    deformed.Outputs.emplace_back(sizes.back() + GuardBytes, GuardByte);
  }
  for (auto& output : deformed.Outputs)
  {
    request.Outputs.push_back(output.data());
  }
  deformed.Coverage.assign(voxels + GuardBytes, 77);
  request.Coverage = deformed.Coverage.data();
  deformed.Report = deformer.Deform(request);
  for (std::size_t array = 0; array < arrays.size(); ++array)
  {
    const auto& output = deformed.Outputs[array];
    EXPECT_TRUE(std::all_of(output.begin() + sizes[array], output.end(),
      [](unsigned char byte) { return byte == GuardByte; }))
      << "written past the end of array " << array;
    deformed.Outputs[array].resize(sizes[array]);
  }
  EXPECT_TRUE(std::all_of(deformed.Coverage.begin() + voxels, deformed.Coverage.end(),
    [](signed char byte) { return byte == 77; }))
    << "written past the end of the coverage";
  deformed.Coverage.resize(voxels);
  return deformed;
}

Deformed LoadAndRun(
  const DeformerCase& deformerCase, const std::vector<VolumeArray>& arrays, Route route)
{
  VolumeDeformer deformer;
  Load(deformer, deformerCase, arrays, route);
  Deformed deformed = RunDeformer(deformer, deformerCase, arrays);
  deformed.ByCell = std::make_shared<Deformed>(
    RunDeformer(deformer, deformerCase, arrays, Resampling::ExactByCell));
  deformed.ByColumns = std::make_shared<Deformed>(
    RunDeformer(deformer, deformerCase, arrays, Resampling::ExactByColumns));
  return deformed;
}

void ExpectEqualsReference(const DeformerCase& deformerCase, const reference::Result& reference,
  const std::vector<VolumeArray>& arrays, const Deformed& deformed)
{
  ASSERT_EQ(
    static_cast<std::int64_t>(reference.Voxels.size()), GetNumberOfPoints(deformerCase.Output));
  std::int64_t holes = 0;
  std::int64_t extra = 0;
  std::int64_t other = 0;
  for (std::size_t voxel = 0; voxel < reference.Voxels.size(); ++voxel)
  {
    const bool covered = !reference.Voxels[voxel].empty();
    const int mark = deformed.Coverage[voxel];
    holes += covered && mark == 0 ? 1 : 0;
    extra += !covered && mark == 1 ? 1 : 0;
    other += mark != 0 && mark != 1 ? 1 : 0;
  }
  EXPECT_EQ(holes, 0) << "voxels in a tetrahedron that are not covered";
  EXPECT_EQ(extra, 0) << "covered voxels that are in no tetrahedron";
  EXPECT_EQ(other, 0) << "voxels whose coverage is neither 0 nor 1";
  EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, reference.NumberOfCoveredVoxels);
  EXPECT_EQ(deformed.Report.NumberOfInvertedTetrahedra, reference.NumberOfInvertedTetrahedra);
  // Without overlap every covered voxel has been written once: the deformer compares the number of
  // its writes with the number of covered voxels.
  if (reference.NumberOfOverlappedVoxels > 0 || reference.NumberOfTouchedVoxels == 0)
  {
    EXPECT_EQ(deformed.Report.Overlapping, reference.NumberOfOverlappedVoxels > 0);
  }
  for (std::size_t array = 0; array < arrays.size(); ++array)
  {
    const int index = static_cast<int>(array);
    switch (arrays[array].Type)
    {
#define COMPARE_CASE(name, type, cl)                                                               \
  case ElementType::name:                                                                          \
    ExpectArrayEqualsReference<type>(                                                              \
      reference, arrays[array], index, deformed, deformerCase.GetNumberOfVoxels());                \
    break;
      DEFORMVOLUME_ELEMENT_TYPES(COMPARE_CASE)
#undef COMPARE_CASE
    }
  }
  if (deformed.ByColumns)
  {
    SCOPED_TRACE("Resampling::ExactByColumns");
    ExpectEqualsReference(deformerCase, reference, arrays, *deformed.ByColumns);
    if (HasVectors())
    {
      for (std::size_t array = 0; array < arrays.size(); ++array)
      {
        EXPECT_TRUE(deformed.Outputs[array] == deformed.ByColumns->Outputs[array])
          << "array " << array << " differs between ExactByLanes and ExactByColumns";
      }
    }
  }
  if (deformed.ByCell)
  {
    SCOPED_TRACE("Resampling::ExactByCell");
    ExpectEqualsReference(deformerCase, reference, arrays, *deformed.ByCell);
  }
}

void ExpectEmbedding(const reference::Result& reference)
{
  ASSERT_EQ(reference.NumberOfInvertedTetrahedra, 0)
    << "the deformation that this test chooses must not invert tetrahedra";
  ASSERT_EQ(reference.NumberOfTouchedVoxels, 0)
    << "the deformation that this test chooses must not make separate parts touch";
}

UsualArrays::UsualArrays(std::size_t voxels)
  : Shorts(MakeRandomValues<std::int16_t>(voxels, 4))
  , Floats(MakeRandomValues<float>(voxels, 5))
  , Labels(MakeRandomValues<std::uint16_t>(2 * voxels, 3))
{
}

std::vector<VolumeArray> UsualArrays::Get() const
{
  return { MakeArray(this->Shorts), MakeArray(this->Floats, 1, false, 2.0),
    MakeArray(this->Labels, 2, true, 12.0) };
}

template <typename T>
std::vector<T> MakeRandomValues(std::size_t size, unsigned int seed)
{
  std::mt19937_64 random(seed);
  std::vector<T> values(size);
  for (T& value : values)
  {
    if constexpr (std::is_integral<T>::value)
    {
      value = static_cast<T>(random());
    }
    else
    {
      value = static_cast<T>(std::uniform_real_distribution<double>(-1000.0, 1000.0)(random));
    }
  }
  return values;
}

template <typename T>
std::vector<T> MakeRandomBits(std::size_t size, unsigned int seed)
{
  std::mt19937_64 random(seed);
  using Limits = std::numeric_limits<T>;
  std::vector<T> special{ T(0), T(1), Limits::lowest(), Limits::max(), Limits::min() };
  if constexpr (std::is_floating_point<T>::value)
  {
    special.insert(special.end(),
      { T(-0.0), Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(),
        Limits::denorm_min() });
  }
  std::vector<T> values(size);
  for (T& value : values)
  {
    const std::uint64_t bits = random();
    if (bits % 4 == 0)
    {
      value = special[(bits >> 8) % special.size()];
    }
    else if constexpr (std::is_integral<T>::value)
    {
      value = static_cast<T>(bits >> 3);
    }
    else
    {
      value = static_cast<T>(std::uniform_real_distribution<double>(-1e30, 1e30)(random));
    }
  }
  return values;
}

#define INSTANTIATE(name, type, cl)                                                                \
  template std::vector<type> MakeRandomValues<type>(std::size_t, unsigned int);                    \
  template std::vector<type> MakeRandomBits<type>(std::size_t, unsigned int);
DEFORMVOLUME_ELEMENT_TYPES(INSTANTIATE)
#undef INSTANTIATE

glm::dmat3 MakeRandomMatrix(std::mt19937& random, double distortion)
{
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (;;)
  {
    const glm::dvec3 axis(uniform(random), uniform(random), uniform(random));
    glm::dmat3 matrix(glm::rotate(glm::dmat4(1.0), 3.1 * uniform(random), axis));
    for (int column = 0; column < 3; ++column)
    {
      for (int row = 0; row < 3; ++row)
      {
        matrix[column][row] += distortion * uniform(random);
      }
    }
    if (glm::determinant(matrix) > 0.3)
    {
      return matrix;
    }
  }
}

std::function<glm::dvec3(const glm::dvec3&)> MakeJitter(unsigned int seed, double amplitude)
{
  return [random = std::mt19937(seed), amplitude](const glm::dvec3& index) mutable
  {
    std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
    const double x = uniform(random);
    const double y = uniform(random);
    return index + glm::dvec3(x, y, uniform(random));
  };
}
