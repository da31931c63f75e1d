// SPDX-License-Identifier: BSD-3-Clause
// The filter where the environment lacks something: one error that says what to do and no output,
// or a way round it. The environment cannot change within a process, so each case is a run of its
// own: its name and the words that the error must hold ("none" where there must be no error) are
// the first two arguments.
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

  // Twice, since the first failure must leave the process and the filter in order.
  for (int i = 0; i < 2; ++i)
  {
    deformed.Filter->Modified();
    deformed.Filter->Update();
    VERIFY_EQUAL(deformed.TakeErrors(), 1);
    if (deformed.LastError.find(words) == std::string::npos)
    {
      std::cerr << "The error does not speak of \"" << words
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
    // What is asked for explicitly goes before the variable.
    deformed.Filter->SetDevice("cpu");
    vtkImageData* output = deformed.Update();
    VERIFY(
      HaveEqualBits(output->GetPointData()->GetScalars(), volume->GetPointData()->GetScalars()));
  }
  return GetExitCode();
}
