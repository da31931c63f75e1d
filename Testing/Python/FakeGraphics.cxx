// SPDX-License-Identifier: BSD-3-Clause
// A library that a Python interpreter loads before all others (LD_PRELOAD): the device appears to
// be a graphics card with memory of its own.
#include "FakeDriver.h"

namespace
{

const bool IsSet = []
{
  FakeDriver::Get().IsGraphics = true;
  return true;
}();

} // namespace
