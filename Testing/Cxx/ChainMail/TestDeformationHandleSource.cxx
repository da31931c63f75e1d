// SPDX-License-Identifier: BSD-3-Clause
// vtkDeformationHandleSource: misuse, its output, and drags by vtkChainMailDeformation with one or
// several handles.
#include "ChainMailTesting.h"
#include "vtkDeformationHandleSource.h"

#include <vtkAppendPolyData.h>

#include <limits>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

TEST(DeformationHandleSource, Misuse)
{
  Observed<vtkDeformationHandleSource> observed;
  vtkDeformationHandleSource* source = observed.Filter;
  source->SetPosition(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0);
  observed.VerifyFailure("not finite");
  source->SetPosition(0.0, 1.0, 0.0);
  source->Update();
  EXPECT_FALSE(observed.Observer->GetError());
  EXPECT_EQ(source->GetOutput()->GetNumberOfPoints(), 1);
}

TEST(DeformationHandleSource, Output)
{
  vtkNew<vtkDeformationHandleSource> source;
  source->SetRestPosition(0.1, 2.0, -3.0);
  source->SetPosition(4.0, 5.3, 6.0);
  source->Update();
  vtkPolyData* output = source->GetOutput();
  EXPECT_EQ(output->GetNumberOfPoints(), 1);
  EXPECT_EQ(output->GetNumberOfVerts(), 1);
  EXPECT_EQ(GetPoint(output, 0), glm::dvec3(4.0, 5.3, 6.0));
  double rest[3];
  output->GetPointData()->GetArray("RestPosition")->GetTuple(0, rest);
  EXPECT_EQ(glm::dvec3(rest[0], rest[1], rest[2]), glm::dvec3(0.1, 2.0, -3.0));
  source->UpdatePiece(1, 2, 0);
  EXPECT_EQ(source->GetOutput()->GetNumberOfPoints(), 0);
}

TEST(DeformationHandleSource, Drag)
{
  const auto volume = MakeVolume({ { 0, 20, 0, 16, 0, 12 } });
  const std::vector<Handle> handles = { { { 5, 6, 4 }, { 7, 6.5, 4 } },
    { { 14, 10, 8 }, { 14, 9, 10 } } };
  vtkNew<vtkAppendPolyData> append;
  for (const Handle& handle : handles)
  {
    vtkNew<vtkDeformationHandleSource> source;
    source->SetRestPosition(handle.Rest.x, handle.Rest.y, handle.Rest.z);
    source->SetPosition(handle.Now.x, handle.Now.y, handle.Now.z);
    append->AddInputConnection(source->GetOutputPort());
  }
  Dragged wanted(volume);
  wanted.Drag(handles);
  Dragged dragged(volume);
  dragged.Filter->SetHandlesConnection(append->GetOutputPort());
  EXPECT_TRUE(HaveEqualBits(
    dragged.Update(), wanted.Filter->GetOutput()->GetPointData()->GetArray("Displacement")));
  EXPECT_GT(dragged.Filter->GetNumberOfMovedVoxels(), 20);
}

} // namespace
