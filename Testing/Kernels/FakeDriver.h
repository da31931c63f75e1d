// SPDX-License-Identifier: BSD-3-Clause
// Stands between the kernels and the OpenCL driver of a test program: has calls fail, and the
// device appear to be another one than it is. Programs that link it take its functions in place of
// those of the OpenCL library, which these call.
#ifndef FakeDriver_h
#define FakeDriver_h

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

struct FakeDriver
{
  /// A kernel of a program as the driver gets it.
  struct Launch
  {
    std::string Text; // of the program
    std::string Kernel;
    std::size_t Items = 1;       // in a group
    std::size_t LocalMemory = 0; // bytes of a group that arguments ask for
  };

  /// Copies from the device that the host does not wait for fail, unless 0: with this error.
  int ReadError = 0;
  /// The device is a graphics card, and has no double precision. Contexts live as long as the
  /// process: these are set before the first one.
  bool IsGraphics = false;
  bool HasDouble = true;
  /// Bytes that the device has, 0: as it is.
  std::uint64_t GlobalMemory = 0;
  std::uint64_t LocalMemory = 0;
  /// No buffer is made over memory of the host that overlaps that of another one: what commands on
  /// both do is undefined.
  bool RefusesOverlaps = false;
  /// Programs are compiled so that products are fused with sums wherever that is possible.
  bool FusesProducts = false;
  /// Launches of more than one work-item that left the size of the groups to the driver.
  int LaunchesWithoutGroup = 0;
  /// Kernels are not run, and what they would have written stays as it was: 0 at first.
  bool SkipsLaunches = false;
  /// Called with each program that has been built from its text: the text, the options, and the
  /// names of the kernels, which are separated by semicolons.
  std::function<void(const std::string&, const std::string&, const std::string&)> OnBuild;
  /// Called with each launch.
  std::function<void(const Launch&)> OnLaunch;

  /// Bytes that calls of the host have brought from buffers and to them. A buffer that is mapped
  /// counts as read and written as the access has it.
  std::uint64_t BytesRead = 0;
  std::uint64_t BytesWritten = 0;

  static FakeDriver& Get();
};

#endif
