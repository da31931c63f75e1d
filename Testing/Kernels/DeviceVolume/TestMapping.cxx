// SPDX-License-Identifier: BSD-3-Clause
// The deformation mapping: meshes with links, displacement fields.
#include "DeformerCase.h"

#include <gtest/gtest.h>

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

using namespace deformvolume;

namespace
{

/// first: the first structured index, an even number. Large indices do not fit into a float.
void TestFieldOfHalfTheResolution(int first)
{
  const Extent extent{ { first - 2, first + 8, first + 1, first + 9, first, first + 10 } };
  std::mt19937 random(6);
  std::uniform_int_distribution<int> uniform(-5, 5);
  DisplacementField field;
  field.Dimensions = { { 6, 5, 6 } };
  const double begin = -0.5 * first;
  field.IndexToField = { { 0.5, 0, 0, begin + 1, 0, 0.5, 0, begin - 0.5, 0, 0, 0.5, begin } };
  // Integer multiples of 8/256 voxel: means of two, four and eight are exact.
  std::vector<int> units(3 * 6 * 5 * 6);
  std::generate(units.begin(), units.end(), [&] { return uniform(random); });
  std::vector<float> vectors;
  for (const int unit : units)
  {
    vectors.push_back(static_cast<float>(unit) / 32.0F);
  }
  field.Vectors = vectors.data();
  DeformerCase refined = MakeCase(extent, NoScale,
    [&](const glm::dvec3& index)
    {
      glm::dvec3 moved = index;
      for (int axis = 0; axis < 3; ++axis)
      {
        double sum = 0.0;
        for (int corner = 0; corner < 8; ++corner)
        {
          glm::ivec3 c;
          for (int i = 0; i < 3; ++i)
          {
            const int doubled = static_cast<int>(index[i]) - extent[2 * i];
            c[i] = (doubled + (corner >> i & 1)) / 2;
          }
          sum += units[3 * ((c.z * 5 + c.y) * 6 + c.x) + axis];
        }
        moved[axis] += sum / 8.0 / 32.0;
      }
      return moved;
    });
  const reference::Result reference = ResampleByReference(refined);
  ExpectEmbedding(reference);
  const auto values = MakeRandomValues<float>(refined.GetNumberOfVoxels(), 7);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  VolumeDeformer deformer;
  Load(deformer, refined, arrays, Route::Field);
  deformer.SetDisplacementField(field);
  ExpectEqualsReference(refined, reference, arrays, RunDeformer(deformer, refined, arrays));
}

} // namespace

TEST(Mapping, FieldOfHalfTheResolution)
{
  TestFieldOfHalfTheResolution(0);
}

TEST(Mapping, FieldOfHalfTheResolutionFarFromTheFirstIndex)
{
  TestFieldOfHalfTheResolution(300000);
}

TEST(Mapping, VoxelsOutsideTheField)
{
  const Extent extent{ { 0, 9, 0, 8, 0, 7 } };
  DisplacementField field;
  field.Dimensions = { { 5, 4, 4 } };
  field.IndexToField = { { 1, 0, 0, -3, 0, 1, 0, -2, 0, 0, 1, -2 } };
  const auto jitter = MakeRandomValues<std::int8_t>(3 * 5 * 4 * 4, 9);
  std::vector<float> vectors;
  for (const std::int8_t unit : jitter)
  {
    vectors.push_back(static_cast<float>(unit / 4) / 256.0F);
  }
  field.Vectors = vectors.data();
  DeformerCase partial = MakeCase(extent, NoScale,
    [&](const glm::dvec3& index)
    {
      const int x = std::clamp(static_cast<int>(index.x) - 3, 0, 4);
      const int y = std::clamp(static_cast<int>(index.y) - 2, 0, 3);
      const int z = std::clamp(static_cast<int>(index.z) - 2, 0, 3);
      const std::int8_t* units = &jitter[3 * ((z * 4 + y) * 5 + x)];
      return index + glm::dvec3(units[0] / 4, units[1] / 4, units[2] / 4) / 256.0;
    });
  const auto values = MakeRandomValues<std::int16_t>(partial.GetNumberOfVoxels(), 7);
  const std::vector<VolumeArray> arrays{ MakeArray(values, 1, false, -1.0) };
  VolumeDeformer deformer;
  Load(deformer, partial, arrays, Route::Field);
  field.Extrapolate = true;
  deformer.SetDisplacementField(field);
  {
    SCOPED_TRACE("voxels outside the field are extrapolated");
    ExpectEqualsReference(
      partial, ResampleByReference(partial), arrays, RunDeformer(deformer, partial, arrays));
  }
  field.Extrapolate = false;
  deformer.SetDisplacementField(field);
  for (int z = 0; z <= 7; ++z)
  {
    for (int y = 0; y <= 8; ++y)
    {
      for (int x = 0; x <= 9; ++x)
      {
        partial.Unlinked.push_back(x < 3 || x > 7 || y < 2 || y > 5 || z < 2 || z > 5);
      }
    }
  }
  SCOPED_TRACE("voxels outside the field are discarded");
  const reference::Result reference = ResampleByReference(partial);
  EXPECT_LT(reference.NumberOfCoveredVoxels, 5 * 4 * 4 + 1);
  ExpectEqualsReference(partial, reference, arrays, RunDeformer(deformer, partial, arrays));
}

TEST(Mapping, FieldOfOnePointMovesEverything)
{
  DisplacementField field;
  field.Dimensions = { { 1, 1, 1 } };
  const std::array<float, 3> vector{ { 2.5F, -1.0F, 0.25F } };
  field.Vectors = vector.data();
  field.Extrapolate = true;
  const DeformerCase moved = MakeCase({ { 0, 4, 0, 4, 0, 4 } }, NoScale,
    [](const glm::dvec3& index) { return index + glm::dvec3(2.5, -1.0, 0.25); });
  const auto values = MakeRandomValues<float>(moved.GetNumberOfVoxels(), 7);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  VolumeDeformer deformer;
  Load(deformer, moved, arrays, Route::Field);
  deformer.SetDisplacementField(field);
  ExpectEqualsReference(
    moved, ResampleByReference(moved), arrays, RunDeformer(deformer, moved, arrays));
}

TEST(Mapping, BarycentricWeightsOfAllFourNodes)
{
  // Weights and displacements that are exact in floats: each voxel has the mean of four nodes.
  const Extent extent{ { 0, 5, 0, 6, 0, 7 } };
  const auto units = MakeRandomValues<std::int8_t>(3 * 50, 12);
  std::mt19937 random(13);
  std::vector<Tetrahedron> tetrahedra(30);
  for (Tetrahedron& tetrahedron : tetrahedra)
  {
    for (std::int32_t& node : tetrahedron)
    {
      node = static_cast<std::int32_t>(random() % 50);
    }
  }
  std::vector<float> displacements;
  for (const std::int8_t unit : units)
  {
    // Multiples of 1/32 voxel: an eighth of them is a multiple of 1/256.
    displacements.push_back(static_cast<float>(unit / 25) / 32.0F);
  }
  DeformerCase linked;
  std::vector<VertexLink> links;
  linked = MakeCase(extent, NoScale,
    [&](const glm::dvec3& index)
    {
      const std::array<std::array<int, 4>, 4> kinds{ { { { 2, 2, 2, 2 } }, { { 1, 4, 2, 1 } },
        { { 0, 0, 0, 8 } }, { { 3, 0, 4, 1 } } } };
      const std::array<int, 4>& eighths = kinds[random() % 4];
      VertexLink link;
      link.Tetrahedron = static_cast<std::int32_t>(random() % 30);
      glm::dvec3 moved = index;
      for (int k = 0; k < 4; ++k)
      {
        if (k < 3)
        {
          link.Weights[k] = static_cast<float>(eighths[k]) / 8.0F;
        }
        for (int axis = 0; axis < 3; ++axis)
        {
          moved[axis] +=
            eighths[k] / 8.0 * displacements[3 * tetrahedra[link.Tetrahedron][k] + axis];
        }
      }
      links.push_back(link);
      return moved;
    });
  const reference::Result reference = ResampleByReference(linked);
  const auto values = MakeRandomValues<float>(linked.GetNumberOfVoxels(), 7);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  VolumeDeformer deformer;
  Load(deformer, linked, arrays, Route::Field);
  deformer.SetMesh(tetrahedra.data(), tetrahedra.size(), 50, links.data());
  deformer.SetNodeDisplacements(displacements.data());
  ExpectEqualsReference(linked, reference, arrays, RunDeformer(deformer, linked, arrays));
}
