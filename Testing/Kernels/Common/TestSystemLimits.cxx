// SPDX-License-Identifier: BSD-3-Clause
// The memory and processors that a process may use, under the limits of control groups as systems
// and containers set them; instruction sets; and exceptions in threads.
#include "ControlGroups.h"
#include "InstructionSets.h"
#include "ParallelFor.h"
#include "Processors.h"
#include "SystemMemory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

using namespace deformvolume;

namespace
{

constexpr std::uint64_t MiB = 1024 * 1024;

/// A simulated root folder of a system with 8,000 MiB available.
class SystemLimits : public testing::Test
{
protected:
  void SetUp() override
  {
    std::string name = testing::TempDir() + "deformvolume-limits-XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    this->Root = name;
    this->Write("/proc/meminfo",
      "MemTotal:       16384000 kB\nMemFree:         100000 kB\nMemAvailable:    8192000 kB\n"
      "HugePages_Total:       0\n");
  }
  void TearDown() override { std::filesystem::remove_all(this->Root); }

  void Write(const std::string& path, const std::string& text) const
  {
    const std::filesystem::path place = this->Root + path;
    std::filesystem::create_directories(place.parent_path());
    std::ofstream(place) << text;
  }
  void MountUnified(const std::string& group = "/", const std::string& folder = "/sys/fs/cgroup")
  {
    this->Write("/proc/self/mountinfo",
      "22 1 8:1 / / rw shared:1 - ext4 /dev/sda1 rw\n"
      "30 23 0:26 " +
        group + " " + folder + " rw,nosuid shared:4 master:2 - cgroup2 cgroup2 rw,nsdelegate\n");
  }
  /// Returns the available memory, in MiB.
  std::uint64_t GetMemory() const { return GetSystemMemory(this->Root) / MiB; }

  std::string Root;
};

std::string InBytes(std::uint64_t mebibytes)
{
  return std::to_string(mebibytes * MiB) + "\n";
}

} // namespace

TEST_F(SystemLimits, MemoryWithoutCgroups)
{
  EXPECT_EQ(this->GetMemory(), 8000U);
  EXPECT_EQ(GetSystemMemory(this->Root + "/nothing"), 0U);
}

TEST_F(SystemLimits, MemoryLimitsOfCgroups)
{
  this->MountUnified();
  this->Write("/proc/self/cgroup", "0::/user.slice/app\n");
  const std::string app = "/sys/fs/cgroup/user.slice/app/";
  this->Write(app + "memory.max", "max\n");
  this->Write(app + "memory.current", InBytes(500));
  EXPECT_EQ(this->GetMemory(), 8000U);

  this->Write(app + "memory.max", InBytes(2000));
  EXPECT_EQ(this->GetMemory(), 1500U);
  // The limit exceeds the memory of the system, so the memory that the group uses is irrelevant.
  this->Write(app + "memory.max", InBytes(16000));
  this->Write(app + "memory.current", InBytes(15000));
  EXPECT_EQ(this->GetMemory(), 8000U);
  this->Write(app + "memory.max", InBytes(15999));
  EXPECT_EQ(this->GetMemory(), 999U);
  this->Write(app + "memory.max", InBytes(2000));
  this->Write(app + "memory.current", InBytes(500));
  // Page cache can be reclaimed; memory of programs and shared segments cannot.
  this->Write(app + "memory.stat",
    "anon " + InBytes(150) + "file " + InBytes(350) + "shmem " + InBytes(50) + "inactive_file " +
      InBytes(200) + "active_file " + InBytes(100) + "slab_reclaimable " + InBytes(10));
  EXPECT_EQ(this->GetMemory(), 1810U);
  // The kernel slows processes down above this limit.
  this->Write(app + "memory.high", InBytes(1000));
  EXPECT_EQ(this->GetMemory(), 810U);

  // Limits of enclosing groups apply, too.
  this->Write("/sys/fs/cgroup/user.slice/memory.max", InBytes(700));
  this->Write("/sys/fs/cgroup/user.slice/memory.current", InBytes(600));
  EXPECT_EQ(this->GetMemory(), 100U);
  // If more is used than allowed, almost nothing is available. That differs from an unknown limit.
  this->Write("/sys/fs/cgroup/user.slice/memory.current", InBytes(900));
  EXPECT_EQ(GetSystemMemory(this->Root), 1U);
}

// A container sees its own group as the root, whatever its name is outside.
TEST_F(SystemLimits, MemoryLimitsOfContainers)
{
  this->MountUnified();
  this->Write("/proc/self/cgroup", "0::/\n");
  this->Write("/sys/fs/cgroup/memory.max", InBytes(512));
  this->Write("/sys/fs/cgroup/memory.current", InBytes(12));
  EXPECT_EQ(this->GetMemory(), 500U);

  this->Write("/proc/self/cgroup", "0::/../other\n");
  EXPECT_EQ(this->GetMemory(), 500U);

  this->MountUnified("/docker/abc", "/sys/fs/c\\040g");
  this->Write("/proc/self/cgroup", "0::/docker/abc/job\n");
  this->Write("/sys/fs/c g/job/memory.max", InBytes(300));
  this->Write("/sys/fs/c g/memory.max", InBytes(400));
  EXPECT_EQ(this->GetMemory(), 300U);
}

TEST(AddressSpace, LimitsTheMemory)
{
  std::ifstream sizes("/proc/self/statm");
  std::uint64_t pages = 0;
  ASSERT_TRUE(sizes >> pages);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit limited = before;
  limited.rlim_cur = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + 200 * MiB;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limited), 0);
  const std::uint64_t left = GetSystemMemory();
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_GT(left, 150 * MiB);
  EXPECT_LE(left, 200 * MiB);
}

TEST_F(SystemLimits, ProcessorQuotaOfACgroup)
{
  const int all = GetProcessorShare(1, this->Root);
  EXPECT_GE(all, 1);
  this->MountUnified();
  this->Write("/proc/self/cgroup", "0::/app\n");
  this->Write("/sys/fs/cgroup/app/cpu.max", "max 100000\n");
  EXPECT_EQ(GetProcessorShare(1, this->Root), all);
  this->Write("/sys/fs/cgroup/app/cpu.max", "150000 100000\n");
  EXPECT_EQ(GetProcessorShare(1, this->Root), std::min(all, 2));
  this->Write("/sys/fs/cgroup/app/cpu.max", "20000 100000\n");
  EXPECT_EQ(GetProcessorShare(1, this->Root), 1);
}

TEST_F(SystemLimits, ProcessorAffinity)
{
  cpu_set_t all;
  ASSERT_EQ(sched_getaffinity(0, sizeof(all), &all), 0);
  EXPECT_EQ(GetProcessorShare(1, this->Root), CPU_COUNT(&all));
  int first = 0;
  while (!CPU_ISSET(first, &all))
  {
    ++first;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
  EXPECT_EQ(GetProcessorShare(1, this->Root), 1);
  EXPECT_EQ(sched_setaffinity(0, sizeof(all), &all), 0);
}

// Ranks on the same machine share its memory.
TEST_F(SystemLimits, ProcessesShareTheProcessors)
{
  const int all = GetProcessorShare(1, "");
  EXPECT_EQ(GetProcessorShare(), all);
  SetProcessesHere(2);
  EXPECT_EQ(GetProcessorShare(), GetProcessorShare(2, ""));
  SetProcessesHere(1000000);
  EXPECT_EQ(GetProcessorShare(), 1);
  const std::thread::id here = std::this_thread::get_id();
  ParallelFor(
    0, 50, 1, [&](std::int64_t, std::int64_t) { EXPECT_EQ(std::this_thread::get_id(), here); });
  SetProcessesHere(1);
  EXPECT_EQ(GetProcessorShare(), all);
}

// The kernel of the system lists the instruction sets that programs may use.
TEST(InstructionSets, AreThoseThatTheSystemLists)
{
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line) && line.rfind("flags\t", 0) != 0)
  {
  }
  std::istringstream words(line);
  const std::set<std::string> flags{ std::istream_iterator<std::string>(words), {} };
  const auto hasAll = [&](const std::vector<std::string>& names)
  {
    return std::all_of(
      names.begin(), names.end(), [&](const std::string& name) { return flags.count(name) != 0; });
  };
  const InstructionSets sets = FindInstructionSets();
  EXPECT_EQ(sets.AVX2, hasAll({ "avx2" }));
  EXPECT_EQ(
    sets.Haswell, hasAll({ "avx2", "fma", "bmi1", "bmi2", "abm", "f16c", "popcnt", "cx16" }));
  EXPECT_EQ(sets.AVX512, hasAll({ "avx512f" }));
}

// An exception in a thread reaches the caller once, and the remaining parts are skipped. Later
// parts take a millisecond each: the thread that throws may not get a processor for a while, and
// the other threads must not finish all parts before.
TEST(ParallelFor, ExceptionsReachTheCaller)
{
  constexpr std::int64_t quickParts = 1000;
  for (const int threads : { 1, 4 })
  {
    std::atomic<int> calls{ 0 };
    const auto run = [&]
    {
      RunOnOwnThreads(
        0, 100000, 1,
        [&](std::int64_t begin, std::int64_t)
        {
          ++calls;
          if (begin == 7)
          {
            throw std::bad_alloc();
          }
          if (begin >= quickParts)
          {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
          }
        },
        threads);
    };
    EXPECT_THROW(run(), std::bad_alloc);
    EXPECT_GE(calls.load(), 8);
    EXPECT_LT(calls.load(), 100000);
  }
  const auto runAll = []
  { ParallelForParts(1000, 10, [](auto, auto) { throw std::runtime_error("x"); }); };
  EXPECT_THROW(runAll(), std::runtime_error);
}

// Each item is handled once, in parts of the requested size.
TEST(ParallelFor, HandlesEachItemOnce)
{
  for (const std::int64_t grain : { 0, 1, 7, 1000 })
  {
    std::vector<std::atomic<int>> seen(150);
    ParallelFor(20, 150, grain,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          ++seen[static_cast<std::size_t>(i)];
        }
      });
    for (std::size_t i = 0; i < seen.size(); ++i)
    {
      EXPECT_EQ(seen[i].load(), i < 20 ? 0 : 1);
    }
  }
  ParallelForParts(95, 10,
    [](std::size_t begin, std::size_t end)
    {
      EXPECT_EQ(begin % 10, 0U);
      EXPECT_EQ(end, std::min<std::size_t>(begin + 10, 95));
    });
  ParallelFor(5, 5, 0, [](std::int64_t, std::int64_t) { ADD_FAILURE(); });
}

// A loop that the program provides is used instead. Exceptions do not leave it.
TEST(ParallelFor, UsesTheLoopOfTheProgram)
{
  static int calls = 0;
  static bool left = false;
  calls = 0;
  SetParallelLoop(
    [](std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body)
    {
      ++calls;
      try
      {
        for (std::int64_t begin = first; begin < last; begin += grain)
        {
          body(begin, std::min(last, begin + grain));
        }
      }
      catch (...)
      {
        left = true;
        throw;
      }
    });
  std::int64_t sum = 0;
  ParallelFor(1, 11, 3,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        sum += i;
      }
    });
  EXPECT_EQ(sum, 55);
  EXPECT_THROW(
    ParallelFor(0, 10, 1, [](std::int64_t, std::int64_t) { throw std::runtime_error("x"); }),
    std::runtime_error);
  SetParallelLoop(nullptr);
  ParallelFor(0, 10, 1, [](std::int64_t, std::int64_t) {});
  EXPECT_EQ(calls, 2);
  EXPECT_FALSE(left);
}
