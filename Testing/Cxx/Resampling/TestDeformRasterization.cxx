// SPDX-License-Identifier: BSD-3-Clause
// The resamplers MESH_RASTERIZATION and AUTOMATIC of the filter, and cubic interpolation.
#include "ArrayMaking.h"
#include "DeviceNeeds.h"
#include "FilterTesting.h"

#include <vtkCellData.h>
#include <vtkDataSetAttributes.h>
#include <vtkImageInterpolator.h>
#include <vtkUnsignedCharArray.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>

using namespace filterTesting;

namespace
{

class DeformRasterization : public testing::Test
{
  void SetUp() override { SKIP_WITHOUT_DOUBLE_PRECISION() }
};

const Extent Box{ { -3, 16, 2, 17, -8, 10 } };

glm::dvec3 BendPoint(const glm::dvec3& p)
{
  return p + glm::dvec3(0.9 * std::sin(0.25 * p.y), 0.4, 0.8 * std::cos(0.3 * p.x));
}

std::string GetError(Deformed& deformed)
{
  deformed.Filter->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeErrors(), 1);
  EXPECT_EQ(deformed.Filter->GetOutput()->GetNumberOfPoints(), 0);
  return deformed.LastError;
}

TEST_F(DeformRasterization, Misuse)
{
  auto volume = MakeVolume(Box);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, BendPoint);
  auto field = MakeImage(Box);
  SetDisplacements(field, BendPoint);

  Deformed byField(volume, field);
  byField.Filter->SetResamplerToMeshRasterization();
  EXPECT_TRUE(HasPart(GetError(byField), "displacement fields"));
  byField.Filter->SetResamplerToAutomatic();
  byField.Update();
  EXPECT_EQ(byField.Filter->GetResamplerInUse(), int(vtkDeformVolumeFilter::EXACT));
  byField.Filter->SetInterpolationToCubicInterpolation();
  byField.Update();
  EXPECT_EQ(byField.Filter->GetResamplerInUse(), int(vtkDeformVolumeFilter::EXACT));

  Deformed deformed(volume, mesh);
  EXPECT_EQ(deformed.Filter->GetResamplerInUse(), int(vtkDeformVolumeFilter::AUTOMATIC));
  deformed.Filter->SetResamplerToMeshRasterization();
  deformed.Filter->SetOutsideModeToExtrapolate();
  EXPECT_TRUE(HasPart(GetError(deformed), "OutsideMode"));
  deformed.Filter->SetOutsideModeToDiscard();
  deformed.Filter->SetInterpolationToCubicInterpolation();
  deformed.Filter->SetResamplerToExact();
  deformed.Filter->SetResampler(1);
  EXPECT_EQ(deformed.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(deformed.LastError, "AUTOMATIC (3)"));
  EXPECT_EQ(deformed.Filter->GetResampler(), int(vtkDeformVolumeFilter::EXACT));
  deformed.Filter->SetFromState("Resampler", vtkDeformVolumeFilter::MESH_RASTERIZATION);
  EXPECT_EQ(deformed.Filter->GetResampler(), int(vtkDeformVolumeFilter::MESH_RASTERIZATION));
  for (const char* name : { "Padding", "", static_cast<const char*>(nullptr) })
  {
    deformed.Filter->SetFromState(name, 1);
    EXPECT_EQ(deformed.TakeErrors(), 1);
    EXPECT_TRUE(HasPart(deformed.LastError, "does not know the property"));
  }
  deformed.Filter->SetMemoryLimit(1000);
  EXPECT_TRUE(HasPart(GetError(deformed), "1000"));
  deformed.Filter->SetMemoryLimit(0);
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetResamplerInUse(), int(vtkDeformVolumeFilter::MESH_RASTERIZATION));

  // Only a lack of memory makes AUTOMATIC choose mesh rasterization. Its error would be another
  // one.
  const auto huge = MakeMesh(volume, 2, 1e10);
  SetDisplacements(huge, Shift(0.0, 0.0, 0.0));
  Deformed byHuge(volume, huge);
  EXPECT_TRUE(HasPart(GetError(byHuge), "more than 2147483648 voxels"));
}

// Both resamplers reproduce a volume of any geometry that is at rest, or moved by whole voxels.
TEST_F(DeformRasterization, Undeformed)
{
  for (const double sign : { 1.0, -1.0 })
  {
    for (const double voxels : { 0.0, 3.0 })
    {
      auto volume = MakeImage(Box, glm::dvec3(0.5, sign * 2.0, 1.25), glm::dvec3(10.0, -20.0, 3.0));
      if (sign > 0.0)
      {
        SetObliqueDirection(volume);
      }
      AddScalars<float>(volume, "value",
        [](const glm::dvec3& p) { return std::sin(p.x) - std::cos(13.0 * p.y * p.z); });
      volume->GetPointData()->GetScalars()->SetComponent(1234, 0, std::nan(""));
      volume->GetPointData()->GetScalars()->SetComponent(99, 0, -0.0);
      auto mesh = MakeMesh(volume, 4);
      const glm::dvec3 step = GetPoint(volume, 1) - GetPoint(volume, 0);
      SetDisplacements(mesh, Shift(voxels * step.x, voxels * step.y, voxels * step.z));
      Deformed deformed(volume, mesh);
      deformed.Filter->SetResamplerToExact();
      vtkNew<vtkImageData> exact;
      exact->DeepCopy(deformed.Update());
      deformed.Filter->SetResamplerToMeshRasterization();
      EXPECT_TRUE(AreEqual(deformed.Update(), exact));
      EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
      EXPECT_TRUE(HaveEqualBits(deformed.GetValues(), volume->GetPointData()->GetScalars()));
    }
  }
}

// A linear function under an affine map of the world.
TEST_F(DeformRasterization, AffineMap)
{
  auto volume = MakeImage(Box, glm::dvec3(0.8, 1.1, -1.3), glm::dvec3(5.0, 6.0, 7.0));
  const auto function = [](const glm::dvec3& p) { return 3.0 * p.x - 2.0 * p.y + 0.5 * p.z; };
  AddScalars<short>(volume, "integer",
    [&](const glm::dvec3& p) { return std::round(20.0 * function(p) + 2000.0); });
  AddScalars<float>(volume, "value", function);
  auto mesh = MakeMesh(volume, 3, 1.0);
  const glm::dmat3 matrix(1.1, 0.2, -0.1, -0.3, 0.9, 0.15, 0.05, -0.2, 1.3);
  const glm::dvec3 offset(0.37, -1.2, 2.5);
  SetDisplacements(mesh, [&](const glm::dvec3& p) { return matrix * p + offset; });
  Deformed deformed(volume, mesh);
  deformed.Filter->SetResamplerToMeshRasterization();
  deformed.Filter->SetOutputSpacingModeToCustomSpacing();
  deformed.Filter->SetCustomSpacing(0.6, 0.7, 0.9);
  vtkImageData* output = deformed.Update();
  vtkDataArray* integers = output->GetPointData()->GetArray("integer");
  double bounds[6];
  volume->GetBounds(bounds);
  vtkIdType covered = 0;
  int wrong = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 rest = glm::inverse(matrix) * (GetPoint(output, id) - offset);
    double outside = -1e9;
    for (int axis = 0; axis < 3; ++axis)
    {
      outside =
        std::max({ outside, bounds[2 * axis] - rest[axis], rest[axis] - bounds[2 * axis + 1] });
    }
    // Positions are rounded to 1/256 voxel, which moves the surface.
    if (std::abs(outside) > 0.01)
    {
      wrong += deformed.IsCovered(id) != (outside < 0.0);
    }
    if (deformed.IsCovered(id))
    {
      ++covered;
      // Displacements are linear over the mesh, except for the rounding of positions (1/512 voxel
      // on each axis) and of displacements (float).
      wrong += std::abs(deformed.GetValues()->GetComponent(id, 0) - function(rest)) > 0.02;
      wrong += std::abs(integers->GetComponent(id, 0) - (20.0 * function(rest) + 2000.0)) >
        0.5 + 0.4 + 0.5;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(covered, deformed.Filter->GetNumberOfCoveredVoxels());
  EXPECT_GT(covered, 5000);

  // The report: no static mapping is built, and a moved mesh does not upload the volume again.
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 0);
  EXPECT_EQ(GetReported(deformed.Filter, "Volumes sent"), 1);
  EXPECT_EQ(GetReportedSeconds(deformed.Filter, "Seconds for the static mapping"), 0.0);
  EXPECT_GT(GetReportedSeconds(deformed.Filter, "Seconds for mapping"), 0.0);
  EXPECT_GT(GetReportedSeconds(deformed.Filter, "Seconds for resampling"), 0.0);
  EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), 0);
  EXPECT_EQ(deformed.Filter->GetNumberOfFlatTetrahedra(), 0);
  SetDisplacements(mesh, [](const glm::dvec3& p) { return glm::dvec3(-p.x, p.y, p.z); });
  deformed.Update();
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 0);
  EXPECT_EQ(GetReported(deformed.Filter, "Volumes sent"), 1);
  EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), mesh->GetNumberOfCells());
  EXPECT_GT(deformed.Filter->GetNumberOfCoveredVoxels(), 5000);

  // Change to the other resampler and back.
  deformed.Filter->SetResamplerToExact();
  deformed.Update();
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 1);
  deformed.Filter->SetResamplerToMeshRasterization();
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  deformed.Filter->SetOutputSpacingModeToVolumeSpacing();
  EXPECT_TRUE(HaveEqualBits(deformed.Update()->GetPointData()->GetArray("value"),
    volume->GetPointData()->GetArray("value")));
}

// In an undeformed volume masks hide the same samples with both resamplers.
TEST_F(DeformRasterization, Masks)
{
  auto volume = MakeVolume(Box);
  const auto active =
    MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", volume->GetNumberOfCells());
  for (vtkIdType cell = 0; cell < volume->GetNumberOfCells(); ++cell)
  {
    active->SetValue(cell, static_cast<unsigned char>(cell * 7919 % 32));
  }
  volume->GetCellData()->AddArray(active);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputSpacingModeToCustomSpacing();
  deformed.Filter->SetCustomSpacing(0.25, 0.25, 0.25);
  deformed.Filter->SetResamplerToExact();
  vtkNew<vtkImageData> exact;
  exact->DeepCopy(deformed.Update());
  deformed.Filter->SetResamplerToMeshRasterization();
  deformed.Update();
  EXPECT_TRUE(HaveEqualBits(exact->GetPointData()->GetArray("vtkValidPointMask"),
    deformed.Filter->GetOutput()->GetPointData()->GetArray("vtkValidPointMask")));
  EXPECT_GT(deformed.Filter->GetNumberOfCoveredVoxels(), 1000);
  EXPECT_LT(deformed.Filter->GetNumberOfCoveredVoxels(), exact->GetNumberOfPoints());

  // With a blanked point, samples to whose value it contributes are not covered.
  volume->GetCellData()->RemoveArray("ActiveTetrahedra");
  const auto ghosts = MakeArray<vtkUnsignedCharArray>(
    vtkDataSetAttributes::GhostArrayName(), volume->GetNumberOfPoints());
  const int center[3] = { 4, 9, -1 };
  ghosts->SetValue(
    volume->ComputePointId(const_cast<int*>(center)), vtkDataSetAttributes::HIDDENPOINT);
  volume->GetPointData()->AddArray(ghosts);
  for (const bool cubic : { false, true })
  {
    deformed.Filter->SetInterpolation(cubic ? vtkDeformVolumeFilter::CUBIC_INTERPOLATION
                                            : vtkDeformVolumeFilter::LINEAR_INTERPOLATION);
    vtkImageData* output = deformed.Update();
    int wrong = 0;
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 d = glm::abs(GetPoint(output, id) - glm::dvec3(4.0, 9.0, -1.0));
      bool weighs = true;
      for (int axis = 0; axis < 3; ++axis)
      {
        weighs &= d[axis] < (cubic ? 2.0 : 1.0) && !(d[axis] == 1.0);
      }
      wrong += deformed.IsCovered(id) == weighs;
    }
    EXPECT_EQ(wrong, 0);
  }
}

// Compares cubic interpolation with that of VTK, but for the outermost cells of the volume, where
// the two differ.
TEST_F(DeformRasterization, Cubic)
{
  auto volume = MakeImage(Box);
  AddScalars<double>(volume, "value",
    [](const glm::dvec3& p) { return std::sin(1.7 * p.x) + std::cos(2.1 * p.y) * p.z; });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.25, -0.625, 0.125));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetInterpolationToCubicInterpolation();
  vtkNew<vtkImageInterpolator> interpolator;
  interpolator->SetInterpolationModeToCubic();
  interpolator->Initialize(volume);
  const glm::dvec3 low = GetPoint(volume, 0);
  const glm::dvec3 high = GetPoint(volume, volume->GetNumberOfPoints() - 1);
  for (const int resampler : { int(vtkDeformVolumeFilter::MESH_RASTERIZATION),
         int(vtkDeformVolumeFilter::EXACT), int(vtkDeformVolumeFilter::AUTOMATIC) })
  {
    deformed.Filter->SetResampler(resampler);
    vtkImageData* output = deformed.Update();
    const bool isRasterized = resampler == vtkDeformVolumeFilter::MESH_RASTERIZATION;
    EXPECT_EQ(deformed.Filter->GetResamplerInUse(),
      int(isRasterized ? vtkDeformVolumeFilter::MESH_RASTERIZATION : vtkDeformVolumeFilter::EXACT));
    double largest = 0.0;
    vtkIdType compared = 0;
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 rest = GetPoint(output, id) - glm::dvec3(0.25, -0.625, 0.125);
      const bool isInside =
        glm::all(glm::greaterThan(rest, low + 1.0)) && glm::all(glm::lessThan(rest, high - 1.0));
      if (deformed.IsCovered(id) && isInside)
      {
        const double expected = interpolator->Interpolate(rest.x, rest.y, rest.z, 0);
        largest = std::max(largest, std::abs(deformed.GetValues()->GetComponent(id, 0) - expected));
        ++compared;
      }
    }
    EXPECT_GT(compared, 2000);
    EXPECT_LT(largest, 1e-9); // rest coordinates are multiples of 1/8, hence exact
  }
}

// The memory limit decides which resampler AUTOMATIC chooses, for all parts of an output alike.
TEST_F(DeformRasterization, Automatic)
{
  auto volume = MakeVolume({ { 0, 63, 0, 63, 0, 63 } });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, BendPoint);
  Deformed deformed(volume, mesh);
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetResamplerInUse(), int(vtkDeformVolumeFilter::EXACT));
  const vtkIdType voxels = volume->GetNumberOfPoints();
  // The least sufficient memory limit is not enough for EXACT.
  vtkIdType limit = voxels;
  do
  {
    limit += voxels / 16;
    deformed.Filter->SetMemoryLimit(limit);
    deformed.Filter->Update();
  } while (deformed.TakeErrors() > 0 && limit < 100 * voxels);
  EXPECT_EQ(deformed.Filter->GetResamplerInUse(), int(vtkDeformVolumeFilter::MESH_RASTERIZATION));
  deformed.Filter->ReleaseDeviceMemory();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(deformed.Update());
  EXPECT_LT(deformed.Filter->GetDeviceMemory(), limit);
  int part[6] = { 7, 40, 3, 37, 11, 29 };
  deformed.Filter->Modified();
  deformed.Filter->UpdateExtent(part);
  EXPECT_EQ(deformed.TakeErrors(), 0);
  EXPECT_EQ(deformed.Filter->GetResamplerInUse(), int(vtkDeformVolumeFilter::MESH_RASTERIZATION));
  int wrong = 0;
  vtkImageData* output = deformed.Filter->GetOutput();
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const vtkIdType other = whole->FindPoint(output->GetPoint(id));
    wrong += deformed.GetValues()->GetComponent(id, 0) !=
      whole->GetPointData()->GetScalars()->GetComponent(other, 0);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(output->GetNumberOfPoints(), 34 * 35 * 19);

  // Features that need the exact resampler fail with its error.
  deformed.Filter->SetOutsideModeToExtrapolate();
  EXPECT_TRUE(HasPart(GetError(deformed), std::to_string(limit)));
  deformed.Filter->SetOutsideModeToDiscard();
  deformed.Filter->AddDensityArray(volume->GetPointData()->GetScalars()->GetName());
  EXPECT_TRUE(HasPart(GetError(deformed), std::to_string(limit)));
  deformed.Filter->ClearDensityArrays();
  deformed.Update();
}

} // namespace
