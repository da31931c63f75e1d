// SPDX-License-Identifier: BSD-3-Clause
// Copies from and to a device with memory of its own while it makes the lists of tetrahedra.
#include "DeviceNeeds.h"
#include "FakeDriver.h"
#include "MemoryBudget.h"
#include "Tetrahedron.h"
#include "TetrahedronLists.h"
#include "WorkDevice.h"

#include <gtest/gtest.h>

#include <vector>

using namespace deformvolume;

// Counters stay on the device. The host reads one length and two counters, no matter how many tiles
// there are.
TEST(MeshRasterizationGraphics, ListsStayOnTheDevice)
{
  SKIP_UNLESS_GRAPHICS()
  const std::vector<cl_int> positions{ 0, 0, 0, 0, 256000, 0, 0, 0, 0, 256000, 0, 0, 0, 0, 256000,
    0 };
  const std::vector<Tetrahedron> tetrahedra(1000, Tetrahedron{ { 0, 1, 2, 3 } });
  RasterParameters p = {};
  p.Tetrahedra = static_cast<int>(tetrahedra.size());
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    p.OutputSize[axis] = 64;
    p.TileCount[axis] = axis == 0 ? 2 : 8;
  }
  WorkDevice device;
  MemoryBudget budget(device, [] { return std::uint64_t{ 0 }; });
  cl::Buffer nodes;
  cl::Buffer mesh;
  device.Send(nodes, positions);
  device.Send(mesh, tetrahedra);
  TetrahedronLists lists;
  FakeDriver& driver = FakeDriver::Get();
  driver.BytesRead = 0;
  driver.BytesWritten = 0;
  driver.LaunchesWithoutGroup = 0;
  EXPECT_EQ(lists.Make(device, budget, mesh, nodes, p).Inverted, 0);
  EXPECT_EQ(driver.BytesRead, 2 * sizeof(cl_uint) + sizeof(cl_ulong));
  EXPECT_EQ(driver.BytesWritten, 2 * sizeof(cl_uint));
  EXPECT_EQ(driver.LaunchesWithoutGroup, 0);
  EXPECT_GE(lists.GetMemory(), 128U * 1000U * sizeof(cl_int));
}
