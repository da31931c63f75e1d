// SPDX-License-Identifier: BSD-3-Clause
// The filter in a pipeline: whole extents that follow the deformation, pieces, progress, abort.
#include "FilterTesting.h"

#include <vtkCallbackCommand.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageDataStreamer.h>
#include <vtkImageGaussianSmooth.h>
#include <vtkInformation.h>
#include <vtkPolyData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkTrivialProducer.h>

#include <glm/geometric.hpp>

using namespace filterTesting;

namespace
{

Extent Moved(const Extent& extent, int x)
{
  Extent moved = extent;
  moved[0] += x;
  moved[1] += x;
  return moved;
}

// Consumers see the right extent in the first update and after each change of the deformation.
TEST(DeformPipeline, WholeExtentDownstream)
{
  auto volume = MakeImage({ { 0, 19, 0, 17, 0, 15 } });
  AddScalars<float>(volume, "value",
    [](const glm::dvec3& p) { return 50.0 - 10.0 * glm::length(p - glm::dvec3(9.5, 8.5, 7.5)); });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  vtkNew<vtkImageGaussianSmooth> smooth;
  smooth->SetStandardDeviation(0.5);
  smooth->SetInputConnection(deformed.Filter->GetOutputPort());
  vtkNew<vtkFlyingEdges3D> surface;
  surface->SetInputConnection(smooth->GetOutputPort());
  surface->SetValue(0, 0.0);
  vtkNew<vtkFlyingEdges3D> direct;
  direct->SetInputConnection(deformed.Filter->GetOutputPort());
  direct->SetValue(0, 0.0);

  vtkIdType points = 0;
  for (const int shift : { 0, 40, -25, 3 })
  {
    SetDisplacements(mesh, Shift(shift, 0.0, 0.0));
    mesh->Modified();
    surface->Update();
    direct->Update();
    EXPECT_EQ(deformed.TakeErrors(), 0);
    const Extent expected = Moved(GetExtent(volume), shift);
    EXPECT_EQ(GetWholeExtent(deformed.Filter), expected);
    EXPECT_EQ(GetExtent(deformed.Filter->GetOutput()), expected);
    EXPECT_EQ(GetExtent(smooth->GetOutput()), expected);
    for (vtkPolyData* sphere : { surface->GetOutput(), direct->GetOutput() })
    {
      double bounds[6];
      sphere->GetBounds(bounds);
      EXPECT_LT(std::abs(bounds[0] - (9.5 - 5.0 + shift)), 0.3);
      EXPECT_LT(std::abs(bounds[1] - (9.5 + 5.0 + shift)), 0.3);
    }
    points = points == 0 ? direct->GetOutput()->GetNumberOfPoints() : points;
    EXPECT_EQ(direct->GetOutput()->GetNumberOfPoints(), points);
  }
  // An update without changes does not execute the filter.
  const vtkMTimeType before = deformed.Filter->GetOutput()->GetMTime();
  surface->Update();
  EXPECT_EQ(deformed.Filter->GetOutput()->GetMTime(), before);
}

// A deformation from a pipeline, and a change of its source.
TEST(DeformPipeline, UpstreamPipeline)
{
  auto volume = MakeVolume();
  vtkNew<vtkTrivialProducer> volumeSource;
  volumeSource->SetOutput(volume);
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetNumberOfNodes(3, 4, 5);
  lattice->EqualSpacingOff();
  lattice->SetBounds(-1.0, 10.0, -1.0, 10.0, -1.0, 10.0);
  Deformed deformed;
  deformed.Filter->SetInputConnection(volumeSource->GetOutputPort());
  deformed.Filter->SetDeformationConnection(lattice->GetOutputPort());
  deformed.Filter->SetRestConnection(lattice->GetOutputPort());
  EXPECT_EQ(GetExtent(deformed.Update()), GetExtent(volume));
  lattice->SetNumberOfNodes(2, 2, 2);
  EXPECT_EQ(GetExtent(deformed.Update()), GetExtent(volume));
  EXPECT_TRUE(HaveEqualBits(deformed.GetValues(), volume->GetPointData()->GetScalars()));
  EXPECT_EQ(GetReported(deformed.Filter, "Static mappings made"), 2);
}

TEST(DeformPipeline, Pieces)
{
  auto volume = MakeVolume({ { 0, 20, 0, 18, 0, 16 } });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh,
    [](const glm::dvec3& p)
    { return p + glm::dvec3(2.0 * std::sin(0.3 * p.y), 1.5 * std::cos(0.2 * p.z), 0.1 * p.x); });
  Deformed deformed(volume, mesh);
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(deformed.Update());
  const Extent extent = GetExtent(whole);
  const vtkIdType covered = deformed.Filter->GetNumberOfCoveredVoxels();

  Deformed pieces(volume, mesh);
  vtkNew<vtkImageDataStreamer> streamer;
  streamer->SetInputConnection(pieces.Filter->GetOutputPort());
  streamer->SetNumberOfStreamDivisions(5);
  streamer->Update();
  EXPECT_EQ(pieces.TakeErrors(), 0);
  EXPECT_NE(GetExtent(pieces.Filter->GetOutput()), extent);
  EXPECT_EQ(GetExtent(streamer->GetOutput()), extent);
  EXPECT_TRUE(HaveEqualBits(
    streamer->GetOutput()->GetPointData()->GetScalars(), whole->GetPointData()->GetScalars()));
  EXPECT_EQ(GetReported(pieces.Filter, "Static mappings made"), 1);
  EXPECT_EQ(GetReported(pieces.Filter, "Volumes sent"), 1);

  // A request for any box.
  const Extent box{ { extent[0] + 3, extent[0] + 8, 4, 4, 5, 11 } };
  pieces.Filter->UpdateExtent(box.data());
  vtkImageData* part = pieces.Filter->GetOutput();
  EXPECT_EQ(GetExtent(part), box);
  for (int z = box[4]; z <= box[5]; ++z)
  {
    for (int x = box[0]; x <= box[1]; ++x)
    {
      EXPECT_EQ(part->GetScalarComponentAsDouble(x, 4, z, 0),
        whole->GetScalarComponentAsDouble(x, 4, z, 0));
    }
  }
  pieces.Filter->UpdateWholeExtent();
  EXPECT_TRUE(AreEqual(pieces.Filter->GetOutput(), whole));
  EXPECT_EQ(pieces.Filter->GetNumberOfCoveredVoxels(), covered);
}

struct ProgressLog
{
  double Last = 0.0;
  int Calls = 0;
  int AbortAt = -1;
  bool Backwards = false;

  static void Execute(vtkObject* caller, unsigned long, void* clientData, void* callData)
  {
    auto* log = static_cast<ProgressLog*>(clientData);
    const double progress = *static_cast<double*>(callData);
    log->Backwards |= progress < log->Last || progress > 1.0;
    log->Last = progress;
    if (log->Calls++ == log->AbortAt)
    {
      static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1);
    }
  }
};

TEST(DeformPipeline, ProgressAndAbort)
{
  auto volume = MakeVolume({ { 0, 20, 0, 18, 0, 16 } });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.5, 0.0, 0.0));
  ProgressLog log;
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(ProgressLog::Execute);
  command->SetClientData(&log);
  Deformed deformed(volume, mesh);
  deformed.Filter->AddObserver(vtkCommand::ProgressEvent, command);
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(deformed.Update());
  EXPECT_GT(log.Calls, 2);
  EXPECT_FALSE(log.Backwards);
  EXPECT_EQ(log.Last, 1.0);

  const int calls = log.Calls;
  for (const int abortAt : { 0, 1, calls / 2 })
  {
    Deformed aborted(volume, mesh);
    aborted.Filter->AddObserver(vtkCommand::ProgressEvent, command);
    log = ProgressLog();
    log.AbortAt = abortAt;
    aborted.Filter->Update();
    EXPECT_EQ(aborted.TakeErrors(), 0);
    EXPECT_EQ(aborted.Filter->GetOutput()->GetNumberOfPoints(), 0);
    // The next update gives the whole output.
    log = ProgressLog();
    aborted.Filter->SetAbortExecute(0);
    EXPECT_TRUE(AreEqual(aborted.Update(), expected));
  }
}

} // namespace
