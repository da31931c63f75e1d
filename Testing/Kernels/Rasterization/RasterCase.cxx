// SPDX-License-Identifier: BSD-3-Clause
#include "RasterCase.h"

#include "OutputPlace.h"

#include "RasterReference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

using namespace deformvolume;

namespace
{

using Map = std::function<glm::dvec3(const glm::dvec3&)>;

// Six tetrahedra around a diagonal of a cube. Corner numbers have bit 0 for x, bit 1 for y and bit
// 2 for z.
constexpr int Kuhn[6][4] = { { 0, 1, 3, 7 }, { 0, 3, 2, 7 }, { 0, 2, 6, 7 }, { 0, 6, 4, 7 },
  { 0, 4, 5, 7 }, { 0, 5, 1, 7 } };

template <typename T>
void ExpectValues(const RasterCase& c, const reference::RasterResult& reference,
  const VolumeArray& array, int index, const Deformed& deformed, bool cubic)
{
  const T* input = static_cast<const T*>(array.Data);
  const T* output = deformed.GetOutput<T>(index);
  long double largest = 0.0L;
  for (std::int64_t i = 0; i < c.GetNumberOfVoxels() * array.Components; ++i)
  {
    largest = std::max(largest, std::fabs(static_cast<long double>(input[i])));
  }
  int failures = 0;
  for (std::size_t voxel = 0; voxel < reference.Voxels.size() && failures < 4; ++voxel)
  {
    const reference::RasterVoxel& expected = reference.Voxels[voxel];
    if (!expected.Covered || expected.Uncertain)
    {
      continue;
    }
    const auto weights = reference::GetWeights(c.VoxelGrid.VertexExtent, expected.Rest, cubic);
    for (int component = 0; component < array.Components; ++component)
    {
      const T value = output[voxel * array.Components + component];
      if (array.Categorical)
      {
        // A label must be that of a voxel within half a voxel on every axis.
        bool found = false;
        for (std::int64_t corner = 0; corner < 8; ++corner)
        {
          std::array<std::int64_t, 3> at{};
          for (int axis = 0; axis < 3; ++axis)
          {
            at[axis] =
              std::llround(expected.Rest[axis] + ((corner >> axis & 1) != 0 ? 1e-5L : -1e-5L));
            at[axis] = std::min(
              std::max<std::int64_t>(at[axis], 0), GetSize(c.VoxelGrid.VertexExtent, axis) - 1);
          }
          found |= std::memcmp(&value,
                     &input[((at[2] * GetSize(c.VoxelGrid.VertexExtent, 1) + at[1]) *
                                GetSize(c.VoxelGrid.VertexExtent, 0) +
                              at[0]) *
                         array.Components +
                       component],
                     sizeof(T)) == 0;
        }
        failures += found ? 0 : 1;
        EXPECT_TRUE(found) << "the value is that of no containing tetrahedron: array " << index
                           << " voxel " << voxel;
        continue;
      }
      long double sum = 0.0L;
      for (const auto& weight : weights)
      {
        sum += weight.second *
          static_cast<long double>(input[weight.first * array.Components + component]);
      }
      if (std::is_integral<T>::value)
      {
        sum = std::min(std::max(sum, static_cast<long double>(std::numeric_limits<T>::lowest())),
          static_cast<long double>(std::numeric_limits<T>::max()));
      }
      const long double tolerance = 1e-5L * largest + (std::is_integral<T>::value ? 0.5L : 0.0L);
      const long double difference = std::fabs(static_cast<long double>(value) - sum);
      EXPECT_LE(difference, tolerance)
        << "array " << index << " voxel " << voxel << " of tetrahedron " << expected.Tetrahedron;
      failures += difference <= tolerance ? 0 : 1;
    }
  }
}

} // namespace

RasterCase MakeRasterCase(const VoxelGrid& voxelGrid, const glm::dvec3& low, const glm::dvec3& high,
  int cells, const Map& deformation, int margin)
{
  RasterCase made;
  made.VoxelGrid = voxelGrid;
  glm::dvec3 least(1e9);
  glm::dvec3 most(-1e9);
  const int nodes = cells + 1;
  for (int z = 0; z < nodes; ++z)
  {
    for (int y = 0; y < nodes; ++y)
    {
      for (int x = 0; x < nodes; ++x)
      {
        const glm::dvec3 rest = low + (high - low) * glm::dvec3(x, y, z) / double(cells);
        const glm::dvec3 moved = deformation(rest);
        made.RestNodes.push_back(rest);
        for (int axis = 0; axis < 3; ++axis)
        {
          made.Displacements.push_back(
            static_cast<float>((moved - PlaceInOutput(voxelGrid.ToOutput, rest))[axis]));
        }
        least = glm::min(least, moved);
        most = glm::max(most, moved);
        if (x < cells && y < cells && z < cells)
        {
          for (const auto& corners : Kuhn)
          {
            Tetrahedron tetrahedron{};
            for (int k = 0; k < 4; ++k)
            {
              const int v = corners[k];
              tetrahedron[k] = ((z + (v >> 2)) * nodes + y + (v >> 1 & 1)) * nodes + x + (v & 1);
            }
            made.Tetrahedra.push_back(tetrahedron);
          }
        }
      }
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    made.Output[2 * axis] = static_cast<int>(std::floor(least[axis])) - margin;
    made.Output[2 * axis + 1] = static_cast<int>(std::ceil(most[axis])) + margin;
  }
  return made;
}

RasterCase MakeRasterCase(
  const Extent& extent, int cells, const Map& deformation, const OutputMap& toOutput)
{
  return MakeRasterCase({ extent, toOutput, {} }, glm::dvec3(extent[0], extent[2], extent[4]),
    glm::dvec3(extent[1], extent[3], extent[5]), cells, deformation);
}

void Load(VolumeDeformer& deformer, const RasterCase& c, const std::vector<VolumeArray>& arrays)
{
  deformer.SetDevice("");
  deformer.SetVoxelGrid(c.VoxelGrid);
  deformer.SetArrays(arrays);
  deformer.SetBlanked(c.Blanked.empty() ? nullptr : c.Blanked.data());
  deformer.SetActiveTetrahedra(c.Active.empty() ? nullptr : c.Active.data());
  deformer.SetRestMesh(
    c.Tetrahedra.data(), c.Tetrahedra.size(), c.RestNodes.size(), &c.RestNodes.front().x);
  deformer.SetNodeDisplacements(c.Displacements.data());
}

Deformed Rasterize(VolumeDeformer& deformer, const RasterCase& c,
  const std::vector<VolumeArray>& arrays, Interpolation interpolation)
{
  DeformerCase output;
  output.Output = c.Output;
  return RunDeformer(deformer, output, arrays, Resampling::MeshRasterization, interpolation);
}

Deformed LoadAndRun(
  const RasterCase& c, const std::vector<VolumeArray>& arrays, Interpolation interpolation)
{
  VolumeDeformer deformer;
  Load(deformer, c, arrays);
  return Rasterize(deformer, c, arrays, interpolation);
}

void ExpectEqualsReference(const RasterCase& c, const std::vector<VolumeArray>& arrays,
  const Deformed& deformed, Interpolation interpolation)
{
  const bool cubic = interpolation == Interpolation::Cubic;
  const reference::RasterResult reference = reference::Rasterize(c, cubic);
  std::int64_t covered = 0;
  std::int64_t uncertain = 0;
  std::int64_t wrong = 0;
  for (std::size_t voxel = 0; voxel < reference.Voxels.size(); ++voxel)
  {
    covered += deformed.Coverage[voxel];
    uncertain += reference.Voxels[voxel].Uncertain;
    wrong += !reference.Voxels[voxel].Uncertain &&
      deformed.Coverage[voxel] != (reference.Voxels[voxel].Covered ? 1 : 0);
  }
  EXPECT_EQ(wrong, 0) << "voxels whose coverage is wrong, of " << reference.Voxels.size();
  EXPECT_LT(uncertain, static_cast<std::int64_t>(reference.Voxels.size()) / 20 + 1);
  EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, covered);
  EXPECT_EQ(deformed.Report.NumberOfInvertedTetrahedra, reference.NumberOfInvertedTetrahedra);
  if (reference.NumberOfOverlappedVoxels > 0 || reference.NumberOfInvertedTetrahedra == 0)
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
    ExpectValues<type>(c, reference, arrays[array], index, deformed, cubic);                       \
    break;
      DEFORMVOLUME_ELEMENT_TYPES(COMPARE_CASE)
#undef COMPARE_CASE
    }
  }
}
