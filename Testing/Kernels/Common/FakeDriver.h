// SPDX-License-Identifier: BSD-3-Clause
// Stands between the kernels and the OpenCL driver of a test program: has calls fail, and the
// device appear to be another one than it is. Programs that link it take its functions in place of
// those of the OpenCL library, which these call.
#ifndef FakeDriver_h
#define FakeDriver_h

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

/// A number that several threads count.
template <typename T>
class Counter
{
public:
  Counter(T value = 0)
    : Value(value)
  {
  }
  Counter(const Counter& other)
    : Value(T(other))
  {
  }
  Counter& operator=(const Counter& other)
  {
    this->Value = T(other);
    return *this;
  }
  operator T() const { return this->Value; }
  T operator+=(T more) { return this->Value += more; }
  T operator++() { return ++this->Value; }
  T operator--(int) { return this->Value--; }

private:
  std::atomic<T> Value;
};

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

  /// Copies from the device, and to it, that the host does not wait for fail, unless 0: with this
  /// error. So many of them succeed before.
  int ReadError = 0;
  Counter<int> ReadsBeforeError;
  int WriteError = 0;
  Counter<int> WritesBeforeError;
  /// Those that fail are not even enqueued.
  bool FailsAtOnce = false;
  /// There is no page-locked memory.
  bool RefusesPinned = false;
  /// The device is a graphics card with memory of its own, and has no double precision. Contexts
  /// live as long as the process: these are set before the first one.
  bool IsGraphics = false;
  bool HasDouble = true;
  /// The name of the device that is asked for something first; empty: as it is.
  std::string FirstName;
  /// The device has the extension cl_nv_compiler_options. Options from the first one of it on are
  /// for OnBuild only, as the driver does not know them.
  bool HasNVIDIAOptions = false;
  /// Bytes that the device has, 0: as it is.
  std::uint64_t GlobalMemory = 0;
  std::uint64_t LocalMemory = 0;
  /// No buffer is made over memory of the host that overlaps that of another one: what commands on
  /// both do is undefined.
  bool RefusesOverlaps = false;
  /// Programs are compiled so that products are fused with sums wherever that is possible.
  bool FusesProducts = false;
  /// Launches of more than one work-item that left the size of the groups to the driver.
  Counter<int> LaunchesWithoutGroup;
  /// Kernels are not run, and what they would have written stays as it was: 0 at first.
  bool SkipsLaunches = false;
  /// Called with each program that has been built from its text: the text, the options, and the
  /// names of the kernels, which are separated by semicolons.
  std::function<void(const std::string&, const std::string&, const std::string&)> OnBuild;
  /// Called with each launch.
  std::function<void(const Launch&)> OnLaunch;

  /// Bytes that calls of the host have brought from buffers and to them. A buffer that is mapped
  /// counts as read and written as the access has it, unless it is page-locked: that one stays
  /// mapped, and is a place of the host.
  Counter<std::uint64_t> BytesRead;
  Counter<std::uint64_t> BytesWritten;
  /// Calls that have done so, those of buffers that are mapped left out.
  Counter<int> Reads;
  Counter<int> Writes;

  static FakeDriver& Get();
  /// Everything as at first, but the kind of the device, which cannot change in a process.
  static void Reset();
};

#endif
