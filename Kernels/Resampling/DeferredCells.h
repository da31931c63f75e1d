// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeferredCells_h
#define DeformVolumeDeferredCells_h

#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

class WorkDevice;

/// The list, on the device, of cells that the kernel for columns defers to later kernels. The host
/// does not know its length: it has room for all cells of a launch.
class DeferredCells
{
public:
  explicit DeferredCells(WorkDevice& device)
    : Device(device)
  {
  }

  /// Returns the memory, in bytes, for a volume with this number of bricks; 0 if the device has no
  /// kernel for columns.
  static std::uint64_t GetMemory(WorkDevice& device, std::uint64_t bricks);

  /// Returns the largest number of bricks in a launch by columns.
  std::uint64_t GetMostBricks();
  /// Allocates memory for launches of this number of bricks, at most GetMostBricks(), and clears
  /// the list.
  void Reserve(std::uint64_t bricks);
  /// Clears the list.
  void Clear();

  const cl::Buffer& GetBuffer() const { return this->Buffer; }

  /// Return the size of a work-group of the kernels that process the list (ResampleDeferredInt32,
  /// ResampleDeferredInt64), and the number of work-items of a launch with such groups.
  std::size_t GetGroup(const cl::Kernel& kernel);
  std::size_t GetItems(std::size_t group);

private:
  WorkDevice& Device;
  cl::Buffer Buffer; // two counts, then the entries (ColumnCells.cl)
};

} // namespace deformvolume

#endif
