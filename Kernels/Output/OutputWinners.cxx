// SPDX-License-Identifier: BSD-3-Clause
#include "OutputWinners.h"

#include "HostMemory.h"
#include "KernelLauncher.h"
#include "KernelMaking.h"
#include "OutputFilling.h"
#include "ResamplingProgram.h"

#include <algorithm>
#include <limits>

namespace deformvolume
{

std::size_t GetWinnerSize(const VoxelGrid& voxelGrid)
{
  constexpr std::int64_t mostCells = (std::int64_t{ 1 } << 30) - 2;
  return GetNumberOfCells(voxelGrid.VertexExtent) <= mostCells ? 4 : 8;
}

void OutputWinners::Start(const Extent& output, const VoxelGrid& voxelGrid)
{
  this->Output = output;
  this->KeySize = GetWinnerSize(voxelGrid);
  this->KeyBytes = static_cast<std::uint64_t>(GetNumberOfPoints(output)) * this->KeySize;
  this->IsUpdate = false;
  if (!this->HasBuffers())
  {
    this->Keys = cl::Buffer();
    this->Patches = cl::Buffer();
  }
}

std::uint64_t OutputWinners::CountPatches() const
{
  std::uint64_t patches = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    patches *= static_cast<std::uint64_t>(DEFORMVOLUME_PATCHES(GetSize(this->Output, axis)));
  }
  return patches;
}

bool OutputWinners::HasBuffers() const
{
  // Buffers of a slightly larger output are reused: the first access to new memory takes longer
  // than filling the buffers.
  const std::uint64_t held = deformvolume::GetMemory(this->Keys);
  return held >= this->KeyBytes && held - this->KeyBytes <= this->KeyBytes / 4 &&
    deformvolume::GetMemory(this->Patches) >= 2 * this->CountPatches();
}

std::uint64_t OutputWinners::GetMissingMemory() const
{
  return this->HasBuffers() ? 0 : this->KeyBytes + 2 * this->CountPatches();
}

void OutputWinners::Prepare(KernelLauncher& launcher)
{
  const std::uint64_t patchBytes = 2 * this->CountPatches();
  if (!this->HasBuffers())
  {
    Reserve(launcher.GetContext(), this->Keys, this->KeyBytes);
    Reserve(launcher.GetContext(), this->Patches, patchBytes);
  }
  Fill(launcher, this->Keys, ElementBytes::Of(cl_uchar{ 0xff }), this->KeyBytes);
  Fill(launcher, this->Patches, ElementBytes::Of(cl_uchar{ 0 }), patchBytes);
}

void OutputWinners::PrepareUpdate(KernelLauncher& launcher,
  const std::vector<std::uint32_t>& patches, const cl::Buffer& list,
  const KernelParameters& parameters)
{
  if (!patches.empty())
  {
    FillPatches(launcher, this->Keys, ElementBytes::Of(std::numeric_limits<cl_uint>::max()),
      this->KeySize / sizeof(cl_uint), list, patches.size(), parameters);
  }
  const MappedBuffer<unsigned char> known(
    launcher.GetQueue(), this->Patches, CL_MAP_READ | CL_MAP_WRITE);
  this->IsUpdate = true;
  const std::uint64_t all = this->CountPatches();
  std::fill_n(known.Get(), all, static_cast<unsigned char>(DEFORMVOLUME_PATCH_KEPT));
  for (const std::uint32_t patch : patches)
  {
    known.Get()[patch] = known.Get()[all + patch] = 0;
  }
}

void OutputWinners::PrepareCounts(KernelLauncher& launcher)
{
  Fill(launcher, this->Keys, ElementBytes::Of(cl_uchar{ 0 }), this->KeyBytes);
}

std::vector<std::uint32_t> OutputWinners::ReadCounts(KernelLauncher& launcher) const
{
  const std::size_t words = this->KeySize / sizeof(cl_uint);
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(this->KeyBytes / sizeof(cl_uint)));
  launcher.GetQueue().enqueueReadBuffer(this->Keys, CL_TRUE, 0, this->KeyBytes, counts.data());
  for (std::size_t i = 0; words > 1 && i < counts.size() / words; ++i)
  {
    counts[i] = counts[words * i];
  }
  counts.resize(counts.size() / words);
  return counts;
}

bool OutputWinners::HasContested(KernelLauncher& launcher) const
{
  const std::uint64_t all = this->CountPatches();
  std::vector<unsigned char> contested(static_cast<std::size_t>(all));
  launcher.GetQueue().enqueueReadBuffer(this->Patches, CL_TRUE, all, all, contested.data());
  return std::find(contested.begin(), contested.end(), 1) != contested.end();
}

void OutputWinners::FindUnsettledVoxels(KernelLauncher& launcher, bool claimed,
  const cl::Buffer& coverage, const cl::Buffer& counters, const KernelParameters& parameters)
{
  if (!claimed)
  {
    // Without the pass in which cells claim voxels, it is not known which patches are touched.
    // Assume that all patches are touched.
    Fill(launcher, this->Patches,
      ElementBytes::Of(static_cast<cl_uchar>(DEFORMVOLUME_PATCH_TOUCHED)), this->CountPatches());
  }
  // If a work-item has a thread of its own, it processes many neighboring patches.
  const cl_uint patchesOfItem = launcher.GetContext().GetDevice().HasVectors ? 32 : 1;
  const cl::Kernel kernel =
    MakeKernel(GetOutputProgram(launcher.GetContext()), "FindUnsettledVoxels", coverage, this->Keys,
      static_cast<cl_uint>(this->KeySize / sizeof(cl_uint)), cl_int{ claimed }, this->Patches,
      counters, patchesOfItem, parameters);
  const std::uint64_t patchesOfRow =
    static_cast<std::uint64_t>(DEFORMVOLUME_PATCHES(GetSize(this->Output, 0)));
  const std::uint64_t items =
    (patchesOfRow + patchesOfItem - 1) / patchesOfItem * (this->CountPatches() / patchesOfRow);
  LaunchHeavyItems(launcher, kernel, static_cast<std::size_t>(items));
}

std::uint64_t OutputWinners::GetMemory() const
{
  return deformvolume::GetMemory(this->Keys, this->Patches);
}

} // namespace deformvolume
