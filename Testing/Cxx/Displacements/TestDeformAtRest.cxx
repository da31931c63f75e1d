// SPDX-License-Identifier: BSD-3-Clause
// Without a deformation on port 1 the output is the volume at rest, as with a deformation of zeros.
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
  volume->GetPointData()->SetActiveScalars(nullptr); // otherwise the array would be replaced
  AddScalars<float>(volume, "more", [](const glm::dvec3& p) { return 0.1 * p.x - p.y * p.z; });
  vtkNew<vtkUnsignedCharArray> active;
  active->SetName("ActiveTetrahedra");
  active->SetNumberOfTuples(volume->GetNumberOfCells());
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

void TestMisuse()
{
  const auto volume = MakeVolume();
  const auto mesh = MakeMesh(volume);
  Deformed subject;
  subject.Filter->SetInputData(volume);
  subject.Filter->SetRestData(mesh);
  VERIFY(!subject.Filter->GetExecutive()->Update());
  VERIFY_EQUAL(subject.TakeErrors(), 1);
  VERIFY_CONTAINS(subject.LastError, "no deformation on input port 1");
  VERIFY_EQUAL(subject.Filter->GetOutput()->GetNumberOfPoints(), 0);

  // A connected deformation must not be empty.
  subject.Filter->SetRestConnection(nullptr);
  for (vtkDataObject* empty : { static_cast<vtkDataObject*>(vtkUnstructuredGrid::New()),
         static_cast<vtkDataObject*>(vtkImageData::New()) })
  {
    subject.Filter->SetDeformationData(empty);
    empty->Delete();
    VERIFY(!subject.Filter->GetExecutive()->Update());
    VERIFY_EQUAL(subject.TakeErrors(), 1);
    VERIFY_EQUAL(subject.Filter->GetOutput()->GetNumberOfPoints(), 0);
  }
  subject.Filter->SetDeformationConnection(nullptr);
  VERIFY_EQUAL(GetExtent(subject.Update()), GetExtent(volume));

  // Mesh rasterization cannot do smooth cuts, also without a deformation.
  const auto cut = MakeVolume();
  vtkNew<vtkUnsignedCharArray> crossed;
  crossed->SetName("CutTetrahedra");
  crossed->SetNumberOfTuples(cut->GetNumberOfCells());
  crossed->Fill(31);
  cut->GetCellData()->AddArray(crossed);
  cut->GetPointData()->SetActiveScalars(nullptr);
  AddScalars<float>(cut, "CutDistance", [](const glm::dvec3& p) { return p.x - 4.5; });
  subject.Filter->SetInputData(cut);
  subject.Filter->SetResamplerToMeshRasterization();
  VERIFY(!subject.Filter->GetExecutive()->Update());
  VERIFY_EQUAL(subject.TakeErrors(), 1);
  VERIFY_CONTAINS(subject.LastError, "cannot do smooth cuts");
  subject.Filter->SetResamplerToAutomatic();
  subject.Update();
  VERIFY_EQUAL(subject.Filter->GetNumberOfCoveredVoxels(), cut->GetNumberOfPoints());

  // The volume is still required.
  Deformed nothing;
  nothing.Filter->Update();
  VERIFY_CONTAINS(nothing.ExecutiveObserver->GetErrorMessage(), "not optional");
}

void TestVolumeItself()
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
    VERIFY_EQUAL(GetExtent(output), GetExtent(volume));
    VERIFY(HaveEqualBits(subject.GetValues(), volume->GetPointData()->GetScalars()));
    VERIFY_EQUAL(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
    VERIFY_EQUAL(subject.Filter->GetResamplerInUse(), resampler);
  }
}

// Different settings, without a deformation and with a deformation of zeros.
void TestSettings()
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
    if (!AreEqual(output, expected.Update()) || output->GetNumberOfPoints() == 0)
    {
      std::cerr << setting.first << ": the output differs from that of a deformation of zeros\n";
      VERIFY(false);
    }
    VERIFY(subject.Filter->GetNumberOfCoveredVoxels() > 0);
    VERIFY(subject.Filter->GetNumberOfCoveredVoxels() < output->GetNumberOfPoints());
  }
}

// A cut volume at rest, and deformations that are connected and disconnected.
void TestConnecting()
{
  const auto volume = MakeCutVolume();
  auto whole = vtkSmartPointer<vtkImageData>::New();
  whole->ShallowCopy(volume);
  whole->GetCellData()->Initialize();
  Deformed subject;
  subject.Filter->SetInputData(whole);
  vtkNew<vtkImageData> atRest;
  atRest->DeepCopy(subject.Update());
  VERIFY_EQUAL(subject.Filter->GetNumberOfCoveredVoxels(), whole->GetNumberOfPoints());
  subject.Filter->SetInputData(volume);
  vtkNew<vtkImageData> cut;
  cut->DeepCopy(subject.Update());
  VERIFY(subject.Filter->GetNumberOfCoveredVoxels() < whole->GetNumberOfPoints());

  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(3.0, 0.0, 1.0));
  subject.Filter->SetDeformationData(mesh);
  VERIFY(!AreEqual(subject.Update(), cut));
  subject.Filter->SetDeformationData(nullptr);
  VERIFY(AreEqual(subject.Update(), cut));
  subject.Filter->SetInputData(whole);
  VERIFY(AreEqual(subject.Update(), atRest));
}

} // namespace

int TestDeformAtRest(int, char*[])
{
  TestMisuse();
  TestVolumeItself();
  TestSettings();
  TestConnecting();
  return GetExitCode();
}
