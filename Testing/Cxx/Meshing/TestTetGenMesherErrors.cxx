// SPDX-License-Identifier: BSD-3-Clause
// Errors of vtkTetGenMesher: invalid inputs, their messages, and valid inputs afterwards.
#include "vtkTetGenMesher.h"

#include "MeshChecks.h"
#include "RunTests.h"

#include <vtkAppendPolyData.h>
#include <vtkCallbackCommand.h>
#include <vtkCubeSource.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkPlaneSource.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkSphereSource.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

using namespace meshChecks;

namespace
{

/// Checks that the mesher leaves no temporary files.
class TetGenMesherErrors : public testing::Test
{
protected:
  void SetUp() override
  {
    std::filesystem::remove_all(this->Folder);
    std::filesystem::create_directories(this->Folder / "temporary");
    setenv("TMPDIR", (this->Folder / "temporary").c_str(), 1);
  }
  void TearDown() override
  {
    EXPECT_TRUE(std::filesystem::is_empty(this->Folder / "temporary"));
    unsetenv("TMPDIR");
  }
  const std::filesystem::path Folder =
    std::filesystem::absolute(GetTestArgument("-T")) / "TestTetGenMesherErrors";
};

vtkSmartPointer<vtkImageData> MakeVolume(double value)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetDimensions(20, 20, 20);
  vtkNew<vtkDoubleArray> values;
  values->SetName("values");
  values->SetNumberOfValues(volume->GetNumberOfPoints());
  values->Fill(value);
  volume->GetPointData()->SetScalars(values);
  return volume;
}

std::string WriteScript(const std::filesystem::path& folder, const char* name, const char* lines)
{
  const std::filesystem::path path = folder / name;
  std::ofstream(path) << "#!/bin/sh\n" << lines << '\n';
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path.string();
}

double SecondsSince(std::chrono::steady_clock::time_point start)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST_F(TetGenMesherErrors, MisuseOfVolumes)
{
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  check.IsRefused("Input port 0");
  vtkNew<vtkRectilinearGrid> rectilinear;
  mesher->SetInputData(rectilinear);
  check.IsRefused("vtkRectilinearGrid");

  vtkNew<vtkImageData> empty;
  mesher->SetInputData(empty);
  check.Fails("0 voxels on axis x");
  vtkNew<vtkImageData> slice;
  slice->SetDimensions(8, 8, 1);
  slice->AllocateScalars(VTK_SHORT, 1);
  mesher->SetInputData(slice);
  check.Fails("1 voxels on axis z");
  vtkNew<vtkImageData> bare;
  bare->SetDimensions(4, 4, 4);
  mesher->SetInputData(bare);
  check.Fails("no such point array");
  mesher->SetInputData(MakeVolume(7.0));
  check.Fails("all values of the volume are equal");
  mesher->AutomaticIsovalueOff();
  mesher->SetIsovalue(8.0);
  check.Fails("no value of at least 8");
  mesher->SetInputData(MakeVolume(std::nan("")));
  check.Fails("infinite or NaN");
  mesher->SetBodyModeToLabels();
  mesher->SetInputData(MakeVolume(0.0));
  check.Fails("a label other than 0");
  mesher->AddLabel(3);
  check.Fails("one of the labels");
  mesher->ClearLabels();
  mesher->SetInputData(MakeVolume(3.0));
  mesher->SetTargetEdgeLength(0.01);
  check.Fails("limit is 20 million");
  mesher->SetTargetEdgeLength(1e300);
  check.Fails("cannot be moved out by a margin of 5e+298 world units");
  mesher->SetTargetEdgeLength(0.0);
  mesher->AddRefinementSphere(10.0, 10.0, 10.0, 5.0, 2.0);
  mesher->AddRefinementSphere(10.0, 10.0, 10.0, 0.0, 1.0);
  check.Fails("Refinement sphere 1 has the center 10, 10, 10, the radius 0 and the edge length 1");
  mesher->ClearRefinementSpheres();
  mesher->AddRefinementSphere(std::nan(""), 10.0, 10.0, 1.0, 1.0);
  check.Fails("must be finite");
  mesher->ClearRefinementSpheres();
  mesher->AddRefinementSphere(10.0, 10.0, 10.0, 8.0, 0.01);
  check.Fails("refinement spheres require about");
  mesher->ClearRefinementSpheres();
  mesher->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "absent");
  check.Fails("no such point array");
  mesher->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "values");
  mesher->SetTargetEdgeLength(0.0);
  check.Succeeds();
  EXPECT_GT(mesher->GetOutput()->GetNumberOfCells(), 0);
}

TEST_F(TetGenMesherErrors, MisuseOfSurfaces)
{
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  vtkNew<vtkPolyData> empty;
  mesher->SetInputData(empty);
  check.Fails("surface is empty");
  vtkNew<vtkPlaneSource> plane;
  mesher->SetInputConnection(plane->GetOutputPort());
  check.Fails("surface is flat");
  vtkNew<vtkSphereSource> open;
  open->SetEndPhi(150.0);
  mesher->SetInputConnection(open->GetOutputPort());
  check.Fails("8 edges belong to one triangle only");

  vtkNew<vtkCubeSource> cube;
  cube->Update();
  vtkNew<vtkPolyData> broken;
  broken->DeepCopy(cube->GetOutput());
  for (vtkIdType i : { 0, 8, 16 }) // the points of one corner
  {
    broken->GetPoints()->SetPoint(i, 0.0, std::nan(""), 0.0);
  }
  mesher->SetInputData(broken);
  check.Fails("not finite");
  vtkNew<vtkCubeSource> neighbor; // shares one edge with the cube
  neighbor->SetCenter(1.0, 1.0, 0.0);
  vtkNew<vtkAppendPolyData> both;
  both->AddInputConnection(cube->GetOutputPort());
  both->AddInputConnection(neighbor->GetOutputPort());
  mesher->SetInputConnection(both->GetOutputPort());
  check.Fails("not manifold: 1 edges");
  neighbor->SetCenter(0.5, 0.45, 0.4); // intersects the cube
  check.Fails("intersects itself. TetGen says:");
  // The messages of TetGen 1.5 and 1.6.
  check.FailsWithAny({ "pairs of faces are intersecting", "segments exactly intersect" });
  mesher->SetInputConnection(cube->GetOutputPort());
  mesher->SetTargetEdgeLength(1e-9); // must fail before TetGen runs for hours
  check.Fails("limit is 20 million");
  mesher->SetTargetEdgeLength(0.0);
  check.Succeeds();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume, 1.0, 1e-12);
}

TEST_F(TetGenMesherErrors, MisuseOfTheProgram)
{
  vtkNew<vtkCubeSource> cube;
  vtkNew<vtkTetGenMesher> mesher;
  mesher->SetInputConnection(cube->GetOutputPort());
  FailureCheck check(mesher);
  mesher->SetTetGenExecutable("/does/not/exist");
  check.Fails("Cannot run TetGen as \"/does/not/exist\": No such file");
  mesher->SetTetGenExecutable(this->Folder.string());
  check.Fails("Permission denied");
  mesher->SetTetGenExecutable("");
  setenv("DEFORMVOLUME_TETGEN", "no-program-of-this-name", 1);
  check.Fails("\"no-program-of-this-name\"");
  unsetenv("DEFORMVOLUME_TETGEN");

  mesher->SetTetGenExecutable(
    WriteScript(this->Folder, "fails", "echo 'Opening x.'; echo 'the moon is wrong'; exit 3"));
  check.Fails("TetGen failed (exit status 3). TetGen says: the moon is wrong");
  mesher->SetTetGenExecutable(WriteScript(this->Folder, "wordless", "kill -ABRT $$"));
  check.Fails("TetGen failed (Subprocess aborted).");
  // An output of TetGen that exceeds the capacity of a pipe.
  mesher->SetTetGenExecutable(
    WriteScript(this->Folder, "talks", "yes 'Opening x.' | head -n 100000; exec tetgen \"$@\""));
  check.Succeeds();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume, 1.0, 1e-12);
  mesher->SetTetGenExecutable(WriteScript(this->Folder, "silent", "exit 0"));
  check.Fails("result cannot be read");
  mesher->SetTetGenExecutable(WriteScript(this->Folder, "nothing",
    "d=$(dirname $2); printf '1 3 0 0\\n0 0 0 0\\n' > $d/surface.1.node; "
    "printf '0 4 0\\n' > $d/surface.1.ele"));
  check.Fails("no tetrahedra");
  mesher->SetTetGenExecutable(WriteScript(this->Folder, "outside",
    "d=$(dirname $2); printf '1 3 0 0\\n0 0 0 0\\n' > $d/surface.1.node; "
    "printf '1 4 0\\n0 0 1 2 3\\n' > $d/surface.1.ele"));
  check.Fails("result cannot be read");
  // TetGen makes flat tetrahedra if points of a surface are in one plane up to rounding. The mesher
  // removes them, since finite elements reject tetrahedra without volume.
  mesher->SetTetGenExecutable(WriteScript(this->Folder, "flat",
    "d=$(dirname $2); printf '5 3 0 0\\n0 0 0 0\\n1 1 0 0\\n2 0 1 0\\n3 1 1 1e-15\\n4 0 0 1\\n' > "
    "$d/surface.1.node; printf '2 4 0\\n0 0 1 2 3\\n1 0 1 2 4\\n' > $d/surface.1.ele"));
  check.Succeeds();
  EXPECT_EQ(mesher->GetOutput()->GetNumberOfCells(), 1);
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume, 1.0 / 6.0, 1e-12);

  const std::string slow = WriteScript(this->Folder, "slow", "sleep 100; exit 0");
  mesher->SetTetGenExecutable(slow);
  mesher->SetTimeLimit(0.3);
  auto start = std::chrono::steady_clock::now();
  check.Fails("did not finish within the time limit of 0.3 s");
  EXPECT_LT(SecondsSince(start), 10.0);

  mesher->SetTimeLimit(60.0);
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void* amount)
    {
      if (*static_cast<double*>(amount) > 0.31) // while TetGen runs
      {
        vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
      }
    });
  const unsigned long tag = mesher->AddObserver(vtkCommand::ProgressEvent, abort);
  start = std::chrono::steady_clock::now();
  check.Succeeds();
  EXPECT_LT(SecondsSince(start), 10.0);
  EXPECT_EQ(mesher->GetOutput()->GetNumberOfPoints(), 0);
  mesher->RemoveObserver(tag);
  mesher->SetAbortExecute(0);
  mesher->SetTetGenExecutable("tetgen"); // found on PATH
  mesher->Update();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume, 1.0, 1e-12);
}

} // namespace

TEST_F(TetGenMesherErrors, NoTemporaryFolder)
{
  setenv("TMPDIR", (this->Folder / "absent").c_str(), 1);
  vtkNew<vtkCubeSource> cube;
  vtkNew<vtkTetGenMesher> mesher;
  mesher->SetInputConnection(cube->GetOutputPort());
  FailureCheck(mesher).Fails("Set the environment variable TMPDIR");
}
