// SPDX-License-Identifier: BSD-3-Clause
// Compares a static mapping by runs, which the filter chooses if tetrahedra are large, with one by
// links, which it uses with extrapolation. The mesh contains the whole volume, so no voxel is
// extrapolated.
#include "FilterTesting.h"

#include <algorithm>

using namespace filterTesting;

namespace
{

const Extent Voxels{ { -4, 59, 3, 50, 0, 44 } };

double GetBytesPerVoxel(Deformed& deformed, vtkImageData* volume)
{
  return static_cast<double>(deformed.Filter->GetDeviceMemory()) /
    static_cast<double>(volume->GetNumberOfPoints());
}

struct Forms
{
  explicit Forms(vtkImageData* volume, vtkUnstructuredGrid* mesh)
    : Runs(volume, mesh)
    , Links(volume, mesh)
  {
    this->Links.Filter->SetOutsideModeToExtrapolate();
    this->Runs.Update();
    this->Links.Update();
    // Links need 16 bytes a voxel, and these runs less than 3.
    const double saved =
      GetBytesPerVoxel(this->Links, volume) - GetBytesPerVoxel(this->Runs, volume);
    std::cout << "runs save " << saved << " bytes a voxel\n";
    VERIFY(saved > 12.0 && saved < 16.0);
  }
  Deformed Runs;
  Deformed Links;
};

void TestWholeVoxels()
{
  auto volume = MakeVolume(Voxels);
  auto mesh = MakeMesh(volume, 4);
  for (const double shift : { 0.0, 7.0 })
  {
    SetDisplacements(mesh, Shift(shift, -2.0 * shift, shift));
    Forms forms(volume, mesh);
    VERIFY(AreEqual(forms.Runs.Filter->GetOutput(), forms.Links.Filter->GetOutput()));
    VERIFY(HaveEqualBits(forms.Runs.GetValues(), volume->GetPointData()->GetScalars()));
  }
}

void TestSmoothDeformation()
{
  auto volume = MakeImage(Voxels);
  AddScalars<float>(
    volume, "value", [](const glm::dvec3& p) { return p.x + 0.5 * p.y - 0.25 * p.z; });
  auto mesh = MakeMesh(volume, 4, 0.37);
  const auto bend = [](const glm::dvec3& p)
  {
    return p +
      glm::dvec3(2.0 * std::sin(0.1 * p.y), 1.5 * std::cos(0.08 * p.z), 2.5 * std::sin(0.07 * p.x));
  };
  SetDisplacements(mesh, bend);
  Forms forms(volume, mesh);
  vtkImageData* output = forms.Runs.Filter->GetOutput();
  forms.Links.Filter->SetOutputBoundsModeToCustomBounds();
  double bounds[6];
  output->GetBounds(bounds);
  forms.Links.Filter->SetCustomBounds(bounds);
  forms.Links.Update();
  VERIFY_EQUAL(GetExtent(output), GetExtent(forms.Links.Filter->GetOutput()));
  double largest = 0.0;
  vtkIdType alone = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    if (forms.Runs.IsCovered(id) != forms.Links.IsCovered(id))
    {
      ++alone;
    }
    else if (forms.Runs.IsCovered(id))
    {
      largest = std::max(largest,
        std::abs(forms.Runs.GetValues()->GetComponent(id, 0) -
          forms.Links.GetValues()->GetComponent(id, 0)));
    }
  }
  // Positions differ by at most 1/256 voxel, if they are rounded differently. Values change by at
  // most 1.75 a voxel, and the deformation stretches by at most 1.5.
  std::cout << "largest difference " << largest << ", covered by one form only: " << alone << "\n";
  VERIFY(largest <= 2.0 * 1.75 * 1.5 / 256.0);
  // Only voxels near the surface of the deformed volume may be covered by one form only.
  VERIFY(alone <= output->GetNumberOfPoints() / 10000);
}

// A coarse mesh, a finer mesh, the coarse mesh again, and other displacements of it.
void TestChangesOfForm()
{
  auto volume = MakeVolume(Voxels);
  auto coarse = MakeMesh(volume, 4);
  auto fine = MakeMesh(volume, 30);
  SetDisplacements(coarse, Shift(3.0, 1.0, 0.0));
  SetDisplacements(fine, Shift(3.0, 1.0, 0.0));
  Deformed deformed(volume, coarse);
  deformed.Update();
  auto expected = vtkSmartPointer<vtkImageData>::New();
  expected->DeepCopy(deformed.Filter->GetOutput());
  const double byRuns = GetBytesPerVoxel(deformed, volume);
  VERIFY_EQUAL(GetReported(deformed.Filter, "Static mappings made"), 1);
  deformed.Filter->SetDeformationData(fine);
  VERIFY(AreEqual(deformed.Update(), expected));
  VERIFY(GetBytesPerVoxel(deformed, volume) > byRuns + 10.0);
  VERIFY_EQUAL(GetReported(deformed.Filter, "Static mappings made"), 2);
  deformed.Filter->SetDeformationData(coarse);
  VERIFY(AreEqual(deformed.Update(), expected));
  VERIFY_EQUAL(GetReported(deformed.Filter, "Static mappings made"), 3);
  SetDisplacements(coarse, Shift(0.0, 0.0, 0.0));
  coarse->Modified();
  deformed.Update();
  VERIFY(HaveEqualBits(deformed.GetValues(), volume->GetPointData()->GetScalars()));
  VERIFY_EQUAL(GetReported(deformed.Filter, "Static mappings made"), 3);
}

// The check of the memory limit, before anything is allocated, knows the size of runs.
void TestMemoryLimit()
{
  auto volume = MakeVolume(Voxels);
  auto coarse = MakeMesh(volume, 4);
  SetDisplacements(coarse, Shift(1.0, 0.0, 0.0));
  // The limit is between the needs of the two forms, which depend on the device.
  Forms forms(volume, coarse);
  const auto limit =
    (forms.Runs.Filter->GetDeviceMemory() + forms.Links.Filter->GetDeviceMemory()) / 2;
  Deformed runs(volume, coarse);
  runs.Filter->SetMemoryLimit(limit);
  runs.Update();
  Deformed links(volume, coarse);
  links.Filter->SetOutsideModeToExtrapolate();
  links.Filter->SetMemoryLimit(limit);
  links.Filter->Update();
  VERIFY(links.TakeErrors() >= 1);
  VERIFY_CONTAINS(links.LastError, "bytes are needed");
}

} // namespace

int TestDeformMappingForms(int, char*[])
{
  TestWholeVoxels();
  TestSmoothDeformation();
  TestChangesOfForm();
  TestMemoryLimit();
  return GetExitCode();
}
