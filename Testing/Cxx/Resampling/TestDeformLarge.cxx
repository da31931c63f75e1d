// SPDX-License-Identifier: BSD-3-Clause
// An output of more than 2^31 voxels, most of them background. The deformed volume is at the end of
// the output, where ids of voxels need more than 32 bits.
#include "FilterTesting.h"

#include <vtkUnsignedCharArray.h>
#include <vtksys/SystemInformation.hxx>

#include <glm/vec3.hpp>

using namespace filterTesting;

TEST(DeformLarge, MoreThan2To31Voxels)
{
  vtksys::SystemInformation system;
  system.RunMemoryCheck();
  if (system.GetAvailablePhysicalMemory() < 8192)
  {
    GTEST_SKIP() << "this needs 8 GiB of free memory";
  }
  const int size = 1300;
  auto volume = MakeImage({ { 0, 12, 0, 11, 0, 10 } });
  AddScalars<unsigned char>(
    volume, "value", [](const glm::dvec3& p) { return 1.0 + p.x + 13.0 * p.y + p.z; });
  auto mesh = MakeMesh(volume);
  const glm::ivec3 shift(size - 13, size - 12, size - 11);
  SetDisplacements(mesh, Shift(shift.x, shift.y, shift.z));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputBoundsModeToCustomBounds();
  deformed.Filter->SetCustomBounds(0.0, size - 1.0, 0.0, size - 1.0, 0.0, size - 1.0);
  vtkImageData* output = deformed.Update();
  const Extent expected{ { 0, size - 1, 0, size - 1, 0, size - 1 } };
  EXPECT_EQ(GetExtent(output), expected);
  const vtkIdType points = static_cast<vtkIdType>(size) * size * size;
  EXPECT_GT(points, vtkIdType(1) << 31);
  EXPECT_EQ(output->GetNumberOfPoints(), points);
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
  auto* values = vtkUnsignedCharArray::SafeDownCast(deformed.GetValues());
  auto* source = vtkUnsignedCharArray::SafeDownCast(volume->GetPointData()->GetScalars());
  ASSERT_NE(values, nullptr);
  ASSERT_EQ(values->GetNumberOfTuples(), points);
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = GetPoint(volume, id);
    int moved[3] = { shift.x + static_cast<int>(p.x), shift.y + static_cast<int>(p.y),
      shift.z + static_cast<int>(p.z) };
    const vtkIdType target = output->ComputePointId(moved);
    EXPECT_EQ(+values->GetValue(target), +source->GetValue(id));
    EXPECT_TRUE(deformed.IsCovered(target));
  }
  vtkIdType covered = 0;
  for (vtkIdType id = 0; id < points; ++id)
  {
    covered += values->GetValue(id) != 0 ? 1 : 0;
  }
  EXPECT_EQ(covered, volume->GetNumberOfPoints());
}
