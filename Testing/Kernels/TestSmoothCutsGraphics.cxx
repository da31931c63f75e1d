// SPDX-License-Identifier: BSD-3-Clause
// All tests of smooth cuts on a device that appears to be a graphics card, with memory of its own
// and groups of work-items.
#include "DeviceNeeds.h"
#include "FakeDriver.h"

#include <gtest/gtest.h>

namespace
{

// Before there is a context.
const bool IsSet = []
{
  FakeDriver::Get().IsGraphics = true;
  return true;
}();

} // namespace

TEST(SmoothCutsGraphics, TheDeviceIsAGraphicsCard)
{
  ASSERT_TRUE(IsSet);
  EXPECT_FALSE(HasVectors());
}
