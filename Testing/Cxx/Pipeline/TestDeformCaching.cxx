// SPDX-License-Identifier: BSD-3-Clause
// Static mappings and uploads that are kept between updates, and the reports of the filter.
#include "FilterTesting.h"

#include "Device.h"

#include <vtkCommand.h>
#include <vtkShortArray.h>
#include <vtkStringArray.h>

#include <limits>

using namespace filterTesting;

namespace
{

class Counted
{
public:
  Counted()
    : Volume(MakeVolume({ { 0, 20, 0, 19, 0, 18 } }))
    , Mesh(MakeMesh(Volume))
    , Subject(Volume, Mesh)
  {
    SetDisplacements(this->Mesh, Shift(1.0, 0.0, 0.0));
  }

  /// Updates the filter, and expects these numbers of static mappings built and of uploads of the
  /// volume.
  void Expect(const char* what, int builds, int uploads)
  {
    vtkDeformVolumeFilter* filter = this->Subject.Filter;
    this->Subject.Update();
    const vtkIdType built = GetReported(filter, "Static mappings made") - this->Builds;
    const vtkIdType sent = GetReported(filter, "Volumes sent") - this->Uploads;
    this->Builds += built;
    this->Uploads += sent;
    EXPECT_EQ(built, builds) << what;
    EXPECT_EQ(sent, uploads) << what;
    EXPECT_EQ(GetReportedSeconds(filter, "Seconds for the static mapping") > 0.0, builds > 0);
    EXPECT_TRUE(GetReportedSeconds(filter, "Seconds for mapping") >= 0.0 &&
      GetReportedSeconds(filter, "Seconds for mapping") < 60.0);
    EXPECT_TRUE(GetReportedSeconds(filter, "Seconds for resampling") > 0.0 &&
      GetReportedSeconds(filter, "Seconds for resampling") < 60.0);
    EXPECT_TRUE(GetReportedSeconds(filter, "Seconds for transfer") > 0.0 &&
      GetReportedSeconds(filter, "Seconds for transfer") < 60.0);
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Subject;

private:
  vtkIdType Builds = 0;
  vtkIdType Uploads = 0;
};

/// Counts how often the progress text changes to that of compilation, and back.
class CompilationListener
{
public:
  explicit CompilationListener(vtkDeformVolumeFilter* filter)
    : Filter(filter)
  {
    filter->AddObserver(vtkCommand::ProgressEvent, this, &CompilationListener::Listen);
  }
  int Begins = 0;
  int Ends = 0;

private:
  void Listen()
  {
    const char* text = this->Filter->GetProgressText();
    const bool compiling = text && std::string(text) == "Compiling kernels";
    this->Begins += compiling && this->Begins == this->Ends;
    this->Ends += !compiling && this->Begins > this->Ends;
  }
  vtkDeformVolumeFilter* Filter;
};

// The first update of a process compiles kernels, or loads them from a cache. The progress text
// says so, and the time for it is reported separately. This must be the first test, since it needs
// kernels that are not loaded yet.
TEST(DeformCaching, Compilation)
{
  Counted counted;
  vtkDeformVolumeFilter* filter = counted.Subject.Filter;
  CompilationListener listener(filter);
  counted.Expect("first", 1, 1);
  EXPECT_TRUE(GetReportedSeconds(filter, "Seconds for compilation") > 0.0 &&
    GetReportedSeconds(filter, "Seconds for compilation") < 600.0);
  EXPECT_GT(listener.Begins, 0);
  EXPECT_EQ(listener.Ends, listener.Begins);
  EXPECT_EQ(filter->GetProgressText(), nullptr);
  const int begins = listener.Begins;
  filter->Modified();
  counted.Expect("filter modified", 0, 0);
  EXPECT_EQ(GetReportedSeconds(filter, "Seconds for compilation"), 0.0);
  EXPECT_EQ(listener.Begins, begins);
}

TEST(DeformCaching, Counters)
{
  Counted counted;
  vtkDeformVolumeFilter* filter = counted.Subject.Filter;
  counted.Expect("first", 1, 1);
  filter->Modified();
  counted.Expect("filter modified", 0, 0);
  SetDisplacements(counted.Mesh, Shift(0.0, 3.5, 0.0));
  counted.Expect("moved by new vectors", 0, 0);
  counted.Mesh->GetPointData()->GetVectors()->SetComponent(0, 0, 1.25);
  counted.Mesh->GetPointData()->GetVectors()->Modified();
  counted.Expect("moved by changed vectors", 0, 0);
  filter->SetDisplacementScale(0.5);
  counted.Expect("displacement scale", 0, 0);
  filter->SetPadding(2);
  counted.Expect("padding", 0, 0);

  counted.Volume->GetPointData()->GetScalars()->SetComponent(5, 0, 17.0);
  counted.Volume->GetPointData()->GetScalars()->Modified();
  counted.Expect("values of the volume", 0, 1);
  // The time of an image in memory may also stand for values that were written.
  counted.Volume->SetOrigin(0.5, 0.0, 0.0);
  counted.Expect("origin of the volume", 1, 1);

  counted.Mesh->GetPoints()->SetPoint(0, -2.0, -2.0, -2.0);
  counted.Mesh->GetPoints()->Modified();
  counted.Expect("rest points", 1, 0);

  auto other = MakeMesh(counted.Volume, 4);
  SetDisplacements(other, Shift(0.0, 0.0, 1.0));
  filter->SetDeformationData(other);
  counted.Expect("another mesh", 1, 0);

  vtkNew<vtkUnstructuredGrid> deformed;
  deformed->DeepCopy(other);
  filter->SetDeformationData(deformed);
  filter->SetRestData(other);
  counted.Expect("the same rest points on port 2", 0, 0);
  deformed->GetPoints()->SetPoint(3, 5.0, 5.0, 5.0);
  deformed->GetPoints()->Modified();
  counted.Expect("deformed points", 0, 0);

  filter->SetOutsideModeToExtrapolate();
  counted.Expect("outside mode", 1, 0);
  filter->ReleaseDeviceMemory();
  EXPECT_EQ(filter->GetDeviceMemory(), 0);
  filter->Modified();
  counted.Expect("after its device memory was released", 0, 1);
}

TEST(DeformCaching, Reports)
{
  Counted counted;
  vtkDeformVolumeFilter* filter = counted.Subject.Filter;
  EXPECT_TRUE(filter->GetDeviceInUse().empty());
  EXPECT_EQ(filter->GetDeviceMemory(), 0);
  counted.Expect("first", 1, 1);
  vtkSmartPointer<vtkStringArray> names;
  names.TakeReference(vtkDeformVolumeFilter::GetDeviceNames());
  EXPECT_GT(names->GetNumberOfValues(), 0);
  EXPECT_EQ(filter->GetDeviceInUse(), std::string(names->GetValue(0)));
  // The device holds the volume, with two bytes a voxel, and the links. A graphics card also holds
  // a list with four bytes for each cell of all bricks of 192 x 16 x 16 cells.
  const vtkIdType list = 4 * 192 * 16 * 16 * GetReported(filter, "Bricks of the volume");
  EXPECT_GT(filter->GetDeviceMemory(), counted.Volume->GetNumberOfPoints());
  EXPECT_LT(filter->GetDeviceMemory(), counted.Volume->GetNumberOfPoints() * 100 + list);
}

// The memory limit is checked before anything is allocated, and the message states the limit.
TEST(DeformCaching, MemoryLimit)
{
  Counted counted;
  vtkDeformVolumeFilter* filter = counted.Subject.Filter;
  filter->SetResamplerToExact(); // AUTOMATIC would choose the resampler that needs less memory
  filter->SetMemoryLimit(12345);
  filter->Update();
  EXPECT_EQ(counted.Subject.TakeErrors(), 1);
  const std::string message = counted.Subject.LastError;
  EXPECT_TRUE(
    message.find("12345") != std::string::npos || message.find("12,345") != std::string::npos);
  EXPECT_EQ(filter->GetDeviceMemory(), 0);
  filter->SetMemoryLimit(100000000);
  counted.Expect("with enough memory", 1, 1);
  EXPECT_LT(filter->GetDeviceMemory(), 100000000);
}

// A coarse mesh, whose static mapping has runs of voxels; a finer mesh, with a link for each voxel;
// the coarse mesh again; and other displacements of it.
TEST(DeformCaching, ChangesOfForm)
{
  auto volume = MakeVolume({ { -4, 59, 3, 50, 0, 44 } });
  auto coarse = MakeMesh(volume, 4);
  auto fine = MakeMesh(volume, 30);
  SetDisplacements(coarse, Shift(3.0, 1.0, 0.0));
  SetDisplacements(fine, Shift(3.0, 1.0, 0.0));
  Deformed deformed(volume, coarse);
  deformed.Update();
  auto expected = vtkSmartPointer<vtkImageData>::New();
  expected->DeepCopy(deformed.Filter->GetOutput());
  const vtkIdType byRuns = deformed.Filter->GetDeviceMemory();
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 1);
  deformed.Filter->SetDeformationData(fine);
  EXPECT_TRUE(AreEqual(deformed.Update(), expected));
  const vtkIdType byLinks = deformed.Filter->GetDeviceMemory();
  EXPECT_GT(byLinks, byRuns + 10 * volume->GetNumberOfPoints());
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 2);
  deformed.Filter->SetDeformationData(coarse);
  EXPECT_TRUE(AreEqual(deformed.Update(), expected));
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 3);
  SetDisplacements(coarse, Shift(0.0, 0.0, 0.0));
  coarse->Modified();
  deformed.Update();
  EXPECT_TRUE(HaveEqualBits(deformed.GetValues(), volume->GetPointData()->GetScalars()));
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 3);
  // The check of the memory limit, before anything is allocated, knows the size of runs.
  Deformed limited(volume, coarse);
  limited.Filter->SetMemoryLimit((byRuns + byLinks) / 2);
  limited.Update();
  limited.Filter->SetOutsideModeToExtrapolate(); // by links
  limited.Filter->Update();
  EXPECT_GE(limited.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(limited.LastError, "bytes are needed"));
}

// A program writes values and points, and passes them in a new data object.
TEST(DeformCaching, ArraysInNewObjects)
{
  const auto volume = MakeVolume({ { 0, 20, 0, 19, 0, 18 } });
  const auto mesh = MakeTetrahedra({ { 2.0, 12.0, 3.0, 13.0, 4.0, 14.0 } }, { { 3, 3, 3 } });
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  Deformed tested(volume, mesh);
  tested.Filter->SetOutputBoundsModeToVolumeBounds();
  tested.Update();
  // SetComponent() does not change the modification time. In the last step, the first objects are
  // used again.
  vtkDataArray* const values = volume->GetPointData()->GetScalars();
  vtkDataArray* const coordinates = mesh->GetPoints()->GetData();
  vtkNew<vtkImageData> images[2];
  vtkNew<vtkUnstructuredGrid> grids[2];
  for (int step = 0; step < 6; ++step)
  {
    if (step < 3)
    {
      for (vtkIdType i = step; i < values->GetNumberOfTuples(); i += 3)
      {
        values->SetComponent(i, 0, 7.0);
      }
      vtkImageData* const image = step < 2 ? images[step].Get() : volume.Get();
      if (image != volume)
      {
        image->ShallowCopy(volume);
      }
      image->Modified();
      tested.Filter->SetInputData(image);
    }
    else
    {
      for (vtkIdType i = 0; i < coordinates->GetNumberOfTuples(); ++i)
      {
        coordinates->SetComponent(i, 0, coordinates->GetComponent(i, 0) + 1.0);
      }
      vtkUnstructuredGrid* const grid = step < 5 ? grids[step - 3].Get() : mesh.Get();
      if (grid != mesh)
      {
        grid->ShallowCopy(mesh);
      }
      grid->Modified();
      tested.Filter->SetDeformationData(grid);
    }
    Deformed expected(volume, mesh);
    expected.Filter->SetOutputBoundsModeToVolumeBounds();
    EXPECT_TRUE(AreEqual(tested.Update(), expected.Update())) << step;
  }
}

// On a CPU device OutputOnDevice has no effect: the output has ordinary arrays.
TEST(DeformCaching, OutputOnDevice)
{
  Counted counted;
  vtkDeformVolumeFilter* filter = counted.Subject.Filter;
  EXPECT_EQ(GetReported(filter, "Arrays on the device"), 0);
  filter->OutputOnDeviceOn();
  counted.Expect("on the device", 1, 1);
  const bool ownMemory = deformvolume::GetDeviceAbilities("").OwnMemory;
  EXPECT_EQ(GetReported(filter, "Arrays on the device"), ownMemory ? 2 : 0);
  EXPECT_EQ(vtkShortArray::SafeDownCast(counted.Subject.GetValues()) != nullptr, !ownMemory);
  vtkNew<vtkImageData> kept;
  kept->DeepCopy(filter->GetOutput());
  filter->OutputOnDeviceOff();
  counted.Expect("on the host", 0, 0);
  EXPECT_EQ(GetReported(filter, "Arrays on the device"), 0);
  EXPECT_NE(vtkShortArray::SafeDownCast(counted.Subject.GetValues()), nullptr);
  EXPECT_TRUE(AreEqual(kept, filter->GetOutput()));
}

} // namespace

// NaN is not equal to itself, but such a background has not changed.
TEST(DeformCaching, BackgroundOfNaN)
{
  Counted counted;
  counted.Subject.Filter->SetBackgroundValue(std::numeric_limits<double>::quiet_NaN());
  counted.Subject.Update();
  counted.Subject.Filter->Modified();
  counted.Subject.Update();
  EXPECT_EQ(GetReported(counted.Subject.Filter, "Bricks resampled"), 0);
}
