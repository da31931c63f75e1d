// SPDX-License-Identifier: BSD-3-Clause
// The filter in an environment without driver, home directory, cache or linker: it reports one
// error that says what to do, or works without them. The environment cannot change within a
// process, so each case is a process of its own. The first two arguments are the name of the case,
// and words that the error must contain, or "none" if there must be no error.
#include "FilterTesting.h"

#include <vtkStringArray.h>

using namespace filterTesting;

int TestEnvironment(int argc, char* argv[])
{
  if (argc < 3)
  {
    std::cerr << "The arguments are missing.\n";
    return EXIT_FAILURE;
  }
  const std::string name = argv[1];
  const std::string words = argv[2];

  const auto volume = MakeVolume();
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0, 0, 0));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "displacement");

  if (words == "none")
  {
    vtkImageData* output = deformed.Update();
    VERIFY(
      HaveEqualBits(output->GetPointData()->GetScalars(), volume->GetPointData()->GetScalars()));
    return GetExitCode();
  }

  // The second update fails in the same way as the first one.
  for (int i = 0; i < 2; ++i)
  {
    deformed.Filter->Modified();
    deformed.Filter->Update();
    VERIFY_EQUAL(deformed.TakeErrors(), 1);
    if (deformed.LastError.find(words) == std::string::npos)
    {
      std::cerr << "The error does not contain \"" << words
                << "\": " << deformed.LastError.substr(deformed.LastError.find("):") + 1);
      VERIFY(false);
    }
    VERIFY_EQUAL(deformed.Filter->GetOutput()->GetPointData()->GetNumberOfArrays(), 0);
  }

  if (name == "NoPlatform")
  {
    const auto names =
      vtkSmartPointer<vtkStringArray>::Take(vtkDeformVolumeFilter::GetDeviceNames());
    VERIFY_EQUAL(names->GetNumberOfValues(), 0);
  }
  if (name == "UnknownDefaultDevice")
  {
    // SetDevice() has priority over the environment variable.
    deformed.Filter->SetDevice("cpu");
    vtkImageData* output = deformed.Update();
    VERIFY(
      HaveEqualBits(output->GetPointData()->GetScalars(), volume->GetPointData()->GetScalars()));
  }
  return GetExitCode();
}
