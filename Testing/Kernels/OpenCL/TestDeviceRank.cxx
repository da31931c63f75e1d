// SPDX-License-Identifier: BSD-3-Clause
// The order of several devices by their rank.
#include "Device.h"
#include "DeviceRank.h"
#include "FakeDriver.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using namespace deformvolume;
using Kind = DeviceDescription::Kind;

namespace
{

DeviceDescription Make(Kind kind, const char* name, const char* platform, bool shares,
  bool hasDouble, unsigned int units)
{
  DeviceDescription device;
  device.Type = kind;
  device.Name = name;
  device.Platform = platform;
  device.SharesMemory = shares;
  device.HasDouble = hasDouble;
  device.ComputeUnits = units;
  return device;
}

// Devices as drivers describe them, from the best to the worst.
const std::vector<DeviceDescription> Ranked{
  Make(Kind::Graphics, "NVIDIA H100", "NVIDIA CUDA", false, true, 132),
  Make(Kind::Graphics, "NVIDIA GeForce", "Portable Computing Language", false, true, 20),
  Make(Kind::Graphics, "Intel(R) Arc(TM)", "Intel(R) OpenCL Graphics", false, false, 512),
  Make(Kind::Other, "FPGA", "Accelerators", false, true, 1),
  Make(Kind::Processor, "cpu-haswell", "Portable Computing Language", true, true, 8),
  Make(Kind::Processor, "Intel(R) Xeon(R)", "Intel(R) OpenCL", true, true, 2),
  Make(Kind::Graphics, "Intel(R) UHD Graphics", "Intel(R) OpenCL Graphics", true, true, 24),
  Make(Kind::Graphics, "Intel(R) Iris(R) Xe", "Intel(R) OpenCL Graphics", true, false, 96),
  Make(Kind::Graphics, "Oclgrind Simulator", "Oclgrind", true, true, 1),
  Make(Kind::Graphics, "llvmpipe (LLVM 19.1.7, 256 bits)", "rusticl", true, false, 64),
  Make(Kind::Processor, "llvmpipe (LLVM 21.1.8, 256 bits)", "rusticl", true, false, 8),
};

} // namespace

TEST(DeviceRank, Order)
{
  for (std::size_t i = 0; i < Ranked.size(); ++i)
  {
    for (std::size_t j = 0; j < Ranked.size(); ++j)
    {
      EXPECT_EQ(IsBetter(Ranked[i], Ranked[j]), i < j)
        << Ranked[i].Name << " and " << Ranked[j].Name;
    }
  }
}

// An emulated device is recognized for any type and memory that its driver reports.
TEST(DeviceRank, Emulated)
{
  const DeviceDescription processor =
    Make(Kind::Processor, "cpu-haswell", "Portable Computing Language", true, true, 1);
  EXPECT_FALSE(IsEmulated(processor));
  for (const char* name : { "llvmpipe (LLVM 19)", "softpipe", "SWRAST", "Google SwiftShader" })
  {
    for (const Kind kind : { Kind::Graphics, Kind::Other, Kind::Processor })
    {
      for (const bool shares : { false, true })
      {
        const DeviceDescription software = Make(kind, name, "any", shares, true, 1000);
        EXPECT_TRUE(IsEmulated(software)) << name;
        EXPECT_TRUE(IsBetter(processor, software)) << name;
        EXPECT_FALSE(IsBetter(software, processor)) << name;
      }
    }
  }
  // PoCL reports another type than CPU if the user requests it.
  EXPECT_TRUE(
    IsEmulated(Make(Kind::Graphics, "cpu-haswell", "Portable Computing Language", false, true, 8)));
  EXPECT_FALSE(IsEmulated(
    Make(Kind::Graphics, "NVIDIA GeForce", "Portable Computing Language", false, true, 8)));
}

// If the driver lists a software renderer before a CPU, the CPU is used. The test needs two
// devices, which Kernels.TestDeviceRank requests from PoCL.
TEST(DeviceRank, EmulatedDeviceThatIsListedFirst)
{
  FakeDriver::Get().FirstName = "llvmpipe (LLVM 19.1.7, 256 bits)";
  const std::vector<std::string> names = GetDeviceNames();
  if (names.size() < 2)
  {
    GTEST_SKIP() << "There is one device only.";
  }
  EXPECT_EQ(names.front().find("llvmpipe"), std::string::npos) << names.front();
  EXPECT_EQ(names.back().find("llvmpipe"), 0U) << names.back();
  EXPECT_EQ(ResolveDevice(""), names.front());
  EXPECT_EQ(ResolveDevice("cpu"), names.front());
  EXPECT_EQ(ResolveDevice("LLVMpipe"), names.back());
}
