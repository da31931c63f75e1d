// SPDX-License-Identifier: BSD-3-Clause
// Positions of voxels, for volumes with any direction, extent and spacing, and bounds and spacing
// of the output. The reference is a linear function of the world position under an affine map.
#include "FilterTesting.h"

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>

using namespace filterTesting;

namespace
{

struct World
{
  glm::dmat3 Matrix{ 1.0 };
  glm::dvec3 Offset{ 0.0 };
  glm::dvec3 Gradient{ 3.0, -2.0, 1.5 };

  glm::dvec3 Move(const glm::dvec3& point) const { return this->Matrix * point + this->Offset; }
  glm::dvec3 MoveBack(const glm::dvec3& point) const
  {
    return glm::inverse(this->Matrix) * (point - this->Offset);
  }
  double GetValue(const glm::dvec3& rest) const { return glm::dot(this->Gradient, rest) + 7.0; }
};

const World Oblique{ glm::dmat3(1.1, 0.2, -0.1, -0.3, 0.9, 0.15, 0.1, -0.2, 1.2),
  glm::dvec3(13.0, -7.0, 3.0) };

glm::dvec3 GetContinuousIndex(vtkImageData* image, const glm::dvec3& point)
{
  glm::dvec3 index;
  image->TransformPhysicalPointToContinuousIndex(&point.x, &index.x);
  return index;
}

/// Checks that values have an error of at most the slope times 3 x 2^-9 output voxels, and that
/// coverage is right, except near the surface of the volume.
void CheckValues(Deformed& deformed, vtkImageData* volume, const World& world)
{
  vtkImageData* output = deformed.Filter->GetOutput();
  double spacing[3];
  output->GetSpacing(spacing);
  const double voxel = std::max({ spacing[0], spacing[1], spacing[2] });
  const double slope = glm::length(world.Gradient * glm::inverse(world.Matrix));
  const double tolerance = slope * voxel * 3.0 / 512.0 + 1e-9;
  const Extent extent = GetExtent(volume);
  const glm::dvec3 first(extent[0], extent[2], extent[4]);
  const glm::dvec3 last(extent[1], extent[3], extent[5]);
  int holes = 0;
  int extra = 0;
  int covered = 0;
  double worst = 0.0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 rest = world.MoveBack(GetPoint(output, id));
    const glm::dvec3 index = GetContinuousIndex(volume, rest);
    const double margin = 0.05;
    const bool inside = glm::all(glm::greaterThan(index, first + margin)) &&
      glm::all(glm::lessThan(index, last - margin));
    const bool outside = glm::any(glm::lessThan(index, first - margin)) ||
      glm::any(glm::greaterThan(index, last + margin));
    const bool marked = deformed.IsCovered(id);
    holes += inside && !marked ? 1 : 0;
    extra += outside && marked ? 1 : 0;
    covered += marked ? 1 : 0;
    if (marked)
    {
      worst =
        std::max(worst, std::abs(deformed.GetValues()->GetComponent(id, 0) - world.GetValue(rest)));
    }
  }
  EXPECT_EQ(holes, 0);
  EXPECT_EQ(extra, 0);
  EXPECT_GT(covered, 100);
  EXPECT_EQ(static_cast<vtkIdType>(covered), deformed.Filter->GetNumberOfCoveredVoxels());
  EXPECT_LE(worst, tolerance);
}

/// Checks that the extent of the output is the smallest one that contains the deformed volume.
void CheckTightExtent(vtkImageData* output, vtkImageData* volume, const World& world)
{
  const Extent extent = GetExtent(volume);
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 index(
      extent[corner & 1], extent[2 + (corner >> 1 & 1)], extent[4 + (corner >> 2)]);
    const glm::dvec3 moved = GetContinuousIndex(output, world.Move(GetWorld(volume, index)));
    low = glm::min(low, moved);
    high = glm::max(high, moved);
  }
  const Extent result = GetExtent(output);
  for (int axis = 0; axis < 3; ++axis)
  {
    EXPECT_LE(std::abs(result[2 * axis] - std::ceil(low[axis] - 0.01)), 0.5);
    EXPECT_LE(std::abs(result[2 * axis + 1] - std::floor(high[axis] + 0.01)), 0.5);
  }
}

vtkSmartPointer<vtkImageData> MakeWorldVolume(const World& world, const Extent& extent,
  const glm::dvec3& spacing, const glm::dvec3& origin, bool oblique)
{
  auto volume = MakeImage(extent, spacing, origin);
  if (oblique)
  {
    SetObliqueDirection(volume);
  }
  AddScalars<float>(
    volume, "value", [&world](const glm::dvec3& point) { return world.GetValue(point); });
  return volume;
}

TEST(DeformGeometry, AffineMaps)
{
  const World maps[] = { Oblique,
    World{ glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1), glm::dvec3(1, 2, 3) },
    World{ glm::dmat3(1.6), glm::dvec3(0.0) } };
  for (const World& world : maps)
  {
    for (const bool oblique : { false, true })
    {
      auto volume = MakeWorldVolume(world, { { -7, 5, 3, 14, -20, -11 } },
        glm::dvec3(0.7, 1.3, 2.1), glm::dvec3(100.0, -50.0, 25.0), oblique);
      auto mesh = MakeMesh(volume, 5);
      SetDisplacements(mesh, [&world](const glm::dvec3& p) { return world.Move(p); });
      Deformed deformed(volume, mesh);
      vtkImageData* output = deformed.Update();
      CheckValues(deformed, volume, world);
      CheckTightExtent(output, volume, world);
      EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), 0);
    }
  }
}

TEST(DeformGeometry, MirroringIsCounted)
{
  const World mirror{ glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1), glm::dvec3(0.3, 0.0, 0.0) };
  auto volume =
    MakeWorldVolume(mirror, { { 0, 6, 0, 6, 0, 6 } }, glm::dvec3(1.0), glm::dvec3(0.0), false);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, [&mirror](const glm::dvec3& p) { return mirror.Move(p); });
  Deformed deformed(volume, mesh);
  deformed.Update();
  CheckValues(deformed, volume, mirror);
  EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), 5 * 216);
}

TEST(DeformGeometry, OutputSpacing)
{
  auto volume = MakeWorldVolume(Oblique, { { -7, 5, 3, 14, -20, -11 } }, glm::dvec3(0.7, 1.3, 2.1),
    glm::dvec3(100.0, -50.0, 25.0), true);
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh, [](const glm::dvec3& p) { return Oblique.Move(p); });
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputSpacingModeToCustomSpacing();
  for (const glm::dvec3& spacing : { glm::dvec3(0.9, 0.8, 1.1), glm::dvec3(2.0, 2.0, 2.0) })
  {
    deformed.Filter->SetCustomSpacing(spacing.x, spacing.y, spacing.z);
    vtkImageData* output = deformed.Update();
    glm::dvec3 result;
    output->GetSpacing(&result.x);
    EXPECT_EQ(result, spacing);
    output->GetOrigin(&result.x);
    EXPECT_EQ(result, glm::dvec3(100.0, -50.0, 25.0));
    CheckValues(deformed, volume, Oblique);
    CheckTightExtent(output, volume, Oblique);
  }
  // An undeformed volume with a custom spacing that is 1/2, 1 and 2 times its own: values of common
  // voxels do not change by a bit.
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  mesh->Modified();
  deformed.Filter->SetCustomSpacing(0.35, 1.3, 4.2);
  vtkImageData* output = deformed.Update();
  EXPECT_EQ(GetExtent(output), (Extent{ { -14, 10, 3, 14, -10, -6 } }));
  vtkDataArray* before = volume->GetPointData()->GetScalars();
  vtkDataArray* after = deformed.GetValues();
  for (int z = -10; z <= -6; ++z)
  {
    for (int y = 3; y <= 14; ++y)
    {
      for (int x = -7; x <= 5; ++x)
      {
        int from[3] = { x, y, 2 * z };
        int to[3] = { 2 * x, y, z };
        EXPECT_EQ(after->GetComponent(output->ComputePointId(to), 0),
          before->GetComponent(volume->ComputePointId(from), 0));
      }
    }
  }
}

TEST(DeformGeometry, OutputBounds)
{
  auto volume = MakeWorldVolume(Oblique, { { -7, 5, 3, 14, -20, -11 } }, glm::dvec3(0.7, 1.3, 2.1),
    glm::dvec3(4.0, -5.0, 25.0), false);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.4, 0.0, -4.2));
  Deformed deformed(volume, mesh);
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { -5, 7, 3, 14, -22, -13 } }));
  deformed.Filter->SetPadding(2);
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { -7, 9, 1, 16, -24, -11 } }));
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { -9, 7, 1, 16, -22, -9 } }));
  deformed.Filter->SetPadding(0);
  EXPECT_EQ(GetExtent(deformed.Update()), GetExtent(volume));
  // The volume moved away from the voxels x = -7, -6 and z = -12, -11.
  const vtkIdType expected = 11 * 12 * 8;
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), expected);
  deformed.Filter->SetOutputBoundsModeToCustomBounds();
  deformed.Filter->SetCustomBounds(4.0, 4.1, -5.0, 0.0, 0.0, 0.1);
  const Extent custom = GetExtent(deformed.Update());
  double bounds[6];
  deformed.Filter->GetOutput()->GetBounds(bounds);
  EXPECT_TRUE(bounds[0] <= 4.0 && bounds[1] >= 4.1 && bounds[2] <= -5.0 && bounds[3] >= 0.0);
  EXPECT_TRUE(bounds[4] <= 0.0 && bounds[5] >= 0.1);
  EXPECT_EQ(custom, (Extent{ { 0, 1, 0, 4, -12, -11 } }));
}

TEST(DeformGeometry, OutsideTheMesh)
{
  // A mesh that contains only the middle of the volume.
  const World shift{ glm::dmat3(1.25, 0, 0, 0, 1, 0, 0, 0, 1), glm::dvec3(3.5, 0.0, 1.25) };
  auto volume =
    MakeWorldVolume(shift, { { 0, 12, 0, 12, 0, 12 } }, glm::dvec3(1.0), glm::dvec3(0.0), false);
  auto core = MakeImage({ { 3, 8, 3, 9, 4, 8 } });
  auto mesh = MakeMesh(core, 3, 0.0);
  SetDisplacements(mesh, [&shift](const glm::dvec3& p) { return shift.Move(p); });
  Deformed deformed(volume, mesh);
  deformed.Update();
  CheckValues(deformed, core, shift);
  CheckTightExtent(deformed.Filter->GetOutput(), core, shift);
  deformed.Filter->SetOutsideModeToExtrapolate();
  deformed.Update();
  CheckValues(deformed, volume, shift);
  CheckTightExtent(deformed.Filter->GetOutput(), volume, shift);
  deformed.Filter->SetOutsideModeToDiscard();
  deformed.Update();
  CheckValues(deformed, core, shift);

  // A mesh that ends between voxels: x from 3.1 to 8.8, y from 3.2 to 9.9, z from 3.35 to 8.05. The
  // engine's TestMeshBoundary has bodies of other shapes and poses.
  const auto between = MakeTetrahedra({ { 2.6, 8.3, 2.7, 9.4, 3.6, 8.3 } }, { { 3, 3, 3 } });
  SetDisplacements(between, Shift(0.5, 0.5, -0.25));
  deformed.Filter->SetDeformationData(between);
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { 4, 8, 4, 9, 4, 8 } }));
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), 5 * 6 * 5);

  // The same with a field.
  auto field = MakeImage({ { 0, 5, 0, 6, 0, 4 } }, glm::dvec3(1.0), glm::dvec3(3.0, 3.0, 4.0));
  SetDisplacements(field, Shift(2.0, -1.0, 0.5));
  const World uniform{ glm::dmat3(1.0), glm::dvec3(2.0, -1.0, 0.5) };
  deformed.Filter->SetDeformationData(field);
  deformed.Update();
  CheckValues(deformed, core, uniform);
  deformed.Filter->SetOutsideModeToExtrapolate();
  deformed.Update();
  CheckValues(deformed, volume, uniform);
}

} // namespace
