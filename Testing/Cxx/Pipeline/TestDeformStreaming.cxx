// SPDX-License-Identifier: BSD-3-Clause
// Streaming: parts of the output that are made from parts of the volume are equal to those of the
// whole output, to the last bit. If the source of the volume can make parts, only the needed parts
// are requested.
#include "DeviceNeeds.h"
#include "DivisionCases.h"

#include <vtkExtentTranslator.h>
#include <vtkImageDataStreamer.h>
#include <vtkImageShiftScale.h>

using namespace divisionCases;

namespace
{

class DeformStreaming : public testing::Test
{
  void SetUp() override { SKIP_WITHOUT_DOUBLE_PRECISION() }
};

/// A filter with the inputs and settings of a case, and a source that makes parts.
struct Streamed : Deformed
{
  explicit Streamed(const Case& from)
  {
    this->Source->SetVolume(from.Volume);
    this->Filter->SetInputConnection(this->Source->GetOutputPort());
    this->Filter->SetDeformationData(from.Deformation);
    from.Set(this->Filter);
  }
  Extent GetWhole()
  {
    this->Filter->UpdateInformation();
    Extent whole;
    this->Filter->GetOutputInformation(0)->Get(
      vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
    return whole;
  }
  vtkNew<PartSource> Source;
};

vtkSmartPointer<vtkImageData> MakeWhole(const Case& from)
{
  Deformed whole(from.Volume, from.Deformation);
  from.Set(whole.Filter);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(whole.Update());
  EXPECT_GT(image->GetNumberOfPoints(), 0);
  return image;
}

/// Compares all arrays of pieces with those of the whole output.
void CheckPieces(const Case& from, vtkImageData* whole)
{
  constexpr int pieces = 8;
  Streamed streamed(from);
  Extent extent = streamed.GetWhole();
  EXPECT_EQ(extent, GetExtent(whole));
  vtkNew<vtkExtentTranslator> translator;
  for (int piece = 0; piece < pieces; ++piece)
  {
    Extent part;
    translator->PieceToExtentThreadSafe(
      piece, pieces, 0, extent.data(), part.data(), vtkExtentTranslator::BLOCK_MODE, 0);
    streamed.Filter->UpdateExtent(part.data());
    EXPECT_EQ(streamed.TakeErrors(), 0);
    EXPECT_EQ(GetExtent(streamed.Filter->GetOutput()), part);
    EXPECT_TRUE(IsPartOf(streamed.Filter->GetOutput(), whole)) << from.Name << ", piece " << piece;
  }
}

/// Compares the scalars that vtkImageDataStreamer assembles from parts.
void CheckStreamer(const Case& from, vtkImageData* whole, int divisions)
{
  Streamed streamed(from);
  vtkNew<vtkImageDataStreamer> streamer;
  streamer->SetInputConnection(streamed.Filter->GetOutputPort());
  streamer->SetNumberOfStreamDivisions(divisions);
  streamer->Update();
  EXPECT_EQ(streamed.TakeErrors(), 0);
  EXPECT_EQ(GetExtent(streamer->GetOutput()), GetExtent(whole));
  EXPECT_TRUE(HaveEqualBits(
    streamer->GetOutput()->GetPointData()->GetScalars(), whole->GetPointData()->GetScalars()));
}

// A source that announces that it can make parts, but makes other parts than requested.
TEST_F(DeformStreaming, WrongParts)
{
  const Case from = MakeCases()[2];
  Streamed streamed(from);
  streamed.Source->GivesOtherParts = true;
  Extent part = streamed.GetWhole();
  part[5] = part[4] + 3;
  streamed.Filter->UpdateExtent(part.data());
  EXPECT_EQ(streamed.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(streamed.LastError, "was asked for an extent"));
  EXPECT_EQ(streamed.Filter->GetOutput()->GetNumberOfPoints(), 0);
  // With a correct source the filter works again.
  streamed.Source->GivesOtherParts = false;
  streamed.Source->Modified();
  streamed.Filter->UpdateExtent(part.data());
  EXPECT_EQ(streamed.TakeErrors(), 0);
  EXPECT_TRUE(IsPartOf(streamed.Filter->GetOutput(), MakeWhole(from)));
}

// A smooth cut needs the whole volume. If the source has not announced the arrays of the cut, the
// first update of a part fails.
void CheckCutInParts(const Case& from)
{
  Streamed streamed(from);
  streamed.Source->AnnouncesArrays = false;
  Extent part = streamed.GetWhole();
  part[5] = part[4] + 3;
  streamed.Filter->UpdateExtent(part.data());
  EXPECT_EQ(streamed.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(streamed.LastError, "smooth cut"));
  EXPECT_EQ(streamed.Filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_LT(streamed.Source->GetMost(), from.Volume->GetNumberOfPoints());
  streamed.Source->Modified();
  streamed.Filter->UpdateExtent(part.data());
  EXPECT_EQ(streamed.TakeErrors(), 0);
  EXPECT_EQ(streamed.Source->GetMost(), from.Volume->GetNumberOfPoints());
  EXPECT_TRUE(IsPartOf(streamed.Filter->GetOutput(), MakeWhole(from)));
}

// The extents that are requested from the source.
TEST_F(DeformStreaming, Requests)
{
  const Case from = MakeCases()[2];
  const vtkIdType all = from.Volume->GetNumberOfPoints();
  {
    // For the whole output the whole volume is requested, once.
    Streamed streamed(from);
    streamed.Update();
    EXPECT_EQ(streamed.Source->Made.size(), 1U);
    EXPECT_EQ(streamed.Source->GetMost(), all);
    // Then parts of the output need no other request.
    Extent part = streamed.GetWhole();
    part[5] = part[4] + 3;
    streamed.Filter->UpdateExtent(part.data());
    EXPECT_EQ(streamed.Source->Made.size(), 1U);
    EXPECT_TRUE(IsPartOf(streamed.Filter->GetOutput(), MakeWhole(from)));
  }
  {
    // For one eighth of the output less than one third of the volume is requested.
    Case high = from;
    high.Volume = divisionCases::MakeVolume({ { 0, 15, 0, 17, -60, 139 } });
    high.Deformation = MakeMesh(high.Volume, 6);
    SetDisplacements(high.Deformation, Bend(high.Volume));
    Streamed streamed(high);
    const vtkIdType all = high.Volume->GetNumberOfPoints();
    const Extent whole = streamed.GetWhole();
    for (int i = 0; i < 8; ++i)
    {
      Extent part = whole;
      part[4] = whole[4] + (whole[5] - whole[4] + 1) * i / 8;
      part[5] = whole[4] + (whole[5] - whole[4] + 1) * (i + 1) / 8 - 1;
      streamed.Filter->UpdateExtent(part.data());
    }
    EXPECT_EQ(streamed.TakeErrors(), 0);
    EXPECT_GT(streamed.Source->Made.size(), 1);
    EXPECT_LT(3 * streamed.Source->GetMost(), all);
    // The same with another filter between source and deformation filter.
    vtkNew<vtkImageShiftScale> shift;
    shift->SetInputConnection(streamed.Source->GetOutputPort());
    shift->SetOutputScalarTypeToFloat();
    streamed.Filter->SetInputConnection(shift->GetOutputPort());
    streamed.Source->Made.clear();
    Extent part = whole;
    part[5] = part[4] + 3;
    streamed.Filter->UpdateExtent(part.data());
    EXPECT_TRUE(!streamed.Source->Made.empty() && 3 * streamed.Source->GetMost() < all);
  }
  {
    // A source that cannot make parts is executed once.
    Streamed streamed(from);
    streamed.Source->CanMakeParts = false;
    CheckStreamer(from, MakeWhole(from), 4);
    vtkNew<vtkImageDataStreamer> streamer;
    streamer->SetInputConnection(streamed.Filter->GetOutputPort());
    streamer->SetNumberOfStreamDivisions(4);
    streamer->Update();
    EXPECT_EQ(streamed.Source->Made.size(), 1U);
    EXPECT_EQ(GetReported(streamed.Filter, "Volumes sent"), 1);
    EXPECT_EQ(GetReported(streamed.Filter, "Static mappings made"), 1);
  }
  {
    // Outside the deformed volume the output is background, and little is read.
    Streamed streamed(from);
    streamed.Filter->SetOutputBoundsModeToCustomBounds();
    streamed.Filter->SetCustomBounds(1000.0, 1010.0, 0.0, 9.0, 0.0, 9.0);
    streamed.Filter->SetBackgroundValue(5.0);
    streamed.Filter->Update();
    EXPECT_EQ(streamed.TakeErrors(), 0);
    EXPECT_LT(10 * streamed.Source->GetMost(), all);
    double range[2];
    streamed.GetValues()->GetRange(range);
    EXPECT_TRUE(range[0] == 5.0 && range[1] == 5.0);
  }
}

// With a mesh between voxels the output is background. A mesh outside the volume is an error, for
// any requested part, and after any other part.
void CheckMeshWithoutVoxels(const Case& from, double x, bool isOutside)
{
  vtkNew<vtkLatticeTetrahedraSource> mesh;
  mesh->SetNumberOfNodes(2, 2, 2);
  mesh->SetBounds(x, x + 0.3, 8.3, 8.6, 3.3, 3.6);
  mesh->Update();
  Case none = from;
  none.Deformation = mesh->GetOutput();
  SetDisplacements(none.Deformation, Shift(0.0, 0.0, 0.0));
  none.Set = [](vtkDeformVolumeFilter* filter) { filter->SetOutputBoundsModeToVolumeBounds(); };
  Streamed edited(none);
  const Extent whole = edited.GetWhole();
  for (const int last : { whole[4] + 3, whole[5], whole[4] + 3 })
  {
    Extent part = whole;
    part[5] = last;
    Streamed fresh(none);
    edited.Filter->Modified();
    for (Streamed* streamed : { &edited, &fresh })
    {
      streamed->Filter->UpdateExtent(part.data());
      EXPECT_EQ(streamed->TakeErrors(), isOutside ? 1 : 0);
      EXPECT_EQ(streamed->Filter->GetOutput()->GetNumberOfPoints(),
        isOutside ? 0 : vtkIdType{ deformvolume::GetNumberOfPoints(part) });
      EXPECT_EQ(streamed->Filter->GetNumberOfCoveredVoxels(), 0);
    }
    if (isOutside)
    {
      EXPECT_TRUE(HasPart(fresh.LastError, "holds no voxel"));
    }
  }
}

} // namespace

TEST_F(DeformStreaming, MeshWithoutVoxels)
{
  const Case from = MakeCases()[2];
  CheckMeshWithoutVoxels(from, 10.3, false);
  CheckMeshWithoutVoxels(from, 1000.3, true);
}

TEST_F(DeformStreaming, Cases)
{
  for (const Case& from : MakeCases())
  {
    const auto whole = MakeWhole(from);
    CheckPieces(from, whole);
    if (from.Name == "Smooth cut")
    {
      CheckCutInParts(from);
    }
  }
}

TEST_F(DeformStreaming, Divisions)
{
  const Case from = MakeCases()[2];
  const auto whole = MakeWhole(from);
  for (const int divisions : { 1, 2, 32 })
  {
    CheckStreamer(from, whole, divisions);
  }
}

// Such an output is resampled in double precision. A part of it must be, too, although a volume of
// its size is resampled in single precision.
TEST_F(DeformStreaming, LongAxis)
{
  Case from{ "Long axis", divisionCases::MakeVolume({ { 0, 32999, 0, 2, 0, 2 } }), nullptr };
  auto field =
    MakeImage({ { 0, 1100, 0, 1, 0, 1 } }, glm::dvec3(30.0, 2.0, 2.0), glm::dvec3(3.0, -2.0, 1.0));
  SetDisplacements(field,
    [](const glm::dvec3& p) { return p + glm::dvec3(std::sin(p.x), 0.0, 0.2 * std::cos(p.x)); });
  from.Deformation = field;
  from.Set = [](vtkDeformVolumeFilter* filter) { filter->SetOutputBoundsModeToVolumeBounds(); };
  const auto whole = MakeWhole(from);
  Streamed part(from);
  const Extent extent{ { 1000, 20999, 0, 2, 0, 2 } };
  part.Filter->UpdateInformation();
  EXPECT_TRUE(part.Filter->UpdateExtent(extent.data()));
  EXPECT_TRUE(IsPartOf(part.Filter->GetOutput(), whole));
}
