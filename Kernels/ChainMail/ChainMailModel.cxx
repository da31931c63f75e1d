// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailModel.h"

#include "ChainMailLinks.h"
#include "ChainMailSolver.h"
#include "ChainMailState.h"
#include "DeviceVectorsInternals.h"
#include "GuardedCall.h"
#include "HostMemory.h"
#include "MemoryBudget.h"
#include "ParallelFor.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace deformvolume
{
namespace
{

// Calls function(number, index) for all voxels. number: with x varying fastest. index: in the
// arrays of all blocks.
template <typename Function>
void ForVoxels(const ChainMailBlocks& blocks, const Function& function)
{
  const std::array<int, 3> size = blocks.GetSize();
  ParallelForItems(size[2], 1,
    [&](int z)
    {
      ForEachPoint({ { 0, size[0] - 1, 0, size[1] - 1, z, z } },
        [&](int x, int y, int)
        {
          const std::int64_t row = std::int64_t{ z } * size[1] + y;
          function(static_cast<std::size_t>(row * size[0] + x), blocks.GetVoxelIndex(x, y, z));
        });
    });
}

std::vector<std::uint32_t> GetAll(const ChainMailBlocks& blocks)
{
  std::vector<std::uint32_t> all(blocks.GetNumberOfBlocks());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

} // namespace

class ChainMailModel::Internals
{
public:
  Internals()
    : Budget(this->Device, [this] { return this->GetMemory(); })
  {
  }

  template <typename Function>
  auto Guard(Function&& function)
  {
    const MemoryBudget::UpdateGuard update(this->Budget);
    return CallGuarded(
      function, [this] { this->Forget(); }, " The state of ChainMail is lost.");
  }

  void CheckIsSet() const
  {
    if (!this->State)
    {
      throw Error("ChainMail has no volume: none was set, or an error of the device discarded it.");
    }
  }

  void Forget()
  {
    this->Solver.reset();
    this->State.reset();
    this->Links = ChainMailLinks();
  }

  std::uint64_t GetMemory() const { return this->State ? this->State->GetMemory() : 0; }

  void CheckMemory(const ChainMailBlocks& blocks);
  void WriteLinks(const std::vector<std::uint32_t>& list);

  WorkDevice Device;
  MemoryBudget Budget;
  unsigned int Order = 0;
  std::array<double, 3> Spacing{ { 1, 1, 1 } };
  std::optional<ChainMailBlocks> Blocks;
  ChainMailLinks Links;
  std::unique_ptr<ChainMailState> State;
  std::unique_ptr<ChainMailSolver> Solver;
};

void ChainMailModel::Internals::CheckMemory(const ChainMailBlocks& blocks)
{
  const std::uint64_t needed = ChainMailState::GetNeededMemory(blocks);
  const std::uint64_t voxels =
    std::uint64_t{ blocks.GetNumberOfBlocks() } * DEFORMVOLUME_BLOCK_VOXELS;
  const std::uint64_t allocation = voxels * 3 * sizeof(std::int32_t);
  CheckAllocation(allocation, this->Device.GetAllocationLimit(), "The displacements of ChainMail",
    "Use a smaller volume");
  if (voxels > std::numeric_limits<std::uint32_t>::max())
  {
    throw Error("The volume has too many voxels for ChainMail: at most 4,294,967,295. Use a "
                "smaller part of it, or a coarser volume.");
  }
  this->Budget.CheckRoomFor(needed, "on the device", "Use a smaller volume");
}

void ChainMailModel::Internals::WriteLinks(const std::vector<std::uint32_t>& list)
{
  if (!list.empty())
  {
    this->State->ChangeLinks(
      [&](unsigned char* bytes) { this->Links.Write(*this->Blocks, list, bytes); });
  }
}

ChainMailModel::ChainMailModel()
  : Impl(new Internals)
{
}

ChainMailModel::~ChainMailModel() = default;

std::string ChainMailModel::SetDevice(const std::string& request)
{
  return this->Impl->Guard(
    [&] { return this->Impl->Device.Choose(request, [&] { this->Impl->Forget(); }); });
}

void ChainMailModel::SetMemoryLimit(std::uint64_t bytes)
{
  this->Impl->Budget.SetLimit(bytes);
}

void ChainMailModel::SetWorkGroupSize(std::size_t size)
{
  this->Impl->Device.SetWorkGroupSize(size);
}

void ChainMailModel::SetBlockOrder(unsigned int order)
{
  this->Impl->Order = order;
  if (this->Impl->Solver)
  {
    this->Impl->Solver->SetOrder(order);
  }
}

void ChainMailModel::SetVoxelGrid(const Extent& extent, const std::array<double, 9>& indexToWorld)
{
  std::array<double, 3> spacing;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    if (GetSize(extent, static_cast<int>(axis)) < 2)
    {
      throw Error("A volume needs at least two voxels on each axis.");
    }
    spacing[axis] = std::hypot(indexToWorld[axis], indexToWorld[axis + 3], indexToWorld[axis + 6]);
    if (!(spacing[axis] > 0.0) || !std::isfinite(spacing[axis]))
    {
      throw Error("The spacing of the volume on axis " + std::to_string(axis) + " is " +
        FormatNumber(spacing[axis]) + ". It must be finite and greater than 0.");
    }
  }
  Internals& impl = *this->Impl;
  impl.Guard(
    [&]
    {
      const ChainMailBlocks blocks(extent);
      impl.Device.GetContext();
      impl.Forget();
      impl.CheckMemory(blocks);
      impl.Blocks = blocks;
      impl.Spacing = spacing;
      impl.State = std::make_unique<ChainMailState>(impl.Device, blocks, indexToWorld);
      impl.Solver = std::make_unique<ChainMailSolver>(*impl.State, blocks);
      impl.Solver->SetOrder(impl.Order);
      impl.State->SetLimits(ChainMailLimits({ ChainMailMaterial() }, spacing));
      impl.WriteLinks(GetAll(blocks));
    });
}

void ChainMailModel::SetMaterials(
  const std::vector<ChainMailMaterial>& table, const unsigned char* indices)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  const ChainMailLimits limits(table, impl.Spacing);
  const auto voxels = GetNumberOfPoints(impl.Blocks->GetExtent());
  std::atomic<int> largest{ 0 };
  ParallelFor(0, indices ? voxels : 0, 0,
    [&](std::int64_t first, std::int64_t last)
    {
      const unsigned char found = *std::max_element(indices + first, indices + last);
      int before = largest.load();
      while (found > before && !largest.compare_exchange_weak(before, found))
      {
      }
    });
  if (largest >= static_cast<int>(table.size()))
  {
    throw Error("A voxel has the material " + std::to_string(largest) +
      ", but the table has only " + std::to_string(table.size()) +
      ". Set all materials, or give the voxel another one.");
  }
  impl.Guard(
    [&]
    {
      impl.State->SetLimits(limits);
      impl.State->ChangeMaterials(
        [&](unsigned char* bytes)
        {
          ForVoxels(*impl.Blocks,
            [&](std::size_t voxel, std::uint32_t index)
            { bytes[index] = indices ? indices[voxel] : 0; });
        });
      impl.Solver->CheckDisplacements();
    });
}

void ChainMailModel::SetActiveTetrahedra(const unsigned char* active)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  impl.Guard(
    [&]
    {
      const std::vector<std::uint32_t> changed = impl.Links.Set(*impl.Blocks, active);
      if (!changed.empty())
      {
        impl.WriteLinks(changed);
        impl.Solver->CheckDisplacements(changed);
        impl.Solver->Touch(changed);
      }
    });
}

void ChainMailModel::SetPinned(const unsigned char* pinned)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  impl.Guard(
    [&]
    {
      impl.State->ChangeLinks(
        [&](unsigned char* bytes)
        {
          ForVoxels(*impl.Blocks,
            [&](std::size_t voxel, std::uint32_t index)
            {
              const int bit = pinned && pinned[voxel] ? DEFORMVOLUME_PINNED : 0;
              bytes[index] =
                static_cast<unsigned char>((bytes[index] & ~DEFORMVOLUME_PINNED) | bit);
            });
        });
    });
}

void ChainMailModel::SetOutput(float* output)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  if (!output)
  {
    throw Error("The output of ChainMail is null.");
  }
  impl.Guard(
    [&]
    {
      impl.State->SetOutput(output);
      impl.State->WriteOutput(GetAll(*impl.Blocks));
      impl.State->ReadOutput({ impl.Blocks->GetExtent() });
    });
}

void ChainMailModel::SetOutput(const std::shared_ptr<DeviceVectors>& output)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  CheckVectors(output.get(), impl.Device,
    static_cast<std::size_t>(GetNumberOfPoints(impl.Blocks->GetExtent())));
  impl.Guard(
    [&]
    {
      impl.State->SetOutput(output);
      impl.State->WriteOutput(GetAll(*impl.Blocks));
      impl.State->ReadOutput({ impl.Blocks->GetExtent() });
      impl.State->MarkChanges({ impl.Blocks->GetExtent() });
    });
}

void ChainMailModel::CheckMaterials(const std::vector<ChainMailMaterial>& table)
{
  ChainMailLimits(table, { { 1.0, 1.0, 1.0 } });
}

void ChainMailModel::CheckRequest(const Extent& extent, const ChainMailRequest& request)
{
  if (!(request.Elasticity >= 0.0 && request.Elasticity <= 1.0))
  {
    throw Error(
      "The elasticity is " + FormatNumber(request.Elasticity) + ". It must be between 0 and 1.");
  }
  if (!(request.PlasticityThreshold >= 0.0))
  {
    throw Error("The plasticity threshold is " + FormatNumber(request.PlasticityThreshold) +
      ". It must be 0 or more.");
  }
  CheckHandles(ChainMailBlocks(extent), request.Handles);
}

ChainMailReport ChainMailModel::Step(const ChainMailRequest& request)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  if (!impl.State->HasOutput())
  {
    throw Error("No output is set: call SetOutput first.");
  }
  CheckRequest(impl.Blocks->GetExtent(), request);
  const ChainMailHandles handles(*impl.Blocks, impl.Spacing, request.Handles);
  return impl.Guard([&] { return impl.Solver->Step(handles, request); });
}

void ChainMailModel::Reset()
{
  this->Impl->CheckIsSet();
  this->Impl->Guard([&] { this->Impl->Solver->ResetDisplacements(); });
}

std::shared_ptr<const ChainMailSnapshot> ChainMailModel::TakeSnapshot(
  const std::shared_ptr<const ChainMailSnapshot>& last)
{
  this->Impl->CheckIsSet();
  return this->Impl->Guard([&] { return this->Impl->Solver->TakeSnapshot(last.get()); });
}

void ChainMailModel::Restore(const ChainMailSnapshot& snapshot)
{
  this->Impl->CheckIsSet();
  if (snapshot.Voxels != this->Impl->Blocks->GetExtent())
  {
    throw Error(
      "The snapshot has other voxels than this volume. Restore snapshots of this volume only.");
  }
  this->Impl->Guard([&] { this->Impl->Solver->Restore(snapshot); });
}

std::uint64_t ChainMailModel::GetDeviceMemory() const
{
  return this->Impl->GetMemory();
}

} // namespace deformvolume
