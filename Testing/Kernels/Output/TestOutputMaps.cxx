// SPDX-License-Identifier: BSD-3-Clause
// Outputs whose grid is rotated, scaled, shifted or mirrored relative to the grid of the volume
// (VoxelGrid::ToOutput), for all kernels, mappings and resamplers.
#include "CaughtError.h"
#include "DeviceNeeds.h"
#include "EditedVolume.h"
#include "OutputPlace.h"
#include "RasterCase.h"
#include "TightMesh.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

using namespace deformvolume;

namespace
{

OutputMap MakeMap(const std::array<double, 9>& matrix, const std::array<double, 3>& shift)
{
  OutputMap map;
  map.Matrix = matrix;
  map.Shift = shift;
  return map;
}

/// Maps whose numbers are multiples of 1/256: the positions are the same in the reference.
const OutputMap Identity;
const OutputMap Mirror = MakeMap({ { -1, 0, 0, 0, 1, 0, 0, 0, 1 } }, { { 20, -3, 0.5 } });
const OutputMap LeftHanded = MakeMap({ { -1, 0, 0, 0, -1.25, 0, 0, 0, -0.75 } }, { { 2, 7, 1 } });
const OutputMap Permuted = MakeMap({ { 0, 0, 1, 1, 0, 0, 0, 1, 0 } }, { { 0, 4, 0 } });
const OutputMap Exchanged = MakeMap({ { 0, 1, 0, 1, 0, 0, 0, 0, 1 } }, { { 0, 0, 0 } });
const OutputMap Turned =
  MakeMap({ { 0.75, -0.625, 0.25, 0.5, 1, -0.375, 0.125, 0.25, 1.125 } }, { { 3.25, 40, -11.5 } });
const OutputMap TurnedMirror =
  MakeMap({ { 0.75, -0.625, 0.25, -0.5, -1, 0.375, 0.125, 0.25, 1.125 } }, { { 3.25, 40, -11.5 } });

/// A rotation with unequal spacings, perhaps mirrored on z. Its numbers are not multiples of 1/256.
OutputMap MakeTurnedMap(const glm::dvec3& center, bool isMirrored, double scale = 1.0)
{
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.6, glm::dvec3(0.3, 0.5, 0.81));
  const glm::dvec3 spacing = scale * glm::dvec3(1.1, 0.9, isMirrored ? -1.03 : 1.03);
  OutputMap map;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      map.Matrix[static_cast<std::size_t>(3 * row + column)] = turn[column][row] * spacing[column];
    }
  }
  const glm::dvec3 shift = center - PlaceInOutput(map, center);
  map.Shift = { { shift.x, shift.y, shift.z } };
  return map;
}

/// Moves voxels slightly, independent of each other.
DeformerCase MakeJittered(const OutputMap& map, unsigned int seed, double amplitude,
  const Extent& extent = { { -5, 29, 3, 12, -12, -5 } })
{
  const auto jitter = MakeJitter(seed, amplitude);
  return MakeCase(extent, map,
    [=](const glm::dvec3& index) { return PlaceInOutput(map, index) + jitter(index) - index; });
}

/// Sets displacements that cause rounding errors in sums.
void MoveUnevenly(VolumeDeformer& deformer, const DeformerCase& deformerCase)
{
  std::vector<float> vectors = deformerCase.GetDisplacements();
  for (float& number : vectors)
  {
    number *= 0.987654321F;
  }
  DisplacementField field;
  for (int axis = 0; axis < 3; ++axis)
  {
    const Extent& extent = deformerCase.VoxelGrid.VertexExtent;
    field.Dimensions[axis] = static_cast<int>(GetSize(extent, axis));
    field.IndexToField[4 * axis + 3] = -extent[2 * axis];
  }
  field.Vectors = vectors.data();
  deformer.SetDisplacementField(field);
}

void ExpectSameOutput(const Deformed& one, const Deformed& other)
{
  EXPECT_TRUE(one.Coverage == other.Coverage);
  ASSERT_EQ(one.Outputs.size(), other.Outputs.size());
  for (std::size_t array = 0; array < one.Outputs.size(); ++array)
  {
    EXPECT_TRUE(one.Outputs[array] == other.Outputs[array]) << "array " << array;
  }
}

} // namespace

TEST(OutputMaps, MisuseIsAnError)
{
  VolumeDeformer deformer;
  deformer.SetDevice("");
  VoxelGrid grid;
  grid.VertexExtent = { { 0, 3, 0, 3, 0, 3 } };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const OutputMap& map : { MakeMap({ { 1, 0, 0, 0, 0, 0, 0, 0, 1 } }, {}),
         MakeMap({ { 1, 2, 0, 2, 4, 0, 0, 0, 1 } }, {}),
         MakeMap({ { 1, 0, 0, 0, nan, 0, 0, 0, 1 } }, {}),
         MakeMap({ { 1, 0, 0, 0, 1, 0, 0, 0, 1 } }, { { 0, nan, 0 } }) })
  {
    grid.ToOutput = map;
    EXPECT_NE(GetError([&] { deformer.SetVoxelGrid(grid); }).find("invertible"), std::string::npos);
  }
  for (OutputMap map : { Identity, Turned })
  {
    map.Shift = { { 0, 3e6, 0 } };
    grid.ToOutput = map;
    EXPECT_NE(GetError([&] { deformer.SetVoxelGrid(grid); }).find("2^21"), std::string::npos);
  }
}

TEST(OutputMaps, EqualTheReference)
{
  for (const OutputMap& map :
    { Identity, Mirror, LeftHanded, Permuted, Exchanged, Turned, TurnedMirror })
  {
    for (const Route route : { Route::Field, Route::Mesh, Route::Runs })
    {
      SCOPED_TRACE(testing::Message() << "matrix elements " << map.Matrix[0] << " and "
                                      << map.Matrix[3] << ", route " << static_cast<int>(route));
      const DeformerCase jittered = MakeJittered(map, 7 + static_cast<unsigned int>(route), 0.08);
      ExpectEmbedding(ResampleByReference(jittered));
      ExpectEqualsReference(jittered, route);
    }
    // At rest samples lie on vertices, edges and faces.
    ExpectEqualsReference(MakeJittered(map, 7, 0.0));
  }
}

TEST(OutputMaps, UprightComesBeforeInverted)
{
  for (const OutputMap& map : { Mirror, Turned, TurnedMirror })
  {
    const DeformerCase folded = MakeJittered(map, 3, 0.9);
    const reference::Result reference = ResampleByReference(folded);
    ASSERT_GT(reference.NumberOfInvertedTetrahedra, 100);
    ASSERT_GT(reference.NumberOfOverlappedVoxels, 100);
    ExpectEqualsReference(folded);
  }
}

TEST(OutputMaps, SmoothCutsAndMasks)
{
  for (const OutputMap& map : { Mirror, Turned, TurnedMirror })
  {
    DeformerCase cut = MakeJittered(map, 5, 0.12);
    CutAtRandom(cut, 11, 3);
    std::mt19937 random(4);
    cut.Active.resize(static_cast<std::size_t>(GetNumberOfCells(cut.VoxelGrid.VertexExtent)));
    for (unsigned char& active : cut.Active)
    {
      active = static_cast<unsigned char>(random() % 4 ? 31 : random() % 32);
    }
    ExpectEqualsReference(cut);
  }
}

TEST(OutputMaps, MirrorImagesHaveTheSameValues)
{
  const DeformerCase plain = MakeJittered(Identity, 2, 0.1);
  OutputMap map;
  map.Matrix[0] = -1.0;
  DeformerCase mirrored = plain;
  mirrored.VoxelGrid.ToOutput = map;
  for (reference::Position& displacement : mirrored.Displacements)
  {
    displacement[0] = -displacement[0];
  }
  mirrored.Output[0] = -plain.Output[1];
  mirrored.Output[1] = -plain.Output[0];
  const UsualArrays values(plain.GetNumberOfVoxels());
  const Deformed one = LoadAndRun(plain, values.Get());
  const Deformed other = LoadAndRun(mirrored, values.Get());
  for (const Deformed& kernel : { other, *other.ByCell, *other.ByColumns })
  {
    EXPECT_EQ(kernel.Report.NumberOfInvertedTetrahedra, 0);
  }
  EXPECT_GT(other.Report.NumberOfCoveredVoxels, 1000);
  EXPECT_EQ(other.Report.NumberOfCoveredVoxels, one.Report.NumberOfCoveredVoxels);
  const std::int64_t width = GetSize(plain.Output, 0);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < one.Coverage.size(); ++i)
  {
    const auto at = static_cast<std::int64_t>(i);
    const auto image = static_cast<std::size_t>(at / width * width + width - 1 - at % width);
    wrong += one.Coverage[i] != other.Coverage[image] ? 1 : 0;
    // Another tetrahedron may own a sample on a face, and add the same products in another order.
    // Rounding errors of floats up to 1000.
    wrong += std::abs(one.GetOutput<float>(1)[i] - other.GetOutput<float>(1)[image]) > 1e-3F;
    wrong +=
      std::abs(one.GetOutput<std::int16_t>(0)[i] - other.GetOutput<std::int16_t>(0)[image]) > 1;
  }
  EXPECT_EQ(wrong, 0U);
}

// With a map and displacements that cause rounding errors, results are the same bit for bit for all
// kernels, slabs, and parts of the volume and of the output.
TEST(OutputMaps, AllPartsHaveTheSameBits)
{
  const OutputMap map = MakeTurnedMap(glm::dvec3(3.2, 11.7, -24.1), true);
  DeformerCase whole = MakeJittered(Identity, 6, 0.1, { { -5, 30, 3, 20, -30, -17 } });
  whole.VoxelGrid.ToOutput = map;
  whole.Output = { { -20, 26, -10, 34, -40, -9 } };
  const UsualArrays values(whole.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = values.Get();
  VolumeDeformer deformer;
  Load(deformer, whole, arrays, Route::Field);
  MoveUnevenly(deformer, whole);
  const Deformed all = RunDeformer(deformer, whole, arrays);
  EXPECT_EQ(all.Report.NumberOfInvertedTetrahedra, 0);
  EXPECT_FALSE(all.Report.Overlapping);
  EXPECT_GT(all.Report.NumberOfCoveredVoxels, 5000);
  for (const Resampling method : { Resampling::ExactByCell, Resampling::ExactByColumns })
  {
    const Deformed other = RunDeformer(deformer, whole, arrays, method);
    EXPECT_TRUE(other.Coverage == all.Coverage);
    EXPECT_TRUE(other.Outputs[2] == all.Outputs[2]);
    if (method == Resampling::ExactByColumns) // in single precision, like by lanes
    {
      EXPECT_TRUE(other.Outputs[0] == all.Outputs[0]);
      EXPECT_TRUE(other.Outputs[1] == all.Outputs[1]);
    }
  }
  deformer.SetAllocationLimit(60000);
  ExpectSameOutput(RunDeformer(deformer, whole, arrays), all);
  deformer.SetAllocationLimit(0);

  const auto count = [&](const Deformed& part, const Extent& output, int& wrong)
  {
    std::size_t i = 0;
    int covered = 0;
    for (int z = output[4]; z <= output[5]; ++z)
    {
      for (int y = output[2]; y <= output[3]; ++y)
      {
        for (int x = output[0]; x <= output[1]; ++x, ++i)
        {
          const Extent& e = whole.Output;
          const auto place = static_cast<std::size_t>(
            ((z - e[4]) * GetSize(e, 1) + y - e[2]) * GetSize(e, 0) + x - e[0]);
          if (!part.Coverage[i])
          {
            continue;
          }
          ++covered;
          wrong += !all.Coverage[place] ||
            part.GetOutput<float>(1)[i] != all.GetOutput<float>(1)[place] ||
            part.GetOutput<std::int16_t>(0)[i] != all.GetOutput<std::int16_t>(0)[place];
        }
      }
    }
    return covered;
  };
  int wrong = 0;
  std::int64_t covered = 0;
  for (const Extent& output : { Extent{ { -20, 2, -10, 34, -40, -9 } },
         Extent{ { 3, 26, -10, 11, -40, -9 } }, Extent{ { 3, 26, 12, 34, -40, -9 } } })
  {
    DeformerCase part = whole;
    part.Output = output;
    covered += count(RunDeformer(deformer, part, arrays), output, wrong);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(covered, all.Report.NumberOfCoveredVoxels);

  // A part of the volume, with another first index on each axis.
  DeformerCase part = whole;
  part.VoxelGrid.VertexExtent = { { 2, 21, 6, 19, -27, -19 } };
  part.VoxelGrid.WholeExtent = whole.VoxelGrid.VertexExtent;
  part.Displacements.clear();
  UsualArrays valuesOfPart(0);
  const Extent& e = part.VoxelGrid.VertexExtent;
  const Extent& w = whole.VoxelGrid.VertexExtent;
  for (int z = e[4]; z <= e[5]; ++z)
  {
    for (int y = e[2]; y <= e[3]; ++y)
    {
      for (int x = e[0]; x <= e[1]; ++x)
      {
        const auto i = static_cast<std::size_t>(
          ((z - w[4]) * GetSize(w, 1) + y - w[2]) * GetSize(w, 0) + x - w[0]);
        part.Displacements.push_back(whole.Displacements[i]);
        valuesOfPart.Shorts.push_back(values.Shorts[i]);
        valuesOfPart.Floats.push_back(values.Floats[i]);
        valuesOfPart.Labels.push_back(values.Labels[2 * i]);
        valuesOfPart.Labels.push_back(values.Labels[2 * i + 1]);
      }
    }
  }
  const std::vector<VolumeArray> ofPart = valuesOfPart.Get();
  VolumeDeformer other;
  Load(other, part, ofPart, Route::Field);
  MoveUnevenly(other, part);
  const Deformed made = RunDeformer(other, part, ofPart);
  EXPECT_GT(count(made, part.Output, wrong), 1000);
  EXPECT_EQ(wrong, 0);
}

class EditsOnOutputMaps : public WayTest
{
};

TEST_P(EditsOnOutputMaps, EqualNewOutputs)
{
  for (const bool isMirrored : { false, true })
  {
    EditedVolume edited = MakeVolume(Extent{ { -5, 90, 0, 50, 3, 40 } });
    edited.Shape.ToOutput = MakeTurnedMap(glm::dvec3(40, 25, 20), isMirrored, 0.7);
    Twins both;
    both.SendAll(edited, GetRoute());
    both.Deform(edited, GetRoute());
    EXPECT_EQ(both.WholeReport.NumberOfInvertedTetrahedra, 0);
    EXPECT_GT(both.WholeReport.NumberOfCoveredVoxels, 10000);
    std::mt19937 random(8);
    int parts = 0;
    for (int edit = 0; edit < 12 && !this->HasFailure(); ++edit)
    {
      edited.Move(random, 0, edit % 4 == 3 ? 6.0F : 0.6F);
      both.Deform(edited, GetRoute());
      parts += both.IsPart() ? 1 : 0;
    }
    EXPECT_GT(parts, 3);
  }
}

INSTANTIATE_TEST_SUITE_P(
  AllWays, EditsOnOutputMaps, GetWays(), [](const auto& info) { return GetWayName(info); });

TEST(OutputMaps, MeshRasterizationEqualsTheReference)
{
  for (const OutputMap& map : { Mirror, LeftHanded, Permuted, Turned, TurnedMirror,
         MakeTurnedMap(glm::dvec3(7.0, 9.0, -2.0), true) })
  {
    const auto wave = [&](const glm::dvec3& index)
    {
      return PlaceInOutput(map, index) +
        glm::dvec3(0.8 * std::sin(0.5 * index.y) + 0.31, 0.6 * std::cos(0.4 * index.z) - 0.17,
          0.7 * std::sin(0.3 * index.x));
    };
    const RasterCase made = MakeRasterCase({ { -3, 18, 2, 16, -9, 5 } }, 2, wave, map);
    const UsualArrays values(made.GetNumberOfVoxels());
    const Deformed deformed = LoadAndRun(made, values.Get());
    EXPECT_EQ(deformed.Report.NumberOfInvertedTetrahedra, 0);
    EXPECT_GT(deformed.Report.NumberOfCoveredVoxels, 1000);
    ExpectEqualsReference(made, values.Get(), deformed);
  }
}

// The tetrahedra of the deformation mesh resample the cells that its boundary crosses.
TEST(OutputMaps, NoVoxelOfATightMeshIsLost)
{
  const glm::dvec3 middle(8.37, 13.21, 10.63);
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), 0.4, glm::dvec3(0.3, 0.5, 0.81)));
  // Bound for values of noise between 0 and 1, see TestMeshBoundary.cxx.
  const double bound = 3.0 * std::sqrt(3.0) / 512.0 / 0.9 + 1e-5;
  for (const double edge : { 1.3, 4.1 })
  {
    TightMesh mesh = MakeTightMesh({ { -3, 20, 2, 24, 0, 21 } }, edge, turn, middle,
      [&](const glm::dvec3& point) { return glm::length(point - middle) < 7.7; });
    for (const bool isMirrored : { false, true })
    {
      mesh.Grid.ToOutput = MakeTurnedMap(middle, isMirrored);
      // At rest, and shifted.
      for (const double shift : { 0.0, 0.37 })
      {
        mesh.Move([&](const glm::dvec3&) { return glm::dvec3(shift, -shift, 0.5 * shift); });
        std::vector<TightOutput> outputs;
        for (const StaticMappingForm form : { StaticMappingForm::Links, StaticMappingForm::Runs })
        {
          VolumeDeformer deformer;
          Load(deformer, mesh, form);
          for (const Resampling method :
            { Resampling::Exact, Resampling::ExactByCell, Resampling::ExactByColumns })
          {
            outputs.push_back(DeformTight(deformer, mesh, method));
            EXPECT_EQ(outputs.back().Report.NumberOfInvertedTetrahedra, 0);
          }
        }
        ExpectTight(mesh, outputs, bound);
      }
    }
  }
}
