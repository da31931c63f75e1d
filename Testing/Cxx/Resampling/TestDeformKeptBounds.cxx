// SPDX-License-Identifier: BSD-3-Clause
// BoundsGranularity: when the extent of the output is kept, and when it changes. While it is kept,
// only a part of the output is resampled, and the result is that of a filter without
// BoundsGranularity.
#include "FilterTesting.h"

#include <random>

using namespace filterTesting;

namespace
{

/// A volume that is translated, and the expected extent of the output.
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
    EXPECT_EQ(GetExtent(this->Subject.Update()), extent);
    EXPECT_EQ(this->GetFilter()->GetNumberOfCoveredVoxels(), this->Volume->GetNumberOfPoints());
  }
  void Expect(double x, int first, int last) { this->Expect(x, { { first, last, 0, 8, 0, 8 } }); }

private:
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Subject;
};

// The voxels of the moved volume are from x to x + 9.
TEST(DeformKeptBounds, Extents)
{
  Moved moved;
  moved.Expect(0.0, 0, 12);
  moved.Expect(3.0, 0, 12);
  moved.Expect(4.0, 0, 16);  // grows at one end; 4 unused voxels at the other end are kept
  moved.Expect(0.0, 0, 16);  // 4 unused voxels at the upper end are kept
  moved.Expect(-1.0, -4, 8); // 8 unused voxels are not kept
  moved.Expect(3.0, -4, 12);
  moved.Expect(-1.0, -4, 12); // does not alternate between two extents
  moved.Expect(9.0, 8, 20);
  moved.Expect(-9.0, -12, 0); // negative multiples of the granularity
}

// Other settings, or another volume, reset the extent.
TEST(DeformKeptBounds, Resets)
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
  filter->SetPadding(1); // is added before the extent is rounded
  moved.Expect(0.0, { { -4, 12, -4, 12, -4, 8 } });
  filter->SetPadding(0);
  moved.Expect(0.0, 0, 12);
  widen();
  filter->SetOutputBoundsModeToVolumeBounds(); // ignores BoundsGranularity
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
  filter->SetBoundsGranularity(1); // has no effect, like 0
  moved.Expect(0.0, { { 0, 9, 0, 8, 0, 7 } });
  filter->SetBoundsGranularity(4);
  moved.Expect(0.0, 0, 12);
  widen();
  moved.GetVolume()->SetOrigin(-1.0, 0.0, 0.0);
  moved.Expect(0.0, 0, 12);
  moved.GetVolume()->SetOrigin(0.0, 0.0, 0.0);
  moved.Expect(0.0, 0, 12);

  // An error does not reset the extent.
  widen();
  moved.GetMesh()->GetPointData()->GetVectors()->SetComponent(0, 0, std::nan(""));
  moved.GetMesh()->GetPointData()->GetVectors()->Modified();
  filter->Update();
  EXPECT_EQ(moved.GetSubject().TakeErrors(), 1);
  moved.Expect(0.0, 0, 16);

  // An output that is too large because of BoundsGranularity and CustomSpacing is one error.
  filter->SetBoundsGranularity(1000);
  filter->SetOutputSpacingModeToCustomSpacing();
  filter->SetCustomSpacing(1e-6, 1e-6, 1e-6);
  filter->Update();
  EXPECT_EQ(moved.GetSubject().TakeErrors(), 1);
  filter->SetOutputSpacingModeToVolumeSpacing();
  filter->SetBoundsGranularity(4);
  moved.Expect(0.0, 0, 12);
}

// Nodes on the boundary of the mesh move repeatedly.
void CheckMoves(int resampler)
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
  EXPECT_EQ(GetExtent(kept.Update()), start);
  EXPECT_TRUE(IsPartOf(tight.Update(), kept.Filter->GetOutput()));
  int parts = 0;
  int extents = 0; // number of changes of the extent without BoundsGranularity
  Extent last = GetExtent(tight.Filter->GetOutput());
  constexpr int moves = 20;
  for (int i = 0; i < moves; ++i)
  {
    // A node on the side of largest x.
    const auto y = static_cast<int>(random() % 12);
    const auto z = static_cast<int>(random() % 12);
    vectors->SetTuple3((z * 12 + y) * 12 + 11, out(random), aside(random), aside(random));
    vectors->Modified();
    EXPECT_EQ(GetExtent(kept.Update()), start);
    EXPECT_TRUE(IsPartOf(tight.Update(), kept.Filter->GetOutput()));
    EXPECT_EQ(kept.Filter->GetNumberOfCoveredVoxels(), tight.Filter->GetNumberOfCoveredVoxels());
    parts += GetReported(kept.Filter, "Bricks resampled") <
        GetReported(kept.Filter, "Bricks of the volume")
      ? 1
      : 0;
    extents += GetExtent(tight.Filter->GetOutput()) != last ? 1 : 0;
    last = GetExtent(tight.Filter->GetOutput());
  }
  std::cout << parts << " of " << moves << " moves were partial updates, " << extents
            << " would have changed the extent\n";
  const bool isExact = resampler == vtkDeformVolumeFilter::EXACT;
  EXPECT_EQ(parts, isExact ? moves : 0);
  EXPECT_GT(extents, 3);

  // One side of the mesh moves far away, and back.
  const auto shift = [&](double x)
  {
    for (vtkIdType node = 11; node < vectors->GetNumberOfTuples(); node += 12)
    {
      vectors->SetTuple3(node, x, 0.0, 0.0);
    }
    vectors->Modified();
    const Extent extent = GetExtent(kept.Update());
    EXPECT_TRUE(IsPartOf(tight.Update(), kept.Filter->GetOutput()));
    return extent;
  };
  Extent wide = start;
  wide[1] = 176;
  EXPECT_EQ(shift(50.0), wide);
  EXPECT_EQ(shift(30.0), wide); // an end of 160 would suffice
  EXPECT_EQ(shift(0.0), start);
}

} // namespace

TEST(DeformKeptBounds, Moves)
{
  CheckMoves(vtkDeformVolumeFilter::EXACT);
  CheckMoves(vtkDeformVolumeFilter::MESH_RASTERIZATION);
}
