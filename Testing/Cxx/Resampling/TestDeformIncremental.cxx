// SPDX-License-Identifier: BSD-3-Clause
// GetChangedExtent() after different updates. Testing/Fuzz checks that partial updates are equal to
// whole ones, and that nothing changes outside this extent.
#include "Extent.h"
#include "FilterTesting.h"

#include <algorithm>

using namespace filterTesting;

namespace
{

const Extent Nothing = deformvolume::EmptyExtent;

Extent GetChangedExtent(const Deformed& deformed)
{
  Extent extent;
  deformed.Filter->GetChangedExtent(extent.data());
  EXPECT_TRUE(std::equal(extent.begin(), extent.end(), deformed.Filter->GetChangedExtent()));
  return extent;
}

// The extent is that of the whole output, empty, or that around a moved node. It is empty after an
// error.
TEST(DeformIncremental, ChangedExtent)
{
  const auto volume = MakeVolume({ { -3, 130, 2, 90, 0, 80 } });
  const auto mesh = MakeMesh(volume, 12, 3.0);
  SetDisplacements(mesh, Shift(0.25, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  EXPECT_EQ(GetChangedExtent(deformed), Nothing);
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  const auto expect = [&](const Extent& expected)
  {
    deformed.Update();
    EXPECT_EQ(GetChangedExtent(deformed), expected);
  };
  expect(GetExtent(volume));
  expect(GetExtent(volume)); // nothing was executed
  deformed.Filter->Modified();
  expect(Nothing);

  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  const vtkIdType node = (6 * 12 + 6) * 12 + 6; // the lattice has 12 nodes on each axis
  vectors->SetTuple3(node, 1.0, 0.5, 0.5);
  vectors->Modified();
  deformed.Update();
  const Extent changed = GetChangedExtent(deformed);
  const glm::dvec3 point = GetPoint(mesh, node);
  const double step[3] = { 140.0 / 11.0, 94.0 / 11.0, 86.0 / 11.0 }; // between nodes
  const int subBrick[3] = { 16, 8, 8 };
  for (int axis = 0; axis < 3; ++axis)
  {
    const double middle = (&point.x)[axis];
    // The extent contains the tetrahedra of the node, and is not larger than the sub-bricks that
    // they intersect.
    EXPECT_TRUE(changed[2 * axis] < middle && middle < changed[2 * axis + 1]);
    EXPECT_GE(changed[2 * axis], middle - step[axis] - subBrick[axis] - 1.0);
    EXPECT_LE(changed[2 * axis + 1], middle + step[axis] + subBrick[axis] + 2.0);
  }

  vectors->SetTuple3(node, std::nan(""), 0.0, 0.0);
  vectors->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeErrors(), 1);
  EXPECT_EQ(GetChangedExtent(deformed), Nothing);
  vectors->SetTuple3(node, 0.0, 0.0, 0.0);
  vectors->Modified();
  expect(GetExtent(volume));

  deformed.Filter->SetResamplerToMeshRasterization();
  expect(GetExtent(volume));
  deformed.Filter->SetResamplerToExact();
  deformed.Filter->SetPadding(2);
  expect({ { -5, 132, 0, 92, -2, 82 } });
}

// Values that a program has written into an array of the output, and marked as modified, are not
// kept.
TEST(DeformIncremental, WrittenOutput)
{
  const auto volume = MakeVolume({ { -3, 130, 2, 90, 0, 80 } });
  const auto mesh = MakeMesh(volume, 12, 3.0);
  SetDisplacements(mesh, Shift(0.25, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  vtkDataArray* values = deformed.Update()->GetPointData()->GetScalars();
  values->Fill(77.0);
  values->Modified();
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  vectors->SetTuple3((6 * 12 + 6) * 12 + 6, 1.0, 0.5, 0.5);
  vectors->Modified();
  Deformed expected(volume, mesh);
  expected.Filter->SetOutputBoundsModeToVolumeBounds();
  EXPECT_TRUE(AreEqual(deformed.Update(), expected.Update()));
}

} // namespace
