// SPDX-License-Identifier: BSD-3-Clause
// The deformation mapping: meshes with links, displacement fields, affine maps.
#include "DeformerCase.h"

#include <gtest/gtest.h>

#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

using namespace deformvolume;

namespace
{

const std::array<double, 3> NoScale{ { 1, 1, 1 } };

/// An affine map of output indices and a linear function of the volume's indices.
struct AffineCase
{
  Lattice SamplingMesh;
  glm::dmat3 Matrix{ 1.0 };
  glm::dvec3 Offset{ 0.0 };
  glm::dvec3 Gradient{ 0.0 };
  double Constant = 0.0;

  glm::dvec3 GetScale() const
  {
    const auto& scale = this->SamplingMesh.Scale;
    return glm::dvec3(scale[0], scale[1], scale[2]);
  }
  glm::dvec3 Move(const glm::dvec3& index) const
  {
    return this->Matrix * (this->GetScale() * index) + this->Offset;
  }
  glm::dvec3 MoveBack(const glm::dvec3& sample) const
  {
    return glm::inverse(this->Matrix) * (sample - this->Offset) / this->GetScale();
  }
  double GetValue(const glm::dvec3& index) const
  {
    return glm::dot(this->Gradient, index) + this->Constant;
  }

  std::vector<double> GetVolume() const
  {
    std::vector<double> values;
    const Extent& e = this->SamplingMesh.VertexExtent;
    for (int z = e[4]; z <= e[5]; ++z)
    {
      for (int y = e[2]; y <= e[3]; ++y)
      {
        for (int x = e[0]; x <= e[1]; ++x)
        {
          values.push_back(this->GetValue(glm::dvec3(x, y, z)));
        }
      }
    }
    return values;
  }

  Extent GetOutput() const
  {
    const Extent& e = this->SamplingMesh.VertexExtent;
    glm::dvec3 low(1e9);
    glm::dvec3 high(-1e9);
    for (int corner = 0; corner < 8; ++corner)
    {
      const glm::dvec3 moved =
        this->Move(glm::dvec3(e[corner & 1], e[2 + (corner >> 1 & 1)], e[4 + (corner >> 2)]));
      low = glm::min(low, moved);
      high = glm::max(high, moved);
    }
    Extent output;
    for (int axis = 0; axis < 3; ++axis)
    {
      output[2 * axis] = static_cast<int>(std::floor(low[axis])) - 1;
      output[2 * axis + 1] = static_cast<int>(std::ceil(high[axis])) + 1;
    }
    return output;
  }

  /// Values within |gradient| x 3 x 2^-9 voxel, which is what rounding positions costs; coverage
  /// wherever the sample lies further than that from the border.
  void Check(const std::vector<double>& output, const std::vector<signed char>& coverage) const
  {
    const double snap = 3.0 / 512.0;
    const glm::dmat3 back = glm::inverse(this->Matrix);
    const glm::dvec3 gradient = (this->Gradient / this->GetScale()) * back;
    const double tolerance = glm::length(gradient) * snap;
    const Extent& e = this->SamplingMesh.VertexExtent;
    glm::dvec3 margin;
    for (int axis = 0; axis < 3; ++axis)
    {
      margin[axis] = glm::length(glm::dvec3(back[0][axis], back[1][axis], back[2][axis])) * snap /
        this->GetScale()[axis];
    }
    const glm::dvec3 first(e[0], e[2], e[4]);
    const glm::dvec3 last(e[1], e[3], e[5]);
    const Extent box = this->GetOutput();
    std::size_t voxel = 0;
    double worst = 0.0;
    int holes = 0;
    int extra = 0;
    for (int z = box[4]; z <= box[5]; ++z)
    {
      for (int y = box[2]; y <= box[3]; ++y)
      {
        for (int x = box[0]; x <= box[1]; ++x, ++voxel)
        {
          const glm::dvec3 rest = this->MoveBack(glm::dvec3(x, y, z));
          const bool inside = glm::all(glm::greaterThan(rest, first + margin)) &&
            glm::all(glm::lessThan(rest, last - margin));
          const bool outside = glm::any(glm::lessThan(rest, first - margin)) ||
            glm::any(glm::greaterThan(rest, last + margin));
          holes += inside && coverage[voxel] == 0 ? 1 : 0;
          extra += outside && coverage[voxel] != 0 ? 1 : 0;
          if (coverage[voxel] != 0)
          {
            worst = std::max(worst, std::abs(output[voxel] - this->GetValue(rest)));
          }
        }
      }
    }
    EXPECT_EQ(holes, 0);
    EXPECT_EQ(extra, 0);
    EXPECT_LE(worst, tolerance);
    EXPECT_GT(worst, 0.0) << "nothing was interpolated";
  }
};

AffineCase MakeRandomAffineCase(unsigned int seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  AffineCase made;
  made.SamplingMesh.VertexExtent = { { -4, 9, 3, 17, -20, -9 } };
  if (seed % 2 == 1)
  {
    made.SamplingMesh.Scale = { { 1.1, 0.7, 1.3 } };
  }
  made.Matrix = MakeRandomMatrix(random);
  made.Offset = 20.0 * glm::dvec3(uniform(random), uniform(random), uniform(random));
  made.Gradient = 100.0 * glm::dvec3(uniform(random), uniform(random), uniform(random));
  made.Constant = 50.0 * uniform(random);
  return made;
}

/// Deforms with one tetrahedron round the whole volume.
void DeformByMesh(const AffineCase& affine, VolumeDeformer& deformer)
{
  const Extent& e = affine.SamplingMesh.VertexExtent;
  const glm::dvec3 corner(e[0] - 3.0, e[2] - 2.0, e[4] - 1.0);
  const double size = 100.0;
  const std::array<glm::dvec3, 4> nodes{ { corner, corner + glm::dvec3(size, 0, 0),
    corner + glm::dvec3(0, size, 0), corner + glm::dvec3(0, 0, size) } };
  std::vector<float> displacements;
  for (const glm::dvec3& node : nodes)
  {
    const glm::dvec3 displacement = affine.Move(node) - affine.GetScale() * node;
    for (int axis = 0; axis < 3; ++axis)
    {
      displacements.push_back(static_cast<float>(displacement[axis]));
    }
  }
  std::vector<VertexLink> links;
  for (int z = e[4]; z <= e[5]; ++z)
  {
    for (int y = e[2]; y <= e[3]; ++y)
    {
      for (int x = e[0]; x <= e[1]; ++x)
      {
        const glm::dvec3 w = (glm::dvec3(x, y, z) - corner) / size;
        VertexLink link;
        link.Tetrahedron = 0;
        link.Weights[0] = static_cast<float>(1.0 - w.x - w.y - w.z);
        link.Weights[1] = static_cast<float>(w.x);
        link.Weights[2] = static_cast<float>(w.y);
        links.push_back(link);
      }
    }
  }
  const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
  deformer.SetMesh(&tetrahedron, 1, 4, links.data());
  deformer.SetNodeDisplacements(displacements.data());
}

/// Deforms with a coarse field whose axes are not those of the volume.
void DeformByField(const AffineCase& affine, VolumeDeformer& deformer)
{
  const glm::dmat3 axes(0.25, 0.125, 0.0, -0.125, 0.25, 0.0625, 0.0, -0.0625, 0.5);
  const Extent& e = affine.SamplingMesh.VertexExtent;
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 index =
      axes * glm::dvec3(e[corner & 1], e[2 + (corner >> 1 & 1)], e[4 + (corner >> 2)]);
    low = glm::min(low, index);
    high = glm::max(high, index);
  }
  DisplacementField field;
  for (int axis = 0; axis < 3; ++axis)
  {
    field.Dimensions[axis] = static_cast<int>(std::ceil(high[axis] - low[axis])) + 1;
    for (int column = 0; column < 3; ++column)
    {
      field.IndexToField[4 * axis + column] = axes[column][axis];
    }
    field.IndexToField[4 * axis + 3] = -low[axis];
  }
  std::vector<float> vectors;
  for (int z = 0; z < field.Dimensions[2]; ++z)
  {
    for (int y = 0; y < field.Dimensions[1]; ++y)
    {
      for (int x = 0; x < field.Dimensions[0]; ++x)
      {
        const glm::dvec3 index = glm::inverse(axes) * (glm::dvec3(x, y, z) + low);
        const glm::dvec3 displacement = affine.Move(index) - affine.GetScale() * index;
        for (int axis = 0; axis < 3; ++axis)
        {
          vectors.push_back(static_cast<float>(displacement[axis]));
        }
      }
    }
  }
  field.Vectors = vectors.data();
  deformer.SetDisplacementField(field);
}

void CheckAffine(const AffineCase& affine, void (*deform)(const AffineCase&, VolumeDeformer&),
  Resampling method = Resampling::Exact)
{
  const std::vector<double> volume = affine.GetVolume();
  const VolumeArray array = MakeArray(volume);
  VolumeDeformer deformer;
  deformer.SetDevice("");
  deformer.SetLattice(affine.SamplingMesh);
  deformer.SetArrays({ array });
  deform(affine, deformer);
  DeformerCase shape;
  shape.Output = affine.GetOutput();
  const Deformed deformed = RunDeformer(deformer, shape, { array }, method);
  EXPECT_EQ(deformed.Report.NumberOfInvertedTetrahedra, 0);
  if (method == Resampling::Exact)
  {
    EXPECT_FALSE(deformed.Report.Overlapping);
  }
  const double* output = deformed.GetOutput<double>(0);
  affine.Check(std::vector<double>(output, output + deformed.Coverage.size()), deformed.Coverage);
}

} // namespace

TEST(Mapping, LinearFunctionUnderAffineMapsByMesh)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    SCOPED_TRACE(seed);
    CheckAffine(MakeRandomAffineCase(seed), DeformByMesh);
  }
}

TEST(Mapping, LinearFunctionUnderAffineMapsByField)
{
  for (unsigned int seed = 20; seed < 28; ++seed)
  {
    SCOPED_TRACE(seed);
    CheckAffine(MakeRandomAffineCase(seed), DeformByField);
  }
}

TEST(Mapping, PublishedKernelAgreesWithinItsTolerance)
{
  for (unsigned int seed = 40; seed < 44; ++seed)
  {
    SCOPED_TRACE(seed);
    CheckAffine(MakeRandomAffineCase(seed), DeformByMesh, Resampling::Published);
    CheckAffine(MakeRandomAffineCase(seed), DeformByField, Resampling::Published);
  }
}

TEST(Mapping, PublishedKernelEqualsExactOneOnASmoothBend)
{
  const DeformerCase bent = MakeCase({ { 0, 15, 0, 11, 0, 9 } }, NoScale,
    [](const glm::dvec3& index)
    {
      const double angle = 0.06 * index.x;
      const double radius = 18.0 - index.y;
      return glm::dvec3(
        radius * std::sin(angle), 18.0 - radius * std::cos(angle), 1.25 * index.z + 0.3);
    });
  const auto values = MakeRandomValues<float>(bent.GetNumberOfVoxels(), 5);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  VolumeDeformer deformer;
  Load(deformer, bent, arrays, Route::Mesh);
  const Deformed exact = RunDeformer(deformer, bent, arrays);
  const Deformed published = RunDeformer(deformer, bent, arrays, Resampling::Published);
  int differences = 0;
  for (std::size_t voxel = 0; voxel < exact.Coverage.size(); ++voxel)
  {
    differences += exact.Coverage[voxel] != published.Coverage[voxel] ? 1 : 0;
    if (exact.Coverage[voxel] != 0 && published.Coverage[voxel] != 0)
    {
      // Values up to 1000 in both directions, weights in float.
      EXPECT_NEAR(
        exact.GetOutput<float>(0)[voxel], published.GetOutput<float>(0)[voxel], 2000.0 * 1e-4);
    }
  }
  // Only voxels on the border may be taken by one kernel alone.
  EXPECT_LE(differences, 20);
}

TEST(Mapping, FieldOfHalfTheResolution)
{
  const Extent extent{ { -2, 8, 1, 9, 0, 10 } };
  std::mt19937 random(6);
  std::uniform_int_distribution<int> uniform(-5, 5);
  DisplacementField field;
  field.Dimensions = { { 6, 5, 6 } };
  field.IndexToField = { { 0.5, 0, 0, 1, 0, 0.5, 0, -0.5, 0, 0, 0.5, 0 } };
  // Whole numbers of 8/256 voxel: means of two, four and eight are exact.
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
    SCOPED_TRACE("extrapolated");
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
  SCOPED_TRACE("discarded");
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
  const auto values = MakeRandomValues<double>(moved.GetNumberOfVoxels(), 7);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  VolumeDeformer deformer;
  Load(deformer, moved, arrays, Route::Field);
  deformer.SetDisplacementField(field);
  ExpectEqualsReference(
    moved, ResampleByReference(moved), arrays, RunDeformer(deformer, moved, arrays));
}

TEST(Mapping, BarycentricWeightsOfAllFourNodes)
{
  // Weights and displacements that float holds exactly: the mean of four nodes of each voxel.
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
    // Multiples of 1/32 voxel, of which an eighth is a multiple of 1/256.
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
