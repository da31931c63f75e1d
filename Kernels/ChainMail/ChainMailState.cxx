// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailState.h"

#include "DeviceVectorsInternals.h"
#include "Error.h"
#include "ExtentRanges.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "KernelSources.h"
#include "KernelText.h"

#include <algorithm>
#include <string>

namespace deformvolume
{
namespace
{

// The largest number of work-items of a work-group. They share the rows of a block.
constexpr std::size_t MostItems = DEFORMVOLUME_BLOCK_ROWS;

static_assert(ChainMailSnapshot::VoxelsPerBlock == DEFORMVOLUME_BLOCK_VOXELS,
  "snapshots have the blocks of the kernels");

std::uint64_t CountVoxels(const ChainMailBlocks& blocks)
{
  return std::uint64_t{ blocks.GetNumberOfBlocks() } * DEFORMVOLUME_BLOCK_VOXELS;
}

} // namespace

ChainMailState::ChainMailState(
  WorkDevice& device, const ChainMailBlocks& blocks, const std::array<double, 9>& indexToWorld)
  : Device(device)
  , Blocks(blocks)
  , Serial(device.HasSerialGroups())
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    this->Grid.Size[axis] = blocks.GetSize()[axis];
    this->Grid.Blocks[axis] = blocks.GetCounts()[axis];
  }
  std::transform(indexToWorld.begin(), indexToWorld.end(), this->Grid.ToWorld,
    [](double value) { return static_cast<float>(value); });
  OpenCLContext& context = device.GetContext();
  this->Program =
    context.GetProgram(ProgramText(this->Serial ? "#define SERIAL 1\n" : "#define SERIAL 0\n") +
        ChainMailParameters_h + ChainMailBlocks_cl + ChainMailOutput_cl + ChainMailPropagation_cl +
        ChainMailRelaxation_cl,
      KernelOptions);
  const std::uint64_t voxels = CountVoxels(blocks);
  Reserve(context, this->Displacements, voxels * 3 * sizeof(cl_int));
  Reserve(context, this->Flags, voxels);
  Reserve(context, this->Links, voxels);
  Reserve(context, this->Materials, voxels);
  Reserve(context, this->List, AtOnce * sizeof(BlockTask));
  Reserve(context, this->Results, AtOnce * sizeof(cl_uint));
  Reserve(context, this->Shared, sizeof(SharedNumbers));
  const cl::CommandQueue& queue = device.GetQueue();
  queue.enqueueFillBuffer(this->Displacements, cl_int{ 0 }, 0, voxels * 3 * sizeof(cl_int));
  for (const cl::Buffer* bytes : { &this->Flags, &this->Links, &this->Materials })
  {
    queue.enqueueFillBuffer(*bytes, cl_uchar{ 0 }, 0, voxels);
  }
  queue.enqueueFillBuffer(this->Shared, cl_uint{ 0 }, 0, sizeof(SharedNumbers));
  queue.finish();
}

std::uint64_t ChainMailState::GetNeededMemory(const ChainMailBlocks& blocks)
{
  const auto output = static_cast<std::uint64_t>(GetNumberOfPoints(blocks.GetExtent()));
  return CountVoxels(blocks) * (3 * sizeof(cl_int) + 3) + output * 3 * sizeof(float);
}

std::uint64_t ChainMailState::GetMemory() const
{
  return deformvolume::GetMemory(this->Displacements, this->Flags, this->Links, this->Materials,
    this->Limits, this->Weights, this->Reciprocals, this->List, this->Results, this->Shared);
}

void ChainMailState::Continue() const
{
  if (this->Progress && !this->Progress())
  {
    throw Aborted();
  }
}

void ChainMailState::SetLimits(const ChainMailLimits& limits)
{
  this->Device.Send(this->Limits, limits.Limits);
  this->Device.Send(this->Weights, limits.Weights);
  this->Device.Send(this->Reciprocals, limits.Reciprocals);
}

void ChainMailState::ChangeBytes(
  const cl::Buffer& buffer, const std::function<void(unsigned char*)>& change)
{
  const MappedBuffer<unsigned char> bytes(
    this->Device.GetQueue(), buffer, CL_MAP_READ | CL_MAP_WRITE);
  change(bytes.Get());
}

void ChainMailState::ChangeLinks(const std::function<void(unsigned char*)>& change)
{
  this->ChangeBytes(this->Links, change);
}

void ChainMailState::ChangeMaterials(const std::function<void(unsigned char*)>& change)
{
  this->ChangeBytes(this->Materials, change);
}

void ChainMailState::SetOutput(float* output)
{
  this->Output.Bind(this->Device.GetContext(), output,
    static_cast<std::size_t>(GetNumberOfPoints(this->Blocks.GetExtent())));
}

void ChainMailState::SetOutput(const std::shared_ptr<DeviceVectors>& output)
{
  this->Output.Bind(this->Device.GetContext(), output);
}

void ChainMailState::MarkChanges(const std::vector<Extent>& changes)
{
  DeviceVectors::Internals* const vectors = this->Output.GetVectors();
  if (!vectors || changes.empty())
  {
    return;
  }
  if (const auto rows = FindRows(changes, this->Blocks.GetExtent()))
  {
    vectors->MarkWritten(*rows);
  }
  else
  {
    vectors->MarkAllWritten();
  }
}

void ChainMailState::ReadOutput(const std::vector<Extent>& changes)
{
  const cl::CommandQueue& queue = this->Device.GetQueue();
  const cl::Buffer& output = this->Output.GetBuffer();
  float* const memory = this->Output.GetHostMemory();
  if (!memory)
  {
    queue.finish();
    return;
  }
  if (IsInPlace(output))
  {
    if (!this->Device.GetContext().SharesHostMemory())
    {
      BeginToRead(queue, output, output.getInfo<CL_MEM_SIZE>(), memory).Check();
    }
    return;
  }
  const Extent& whole = this->Blocks.GetExtent();
  PendingCopies reads;
  for (const Extent& box : changes)
  {
    reads.Add(BeginToReadBox(queue, output, whole, box, 3 * sizeof(float), memory, whole));
  }
  reads.Check();
}

void ChainMailState::Launch(const cl::Kernel& kernel, std::size_t groups)
{
  const std::size_t items =
    this->Serial ? 1 : std::min(this->Device.GetGroupSize(kernel, MostItems), MostItems);
  this->Device.GetContext().Launch(
    this->Device.GetQueue(), kernel, cl::NDRange(groups * items), cl::NDRange(items));
}

void ChainMailState::ForParts(
  const std::vector<BlockTask>& list, const Setter& launch, bool canStop)
{
  const cl::CommandQueue& queue = this->Device.GetQueue();
  const QueueGuard guard(queue);
  for (std::size_t begin = 0; begin < list.size(); begin += AtOnce)
  {
    const std::size_t count = std::min(AtOnce, list.size() - begin);
    PendingCopy sent =
      BeginToWrite(queue, this->List, 0, count * sizeof(BlockTask), list.data() + begin);
    launch(begin, count);
    queue.finish();
    sent.Check();
    if (canStop)
    {
      this->Continue();
    }
  }
}

void ChainMailState::ForParts(
  const std::vector<std::uint32_t>& list, const Setter& launch, bool canStop)
{
  std::vector<BlockTask> tasks(list.size());
  std::transform(list.begin(), list.end(), tasks.begin(),
    [](std::uint32_t block) {
      return BlockTask{ block, 0 };
    });
  this->ForParts(tasks, launch, canStop);
}

void ChainMailState::Run(
  const cl::Kernel& kernel, const std::vector<std::uint32_t>& list, bool canStop)
{
  this->ForParts(
    list, [&](std::size_t, std::size_t count) { this->Launch(kernel, count); }, canStop);
}

template <typename Task>
void ChainMailState::RunAndRead(const cl::Kernel& kernel, const std::vector<Task>& list,
  std::vector<std::uint32_t>& results, bool canStop)
{
  results.resize(list.size());
  this->ForParts(
    list,
    [&](std::size_t begin, std::size_t count)
    {
      this->Launch(kernel, count);
      this->Device.GetQueue().enqueueReadBuffer(
        this->Results, CL_TRUE, 0, count * sizeof(cl_uint), results.data() + begin);
    },
    canStop);
}

void ChainMailState::Save(const std::vector<std::uint32_t>& list)
{
  constexpr bool canStop = false;
  this->Run(MakeKernel(this->Program, "Save", this->Displacements, this->Output.GetBuffer(),
              this->List, this->Grid),
    list, canStop);
}

void ChainMailState::Restore(const std::vector<std::uint32_t>& list, bool isEnd)
{
  this->Run(MakeKernel(this->Program, "Restore", this->Displacements, this->Flags,
              this->Output.GetBuffer(), this->List, cl_int{ isEnd }, this->Grid),
    list);
}

void ChainMailState::ClearFlags(const std::vector<std::uint32_t>& list)
{
  this->Run(MakeKernel(this->Program, "ClearFlags", this->Flags, this->List), list);
}

void ChainMailState::ResetDisplacements(const std::vector<std::uint32_t>& list)
{
  this->Run(MakeKernel(this->Program, "ResetDisplacements", this->Displacements, this->List), list);
}

void ChainMailState::WriteOutput(const std::vector<std::uint32_t>& list)
{
  this->Run(MakeKernel(this->Program, "Write", this->Displacements, this->Output.GetBuffer(),
              this->List, this->Grid),
    list);
}

void ChainMailState::ReadBlocks(
  const std::vector<std::uint32_t>& list, std::vector<ChainMailSnapshot::Block>& values)
{
  constexpr std::size_t bytes = sizeof(ChainMailSnapshot::Block);
  PendingCopies reads;
  for (std::size_t begin = 0; begin < list.size();)
  {
    // Read consecutive blocks at once.
    std::size_t end = begin + 1;
    while (end < list.size() && list[end] == list[end - 1] + 1)
    {
      ++end;
    }
    reads.Add(BeginToReadRange(this->Device.GetQueue(), this->Displacements, list[begin] * bytes,
      (end - begin) * bytes, values[begin].data()));
    begin = end;
  }
  reads.Check();
}

void ChainMailState::WriteBlocks(const std::vector<std::uint32_t>& list,
  const std::vector<std::shared_ptr<const ChainMailSnapshot::Block>>& values)
{
  constexpr std::size_t bytes = sizeof(ChainMailSnapshot::Block);
  const cl::CommandQueue& queue = this->Device.GetQueue();
  PendingCopies writes;
  for (std::size_t i = 0; i < list.size(); ++i)
  {
    writes.Add(BeginToWrite(queue, this->Displacements, list[i] * bytes, bytes, values[i]->data()));
  }
  writes.Check();
}

void ChainMailState::Check(const std::vector<std::uint32_t>& list)
{
  this->Run(MakeKernel(this->Program, "Check", this->Displacements, this->Links, this->Materials,
              this->Limits, this->Shared, this->List, this->Grid),
    list);
}

void ChainMailState::Propagate(
  const std::vector<BlockTask>& list, std::vector<std::uint32_t>& results)
{
  constexpr bool canStop = false;
  this->RunAndRead(MakeKernel(this->Program, "Propagate", this->Displacements, this->Flags,
                     this->Links, this->Materials, this->Limits, this->Output.GetBuffer(),
                     this->Shared, this->List, this->Results, this->Grid),
    list, results, canStop);
}

void ChainMailState::Relax(const std::vector<std::uint32_t>& list, float elasticity, int threshold,
  std::vector<std::uint32_t>& results)
{
  const cl::CommandQueue& queue = this->Device.GetQueue();
  for (cl_int parity = 0; parity < 2; ++parity)
  {
    const cl::Kernel kernel = MakeKernel(this->Program, "Relax", this->Displacements, this->Flags,
      this->Links, this->Materials, this->Limits, this->Weights, this->Reciprocals, this->List,
      this->Results, parity, elasticity, cl_int{ threshold }, this->Grid);
    this->ForParts(list,
      [&](std::size_t begin, std::size_t count)
      {
        const std::size_t bytes = count * sizeof(cl_uint);
        PendingCopy sent = BeginToWrite(queue, this->Results, 0, bytes, results.data() + begin);
        this->Launch(kernel, count);
        queue.enqueueReadBuffer(this->Results, CL_TRUE, 0, bytes, results.data() + begin);
        sent.Check();
      });
  }
}

void ChainMailState::Finish(
  const std::vector<std::uint32_t>& list, std::vector<std::uint32_t>& moved)
{
  this->RunAndRead(MakeKernel(this->Program, "Finish", this->Displacements, this->Flags,
                     this->Links, this->Materials, this->Limits, this->Output.GetBuffer(),
                     this->Shared, this->List, this->Results, this->Grid),
    list, moved);
}

void ChainMailState::Hold(const std::vector<HeldVoxel>& voxels,
  const std::vector<HandleTask>& handles, std::vector<std::uint32_t>& counts)
{
  OpenCLContext& context = this->Device.GetContext();
  const cl::CommandQueue& queue = this->Device.GetQueue();
  const std::size_t bytes = handles.size() * sizeof(cl_uint);
  counts.assign(handles.size(), 0);
  const cl::Buffer list(context.GetContext(), CL_MEM_READ_ONLY, voxels.size() * sizeof(HeldVoxel));
  const cl::Buffer targets(
    context.GetContext(), CL_MEM_READ_ONLY, handles.size() * sizeof(HandleTask));
  const cl::Buffer found(context.GetContext(), CL_MEM_READ_WRITE, bytes);
  const QueueGuard guard(queue);
  PendingCopies writes;
  writes.Add(BeginToWrite(queue, list, 0, voxels.size() * sizeof(HeldVoxel), voxels.data()));
  writes.Add(BeginToWrite(queue, targets, 0, handles.size() * sizeof(HandleTask), handles.data()));
  writes.Add(BeginToWrite(queue, found, 0, bytes, counts.data()));
  const cl::Kernel kernel = MakeKernel(this->Program, "Hold", this->Displacements, this->Flags,
    this->Links, list, targets, this->Shared, found, static_cast<cl_uint>(voxels.size()));
  this->Device.Launch(kernel, voxels.size());
  queue.enqueueReadBuffer(found, CL_TRUE, 0, bytes, counts.data());
  writes.Check();
}

SharedNumbers ChainMailState::TakeShared()
{
  SharedNumbers numbers;
  const cl::CommandQueue& queue = this->Device.GetQueue();
  queue.enqueueReadBuffer(this->Shared, CL_TRUE, 0, sizeof(numbers), numbers.data());
  if (std::any_of(numbers.begin(), numbers.end(), [](std::uint32_t n) { return n != 0; }))
  {
    const SharedNumbers none{};
    queue.enqueueWriteBuffer(this->Shared, CL_TRUE, 0, sizeof(none), none.data());
  }
  return numbers;
}

} // namespace deformvolume
