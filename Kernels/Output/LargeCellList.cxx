// SPDX-License-Identifier: BSD-3-Clause
#include "LargeCellList.h"

#include "HostMemory.h"
#include "KernelParameters.h"

#include <algorithm>

namespace deformvolume
{

void LargeCellList::Start(
  OpenCLContext& context, const cl::CommandQueue& queue, std::int64_t numberOfCells)
{
  this->Queue = queue;
  this->Capacity =
    static_cast<std::size_t>(std::min<std::int64_t>(numberOfCells, DEFORMVOLUME_MOST_LARGE_CELLS));
  Reserve(context, this->Buffer, (1 + this->Capacity) * sizeof(LargeCell));
}

void LargeCellList::Clear() const
{
  this->Queue.enqueueFillBuffer(this->Buffer, cl_uint{ 0 }, 0, sizeof(cl_uint));
}

std::vector<LargeCellList::LargeCell> LargeCellList::Read() const
{
  cl_uint number = 0;
  this->Queue.enqueueReadBuffer(this->Buffer, CL_TRUE, 0, sizeof(number), &number);
  std::vector<LargeCell> cells(std::min<std::size_t>(number, this->Capacity));
  if (!cells.empty())
  {
    this->Queue.enqueueReadBuffer(
      this->Buffer, CL_TRUE, sizeof(LargeCell), cells.size() * sizeof(LargeCell), cells.data());
  }
  return cells;
}

} // namespace deformvolume
