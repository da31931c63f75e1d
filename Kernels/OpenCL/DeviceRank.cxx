// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceRank.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <tuple>

namespace deformvolume
{

std::string ToLower(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

namespace
{

bool BeginsWith(const std::string& text, const char* begin)
{
  return text.rfind(begin, 0) == 0;
}

/// PoCL has devices for CPUs and for other processors, which differ in the prefix of the name.
bool IsProcessorOfPoCL(const DeviceDescription& device)
{
  return BeginsWith(device.Platform, "Portable Computing Language") &&
    (BeginsWith(device.Name, "cpu") || BeginsWith(device.Name, "pthread") ||
      BeginsWith(device.Name, "basic"));
}

/// From the least to the most preferred, see IsBetter().
enum Class
{
  Emulated,
  Integrated,
  Processor,
  Accelerator,
  Graphics
};

Class GetClass(const DeviceDescription& device)
{
  if (IsEmulated(device))
  {
    return Emulated;
  }
  if (device.Type == DeviceDescription::Kind::Processor)
  {
    return Processor;
  }
  if (device.SharesMemory)
  {
    return Integrated;
  }
  return device.Type == DeviceDescription::Kind::Graphics ? Graphics : Accelerator;
}

} // namespace

bool IsEmulated(const DeviceDescription& device)
{
  static const std::array<const char*, 6> emulators{ { "llvmpipe", "softpipe", "swrast", "lavapipe",
    "swiftshader", "oclgrind" } };
  const std::string name = ToLower(device.Name + " " + device.Platform);
  return std::any_of(emulators.begin(), emulators.end(),
           [&](const char* emulator) { return name.find(emulator) != std::string::npos; }) ||
    (device.Type != DeviceDescription::Kind::Processor && IsProcessorOfPoCL(device));
}

bool IsBetter(const DeviceDescription& a, const DeviceDescription& b)
{
  return std::make_tuple(GetClass(a), a.HasDouble, a.ComputeUnits) >
    std::make_tuple(GetClass(b), b.HasDouble, b.ComputeUnits);
}

} // namespace deformvolume
