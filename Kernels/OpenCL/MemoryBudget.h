// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMemoryBudget_h
#define DeformVolumeMemoryBudget_h

#include <cstdint>
#include <functional>
#include <optional>

namespace deformvolume
{

class WorkDevice;

/// How much memory may be used: on the device, and in the system, which a processor shares with its
/// device.
class MemoryBudget
{
public:
  /// held: bytes that are allocated on the device.
  MemoryBudget(WorkDevice& device, std::function<std::uint64_t()> held);

  /// Bytes that may be used on the device; 0: what the device (and for a processor, the system) has
  /// available.
  void SetLimit(std::uint64_t bytes) { this->Limit = bytes; }

  /// Bytes that may be allocated on the device, those included that are and will be freed or used
  /// again: all that it has, and for a processor no more than GetSystemMemory().
  std::uint64_t GetUsable();
  /// Bytes that the system had left when this was asked first in an update, and for a processor
  /// those held then, which are of the same memory; 0: unknown.
  std::uint64_t GetSystemMemory();
  /// An update begins: it is asked again.
  void ForgetSystemMemory() { this->SystemMemory.reset(); }
  /// Does so at the end of an update, also of one that fails.
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

  /// Whether there is room for so many bytes beside what is held now.
  bool HasRoomFor(std::uint64_t bytes);
  /// Throws an Error where there is none. where: as in CheckBytes.
  void CheckRoomFor(std::uint64_t bytes, const char* where);

  /// Throws an Error that names the bytes where there are too few. where: "on the device".
  static void CheckBytes(std::uint64_t needed, std::uint64_t available, const char* where);

private:
  /// Measures the memory of the system: something may have been allocated.
  void MeasureSystemMemory();

  WorkDevice& Device;
  std::function<std::uint64_t()> CountHeld;
  std::uint64_t Limit = 0;
  std::optional<std::uint64_t> SystemMemory;
};

} // namespace deformvolume

#endif
