// SPDX-License-Identifier: BSD-3-Clause
// A library that a Python interpreter loads before all other libraries (LD_PRELOAD). It makes the
// device appear to be a GPU with memory of its own.
#include "FakeDriver.h"

namespace
{

const bool IsSet = []
{
  FakeDriver::Get().IsGraphics = true;
  return true;
}();

} // namespace
