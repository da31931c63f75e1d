// SPDX-License-Identifier: BSD-3-Clause
// Affine maps of a linear function, by mesh and by field. The expected values are known exactly.
#include "DeformerCase.h"
#include "DeviceNeeds.h"
#include "OutputPlace.h"

#include <gtest/gtest.h>

#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

using namespace deformvolume;

namespace
{

/// An affine map of output indices and a linear function of the volume's indices.
struct AffineCase
{
  VoxelGrid SamplingMesh;
  glm::dmat3 Matrix{ 1.0 };
  glm::dvec3 Offset{ 0.0 };
  glm::dvec3 Gradient{ 0.0 };
  double Constant = 0.0;

  glm::dvec3 Place(const glm::dvec3& index) const
  {
    return PlaceInOutput(this->SamplingMesh.ToOutput, index);
  }
  glm::dvec3 Move(const glm::dvec3& index) const
  {
    return this->Matrix * this->Place(index) + this->Offset;
  }
  /// Derivatives of the volume's indices by the output's indices.
  glm::dmat3 GetBack() const
  {
    glm::dmat3 steps;
    for (int axis = 0; axis < 3; ++axis)
    {
      glm::dvec3 one(0.0);
      one[axis] = 1.0;
      steps[axis] = this->Move(one) - this->Move(glm::dvec3(0.0));
    }
    return glm::inverse(steps);
  }
  glm::dvec3 MoveBack(const glm::dvec3& sample) const
  {
    return this->GetBack() * (sample - this->Move(glm::dvec3(0.0)));
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

  /// Values may differ by |gradient| x 3 x 2^-9 voxel, because positions are rounded. Coverage is
  /// checked for samples that are farther than this distance from the border.
  void Check(const std::vector<double>& output, const std::vector<signed char>& coverage) const
  {
    const double snap = 3.0 / 512.0;
    const glm::dmat3 back = this->GetBack();
    const glm::dvec3 gradient = this->Gradient * back;
    const double tolerance = glm::length(gradient) * snap;
    const Extent& e = this->SamplingMesh.VertexExtent;
    glm::dvec3 margin;
    for (int axis = 0; axis < 3; ++axis)
    {
      margin[axis] = glm::length(glm::dvec3(back[0][axis], back[1][axis], back[2][axis])) * snap;
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
    EXPECT_GT(worst, 0.0) << "the largest error must not be 0: else nothing was interpolated";
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
    made.SamplingMesh.ToOutput = std::array<double, 3>{ { 1.1, 0.7, 1.3 } };
  }
  made.Matrix = MakeRandomMatrix(random);
  made.Offset = 20.0 * glm::dvec3(uniform(random), uniform(random), uniform(random));
  made.Gradient = 100.0 * glm::dvec3(uniform(random), uniform(random), uniform(random));
  made.Constant = 50.0 * uniform(random);
  return made;
}

/// A random affine case on a rotated, and perhaps mirrored, voxel grid. Neither inverts tetrahedra.
AffineCase MakeTurnedAffineCase(unsigned int seed)
{
  AffineCase made = MakeRandomAffineCase(seed);
  std::mt19937 random(seed + 100);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const glm::dmat3 turn = MakeRandomMatrix(random);
  const glm::dvec3 spacing(1.3, 0.6, seed % 2 == 0 ? 1.1 : -1.1);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      made.SamplingMesh.ToOutput.Matrix[3 * row + column] = turn[column][row] * spacing[column];
    }
    made.SamplingMesh.ToOutput.Shift[row] = 50.0 * uniform(random);
  }
  return made;
}

/// Deforms with one tetrahedron that contains the whole volume.
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
    const glm::dvec3 displacement = affine.Move(node) - affine.Place(node);
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
        const glm::dvec3 displacement = affine.Move(index) - affine.Place(index);
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

void CheckAffine(const AffineCase& affine, void (*deform)(const AffineCase&, VolumeDeformer&))
{
  const std::vector<double> volume = affine.GetVolume();
  const VolumeArray array = MakeArray(volume);
  VolumeDeformer deformer;
  deformer.SetDevice("");
  deformer.SetVoxelGrid(affine.SamplingMesh);
  deformer.SetArrays({ array });
  deform(affine, deformer);
  DeformerCase shape;
  shape.Output = affine.GetOutput();
  const Deformed deformed = RunDeformer(deformer, shape, { array });
  EXPECT_EQ(deformed.Report.NumberOfInvertedTetrahedra, 0);
  EXPECT_FALSE(deformed.Report.Overlapping);
  const double* output = deformed.GetOutput<double>(0);
  affine.Check(std::vector<double>(output, output + deformed.Coverage.size()), deformed.Coverage);
}

} // namespace

TEST(AffineMaps, LinearFunctionByMesh)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    SCOPED_TRACE(seed);
    CheckAffine(MakeRandomAffineCase(seed), DeformByMesh);
  }
}

TEST(AffineMaps, LinearFunctionOnATurnedGrid)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (unsigned int seed = 40; seed < 48; ++seed)
  {
    SCOPED_TRACE(seed);
    CheckAffine(MakeTurnedAffineCase(seed), seed % 4 < 2 ? DeformByMesh : DeformByField);
  }
}

TEST(AffineMaps, LinearFunctionByField)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (unsigned int seed = 20; seed < 28; ++seed)
  {
    SCOPED_TRACE(seed);
    CheckAffine(MakeRandomAffineCase(seed), DeformByField);
  }
}
