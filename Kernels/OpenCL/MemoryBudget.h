// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMemoryBudget_h
#define DeformVolumeMemoryBudget_h

#include <cstdint>
#include <functional>
#include <optional>

namespace deformvolume
{

class WorkDevice;

/// The memory that may be used on the device and on the host. A CPU device uses host memory.
class MemoryBudget
{
public:
  /// held() returns the bytes that are allocated on the device.
  MemoryBudget(WorkDevice& device, std::function<std::uint64_t()> held);

  /// Set the bytes that may be used on the device. 0: all memory of the device; on a CPU device,
  /// all memory that the system has available.
  void SetLimit(std::uint64_t bytes) { this->Limit = bytes; }

  /// Returns the bytes that may be allocated on the device in total, including those that are
  /// allocated now. This is the limit of SetLimit() if one is set. Otherwise it is the memory of
  /// the device, and on a CPU device at most GetSystemMemory().
  std::uint64_t GetUsable();
  /// Returns the bytes that the system has available, as measured at the first call in an update.
  /// On a CPU device, the bytes that were held at that time are added. 0: unknown.
  std::uint64_t GetSystemMemory();
  /// Makes GetSystemMemory() measure again.
  void ForgetSystemMemory() { this->SystemMemory.reset(); }
  /// Calls ForgetSystemMemory() at the end of an update, also after an exception.
  class UpdateGuard
  {
  public:
    explicit UpdateGuard(MemoryBudget& budget)
      : Budget(budget)
    {
    }
    ~UpdateGuard() { this->Budget.ForgetSystemMemory(); }
    UpdateGuard(const UpdateGuard&) = delete;
    UpdateGuard& operator=(const UpdateGuard&) = delete;

  private:
    MemoryBudget& Budget;
  };

  /// Whether `bytes` can be allocated in addition to the memory that is held now.
  bool HasRoomFor(std::uint64_t bytes);
  /// What to do if a deformed volume needs too much memory.
  static constexpr const char* VolumeRemedy =
    "Use a smaller volume, fewer arrays or smaller output bounds";
  /// Throws Error unless HasRoomFor(bytes). where, remedy: as in CheckBytes().
  void CheckRoomFor(std::uint64_t bytes, const char* where, const char* remedy = VolumeRemedy);

  /// Throws Error if needed > available. where: a phrase for the message, such as "on the device".
  /// remedy: what to do, except for raising the limit and using another device.
  static void CheckBytes(std::uint64_t needed, std::uint64_t available, const char* where,
    const char* remedy = VolumeRemedy);

private:
  /// Measures the memory of the system again, since memory may have been allocated.
  void MeasureSystemMemory();

  WorkDevice& Device;
  std::function<std::uint64_t()> CountHeld;
  std::uint64_t Limit = 0;
  std::optional<std::uint64_t> SystemMemory;
};

} // namespace deformvolume

#endif
