// SPDX-License-Identifier: BSD-3-Clause
// The filter in an environment without driver, home directory, cache or linker, with a cache that
// is removed, and in a forked process: it reports one error that says what to do, or works. The
// environment cannot change within a process, so CTest runs each test in a process of its own.
#include "FilterTesting.h"

#include <vtkStringArray.h>

#include <filesystem>

#include <sys/wait.h>
#include <unistd.h>

using namespace filterTesting;

namespace
{

class Environment : public testing::Test
{
protected:
  Environment()
  {
    SetDisplacements(this->Mesh, Shift(0, 0, 0));
    this->Subject.Filter->SetInputArrayToProcess(
      0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "displacement");
  }

  void Succeeds()
  {
    this->Subject.Update();
    EXPECT_TRUE(
      HaveEqualBits(this->Subject.GetValues(), this->Volume->GetPointData()->GetScalars()));
  }

  void Fails(const std::string& words)
  {
    // The second update fails in the same way as the first one.
    for (int i = 0; i < 2; ++i)
    {
      this->Subject.Filter->Modified();
      this->Subject.Filter->Update();
      EXPECT_EQ(this->Subject.TakeErrors(), 1);
      EXPECT_TRUE(HasPart(this->Subject.LastError, words));
      EXPECT_EQ(this->Subject.Filter->GetOutput()->GetPointData()->GetNumberOfArrays(), 0);
    }
  }

  vtkSmartPointer<vtkImageData> Volume = MakeVolume();
  vtkSmartPointer<vtkUnstructuredGrid> Mesh = MakeMesh(Volume);
  Deformed Subject{ Volume, Mesh };
};

} // namespace

TEST_F(Environment, NoPlatform)
{
  this->Fails("pocl-opencl-icd");
  const auto names = vtkSmartPointer<vtkStringArray>::Take(vtkDeformVolumeFilter::GetDeviceNames());
  EXPECT_EQ(names->GetNumberOfValues(), 0);
}

TEST_F(Environment, UnknownDefaultDevice)
{
  this->Fails("no such device");
  // SetDevice() has priority over the environment variable.
  this->Subject.Filter->SetDevice("cpu");
  this->Succeeds();
}

TEST_F(Environment, DefaultDevice)
{
  this->Succeeds();
}

TEST_F(Environment, UnusableCache)
{
  this->Succeeds();
}

TEST_F(Environment, NoHome)
{
  this->Succeeds();
}

TEST_F(Environment, NoCache)
{
  this->Fails("POCL_CACHE_DIR");
}

// The cache is a relative path. The current directory changes, and somebody removes the cache: the
// kernels that are compiled then are written to the same place.
TEST_F(Environment, RemovedCache)
{
  const std::filesystem::path cache = std::filesystem::absolute("RemovedCache");
  this->Succeeds();
  EXPECT_TRUE(std::filesystem::exists(cache));
  std::filesystem::current_path(std::filesystem::temp_directory_path());
  std::filesystem::remove_all(cache);
  this->Subject.Filter->SetInterpolationToCubicInterpolation();
  this->Succeeds();
  EXPECT_TRUE(std::filesystem::exists(cache));
  std::filesystem::remove_all(cache);
}

TEST_F(Environment, Fork)
{
  this->Succeeds();
  const pid_t child = fork();
  if (child == 0)
  {
    alarm(60); // ends the child if it hangs
    this->Fails("forked");
    const auto names =
      vtkSmartPointer<vtkStringArray>::Take(vtkDeformVolumeFilter::GetDeviceNames());
    EXPECT_EQ(names->GetNumberOfValues(), 0);
    _exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  this->Succeeds();
}

TEST_F(Environment, NoLinker)
{
  this->Fails("cannot be run");
}

TEST_F(Environment, NoPath)
{
  this->Fails("PATH is not set");
}

TEST_F(Environment, NoLibraries)
{
  this->Fails("cannot find -lgcc");
}
