// SPDX-License-Identifier: BSD-3-Clause
// Loaded before the OpenCL library (LD_PRELOAD), together with FakeDriver.cxx: the device of any
// program appears to be a graphics card.
#include "FakeDriver.h"

namespace
{

const bool IsGraphics = FakeDriver::Get().IsGraphics = true;

} // namespace
