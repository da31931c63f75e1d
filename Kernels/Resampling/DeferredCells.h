// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeferredCells_h
#define DeformVolumeDeferredCells_h

#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

class WorkDevice;

/// The cells that the kernel for columns defers to those that follow, in a list on the device. The
/// host does not know how many there are: the list has room for all cells of a launch.
class DeferredCells
{
public:
  explicit DeferredCells(WorkDevice& device)
    : Device(device)
  {
  }

  /// Bytes for a volume of so many bricks; 0 where the device has no kernel for columns.
  static std::uint64_t GetMemory(WorkDevice& device, std::uint64_t bricks);

  /// Bricks in a launch by columns, at most.
  std::uint64_t GetMostBricks();
  /// Makes room for launches of so many bricks, or of GetMostBricks(), and clears the list.
  void Reserve(std::uint64_t bricks);
  /// Nothing is in the list.
  void Clear();

  const cl::Buffer& GetBuffer() const { return this->Buffer; }

  /// Work-items of a group of the kernels that drain the list (ResampleDeferredInt32,
  /// ResampleDeferredInt64), and of a launch with groups of that size.
  std::size_t GetGroup(const cl::Kernel& kernel);
  std::size_t GetItems(std::size_t group);

private:
  WorkDevice& Device;
  cl::Buffer Buffer; // two counts, then the entries: see ColumnCells.cl
};

} // namespace deformvolume

#endif
