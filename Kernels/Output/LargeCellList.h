// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLargeCellList_h
#define DeformVolumeLargeCellList_h

#include "OpenCLContext.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The list, on the device, of large cells (DEFORMVOLUME_PIECE) that the launches of a pass have
/// found.
class LargeCellList
{
public:
  struct LargeCell
  {
    std::array<cl_int, 3> Cell; // local index
    cl_int Pieces;
  };

  /// Reserves memory for the list. numberOfCells: of the sampling mesh.
  void Start(OpenCLContext& context, const cl::CommandQueue& queue, std::int64_t numberOfCells);
  void Clear() const;
  std::vector<LargeCell> Read() const;

  /// The largest number of cells in the list.
  std::size_t GetCapacity() const { return this->Capacity; }
  const cl::Buffer& GetBuffer() const { return this->Buffer; }

private:
  cl::CommandQueue Queue;
  cl::Buffer Buffer; // number of cells, three unused integers, then the cells
  std::size_t Capacity = 0;
};

} // namespace deformvolume

#endif
