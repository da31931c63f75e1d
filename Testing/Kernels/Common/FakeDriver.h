// SPDX-License-Identifier: BSD-3-Clause
// A layer between the kernels and the OpenCL driver of a test program. It makes calls fail, and
// makes the device appear as another one. Programs that link it call its functions instead of those
// of the OpenCL library; the functions then call the library.
#ifndef FakeDriver_h
#define FakeDriver_h

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

/// A number that several threads increment.
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
  /// A launch of a kernel, as the driver receives it.
  struct Launch
  {
    std::string Text; // of the program
    std::string Kernel;
    std::size_t Items = 1;       // of a work-group
    std::size_t LocalMemory = 0; // bytes per work-group that arguments request
  };

  /// If not 0, non-blocking copies from and to the device fail with this error, after
  /// ReadsBeforeError or WritesBeforeError copies have succeeded.
  int ReadError = 0;
  Counter<int> ReadsBeforeError;
  int WriteError = 0;
  Counter<int> WritesBeforeError;
  /// Failing copies are not even enqueued.
  bool FailsAtOnce = false;
  /// The driver has no page-locked memory.
  bool RefusesPinned = false;
  /// The device is a graphics card with its own memory, and has no double precision. Contexts live
  /// as long as the process, so set these members before the first context is created.
  bool IsGraphics = false;
  bool HasDouble = true;
  /// The name of the device whose properties are queried first; empty: the real name.
  std::string FirstName;
  /// The device has the extension cl_nv_compiler_options. Compiler options from the first option of
  /// this extension on are passed to OnBuild only, as the real driver does not support them.
  bool HasNVIDIAOptions = false;
  /// The memory of the device, in bytes; 0: the real size.
  std::uint64_t GlobalMemory = 0;
  std::uint64_t LocalMemory = 0;
  /// Buffers over host memory that overlaps the memory of another buffer are refused. The result of
  /// commands that use both buffers would be undefined.
  bool RefusesOverlaps = false;
  /// Programs are compiled so that multiplications and additions are fused wherever possible.
  bool FusesProducts = false;
  /// The number of launches of more than one work-item for which the driver chose the size of
  /// work-groups.
  Counter<int> LaunchesWithoutGroup;
  /// Kernels are not run. Their output keeps its values, which are 0 at first.
  bool SkipsLaunches = false;
  /// Programs are compiled without optimization, which takes less time.
  bool SkipsOptimization = false;
  /// Called with each program that was built from source: the text, the options, and the names of
  /// the kernels, separated by semicolons.
  std::function<void(const std::string&, const std::string&, const std::string&)> OnBuild;
  /// Called for each launch.
  std::function<void(const Launch&)> OnLaunch;

  /// The number of bytes that calls of the host have copied from and to buffers. A mapped buffer
  /// counts as read and written according to its access flags. Page-locked buffers do not count:
  /// they stay mapped, and serve as host memory.
  Counter<std::uint64_t> BytesRead;
  Counter<std::uint64_t> BytesWritten;
  /// The number of calls that copied these bytes, without those that map buffers.
  Counter<int> Reads;
  Counter<int> Writes;

  static FakeDriver& Get();
  /// Resets all members except the kind of the device, which cannot change in a process.
  static void Reset();
};

#endif
