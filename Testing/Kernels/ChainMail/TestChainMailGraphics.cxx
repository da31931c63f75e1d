// SPDX-License-Identifier: BSD-3-Clause
// ChainMail: failing copies from a device with its own memory.
#include "ChainMailModel.h"
#include "DeviceNeeds.h"
#include "FakeDriver.h"

#include <gtest/gtest.h>

using namespace deformvolume;

TEST(ChainMailFaults, CopiesThatFail)
{
  SKIP_UNLESS_GRAPHICS()
  const Extent extent{ { 0, 20, 0, 20, 0, 20 } };
  ChainMailModel model;
  std::vector<float> output(3 * 21 * 21 * 21);
  ChainMailRequest request;
  request.Handles.resize(1);
  request.Handles[0].RestPosition = { { 10, 10, 10 } };
  request.Handles[0].Displacement = { { 2, 0, 0 } };
  model.SetVoxelGrid(extent);
  model.SetOutput(output.data());
  model.Step(request);
  const std::vector<float> expected = output;
  request.Handles[0].Displacement = { { 3, 0, 0 } };
  FakeDriver::Get().ReadError = -5;
  EXPECT_THROW(model.Step(request), Error);
  FakeDriver::Get().ReadError = 0;
  // The state of the device may be incomplete, so the volume must be set again.
  EXPECT_THROW(model.Step(request), Error);
  EXPECT_EQ(model.GetDeviceMemory(), 0U);
  model.SetVoxelGrid(extent);
  model.SetOutput(output.data());
  request.Handles[0].Displacement = { { 2, 0, 0 } };
  model.Step(request);
  EXPECT_EQ(output, expected);
}
