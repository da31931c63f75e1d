// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFreeMemory_h
#define DeformVolumeFreeMemory_h

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

namespace deformvolume
{

/// How much memory this process can get, measured once for all objects that ask within a short
/// time: to measure it takes half a millisecond, and the filters of a pipeline ask one after the
/// other. It can be called from any thread.
class FreeMemory
{
public:
  /// A measurement is used for so long: longer than an update to which half a millisecond matters,
  /// and too short for programs to take much of the memory meanwhile.
  static constexpr std::chrono::milliseconds Validity{ 100 };

  /// measure: returns the bytes that are left; 0: unknown (GetSystemMemory).
  explicit FreeMemory(std::function<std::uint64_t()> measure);

  /// That of the process.
  static FreeMemory& Get();

  /// Grants bytes of the last measurement, if it is valid and at least half of it remains after
  /// all that it has granted. Returns how many bytes it had left before; nothing where it has to be
  /// measured again. So the last measurement never serves where memory is short.
  std::optional<std::uint64_t> Grant(std::uint64_t bytes);

  /// Measures, and grants bytes. Returns how many bytes are left before that; 0: unknown.
  std::uint64_t Measure(std::uint64_t bytes);

  /// How often it has been measured.
  std::uint64_t GetNumberOfMeasurements() const;

private:
  using Clock = std::chrono::steady_clock;

  std::function<std::uint64_t()> MeasureNow;
  mutable std::mutex Mutex;
  std::uint64_t Measured = 0;
  std::uint64_t Granted = 0; // since it was measured
  Clock::time_point Time;
  std::uint64_t NumberOfMeasurements = 0;
};

} // namespace deformvolume

#endif
