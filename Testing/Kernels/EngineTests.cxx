// SPDX-License-Identifier: BSD-3-Clause
// The main function of tests that intercept the calls of the driver: all tests of the engine, and
// some of the VTK classes.
//
// Usage: as in RunTests.h, and in addition
//   --device=gpu-like            the device appears to be a graphics card
//   --device=gpu-like-no-double  the device appears to be a graphics card without double precision
#include "RunTests.h"

#include "Device.h"
#include "FakeDriver.h"

#include <iostream>
#include <string>
#include <vector>

int main(int argc, char* argv[])
{
  std::vector<char*> others;
  for (int i = 0; i < argc; ++i)
  {
    const std::string argument = argv[i];
    if (argument == "--device=gpu-like" || argument == "--device=gpu-like-no-double")
    {
      FakeDriver::Get().IsGraphics = true; // before the first context is created
      FakeDriver::Get().HasDouble = argument == "--device=gpu-like";
    }
    else
    {
      others.push_back(argv[i]);
    }
  }
  // Otherwise the tests would run as on a CPU, and prove nothing for graphics cards.
  if (FakeDriver::Get().IsGraphics && deformvolume::GetDeviceAbilities("").Vectors)
  {
    std::cerr << argv[0] << ": the device does not appear to be a graphics card\n";
    return 2;
  }
  return RunTests(static_cast<int>(others.size()), others.data());
}
