// SPDX-License-Identifier: BSD-3-Clause
// The resamplers MESH_RASTERIZATION and AUTOMATIC of the filter, and cubic interpolation.
#include "DeviceNeeds.h"
#include "FilterTesting.h"

#include <vtkImageInterpolator.h>

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

// No static mapping is built, and a moved mesh does not send the volume again. A change to the
// other resampler and back sends it, and a volume at rest has the same values.
TEST_F(DeformRasterization, Reports)
{
  auto volume = MakeVolume(Box);
  auto mesh = MakeMesh(volume, 3, 1.0);
  Deformed deformed(volume, mesh);
  const auto update = [&](int resampler, const WorldMap& map, int builds, int sent)
  {
    SetDisplacements(mesh, map);
    deformed.Filter->SetResampler(resampler);
    deformed.Update();
    EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), builds);
    EXPECT_EQ(GetReported(deformed.Filter, "Volumes sent"), sent);
    EXPECT_EQ(GetReportedSeconds(deformed.Filter, "Seconds for the static mapping") > 0.0,
      resampler == vtkDeformVolumeFilter::EXACT);
    EXPECT_GT(GetReportedSeconds(deformed.Filter, "Seconds for resampling"), 0.0);
  };
  update(vtkDeformVolumeFilter::MESH_RASTERIZATION, BendPoint, 0, 1);
  EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), 0);
  update(
    vtkDeformVolumeFilter::MESH_RASTERIZATION,
    [](const glm::dvec3& p) { return glm::dvec3(-p.x, p.y, p.z); }, 0, 1);
  EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), mesh->GetNumberOfCells());
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
  update(vtkDeformVolumeFilter::EXACT, BendPoint, 1, 2);
  update(vtkDeformVolumeFilter::MESH_RASTERIZATION, Shift(0.0, 0.0, 0.0), 1, 3);
  EXPECT_TRUE(HaveEqualBits(deformed.GetValues(), volume->GetPointData()->GetScalars()));
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
