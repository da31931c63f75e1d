// SPDX-License-Identifier: BSD-3-Clause
// Without a deformation on port 1 the output is the volume at rest, as with a deformation of zeros.
#include "ArrayMaking.h"
#include "FilterTesting.h"

#include <vtkCellData.h>
#include <vtkUnsignedCharArray.h>

#include <functional>
#include <limits>
#include <utility>
#include <vector>

using namespace filterTesting;

namespace
{

vtkSmartPointer<vtkImageData> MakeCutVolume()
{
  auto volume = MakeVolume({ { -3, 9, 2, 12, 5, 14 } });
  volume->SetSpacing(0.7, 1.1, 2.3);
  volume->SetOrigin(100.0, -50.0, 7.0);
  SetObliqueDirection(volume);
  AddScalars<float>(volume, "more", [](const glm::dvec3& p) { return 0.1 * p.x - p.y * p.z; });
  const auto active =
    MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", volume->GetNumberOfCells());
  for (vtkIdType cell = 0; cell < volume->GetNumberOfCells(); ++cell)
  {
    active->SetValue(cell, static_cast<unsigned char>(cell % 12 < 5 ? cell % 32 : 31));
  }
  volume->GetCellData()->AddArray(active);
  return volume;
}

// A field of zeros whose points are the voxels, and one more layer of points around them.
vtkSmartPointer<vtkImageData> MakeZeros(vtkImageData* volume)
{
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  Extent extent = GetExtent(volume);
  for (int i = 0; i < 6; ++i)
  {
    extent[i] += i % 2 == 0 ? -1 : 1;
  }
  field->SetExtent(extent.data());
  SetDisplacements(field, Shift(0.0, 0.0, 0.0));
  return field;
}

TEST(DeformAtRest, Misuse)
{
  const auto volume = MakeVolume();
  const auto mesh = MakeMesh(volume);
  Deformed subject;
  subject.Filter->SetInputData(volume);
  subject.Filter->SetRestData(mesh);
  subject.VerifyFailure("no deformation on input port 1");

  // A connected deformation must not be empty.
  subject.Filter->SetRestConnection(nullptr);
  for (vtkDataObject* empty : { static_cast<vtkDataObject*>(vtkUnstructuredGrid::New()),
         static_cast<vtkDataObject*>(vtkImageData::New()) })
  {
    subject.Filter->SetDeformationData(empty);
    empty->Delete();
    EXPECT_FALSE(subject.Filter->GetExecutive()->Update());
    EXPECT_EQ(subject.TakeErrors(), 1);
    EXPECT_EQ(subject.Filter->GetOutput()->GetNumberOfPoints(), 0);
  }
  subject.Filter->SetDeformationConnection(nullptr);
  EXPECT_EQ(GetExtent(subject.Update()), GetExtent(volume));

  // Mesh rasterization cannot do smooth cuts, also without a deformation.
  const auto cut = MakeVolume();
  const auto crossed = MakeArray<vtkUnsignedCharArray>("CutTetrahedra", cut->GetNumberOfCells());
  crossed->Fill(31);
  cut->GetCellData()->AddArray(crossed);
  AddScalars<float>(cut, "CutDistance", [](const glm::dvec3& p) { return p.x - 4.5; });
  subject.Filter->SetInputData(cut);
  subject.Filter->SetResamplerToMeshRasterization();
  subject.VerifyFailure("cannot do smooth cuts");
  subject.Filter->SetResamplerToAutomatic();
  subject.Update();
  EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), cut->GetNumberOfPoints());

  // The volume is still required.
  Deformed nothing;
  nothing.Filter->Update();
  EXPECT_TRUE(HasPart(nothing.ExecutiveObserver->GetErrorMessage(), "not optional"));
}

TEST(DeformAtRest, VolumeItself)
{
  const auto volume = MakeVolume({ { -3, 9, 2, 12, 5, 14 } });
  SetObliqueDirection(volume);
  for (const int resampler :
    { vtkDeformVolumeFilter::EXACT, vtkDeformVolumeFilter::MESH_RASTERIZATION })
  {
    Deformed subject;
    subject.Filter->SetInputData(volume);
    subject.Filter->SetResampler(resampler);
    vtkImageData* output = subject.Update();
    EXPECT_EQ(GetExtent(output), GetExtent(volume));
    EXPECT_TRUE(HaveEqualBits(subject.GetValues(), volume->GetPointData()->GetScalars()));
    EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
    EXPECT_EQ(subject.Filter->GetResamplerInUse(), resampler);
  }
}

// Different settings, without a deformation and with a deformation of zeros.
TEST(DeformAtRest, Settings)
{
  using Setting = std::pair<const char*, std::function<void(vtkDeformVolumeFilter*)>>;
  const std::vector<Setting> settings{
    { "none", [](vtkDeformVolumeFilter*) {} },
    { "volume bounds", [](vtkDeformVolumeFilter* f) { f->SetOutputBoundsModeToVolumeBounds(); } },
    { "custom bounds",
      [](vtkDeformVolumeFilter* f)
      {
        f->SetOutputBoundsModeToCustomBounds();
        f->SetCustomBounds(98.0, 104.0, -60.0, -40.0, 0.0, 30.0);
      } },
    { "padding", [](vtkDeformVolumeFilter* f) { f->SetPadding(2); } },
    { "granularity", [](vtkDeformVolumeFilter* f) { f->SetBoundsGranularity(8); } },
    { "spacing",
      [](vtkDeformVolumeFilter* f)
      {
        f->SetOutputSpacingModeToCustomSpacing();
        f->SetCustomSpacing(0.45, 0.8, 1.9);
      } },
    { "coarse", [](vtkDeformVolumeFilter* f) { f->SetSamplingFactor(2); } },
    { "extrapolate", [](vtkDeformVolumeFilter* f) { f->SetOutsideModeToExtrapolate(); } },
    { "rasterization", [](vtkDeformVolumeFilter* f) { f->SetResamplerToMeshRasterization(); } },
    { "cubic", [](vtkDeformVolumeFilter* f) { f->SetInterpolationToCubicInterpolation(); } },
  };
  const auto volume = MakeCutVolume();
  const auto zeros = MakeZeros(volume);
  Deformed kept;
  kept.Filter->SetInputData(volume);
  for (const Setting& setting : settings)
  {
    Deformed expected(volume, zeros);
    setting.second(expected.Filter);
    if (setting.first == std::string("rasterization"))
    {
      expected.Filter->FieldIsInverseOn();
    }
    Deformed subject;
    subject.Filter->SetInputData(volume);
    setting.second(subject.Filter);
    // Settings of the deformation are ignored.
    subject.Filter->PointsAreDeformedOn();
    subject.Filter->FieldIsInverseOn();
    subject.Filter->SetDisplacementScale(-3.0);
    subject.Filter->SetInputArrayToProcess(
      0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "nowhere");
    vtkImageData* output = subject.Update();
    // A deformation of zeros.
    EXPECT_TRUE(AreEqual(output, expected.Update())) << setting.first;
    EXPECT_GT(output->GetNumberOfPoints(), 0) << setting.first;
    EXPECT_GT(subject.Filter->GetNumberOfCoveredVoxels(), 0);
    EXPECT_LT(subject.Filter->GetNumberOfCoveredVoxels(), output->GetNumberOfPoints());
  }
}

// A cut volume at rest, and deformations that are connected and disconnected.
TEST(DeformAtRest, Connecting)
{
  const auto volume = MakeCutVolume();
  auto whole = vtkSmartPointer<vtkImageData>::New();
  whole->ShallowCopy(volume);
  whole->GetCellData()->Initialize();
  Deformed subject;
  subject.Filter->SetInputData(whole);
  vtkNew<vtkImageData> atRest;
  atRest->DeepCopy(subject.Update());
  EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), whole->GetNumberOfPoints());
  subject.Filter->SetInputData(volume);
  vtkNew<vtkImageData> cut;
  cut->DeepCopy(subject.Update());
  EXPECT_LT(subject.Filter->GetNumberOfCoveredVoxels(), whole->GetNumberOfPoints());

  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(3.0, 0.0, 1.0));
  subject.Filter->SetDeformationData(mesh);
  EXPECT_FALSE(AreEqual(subject.Update(), cut));
  subject.Filter->SetDeformationData(nullptr);
  EXPECT_TRUE(AreEqual(subject.Update(), cut));
  subject.Filter->SetInputData(whole);
  EXPECT_TRUE(AreEqual(subject.Update(), atRest));
}

} // namespace
