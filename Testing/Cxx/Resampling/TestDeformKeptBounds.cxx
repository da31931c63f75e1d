// SPDX-License-Identifier: BSD-3-Clause
// BoundsGranularity: where the extent of the output ends, when it stays and when it moves; that
// moves within it are made in part; and that its voxels are those of a filter without it.
#include "FilterTesting.h"

#include <random>

using namespace filterTesting;

namespace
{

void TestProperty()
{
  vtkNew<vtkDeformVolumeFilter> filter;
  VERIFY_EQUAL(filter->GetBoundsGranularity(), 0);
  filter->SetBoundsGranularity(-5);
  VERIFY_EQUAL(filter->GetBoundsGranularity(), 0);
  const vtkMTimeType time = filter->GetMTime();
  filter->SetBoundsGranularity(1000000);
  VERIFY_EQUAL(filter->GetBoundsGranularity(), 1000);
  VERIFY(filter->GetMTime() > time);
}

/// A volume that is moved as a whole, and what becomes of the extent of the output.
class Moved
{
public:
  Moved()
    : Volume(MakeVolume()) // 10 x 9 x 8 voxels from 0, 0, 0
    , Mesh(MakeMesh(Volume))
    , Subject(Volume, Mesh)
  {
    this->Subject.Filter->SetBoundsGranularity(4);
  }

  vtkDeformVolumeFilter* GetFilter() { return this->Subject.Filter; }
  vtkImageData* GetVolume() { return this->Volume; }
  Deformed& GetSubject() { return this->Subject; }
  vtkUnstructuredGrid* GetMesh() { return this->Mesh; }

  void Expect(double x, const Extent& extent)
  {
    SetDisplacements(this->Mesh, Shift(x, 0.0, 0.0));
    VERIFY_EQUAL(GetExtent(this->Subject.Update()), extent);
    VERIFY_EQUAL(this->GetFilter()->GetNumberOfCoveredVoxels(), this->Volume->GetNumberOfPoints());
  }
  void Expect(double x, int first, int last) { this->Expect(x, { { first, last, 0, 8, 0, 8 } }); }

private:
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Subject;
};

// The voxels lie from x to x + 9.
void TestExtents()
{
  Moved moved;
  moved.Expect(0.0, 0, 12);
  moved.Expect(3.0, 0, 12);
  moved.Expect(4.0, 0, 16);  // out at one side, and the other could be 4 nearer only
  moved.Expect(0.0, 0, 16);  // now this one could
  moved.Expect(-1.0, -4, 8); // 8 nearer is more than one granule
  moved.Expect(3.0, -4, 12);
  moved.Expect(-1.0, -4, 12); // no flicker
  moved.Expect(9.0, 8, 20);
  moved.Expect(-9.0, -12, 0); // multiples below 0, too
}

// What is kept is of these settings and this volume only.
void TestFreshStarts()
{
  Moved moved;
  vtkDeformVolumeFilter* filter = moved.GetFilter();
  const auto widen = [&]
  {
    moved.Expect(4.0, 0, 16);
    moved.Expect(0.0, 0, 16);
  };
  moved.Expect(0.0, 0, 12);
  widen();
  filter->SetPadding(1); // counts before the rounding
  moved.Expect(0.0, { { -4, 12, -4, 12, -4, 8 } });
  filter->SetPadding(0);
  moved.Expect(0.0, 0, 12);
  widen();
  filter->SetOutputBoundsModeToVolumeBounds(); // for which it does not count
  moved.Expect(0.0, { { 0, 9, 0, 8, 0, 7 } });
  filter->SetOutputBoundsModeToDeformedBounds();
  moved.Expect(0.0, 0, 12);
  widen();
  filter->SetOutsideModeToExtrapolate();
  moved.Expect(0.0, 0, 12);
  widen();
  filter->SetDisplacementScale(2.0);
  moved.Expect(0.0, 0, 12);
  filter->SetDisplacementScale(1.0);
  moved.Expect(0.0, 0, 12);
  widen();
  filter->SetBoundsGranularity(1); // off, as 0 is
  moved.Expect(0.0, { { 0, 9, 0, 8, 0, 7 } });
  filter->SetBoundsGranularity(4);
  moved.Expect(0.0, 0, 12);
  widen();
  moved.GetVolume()->SetOrigin(-1.0, 0.0, 0.0);
  moved.Expect(0.0, 0, 12);
  moved.GetVolume()->SetOrigin(0.0, 0.0, 0.0);
  moved.Expect(0.0, 0, 12);

  // An error in between is none of these.
  widen();
  moved.GetMesh()->GetPointData()->GetVectors()->SetComponent(0, 0, std::nan(""));
  moved.GetMesh()->GetPointData()->GetVectors()->Modified();
  filter->Update();
  VERIFY_EQUAL(moved.GetSubject().TakeErrors(), 1);
  moved.Expect(0.0, 0, 16);

  // Too large is one error, whatever makes it so.
  filter->SetBoundsGranularity(1000);
  filter->SetOutputSpacingModeToCustomSpacing();
  filter->SetCustomSpacing(1e-6, 1e-6, 1e-6);
  filter->Update();
  VERIFY_EQUAL(moved.GetSubject().TakeErrors(), 1);
  filter->SetOutputSpacingModeToVolumeSpacing();
  filter->SetBoundsGranularity(4);
  moved.Expect(0.0, 0, 12);
}

/// Every voxel that both have is the same, and what one has beyond is background.
bool HaveSameVoxels(vtkImageData* larger, vtkImageData* smaller)
{
  vtkNew<vtkImageData> cropped;
  cropped->ShallowCopy(larger);
  cropped->Crop(smaller->GetExtent());
  return GetExtent(cropped) == GetExtent(smaller) && AreEqual(cropped, smaller);
}

// Nodes on the border of the mesh move, again and again.
void TestMoves(int resampler)
{
  const auto volume = MakeVolume({ { -3, 130, 2, 90, 0, 80 } });
  const auto mesh = MakeMesh(volume, 12, 3.0);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed kept(volume, mesh);
  Deformed tight(volume, mesh);
  for (vtkDeformVolumeFilter* filter : { kept.Filter.Get(), tight.Filter.Get() })
  {
    filter->SetResampler(resampler);
    filter->SetPadding(1);
  }
  kept.Filter->SetBoundsGranularity(16);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> out(0.0, 6.0);
  std::uniform_real_distribution<double> aside(-1.5, 1.5);
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  const Extent start{ { -16, 144, 0, 96, -16, 96 } };
  VERIFY_EQUAL(GetExtent(kept.Update()), start);
  VERIFY(HaveSameVoxels(kept.Filter->GetOutput(), tight.Update()));
  int parts = 0;
  int extents = 0; // of the other filter
  Extent last = GetExtent(tight.Filter->GetOutput());
  constexpr int moves = 20;
  for (int i = 0; i < moves; ++i)
  {
    // A node on the side where x is greatest.
    const auto y = static_cast<int>(random() % 12);
    const auto z = static_cast<int>(random() % 12);
    vectors->SetTuple3((z * 12 + y) * 12 + 11, out(random), aside(random), aside(random));
    vectors->Modified();
    VERIFY_EQUAL(GetExtent(kept.Update()), start);
    VERIFY(HaveSameVoxels(kept.Filter->GetOutput(), tight.Update()));
    VERIFY_EQUAL(kept.Filter->GetNumberOfCoveredVoxels(), tight.Filter->GetNumberOfCoveredVoxels());
    parts += GetReported(kept.Filter, "Bricks resampled") <
        GetReported(kept.Filter, "Bricks of the volume")
      ? 1
      : 0;
    extents += GetExtent(tight.Filter->GetOutput()) != last ? 1 : 0;
    last = GetExtent(tight.Filter->GetOutput());
  }
  std::cout << parts << " of " << moves << " moves were made in part, " << extents
            << " would have changed the extent\n";
  const bool isExact = resampler == vtkDeformVolumeFilter::EXACT;
  VERIFY_EQUAL(parts, isExact ? moves : 0);
  VERIFY(extents > 3);

  // A side goes far out, and comes back.
  const auto shift = [&](double x)
  {
    for (vtkIdType node = 11; node < vectors->GetNumberOfTuples(); node += 12)
    {
      vectors->SetTuple3(node, x, 0.0, 0.0);
    }
    vectors->Modified();
    const Extent extent = GetExtent(kept.Update());
    VERIFY(HaveSameVoxels(kept.Filter->GetOutput(), tight.Update()));
    return extent;
  };
  Extent wide = start;
  wide[1] = 176;
  VERIFY_EQUAL(shift(50.0), wide);
  VERIFY_EQUAL(shift(30.0), wide); // 160 would do
  VERIFY_EQUAL(shift(0.0), start);
}

} // namespace

int TestDeformKeptBounds(int, char*[])
{
  TestProperty();
  TestExtents();
  TestFreshStarts();
  TestMoves(vtkDeformVolumeFilter::EXACT);
  TestMoves(vtkDeformVolumeFilter::MESH_RASTERIZATION);
  return GetExitCode();
}
