// SPDX-License-Identifier: BSD-3-Clause
// A library for LD_PRELOAD, with FakeDriver.cxx: the OpenCL device appears to be a graphics card in
// any program.
#include "FakeDriver.h"

namespace
{

const bool IsGraphics = FakeDriver::Get().IsGraphics = true;

} // namespace
