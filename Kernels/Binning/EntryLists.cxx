// SPDX-License-Identifier: BSD-3-Clause
#include "EntryLists.h"

#include "BinningProgram.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "WorkDevice.h"

#include <algorithm>
#include <utility>

namespace deformvolume
{
namespace
{

// Enough work-groups for a large GPU. Each work-item takes many numbers, so that the data of a
// work-group are small in comparison.
constexpr std::uint64_t MostGroups = 1024;
constexpr std::uint64_t NumbersPerItem = 16;

// The largest work-group: local memory must hold a bit for each of its items and each digit.
constexpr std::size_t LargestGroup = 256;

/// A kernel, and the number of work-groups that share its work.
class SharedWork
{
public:
  SharedWork(WorkDevice& device, const char* name, std::uint64_t numbers)
    : Kernel(GetEntryListsProgram(device.GetContext()), name)
    , GroupSize(std::min(device.GetHeavyGroupSize(this->Kernel), LargestGroup))
    , Groups(static_cast<std::size_t>(std::min(
        MostGroups, std::max<std::uint64_t>(1, numbers / (NumbersPerItem * this->GroupSize)))))
  {
  }

  template <typename... Arguments>
  void Launch(WorkDevice& device, const Arguments&... arguments)
  {
    SetArguments(this->Kernel, 0, arguments...);
    device.GetContext().Launch(device.GetQueue(), this->Kernel,
      cl::NDRange(this->Groups * this->GroupSize), cl::NDRange(this->GroupSize));
  }

  /// Local memory for a prefix sum over the work-items.
  cl::LocalSpaceArg ForSums() const { return cl::Local((this->GroupSize + 1) * sizeof(cl_ulong)); }

  cl::Kernel Kernel;
  std::size_t GroupSize;
  std::size_t Groups;
};

} // namespace

std::uint64_t EntryLists::Count(WorkDevice& device, const cl::Buffer& tetrahedra,
  const cl::Buffer& positions, const RasterParameters& p, ListBuffers& buffers)
{
  const auto count = static_cast<cl_uint>(p.Tetrahedra);
  ReserveLists(device, this->EntryBegins, std::uint64_t{ count } * sizeof(cl_uint));
  SharedWork(device, "FindTiles", count)
    .Launch(device, tetrahedra, positions, buffers.Boxes, buffers.Counters, this->EntryBegins, p);
  const std::size_t index = this->AddBefore(device, this->EntryBegins, count);
  cl_ulong length = 0;
  device.GetQueue().enqueueReadBuffer(
    this->Sums, CL_TRUE, index * sizeof(length), sizeof(length), &length);
  return length;
}

void EntryLists::Fill(
  WorkDevice& device, const RasterParameters& p, ListBuffers& buffers, cl_uint length)
{
  const auto tiles = static_cast<cl_uint>(CountTiles(p));
  ReserveLists(device, buffers.Begins, (std::uint64_t{ tiles } + 1) * sizeof(cl_uint));
  for (cl::Buffer* buffer : { &this->Keys, &this->SortedKeys, &this->SortedLists })
  {
    ReserveLists(device, *buffer, std::max<std::uint64_t>(length, 1) * sizeof(cl_uint));
  }
  SharedWork(device, "MakeEntries", length)
    .Launch(device, buffers.Boxes, this->EntryBegins, length, this->Keys, buffers.Lists, p);
  this->Sort(device, tiles, buffers, length);
  SharedWork(device, "FindBegins", std::uint64_t{ tiles } + 1)
    .Launch(device, this->Keys, length, tiles, buffers.Begins);
}

std::size_t EntryLists::AddBefore(WorkDevice& device, const cl::Buffer& numbers, cl_uint count)
{
  ReserveLists(device, this->Sums, (MostGroups + 1) * sizeof(cl_ulong));
  SharedWork sum(device, "SumRanges", count);
  sum.Launch(device, numbers, count, this->Sums, sum.ForSums());
  SharedWork join(device, "AddSums", 1);
  join.Launch(device, static_cast<cl_uint>(sum.Groups), this->Sums, join.ForSums());
  SharedWork add(device, "AddNumbers", count);
  add.Groups = sum.Groups; // must use the same ranges
  add.Launch(device, numbers, count, this->Sums, add.ForSums());
  return sum.Groups;
}

void EntryLists::Sort(WorkDevice& device, cl_uint tiles, ListBuffers& buffers, cl_uint entries)
{
  const std::uint64_t largestKey = 2 * std::uint64_t{ tiles } - 1;
  cl_uint bits = 1;
  while (largestKey >> bits != 0)
  {
    ++bits;
  }
  const cl_uint passes = (bits + DEFORMVOLUME_DIGIT_BITS - 1) / DEFORMVOLUME_DIGIT_BITS;
  DigitParameters d = {};
  d.Entries = entries;
  d.Bits = (bits + passes - 1) / passes;
  const cl_uint digits = cl_uint{ 1 } << d.Bits;
  SharedWork count(device, "CountDigits", entries);
  SharedWork sort(device, "SortByDigits", entries);
  sort.Groups = count.Groups; // must use the same ranges
  const cl_uint counters = digits * static_cast<cl_uint>(count.Groups);
  ReserveLists(device, this->Digits, std::uint64_t{ counters } * sizeof(cl_uint));
  const cl::LocalSpaceArg masks =
    cl::Local(digits * ((sort.GroupSize + 31) / 32) * sizeof(cl_uint));
  for (; d.Shift < bits; d.Shift += d.Bits)
  {
    count.Launch(device, this->Keys, this->Digits, d);
    this->AddBefore(device, this->Digits, counters);
    sort.Launch(device, this->Keys, buffers.Lists, this->Digits, this->SortedKeys,
      this->SortedLists, masks, d);
    std::swap(this->Keys, this->SortedKeys);
    std::swap(buffers.Lists, this->SortedLists);
  }
}

std::uint64_t EntryLists::GetMemory() const
{
  return deformvolume::GetMemory(
    this->EntryBegins, this->Sums, this->Keys, this->SortedKeys, this->SortedLists, this->Digits);
}

std::uint64_t EntryLists::GetMemoryNeeded(std::uint64_t numberOfTetrahedra, std::uint64_t length)
{
  return numberOfTetrahedra * sizeof(cl_uint) + length * 3 * sizeof(cl_uint) +
    (MostGroups << DEFORMVOLUME_DIGIT_BITS) * sizeof(cl_uint);
}

} // namespace deformvolume
