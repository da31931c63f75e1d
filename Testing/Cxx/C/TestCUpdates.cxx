// SPDX-License-Identifier: BSD-3-Clause
// Calls after changes of an input, which the device has a copy of, give the results of
// vtkDeformVolumeFilter, to the last bit.
#include "CTesting.h"
#include "FilterTesting.h"

using namespace filterTesting;

namespace
{

// Incremental calls after changes of displacements.
TEST(CUpdates, Displacements)
{
  const auto volume = MakeTwoArrays();
  auto mesh = MakeMesh(volume, 5);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::VOLUME_BOUNDS);
  InC inC;
  inC.IsIncremental = true;
  inC.SetVolume(volume, 0.0);
  inC.SetMesh(mesh);
  dv_output output = {};
  output.struct_size = sizeof(output);
  output.bounds_mode = DV_BOUNDS_VOLUME;
  Check(dv_set_output(inC.Deformer, &output));
  for (int step = 0; step < 4; ++step)
  {
    vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
    vectors->SetComponent(62, 0, 0.5 * step);
    vectors->Modified();
    inC.SetDisplacements(mesh);
    inC.Compare(deformed);
  }
}

// Other values in the same memory, for arrays with and without densities.
TEST(CUpdates, Values)
{
  const auto volume = MakeTwoArrays();
  auto mesh = MakeMesh(volume, 5);
  SetDisplacements(mesh, Bend);
  for (const bool isDensity : { false, true })
  {
    Deformed deformed(volume, mesh);
    InC inC;
    if (isDensity)
    {
      deformed.Filter->AddDensityArray("int16");
      inC.Densities = { "int16" };
    }
    inC.SetVolume(volume, 0.0);
    inC.SetMesh(mesh);
    inC.Compare(deformed);
    vtkDataArray* values = volume->GetPointData()->GetArray("int16");
    const vtkIdType middle = values->GetNumberOfTuples() / 2;
    const double value = values->GetComponent(middle, 0);
    values->SetComponent(middle, 0, value + 20000.0);
    values->Modified();
    inC.SetVolume(volume, 0.0);
    inC.Compare(deformed);
    values->SetComponent(middle, 0, value);
    values->Modified();
  }
}

} // namespace
