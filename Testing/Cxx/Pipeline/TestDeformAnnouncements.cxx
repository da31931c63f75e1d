// SPDX-License-Identifier: BSD-3-Clause
// Sources whose pipeline information differs from their data. Either the output contains the whole
// volume, or an error or a warning states the difference.
#include "ArrayMaking.h"
#include "FilterTesting.h"

#include "vtkCutVolume.h"

#include <vtkImageAlgorithm.h>
#include <vtkImageClip.h>
#include <vtkImageShiftScale.h>
#include <vtkInformation.h>
#include <vtkInformationDoubleVectorKey.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkRTAnalyticSource.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkTemporalInterpolator.h>

#include <algorithm>

using namespace filterTesting;
using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{

/// A source that announces the information that a test sets, and outputs a volume: from time 1 on
/// another one, if it is set.
class CarelessSource : public vtkImageAlgorithm
{
public:
  static CarelessSource* New();
  vtkTypeMacro(CarelessSource, vtkImageAlgorithm);

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkImageData> LaterVolume;
  Extent WholeExtent;
  vtkNew<vtkInformation> Announced;
  int Executions = 0;

  void AnnounceTimes(double first, double second)
  {
    const double times[2] = { first, second };
    this->Announced->Set(Pipeline::TIME_STEPS(), times, 2);
    this->Announced->Set(Pipeline::TIME_RANGE(), times, 2);
    this->Modified();
  }

protected:
  CarelessSource() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    vtkInformation* info = output->GetInformationObject(0);
    info->Set(Pipeline::WHOLE_EXTENT(), this->WholeExtent.data(), 6);
    for (vtkInformationDoubleVectorKey* key : { vtkDataObject::ORIGIN(), vtkDataObject::SPACING(),
           vtkDataObject::DIRECTION(), Pipeline::TIME_STEPS(), Pipeline::TIME_RANGE() })
    {
      info->Remove(key);
      info->CopyEntry(this->Announced, key);
    }
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    ++this->Executions;
    vtkInformation* info = output->GetInformationObject(0);
    const double time =
      info->Has(Pipeline::UPDATE_TIME_STEP()) ? info->Get(Pipeline::UPDATE_TIME_STEP()) : 0.0;
    vtkImageData* image = vtkImageData::GetData(info);
    image->ShallowCopy(time >= 1.0 && this->LaterVolume ? this->LaterVolume : this->Volume);
    image->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    return 1;
  }
};
vtkStandardNewMacro(CarelessSource);

struct Careless
{
  Careless()
  {
    this->Volume = MakeImage(
      { { 0, 39, 0, 39, 0, 39 } }, glm::dvec3(2.0, 1.5, 0.5), glm::dvec3(10.0, -5.0, 3.0));
    AddScalars<short>(this->Volume, "value", [](const glm::dvec3& p) { return p.x + p.y; });
    this->Mesh = MakeMesh(this->Volume);
    SetDisplacements(this->Mesh, Shift(2.0, 0.0, 0.0)); // one voxel
    this->Source->Volume = this->Volume;
    this->Source->WholeExtent = GetExtent(this->Volume);
    this->Subject.Filter->SetInputConnection(this->Source->GetOutputPort());
    this->Subject.Filter->SetDeformationData(this->Mesh);
  }
  void Announce(const glm::dvec3& origin, const glm::dvec3& spacing)
  {
    this->Source->Announced->Set(vtkDataObject::ORIGIN(), &origin.x, 3);
    this->Source->Announced->Set(vtkDataObject::SPACING(), &spacing.x, 3);
    this->Source->Modified();
  }
  void IsRight(const char* what)
  {
    SCOPED_TRACE(what);
    vtkImageData* output = this->Subject.Update();
    EXPECT_EQ(GetExtent(output), (Extent{ { 1, 40, 0, 39, 0, 39 } }));
    EXPECT_EQ(this->Subject.Filter->GetNumberOfCoveredVoxels(), 64000);
    EXPECT_EQ(GetPoint(output, 0), GetPoint(this->Volume, 1));
  }
  void Fails(const char* what, const std::string& words)
  {
    this->Source->Modified();
    this->Subject.Filter->Update();
    EXPECT_EQ(this->Subject.TakeErrors(), 1) << what;
    EXPECT_TRUE(HasPart(this->Subject.LastError, words)) << what;
    EXPECT_EQ(this->Subject.Filter->GetOutput()->GetNumberOfPoints(), 0);
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  vtkNew<CarelessSource> Source;
  Deformed Subject;
};

TEST(DeformAnnouncements, Geometry)
{
  const glm::dvec3 origin(10.0, -5.0, 3.0);
  const glm::dvec3 spacing(2.0, 1.5, 0.5);
  const double straight[9] = { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };
  // Without announced geometry the filter executes the source, once.
  Careless forgetful;
  forgetful.IsRight("a source that announces nothing");
  EXPECT_EQ(forgetful.Source->Executions, 1);
  forgetful.Mesh->Modified();
  forgetful.IsRight("once more");
  EXPECT_EQ(forgetful.Source->Executions, 1);

  forgetful.Source->Announced->Set(vtkDataObject::ORIGIN(), &origin.x, 3);
  forgetful.Source->Modified();
  forgetful.IsRight("a source that announces no spacing");
  forgetful.Announce(origin, spacing);
  forgetful.IsRight("a source that announces its geometry");
  // The announced geometry of sources in single precision differs by rounding.
  forgetful.Announce(origin + glm::dvec3(1e-6), spacing * (1.0 + 1e-7));
  forgetful.Subject.Update();
  EXPECT_EQ(GetExtent(forgetful.Subject.Filter->GetOutput())[0], 1);
  EXPECT_EQ(GetExtent(forgetful.Subject.Filter->GetOutput())[1], 40);

  // Without a direction the data count, with one what is announced.
  forgetful.Announce(origin, glm::dvec3(1.0));
  forgetful.IsRight("a wrong spacing without a direction");
  forgetful.Announce(glm::dvec3(0.0), spacing);
  forgetful.IsRight("a wrong origin without a direction");
  forgetful.Source->Announced->Set(vtkDataObject::DIRECTION(), straight, 9);
  forgetful.Announce(origin, glm::dvec3(1.0));
  forgetful.Fails("a wrong spacing", "spacing 2, 1.5, 0.5 and direction 1");
  forgetful.Announce(glm::dvec3(0.0), spacing);
  forgetful.Fails("a wrong origin", "announced origin 0, 0, 0");
  forgetful.Announce(origin, spacing);
  forgetful.IsRight("a source that is right again");
  forgetful.Source->Announced->Remove(vtkDataObject::DIRECTION());

  // The executive and ParaView do not pass on directions.
  SetObliqueDirection(forgetful.Volume);
  forgetful.Mesh->ShallowCopy(MakeMesh(forgetful.Volume));
  SetDisplacements(forgetful.Mesh, Shift(0.0, 0.0, 0.0));
  const auto isOblique = [&]
  {
    forgetful.Source->Modified();
    vtkImageData* output = forgetful.Subject.Update();
    EXPECT_EQ(GetExtent(output), GetExtent(forgetful.Volume));
    EXPECT_EQ(GetPoint(output, 63999), GetPoint(forgetful.Volume, 63999));
    EXPECT_EQ(forgetful.Subject.Filter->GetNumberOfCoveredVoxels(), 64000);
  };
  isOblique();
  forgetful.Source->Announced->Set(vtkDataObject::DIRECTION(), straight, 9);
  forgetful.Fails("a wrong direction", "set ORIGIN(), SPACING() and DIRECTION()");
  forgetful.Source->Announced->Set(
    vtkDataObject::DIRECTION(), forgetful.Volume->GetDirectionMatrix()->GetData(), 9);
  isOblique();
}

// The part of the volume from which the filter takes the direction is not what an update of a
// source by itself makes afterwards.
TEST(DeformAnnouncements, Requests)
{
  vtkNew<vtkRTAnalyticSource> source;
  vtkNew<vtkImageShiftScale> shift;
  shift->SetInputConnection(source->GetOutputPort());
  const auto mesh = MakeMesh(MakeImage({ { -10, 10, -10, 10, -10, 10 } }));
  SetDisplacements(mesh, Shift(2.0, 0.0, 0.0));
  Deformed subject;
  subject.Filter->SetInputConnection(shift->GetOutputPort());
  subject.Filter->SetDeformationData(mesh);
  subject.Filter->UpdateInformation();
  EXPECT_EQ(GetExtent(shift->GetOutput()), (Extent{ { -10, -9, -10, -9, -10, -9 } }));
  source->Update();
  EXPECT_EQ(GetExtent(source->GetOutput()), (Extent{ { -10, 10, -10, 10, -10, 10 } }));
  shift->Update();
  EXPECT_EQ(GetExtent(shift->GetOutput()), (Extent{ { -10, 10, -10, 10, -10, 10 } }));
  subject.Update();
  EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), 9261);
}

// A reference image of which only the extent is announced.
TEST(DeformAnnouncements, Reference)
{
  const auto grid =
    MakeImage({ { -2, 17, 3, 22, 0, 9 } }, glm::dvec3(3.0, 2.0, 1.5), glm::dvec3(12.0, -3.0, 4.0));
  SetObliqueDirection(grid);
  const vtkNew<CarelessSource> source;
  source->Volume = grid;
  source->WholeExtent = GetExtent(grid);
  Careless careless;
  careless.Subject.Filter->SetReferenceConnection(source->GetOutputPort());
  for (int update = 0; update < 2; ++update)
  {
    careless.Mesh->Modified();
    vtkImageData* output = careless.Subject.Update();
    EXPECT_EQ(GetExtent(output), GetExtent(grid));
    EXPECT_EQ(GetPoint(output, 0), GetPoint(grid, 0));
    EXPECT_EQ(GetPoint(output, 3999), GetPoint(grid, 3999));
    EXPECT_EQ(source->Executions, 1);
  }
}

// vtkTemporalInterpolator fails without a time. The first update reads the geometry before a time
// is requested.
TEST(DeformAnnouncements, InterpolatedImages)
{
  for (const bool isReference : { false, true })
  {
    Careless careless;
    careless.Source->AnnounceTimes(0.0, 1.0);
    vtkNew<vtkTemporalInterpolator> interpolator;
    interpolator->SetInputConnection(careless.Source->GetOutputPort());
    if (isReference)
    {
      careless.Subject.Filter->SetInputData(careless.Volume);
      careless.Subject.Filter->SetReferenceConnection(interpolator->GetOutputPort());
    }
    else
    {
      careless.Subject.Filter->SetInputConnection(interpolator->GetOutputPort());
    }
    for (const double time : { 0.5, 0.25, 1.0 })
    {
      careless.Subject.Filter->UpdateTimeStep(time);
      EXPECT_EQ(careless.Subject.TakeErrors(), 0) << careless.Subject.LastError;
      vtkImageData* output = careless.Subject.Filter->GetOutput();
      EXPECT_EQ(GetExtent(output)[0], isReference ? 0 : 1);
      EXPECT_GT(careless.Subject.Filter->GetNumberOfCoveredVoxels(), 60000);
    }
  }
}

// The volumes of two time steps have different grids.
TEST(DeformAnnouncements, OtherGridLater)
{
  Careless careless;
  careless.Source->AnnounceTimes(0.0, 1.0);
  careless.Source->LaterVolume = vtkSmartPointer<vtkImageData>::New();
  careless.Source->LaterVolume->ShallowCopy(careless.Volume);
  careless.Source->LaterVolume->SetOrigin(11.0, -5.0, 3.0);
  careless.IsRight("the first time step");
  const auto fails = [&](const char* words)
  {
    careless.Subject.Filter->UpdateTimeStep(1.0);
    EXPECT_EQ(careless.Subject.TakeErrors(), 1);
    EXPECT_TRUE(HasPart(careless.Subject.LastError, "has origin 11, -5, 3"));
    EXPECT_TRUE(HasPart(careless.Subject.LastError, words));
  };
  fails("but had origin 10, -5, 3, spacing 2, 1.5, 0.5 and direction 1, 0, 0, 0, 1, 0, 0, 0, 1 "
        "before");
  const double straight[9] = { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };
  careless.Source->Announced->Set(vtkDataObject::DIRECTION(), straight, 9);
  careless.Announce(glm::dvec3(10.0, -5.0, 3.0), glm::dvec3(2.0, 1.5, 0.5));
  fails("but its source announced origin 10, -5, 3");
}

// The grid of a reference image that varies in time stays, with one warning.
TEST(DeformAnnouncements, ReferenceInTime)
{
  const vtkNew<CarelessSource> source;
  source->Volume = MakeImage({ { 0, 9, 0, 9, 0, 9 } }, glm::dvec3(2.0), glm::dvec3(20.0, 0.0, 5.0));
  source->LaterVolume = MakeImage({ { 0, 9, 0, 9, 0, 9 } }, glm::dvec3(2.0));
  source->WholeExtent = GetExtent(source->Volume);
  Careless careless;
  careless.Subject.Filter->SetReferenceConnection(source->GetOutputPort());
  source->AnnounceTimes(0.0, 0.0); // one time, as vtkForceTime announces it
  careless.Subject.Update();
  EXPECT_EQ(careless.Subject.TakeWarning(), "");
  source->AnnounceTimes(0.0, 1.0);
  careless.Subject.Filter->UpdateTimeStep(0.0);
  EXPECT_TRUE(HasPart(careless.Subject.TakeWarning(), "reference image on input port 3 varies"));
  careless.Mesh->Modified();
  careless.Subject.Filter->UpdateTimeStep(1.0);
  EXPECT_EQ(careless.Subject.TakeWarning(), "");
  EXPECT_EQ(GetPoint(careless.Subject.Filter->GetOutput(), 0), glm::dvec3(20.0, 0.0, 5.0));
  EXPECT_EQ(careless.Subject.TakeErrors(), 0);
}

TEST(DeformAnnouncements, Extents)
{
  Careless careless;
  careless.Announce(glm::dvec3(10.0, -5.0, 3.0), glm::dvec3(2.0, 1.5, 0.5));
  careless.IsRight("a source that is right");
  careless.Source->WholeExtent = { { 0, 49, 0, 39, 0, 39 } };
  careless.Fails("less than announced",
    "was asked for an extent of it, 0, 49, 0, 39, 0, 39, and gave another one, 0, 39, 0, 39, 0, "
    "39");
  careless.Source->WholeExtent = { { 5, 44, 0, 39, 0, 39 } };
  careless.Fails("another extent than announced", "asked for an extent of it, 5, 44");

  // Data outside the announced whole extent is cropped, with a warning.
  careless.Source->WholeExtent = { { 10, 29, 0, 39, 0, 39 } };
  careless.Source->Modified();
  careless.Subject.Filter->Update();
  EXPECT_TRUE(HasPart(careless.Subject.TakeWarning(), "more than the whole extent 10, 29"));
  EXPECT_EQ(GetExtent(careless.Subject.Filter->GetOutput()), (Extent{ { 11, 30, 0, 39, 0, 39 } }));
  EXPECT_EQ(careless.Subject.Filter->GetNumberOfCoveredVoxels(), 32000);
  const vtkIdType uploads = GetReported(careless.Subject.Filter, "Volumes sent");
  careless.Mesh->Modified();
  careless.Subject.Update();
  EXPECT_EQ(GetReported(careless.Subject.Filter, "Volumes sent"), uploads);
  EXPECT_EQ(careless.Subject.TakeWarning(), "");
  const auto few = MakeArray<vtkFloatArray>("few", 7);
  careless.Volume->GetPointData()->AddArray(few);
  careless.Fails("a short array of a volume that is cut", "7 tuples");
  careless.Volume->GetPointData()->RemoveArray("few");
  careless.Source->WholeExtent = GetExtent(careless.Volume);
  careless.Source->Modified();
  careless.IsRight("a source that is right again");

  // vtkImageClip passes data outside its announced whole extent on.
  vtkNew<vtkImageClip> clip;
  clip->SetInputData(careless.Volume);
  clip->SetOutputWholeExtent(10, 29, 5, 34, 0, 39);
  careless.Subject.Filter->SetInputConnection(clip->GetOutputPort());
  careless.Subject.Filter->Update();
  EXPECT_EQ(careless.Subject.TakeErrors(), 0);
  EXPECT_EQ(GetExtent(careless.Subject.Filter->GetOutput()), (Extent{ { 11, 30, 5, 34, 0, 39 } }));
  EXPECT_EQ(careless.Subject.Filter->GetNumberOfCoveredVoxels(), 20 * 30 * 40);
}

// A filter announces the geometry and the scalars of its output.
void CheckAnnounced(vtkImageAlgorithm* filter)
{
  const auto volume =
    MakeImage({ { 2, 9, 0, 8, -3, 7 } }, glm::dvec3(2.0, 1.5, 0.5), glm::dvec3(10.0, -5.0, 3.0));
  SetObliqueDirection(volume);
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return p.x; });
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  filter->SetInputData(volume);
  if (auto* deform = vtkDeformVolumeFilter::SafeDownCast(filter))
  {
    deform->SetDeformationData(mesh);
  }
  for (const int type : { VTK_SHORT, VTK_FLOAT })
  {
    if (type == VTK_FLOAT)
    {
      AddScalars<float>(volume, "value", [](const glm::dvec3& p) { return p.y; });
    }
    filter->UpdateInformation();
    vtkInformation* announced = filter->GetOutputInformation(0);
    Extent extent;
    announced->Get(Pipeline::WHOLE_EXTENT(), extent.data());
    EXPECT_EQ(vtkImageData::GetScalarType(announced), type);
    EXPECT_EQ(vtkImageData::GetNumberOfScalarComponents(announced), 1);
    filter->Update();
    vtkImageData* output = filter->GetOutput();
    EXPECT_EQ(extent, GetExtent(output));
    EXPECT_EQ(output->GetScalarType(), type);
    const auto isAnnounced = [&](vtkInformationDoubleVectorKey* key, const double* values, int size)
    { return announced->Has(key) && std::equal(values, values + size, announced->Get(key)); };
    EXPECT_TRUE(isAnnounced(vtkDataObject::ORIGIN(), output->GetOrigin(), 3));
    EXPECT_TRUE(isAnnounced(vtkDataObject::SPACING(), output->GetSpacing(), 3));
    EXPECT_TRUE(
      isAnnounced(vtkDataObject::DIRECTION(), output->GetDirectionMatrix()->GetData(), 9));
  }
}

} // namespace

TEST(DeformAnnouncements, Announced)
{
  CheckAnnounced(vtkNew<vtkDeformVolumeFilter>());
  CheckAnnounced(vtkNew<vtkCutVolume>());
}
