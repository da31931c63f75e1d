// SPDX-License-Identifier: BSD-3-Clause
// Meshes that end within the volume: the deformed volume must end at the boundary of the deformed
// mesh.
#include "DeviceNeeds.h"
#include "TightMesh.h"
#include "TimeAllowance.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace deformvolume;

namespace
{

const Extent Volume{ { -3, 20, 2, 24, 0, 21 } };
const glm::dvec3 Middle(8.37, 13.21, 10.63);

glm::dmat3 Turn(double angle)
{
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(0.3, 0.5, 0.81));
  return glm::dmat3(turn);
}

glm::dvec3 Rotate(const glm::dvec3& point, double angle)
{
  return Turn(angle) * (point - Middle) - (point - Middle);
}

TightMesh MakeBall(double edge, double angle = 0.4)
{
  return MakeTightMesh(Volume, edge, Turn(angle), Middle,
    [](const glm::dvec3& point) { return glm::length(point - Middle) < 7.7; });
}

TightMesh MakeTorus(double edge)
{
  return MakeTightMesh(Volume, edge, Turn(0.7), Middle,
    [](const glm::dvec3& point)
    {
      const glm::dvec3 p = point - Middle;
      return glm::length(glm::dvec2(glm::length(glm::dvec2(p.x, p.y)) - 6.0, p.z)) < 2.4;
    });
}

// A wall that is thinner than a voxel.
TightMesh MakeWall(double thickness)
{
  const glm::dmat3 turn = Turn(0.5);
  return MakeTightMesh(Volume, thickness, turn, Middle,
    [=](const glm::dvec3& point)
    {
      const glm::dvec3 p = glm::transpose(turn) * (point - Middle) / thickness;
      return p.z > 0.0 && p.z < 1.0 && std::abs(p.x) * thickness < 6.5 &&
        std::abs(p.y) * thickness < 5.5;
    });
}

// A forward field that ends within the volume, around its center.
class TightField
{
public:
  // edge: of the cells of the field, in voxels. size: number of points on each axis.
  TightField(double edge, const glm::dmat3& axes, const std::array<int, 3>& size)
    : Edge(edge)
    , Axes(axes)
    , Size(size)
    , First(Middle - axes * (0.5 * edge * (glm::dvec3(size[0], size[1], size[2]) - 1.0)))
  {
  }

  // Returns the cells of the field as a mesh.
  TightMesh MakeMesh() const
  {
    return MakeTightMesh(Volume, this->Edge, this->Axes, this->First,
      [this](const glm::dvec3& point)
      {
        const glm::dvec3 q = glm::transpose(this->Axes) * (point - this->First) / this->Edge;
        return q.x > 0.0 && q.y > 0.0 && q.z > 0.0 && q.x < this->Size[0] - 1.0 &&
          q.y < this->Size[1] - 1.0 && q.z < this->Size[2] - 1.0;
      });
  }

  std::vector<float> MakeVectors(const std::function<glm::dvec3(const glm::dvec3&)>& move) const
  {
    std::vector<float> vectors;
    for (int z = 0; z < this->Size[2]; ++z)
    {
      for (int y = 0; y < this->Size[1]; ++y)
      {
        for (int x = 0; x < this->Size[0]; ++x)
        {
          const glm::dvec3 d = move(this->First + this->Axes * (this->Edge * glm::dvec3(x, y, z)));
          vectors.insert(vectors.end(), { float(d.x), float(d.y), float(d.z) });
        }
      }
    }
    return vectors;
  }

  DisplacementField MakeField(const std::vector<float>& vectors) const
  {
    DisplacementField field;
    field.Dimensions = this->Size;
    field.Vectors = vectors.data();
    const glm::dvec3 offset = glm::transpose(this->Axes) * this->First / this->Edge;
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        field.IndexToField[static_cast<std::size_t>(4 * row + column)] =
          this->Axes[row][column] / this->Edge;
      }
      field.IndexToField[static_cast<std::size_t>(4 * row + 3)] = -offset[row];
    }
    return field;
  }

  // The number of the point whose index is four times the given one, or the last index on an axis.
  std::size_t GetPoint(const std::array<std::size_t, 3>& index) const
  {
    std::size_t number = 0;
    for (std::size_t axis = 3; axis-- > 0;)
    {
      const auto size = static_cast<std::size_t>(this->Size[axis]);
      number = number * size + std::min(4 * index[axis], size - 1);
    }
    return number;
  }

private:
  double Edge;
  glm::dmat3 Axes;
  std::array<int, 3> Size;
  glm::dvec3 First;
};

// The error of noise between 0 and 1 in a tetrahedron of unit edges. No derivative exceeds 1. A
// rest coordinate has the error of rounded positions (1/512 on each axis), rotated: on each axis
// less than sqrt(3) / 512 times the compression of the map.
double GetBound(double compression)
{
  return 3.0 * std::sqrt(3.0) / 512.0 * compression + 1e-5;
}

// Compares the outputs of all kernels with the search.
void ExpectTight(const TightMesh& mesh, double bound,
  StaticMappingForm form = StaticMappingForm::Automatic, const DisplacementField* field = nullptr)
{
  VolumeDeformer deformer;
  Load(deformer, mesh, form);
  if (field)
  {
    deformer.SetDisplacementField(*field);
  }
  std::vector<TightOutput> outputs;
  for (const Resampling method : GetExactMethods())
  {
    outputs.push_back(DeformTight(deformer, mesh, method));
  }
  ExpectTight(mesh, outputs, bound);
}

class TightMeshes : public testing::TestWithParam<Resampling>
{
protected:
  void SetUp() override
  {
    if (this->GetParam() == Resampling::ExactByLanes)
    {
      SKIP_WITHOUT_VECTORS()
    }
  }
  TightOutput LoadAndRun(const TightMesh& mesh)
  {
    VolumeDeformer deformer;
    Load(deformer, mesh);
    return DeformTight(deformer, mesh, this->GetParam());
  }

  // Checks updates after random changes of nodes and masks.
  void CheckUpdates(TightMesh mesh)
  {
    VolumeDeformer deformer;
    Load(deformer, mesh);
    TightOutput last = DeformTight(deformer, mesh, this->GetParam());
    const std::vector<std::int64_t> crossed =
      FindMeshBoundary(Volume, Volume, mesh.Points, mesh.Tetrahedra).Crossed;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> number(-0.6F, 0.6F);
    int masked = 0;
    std::int64_t inPart = 0;
    const int steps = GetNumberOfCases(40);
    for (int step = 0; step < steps; ++step)
    {
      if (step % 4 == 3)
      {
        const auto cells = static_cast<std::size_t>(GetNumberOfCells(mesh.Grid.VertexExtent));
        mesh.Active.resize(cells, 31);
        mesh.Active[static_cast<std::size_t>(crossed[random() % crossed.size()])] =
          step % 8 == 3 ? 0 : 30;
        SetMasks(deformer, mesh);
      }
      else
      {
        const std::size_t node = random() % mesh.Points.size();
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          mesh.Displacements[3 * node + axis] += number(random);
        }
        deformer.SetNodeDisplacements(mesh.Displacements.data());
      }
      const TightOutput output = DeformTight(deformer, mesh, this->GetParam(), &last);
      masked += step % 4 == 3 && output.Coverage != last.Coverage ? 1 : 0;
      inPart += output.Report.NumberOfResampledBricks < output.Report.NumberOfBricks ||
          output.Report.ChangedExtent != mesh.Output
        ? 1
        : 0;
      VolumeDeformer fresh;
      Load(fresh, mesh);
      ExpectSame(output, DeformTight(fresh, mesh, this->GetParam()));
      if (this->HasFailure())
      {
        FAIL() << "step " << step;
      }
      last = output;
    }
    EXPECT_GT(inPart, steps / 2);
    EXPECT_GE(masked, steps / 13);
  }
};

} // namespace

TEST(MeshBoundaries, AtRestNothingIsLost)
{
  for (const TightMesh& mesh :
    { MakeBall(1.3), MakeBall(4.1), MakeTorus(1.1), MakeWall(1.2), MakeWall(0.45) })
  {
    ExpectTight(mesh, 1e-12); // rounding errors of the search
  }
}

TEST(MeshBoundaries, MovedAndTurned)
{
  for (TightMesh mesh :
    { MakeBall(1.3), MakeBall(4.1), MakeTorus(1.1), MakeWall(1.2), MakeWall(0.45) })
  {
    mesh.Move([](const glm::dvec3&) { return glm::dvec3(0.5, -0.25, 0.3); });
    ExpectTight(mesh, GetBound(1.0));
    mesh.Move([](const glm::dvec3& point) { return Rotate(point, 0.9); });
    ExpectTight(mesh, GetBound(1.0));
    ExpectTight(mesh, GetBound(1.0), StaticMappingForm::Runs);
  }
}

TEST_P(TightMeshes, RefusedMeshChangesNothing)
{
  TightMesh mesh = MakeBall(2.3);
  mesh.Move([](const glm::dvec3&) { return glm::dvec3(0.5, -0.25, 0.3); });
  VolumeDeformer deformer;
  Load(deformer, mesh);
  const TightOutput wanted = DeformTight(deformer, mesh, this->GetParam());
  std::vector<VertexLink> links(static_cast<std::size_t>(mesh.GetNumberOfVoxels()));
  links.back().Tetrahedron = 1 << 28;
  EXPECT_THROW(deformer.SetMesh(
                 mesh.Tetrahedra.data(), mesh.Tetrahedra.size(), mesh.Points.size(), links.data()),
    Error);
  const TightOutput output = DeformTight(deformer, mesh, this->GetParam());
  EXPECT_EQ(output.Coverage, wanted.Coverage);
  EXPECT_EQ(output.Values, wanted.Values);
}

TEST(MeshBoundaries, FinerOutput)
{
  TightMesh mesh = MakeBall(2.3);
  mesh.Grid.ToOutput = std::array<double, 3>{ { 1.5, 0.75, 2.0 } };
  mesh.Move([](const glm::dvec3&) { return glm::dvec3(0.4, 0.1, -0.3); });
  ExpectTight(mesh, GetBound(1.0 / 0.75));
}

TEST(MeshBoundaries, NoHoleInHundredPoses)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  TightMesh mesh = MakeTorus(1.7);
  VolumeDeformer deformer;
  Load(deformer, mesh);
  for (int pose = 0; pose < GetNumberOfCases(100); ++pose)
  {
    const double angle = 3.0 * number(random);
    const glm::dvec3 shift(number(random), number(random), number(random));
    const glm::dvec3 bend(number(random), number(random), number(random));
    mesh.Move(
      [&](const glm::dvec3& point)
      {
        const glm::dvec3 p = 0.3 * (point - Middle);
        return Rotate(point, angle) + shift + bend * glm::sin(glm::dvec3(p.y, p.z, p.x));
      });
    deformer.SetNodeDisplacements(mesh.Displacements.data());
    const std::vector<TightVoxel> voxels = FindTightVoxels(mesh);
    for (const Resampling method : GetExactMethods())
    {
      const TightOutput output = DeformTight(deformer, mesh, method);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < voxels.size(); ++i)
      {
        wrong += voxels[i].Covered >= 0 && voxels[i].Covered != output.Coverage[i] ? 1 : 0;
      }
      ASSERT_EQ(wrong, 0U) << "pose " << pose << ", method " << static_cast<int>(method);
    }
  }
}

TEST(MeshBoundaries, Masks)
{
  TightMesh mesh = MakeBall(2.1);
  std::mt19937 random(11);
  const Extent& e = mesh.Grid.VertexExtent;
  mesh.Active.resize(static_cast<std::size_t>(GetNumberOfCells(e)));
  for (unsigned char& active : mesh.Active)
  {
    active = static_cast<unsigned char>(random() % 4 ? 31 : random() % 32);
  }
  mesh.Blanked.resize(static_cast<std::size_t>(mesh.GetNumberOfVoxels()));
  for (unsigned char& blanked : mesh.Blanked)
  {
    blanked = random() % 40 == 0 ? 1 : 0;
  }
  for (int z = e[4]; z <= e[5]; ++z)
  {
    for (int y = e[2]; y <= e[3]; ++y)
    {
      for (int x = e[0]; x <= e[1]; ++x)
      {
        mesh.Distances.push_back(static_cast<float>(
          glm::length(glm::dvec3(x, y, z) - Middle - glm::dvec3(7, 0, 0)) - 4.3));
      }
    }
  }
  mesh.Move([](const glm::dvec3& point) { return Rotate(point, 0.6); });
  ExpectTight(mesh, GetBound(1.0));
}

// A sheet between two planes of voxels. The boundary crosses all cells that meet it, and all of
// their vertices lie in the sheet. Boundary distances carve a part of it.
TEST(MeshBoundaries, CarvedSheet)
{
  const Extent wide{ { 0, 99, 0, 14, 0, 9 } };
  TightMesh mesh = MakeTightMesh(wide, 1.0, glm::dmat3(1.0), glm::dvec3(-2.0, -2.0, 4.0),
    [](const glm::dvec3& p)
    { return p.z > 4.0 && p.z < 6.0 && p.x < 102.0 && p.x > -2.0 && p.y < 17.0 && p.y > -2.0; });
  const Extent& e = wide;
  for (int z = e[4]; z <= e[5]; ++z)
  {
    for (int y = e[2]; y <= e[3]; ++y)
    {
      for (int x = e[0]; x <= e[1]; ++x)
      {
        mesh.Distances.push_back(static_cast<float>(
          std::min(std::abs(x - 50.0) - 20.4, glm::length(glm::dvec2(x - 90.0, y - 7.0)) - 0.7)));
      }
    }
  }
  mesh.Move([](const glm::dvec3&) { return glm::dvec3(0.3, 0.25, 0.4); });
  mesh.Output = wide;
  ExpectTight(mesh, GetBound(1.0));
}

// Updates must equal new outputs bit for bit, whichever parts of the output they resample. The
// tetrahedra of the wall contain no voxels.
TEST_P(TightMeshes, UpdatesEqualNewOutputs)
{
  for (TightMesh mesh : { MakeBall(1.9), MakeWall(0.45) })
  {
    mesh.Move([](const glm::dvec3& point) { return Rotate(point, 0.5); });
    mesh.Output = { { -8, 26, -2, 29, -6, 27 } };
    this->CheckUpdates(mesh);
  }
}

TEST_P(TightMeshes, ChunksAndSlabs)
{
  TightMesh mesh = MakeBall(2.1);
  const auto turn = [](const glm::dvec3& point) { return Rotate(point, 0.9) * 1.4; };
  // Folded along a plane, which is oblique to the planes of voxels.
  const auto fold = [](const glm::dvec3& point)
  {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.4, 0.8));
    const double height = glm::dot(point - Middle, normal);
    return height > 0.9 ? (1.8 - 2.0 * height) * 0.9 * normal : glm::dvec3(0.1);
  };
  for (const bool isFolded : { false, true })
  {
    if (isFolded)
    {
      mesh.Move(fold);
    }
    else
    {
      mesh.Move(turn);
    }
    const TightOutput whole = this->LoadAndRun(mesh);
    EXPECT_EQ(whole.Report.NumberOfInvertedTetrahedra > 0, isFolded);
    VolumeDeformer deformer;
    // Links take chunks of eight planes, and the output takes slabs of a few planes.
    deformer.SetAllocationLimit(8 * 16 * 24 * 23);
    Load(deformer, mesh);
    ExpectSame(DeformTight(deformer, mesh, this->GetParam()), whole);
    // The other kernels give the same result.
    VolumeDeformer other;
    Load(other, mesh);
    const TightOutput byCell = DeformTight(other, mesh, Resampling::ExactByCell);
    EXPECT_EQ(byCell.Coverage, whole.Coverage);
    EXPECT_EQ(byCell.Labels, whole.Labels);
    if (!isFolded) // on the crease of a fold, cells of the volume are bent, whereas the mesh is not
    {
      ExpectTight(mesh, { whole }, GetBound(1.0));
    }
  }
}

// A part of the volume and of its output equals the same part of the whole.
TEST_P(TightMeshes, Parts)
{
  TightMesh mesh = MakeBall(2.1);
  mesh.Move([](const glm::dvec3&) { return glm::dvec3(0.3, 0.2, 0.1); });
  const TightOutput whole = this->LoadAndRun(mesh);
  TightMesh part = mesh;
  part.Grid.WholeExtent = Volume;
  part.Grid.VertexExtent[4] = 6;
  part.Grid.VertexExtent[5] = 16;
  part.Output[4] = 9;
  part.Output[5] = 13;
  // The part has the arrays of the whole volume.
  const std::int64_t plane = GetSize(Volume, 0) * GetSize(Volume, 1);
  const UsualArrays usual = MakeTightArrays(mesh);
  std::vector<VolumeArray> arrays = usual.Get();
  for (VolumeArray& array : arrays)
  {
    array.Data = static_cast<const char*>(array.Data) +
      static_cast<std::size_t>(6 * plane * array.Components) * GetElementSize(array.Type);
  }
  VolumeDeformer deformer;
  deformer.SetVoxelGrid(part.Grid);
  deformer.SetArrays(arrays);
  const StaticMapping mapping = StaticMappingBuilder(
    Volume, glm::dvec3(1.0), mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links)
                                  .Build(part.Grid.VertexExtent);
  deformer.SetMesh(mesh.Tetrahedra.data(), mesh.Tetrahedra.size(), mesh.Points.size(),
    mapping.Links.data(), &mapping.Boundary);
  deformer.SetNodeDisplacements(mesh.Displacements.data());
  const TightOutput output = DeformTight(deformer, part, this->GetParam());
  const std::int64_t outputPlane = GetSize(mesh.Output, 0) * GetSize(mesh.Output, 1);
  const std::int64_t first = outputPlane * (part.Output[4] - mesh.Output[4]);
  for (std::size_t i = 0; i < output.Values.size(); ++i)
  {
    const std::size_t there = i + static_cast<std::size_t>(first);
    ASSERT_EQ(output.Coverage[i], whole.Coverage[there]) << "voxel " << i;
    ASSERT_EQ(output.Values[i], whole.Values[there]) << "voxel " << i;
    ASSERT_EQ(output.Labels[2 * i], whole.Labels[2 * there]) << "voxel " << i;
  }
}

// All voxels lie in the mesh, and a gap between them opens. Rows are so long that the kernels
// handle many cells beside the gap at once.
TEST(MeshBoundaries, GapsBetweenVoxels)
{
  const Extent wide{ { -3, 100, 2, 20, 0, 9 } };
  const double gap = 8.4;
  TightMesh mesh = MakeTightMesh(wide, 110.0, glm::dmat3(1.0), glm::dvec3(-6.0, gap, -40.0),
    [&](const glm::dvec3& p) { return p.x < 110.0 && p.z < 80.0 && std::abs(p.y - gap) < 100.0; });
  // Two parts: y from 8.4 on, and y up to 8.2.
  const std::size_t points = mesh.Points.size();
  for (Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    double y = 0.0;
    for (const std::int32_t node : tetrahedron)
    {
      y += 0.25 * mesh.Points[static_cast<std::size_t>(node)].y;
    }
    for (std::int32_t& node : tetrahedron)
    {
      node += y < gap ? static_cast<std::int32_t>(points) : 0;
    }
  }
  for (std::size_t i = 0; i < points; ++i)
  {
    mesh.Points.push_back(mesh.Points[i] - glm::dvec3(0.0, 0.2, 0.0));
  }
  // Each side moves by 1.5 voxels.
  mesh.Displacements.assign(3 * mesh.Points.size(), 0.125F);
  for (std::size_t i = 0; i < mesh.Points.size(); ++i)
  {
    mesh.Displacements[3 * i + 1] = i < points ? 1.5F : -1.5F;
  }
  mesh.Output = wide;
  ExpectTight(mesh, GetBound(1.0));
}

// A forward field that ends within the volume, on a rotated grid, must equal a mesh of its cells.
TEST(MeshBoundaries, Fields)
{
  const TightField tight(2.7, Turn(0.6), { { 5, 4, 6 } });
  TightMesh mesh = tight.MakeMesh();
  const auto move = [](const glm::dvec3& point)
  { return Rotate(point, 0.3) + 0.1 * (point - Middle); };
  mesh.Move(move);
  std::vector<float> vectors = tight.MakeVectors(move);
  const DisplacementField field = tight.MakeField(vectors);
  ExpectTight(mesh, GetBound(1.0), StaticMappingForm::Automatic, &field);
}

// Fields that are coarser and finer than the pieces of the boundary, one of them with points beside
// the volume. Whichever points move, the output must equal that of a new deformer bit for bit.
TEST_P(TightMeshes, UpdatesOfFieldsEqualNewOutputs)
{
  for (const TightField& tight :
    { TightField(2.7, Turn(0.6), { { 5, 4, 6 } }), TightField(0.9, Turn(0.6), { { 13, 11, 15 } }),
      TightField(0.83, glm::dmat3(1.0), { { 34, 12, 12 } }) })
  {
    TightMesh mesh = tight.MakeMesh();
    // Output voxels lie beyond the outermost voxels of the field.
    const auto move = [](const glm::dvec3& point)
    { return 0.1 * (point - Middle) + glm::dvec3(0.55, 0.6, 0.0); };
    mesh.Move(move);
    mesh.Output = { { -8, 26, -2, 29, -6, 27 } }; // only a part of it changes
    std::vector<float> vectors = tight.MakeVectors(move);
    const DisplacementField field = tight.MakeField(vectors);
    VolumeDeformer deformer;
    Load(deformer, mesh);
    deformer.SetDisplacementField(field);
    TightOutput last = DeformTight(deformer, mesh, this->GetParam());
    std::mt19937 random(9);
    std::uniform_real_distribution<float> number(-0.9F, 0.9F);
    int changed = 0;
    int inPart = 0;
    const int steps = GetNumberOfCases(50);
    for (int step = 0; step < steps; ++step)
    {
      // A corner of a piece into which a fine field is divided, or any point.
      const std::size_t point = step % 2
        ? tight.GetPoint({ random() % 9, random() % 4, random() % 4 })
        : random() % (vectors.size() / 3);
      // All points move, or one point.
      for (std::size_t i = 0; i < (step == 3 ? vectors.size() : 3); ++i)
      {
        vectors[step == 3 ? i : 3 * point + i] += number(random) * (step == 3 ? 0.1F : 1.0F);
      }
      deformer.SetDisplacementField(field);
      const TightOutput output = DeformTight(deformer, mesh, this->GetParam(), &last);
      VolumeDeformer fresh;
      Load(fresh, mesh);
      fresh.SetDisplacementField(field);
      ExpectSame(output, DeformTight(fresh, mesh, this->GetParam()));
      if (this->HasFailure())
      {
        FAIL() << "step " << step;
      }
      inPart += output.Report.ChangedExtent != mesh.Output ? 1 : 0;
      changed += output.Values != last.Values ? 1 : 0;
      last = output;
    }
    EXPECT_GT(changed, steps / 5);
    EXPECT_GT(inPart, steps / 5);
  }
}

// If a mesh is folded onto itself, the upright part hides the inverted part, even if it lies in a
// later chunk of the volume. Both parts lie between planes of voxels at rest.
TEST_P(TightMeshes, UprightBeforeInvertedInAllChunks)
{
  const double edge = 0.6;
  const glm::dvec3 first(8.3, 13.2, 4.2);
  TightMesh mesh = MakeTightMesh(Volume, edge, glm::dmat3(1.0), first,
    [&](const glm::dvec3& p)
    {
      const glm::dvec3 q = glm::abs(p - first);
      return q.x < 6.0 && q.y < 5.4 && p.z > 4.2 && (p.z < 4.8 || (p.z > 16.2 && p.z < 16.8));
    });
  const auto isBelow = [](const glm::dvec3& p) { return p.z < 10.0; };
  mesh.Move(
    [&](const glm::dvec3& p) {
      return isBelow(p) ? glm::dvec3(2.0 * (first.x - p.x), 0.0, 12.5) : glm::dvec3(0.0, 0.0, 0.5);
    });
  mesh.Output = Volume;
  TightMesh apart = mesh;
  for (std::size_t i = 0; i < mesh.Points.size(); ++i)
  {
    apart.Displacements[3 * i + 2] -= isBelow(mesh.Points[i]) ? 10.0F : 0.0F;
  }
  const TightOutput whole = this->LoadAndRun(mesh);
  const TightOutput beside = this->LoadAndRun(apart);
  const auto plane = static_cast<std::size_t>(GetSize(Volume, 0) * GetSize(Volume, 1));
  std::size_t covered = 0;
  for (std::size_t i = 17 * plane; i < 18 * plane; ++i)
  {
    covered += beside.Coverage[i] == 1 ? 1U : 0U;
    ASSERT_EQ(whole.Coverage[i], beside.Coverage[i]) << "voxel " << i;
    ASSERT_EQ(whole.Labels[2 * i], beside.Labels[2 * i]) << "voxel " << i;
  }
  EXPECT_EQ(covered, 12U * 11U);
  VolumeDeformer deformer;
  deformer.SetAllocationLimit(8 * 16 * 24 * 23); // eight planes of links
  Load(deformer, mesh);
  ExpectSame(DeformTight(deformer, mesh, this->GetParam()), whole);
}

// The tetrahedra are large, but parts of them are small enough for edge functions of 64 bits.
TEST(MeshBoundaries, LargeTetrahedra)
{
  TightMesh mesh = MakeTightMesh(Volume, 40000.0, Turn(0.3), Middle,
    [](const glm::dvec3& point)
    {
      return (glm::transpose(Turn(0.3)) * (point - Middle)).x > 0.0 &&
        glm::length(point - Middle) < 50000.0;
    });
  mesh.Move([](const glm::dvec3& point) { return 1e-4 * (point - Middle); });
  mesh.Output = Volume;
  ExpectTight(mesh, 3 * GetBound(1.0));
}

// Nodes that coincide at rest belong together: there is no boundary between unmerged parts of a
// mesh.
TEST(MeshBoundaries, NoneBetweenUnmergedParts)
{
  const TightMesh mesh =
    MakeTightMesh(Volume, 12.3, Turn(0.2), Middle, [](const glm::dvec3&) { return true; });
  TightMesh apart = mesh;
  apart.Points.clear();
  for (Tetrahedron& tetrahedron : apart.Tetrahedra)
  {
    for (std::int32_t& node : tetrahedron)
    {
      apart.Points.push_back(mesh.Points[static_cast<std::size_t>(node)]);
      node = static_cast<std::int32_t>(apart.Points.size() - 1);
    }
  }
  EXPECT_TRUE(FindMeshBoundary(Volume, Volume, mesh.Points, mesh.Tetrahedra).IsEmpty());
  EXPECT_TRUE(FindMeshBoundary(Volume, Volume, apart.Points, apart.Tetrahedra).IsEmpty());
}

// A mesh whose tetrahedra, or some of them, are listed twice, and a flat tetrahedron on its
// surface, do not change the boundary.
TEST(MeshBoundaries, DuplicateAndFlatTetrahedraChangeNothing)
{
  const TightMesh mesh = MakeBall(3.1);
  const MeshBoundary once = FindMeshBoundary(Volume, Volume, mesh.Points, mesh.Tetrahedra);
  TightMesh twice = mesh;
  twice.Points.insert(twice.Points.end(), mesh.Points.begin(), mesh.Points.end());
  for (Tetrahedron tetrahedron : mesh.Tetrahedra)
  {
    for (std::int32_t& node : tetrahedron)
    {
      node += static_cast<std::int32_t>(mesh.Points.size());
    }
    twice.Tetrahedra.push_back(tetrahedron);
  }
  EXPECT_EQ(FindMeshBoundary(Volume, Volume, twice.Points, twice.Tetrahedra).Crossed, once.Crossed);
  twice.Tetrahedra.resize(mesh.Tetrahedra.size() * 4 / 3);
  EXPECT_EQ(FindMeshBoundary(Volume, Volume, twice.Points, twice.Tetrahedra).Crossed, once.Crossed);
  TightMesh same = mesh;
  same.Tetrahedra.insert(same.Tetrahedra.end(), mesh.Tetrahedra.begin(), mesh.Tetrahedra.end());
  EXPECT_EQ(FindMeshBoundary(Volume, Volume, same.Points, same.Tetrahedra).Crossed, once.Crossed);
  TightMesh flat = mesh;
  for (const Tetrahedron& t : mesh.Tetrahedra)
  {
    flat.Tetrahedra.push_back({ { t[0], t[0], t[1], t[2] } });
    flat.Tetrahedra.push_back({ { t[3], t[1], t[2], t[3] } });
  }
  EXPECT_EQ(FindMeshBoundary(Volume, Volume, flat.Points, flat.Tetrahedra).Crossed, once.Crossed);
}

// The boundary of a mesh that contains the whole volume does not pass through it, even if it lies
// on the border of the volume or touches a corner.
TEST(MeshBoundaries, NoneIfTheMeshContainsTheVolume)
{
  const Extent& e = Volume;
  const glm::dvec3 low(e[0], e[2], e[4]);
  const glm::dvec3 high(e[1], e[3], e[5]);
  const TightMesh same = MakeTightMesh(Volume, 1.0, glm::dmat3(1.0), low,
    [&](const glm::dvec3& p)
    { return glm::all(glm::greaterThan(p, low)) && glm::all(glm::lessThan(p, high)); });
  EXPECT_TRUE(FindMeshBoundary(Volume, Volume, same.Points, same.Tetrahedra).IsEmpty());
  // One layer less on one side.
  const TightMesh less = MakeTightMesh(Volume, 1.0, glm::dmat3(1.0), low,
    [&](const glm::dvec3& p)
    {
      return glm::all(glm::greaterThan(p, low + glm::dvec3(1, 0, 0))) &&
        glm::all(glm::lessThan(p, high));
    });
  EXPECT_FALSE(FindMeshBoundary(Volume, Volume, less.Points, less.Tetrahedra).IsEmpty());
  // A cube that has a corner of the volume on one of its faces.
  const glm::dmat3 turn = Turn(0.4);
  const glm::dvec3 corner = glm::transpose(turn) * low;
  glm::dvec3 first = corner;
  for (int i = 0; i < 8; ++i)
  {
    const glm::dvec3 other(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    first = glm::min(first, glm::transpose(turn) * other);
  }
  const TightMesh touching = MakeTightMesh(Volume, 60.0, turn, turn * first,
    [&](const glm::dvec3& p) {
      return glm::all(glm::greaterThan(glm::transpose(turn) * p, first)) && glm::length(p) < 80.0;
    });
  EXPECT_TRUE(FindMeshBoundary(Volume, Volume, touching.Points, touching.Tetrahedra).IsEmpty());
}

// A tetrahedron that extends far beyond the volume is divided into few pieces, which fill it within
// the volume.
TEST(MeshBoundaries, LargeTetrahedraHaveFewPieces)
{
  const std::vector<glm::dvec3> points{ { 0.3, 5.1, 3.2 }, { 0.2, 20.4, 5.3 }, { 0.4, 8.7, 18.6 },
    { 1e8, 10.2, 9.1 } };
  const MeshBoundary boundary = FindMeshBoundary(Volume, Volume, points, { { { 0, 1, 2, 3 } } });
  ASSERT_FALSE(boundary.IsEmpty());
  // Bisections lead to parts of at most 4,096 cells on an axis. The edges of these parts are halved
  // five times, to at most 128 cells, so a cross-section has 32 x 32 pieces.
  EXPECT_LT(boundary.Pieces.size(), 10U * 32U * 32U);
  const auto isInside = [](const auto& corners, const glm::dvec3& point)
  {
    const glm::dmat3 edges(
      corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
    const glm::dvec3 w = glm::inverse(edges) * (point - corners[0]);
    return std::min({ w.x, w.y, w.z, 1.0 - w.x - w.y - w.z }) > -1e-9;
  };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int inside = 0;
  for (int i = 0; i < 300; ++i)
  {
    // Next to the face of the three near nodes.
    const double u = uniform(random);
    const double v = (1.0 - u) * uniform(random);
    const glm::dvec3 point =
      points[0] + u * (points[1] - points[0]) + v * (points[2] - points[0]) + glm::dvec3(0.5, 0, 0);
    if (isInside(points, point))
    {
      ++inside;
      EXPECT_TRUE(std::any_of(boundary.Pieces.begin(), boundary.Pieces.end(),
        [&](const MeshBoundary::Piece& piece) { return isInside(piece.Rest, point); }));
    }
  }
  EXPECT_GT(inside, 250);
}

INSTANTIATE_TEST_SUITE_P(Methods, TightMeshes,
  testing::Values(Resampling::ExactByCell, Resampling::ExactByLanes, Resampling::ExactByColumns),
  [](const auto& info)
  {
    return info.param == Resampling::ExactByCell ? "ByCell"
      : info.param == Resampling::ExactByLanes   ? "ByLanes"
                                                 : "ByColumns";
  });
