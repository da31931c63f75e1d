// SPDX-License-Identifier: BSD-3-Clause
#include "SectionCounters.h"

#include "BrickGrid.h"
#include "HostMemory.h"
#include "KernelLauncher.h"
#include "KernelMaking.h"
#include "KernelParameters.h"
#include "OutputFilling.h"
#include "ResamplingProgram.h"

#include <array>

namespace deformvolume
{
namespace
{

/// The bits of a section of a brick, in the format of DEFORMVOLUME_BRICK_BITS.
cl_uint GetSectionBits(std::size_t section)
{
  const std::size_t halves = section / DEFORMVOLUME_SPANS;
  return MakeSectionBits(static_cast<cl_uint>(section % DEFORMVOLUME_SPANS), halves & 1, halves & 2)
    << DEFORMVOLUME_BRICK_BITS;
}

} // namespace

void SectionCounters::Start(KernelLauncher& launcher, std::size_t numberOfBricks)
{
  this->NumberOfSections = DEFORMVOLUME_SECTIONS * numberOfBricks;
  Reserve(launcher.GetContext(), this->Counters,
    this->NumberOfSections * DEFORMVOLUME_COUNTERS * sizeof(cl_uint));
  this->Clear(launcher);
}

void SectionCounters::Clear(KernelLauncher& launcher)
{
  Fill(launcher, this->Counters, ElementBytes::Of(cl_uint{ 0 }),
    this->NumberOfSections * DEFORMVOLUME_COUNTERS);
}

void SectionCounters::ClearSections(
  KernelLauncher& launcher, std::size_t bricks, const cl::Buffer& brickList, bool withWinners)
{
  const auto launch = [&](const char* name, std::size_t sections, const auto&... arguments)
  {
    LaunchLightItems(launcher,
      MakeKernel(GetOutputProgram(launcher.GetContext()), name, this->Counters, arguments...,
        static_cast<cl_uint>(sections)),
      sections);
  };
  launch("ClearSections", DEFORMVOLUME_SECTIONS * bricks, brickList);
  if (withWinners)
  {
    launch("ClearWinnerCounters", this->NumberOfSections);
  }
}

SlabCounts SectionCounters::Read(
  KernelLauncher& launcher, const cl::Buffer& coverageBits, std::uint64_t coverageWords)
{
  OpenCLContext& context = launcher.GetContext();
  std::array<cl_uint, DEFORMVOLUME_SUMMARY_WORDS> words;
  Reserve(context, this->Parts, DEFORMVOLUME_PARTS * DEFORMVOLUME_SUMMED * sizeof(cl_ulong));
  Reserve(context, this->Summary, sizeof(words));
  const auto launch = [&](const char* name, std::size_t groups, const auto&... arguments)
  {
    cl::Kernel kernel(GetOutputProgram(context), name);
    const std::size_t group = launcher.GetDevice().GetHeavyGroupSize(kernel, 256);
    SetArguments(
      kernel, 0, arguments..., cl::Local(DEFORMVOLUME_SUMMED * group * sizeof(cl_ulong)));
    launcher.Launch(kernel, cl::NDRange(group * groups), cl::NDRange(group));
  };
  launch("SumParts", DEFORMVOLUME_PARTS, this->Counters,
    static_cast<cl_uint>(this->NumberOfSections), coverageBits, cl_ulong{ coverageWords },
    this->Parts);
  launch("Summarize", 1, this->Parts, this->Summary);
  launcher.GetQueue().enqueueReadBuffer(this->Summary, CL_TRUE, 0, sizeof(words), words.data());
  const auto join = [&](std::size_t word)
  { return words[word] | std::uint64_t{ words[word + 1] } << 32; };
  SlabCounts counts;
  counts.Writes = join(0);
  counts.Covered = join(2);
  counts.Inverted = join(4);
  counts.Overstretched = words[6];
  counts.MissingWhereAssumed = (words[7] & DEFORMVOLUME_SUMMARY_MISSING_WHERE_ASSUMED) != 0;
  counts.HasLarge = (words[7] & DEFORMVOLUME_SUMMARY_LARGE) != 0;
  return counts;
}

std::vector<cl_uint> SectionCounters::FindBricks(KernelLauncher& launcher, int counter) const
{
  std::vector<cl_uint> counters(this->NumberOfSections * DEFORMVOLUME_COUNTERS);
  launcher.GetQueue().enqueueReadBuffer(
    this->Counters, CL_TRUE, 0, counters.size() * sizeof(cl_uint), counters.data());
  std::vector<cl_uint> bricks;
  for (std::size_t brick = 0; brick < this->NumberOfSections / DEFORMVOLUME_SECTIONS; ++brick)
  {
    cl_uint bits = 0;
    for (std::size_t section = 0; section < DEFORMVOLUME_SECTIONS; ++section)
    {
      const std::size_t index = (DEFORMVOLUME_SECTIONS * brick + section) * DEFORMVOLUME_COUNTERS;
      if (counters[index + static_cast<std::size_t>(counter)])
      {
        bits |= GetSectionBits(section);
      }
    }
    if (bits)
    {
      bricks.push_back(static_cast<cl_uint>(brick) | bits);
    }
  }
  return bricks;
}

std::uint64_t SectionCounters::GetMemory() const
{
  return deformvolume::GetMemory(this->Counters);
}

} // namespace deformvolume
