// SPDX-License-Identifier: BSD-3-Clause
// Threads: exceptions in threads reach the caller, settings of vtkSMPTools are respected and not
// changed, and filters in several threads do not affect each other.
#include "FilterTesting.h"

#include "ParallelFor.h"
#include "Processors.h"

#include <vtkSMPTools.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>

using namespace filterTesting;

namespace
{

/// Restores the usual backend and number of threads after each test.
class Threads : public testing::Test
{
protected:
  void TearDown() override
  {
    vtkSMPTools::SetBackend(this->Usual.c_str());
    vtkSMPTools::Initialize(0);
  }
  const std::string Usual = vtkSMPTools::GetBackend();
};

// Two filters in two threads, with inputs of their own, have the same results as one filter alone.
void CheckTwoThreads()
{
  constexpr int rounds = 10;
  const auto run = [](double shift, bool& right)
  {
    auto volume = MakeVolume();
    auto mesh = MakeMesh(volume);
    for (int round = 0; round < rounds; ++round)
    {
      vtkNew<vtkDeformVolumeFilter> filter;
      filter->SetInputData(volume);
      filter->SetDeformationData(mesh);
      SetDisplacements(mesh, Shift(shift + round, 0.0, 0.0));
      filter->Update();
      right = right && filter->GetNumberOfCoveredVoxels() == volume->GetNumberOfPoints() &&
        filter->GetOutput()->GetExtent()[0] == static_cast<int>(shift) + round;
    }
  };
  const std::string backend = vtkSMPTools::GetBackend();
  bool first = true;
  bool second = true;
  std::thread other([&] { run(20.0, second); });
  run(1.0, first);
  other.join();
  EXPECT_TRUE(first);
  EXPECT_TRUE(second);
  EXPECT_EQ(std::string(vtkSMPTools::GetBackend()), backend);
}

// The first test, so that two threads find the devices and build the kernels at the same time.
TEST_F(Threads, TwoThreads)
{
  CheckTwoThreads();
  vtkSMPTools::SetBackend("Sequential");
  CheckTwoThreads();
}

// Returns how many threads process a number of parts. Each part waits until `expected` threads have
// come, at most 10 s in all: on a busy computer, a thread may begin late.
std::size_t CountThreads(vtkIdType parts, std::size_t expected = 1)
{
  std::mutex mutex;
  std::condition_variable hasCome;
  std::set<std::thread::id> threads;
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  deformvolume::ParallelFor(0, parts, 1,
    [&](vtkIdType, vtkIdType)
    {
      {
        std::unique_lock<std::mutex> lock(mutex);
        threads.insert(std::this_thread::get_id());
        hasCome.notify_all();
        hasCome.wait_until(lock, until, [&] { return threads.size() >= expected; });
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
  return threads.size();
}

// ParallelFor() processes every item once, with any backend and grain.
void CheckRange()
{
  for (const vtkIdType grain : { 0, 1, 7, 1000 })
  {
    std::vector<std::atomic<int>> seen(150);
    deformvolume::ParallelFor(20, 150, grain,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          ++seen[static_cast<std::size_t>(i)];
        }
      });
    for (int i = 0; i < 150; ++i)
    {
      EXPECT_EQ(seen[static_cast<std::size_t>(i)].load(), i < 20 ? 0 : 1);
    }
  }
  deformvolume::ParallelFor(5, 5, 0, [](vtkIdType, vtkIdType) { ADD_FAILURE(); });
}

template <typename Exception>
bool IsCarried()
{
  try
  {
    deformvolume::ParallelFor(0, 1000, 1,
      [](vtkIdType begin, vtkIdType)
      {
        if (begin == 500)
        {
          throw Exception("");
        }
      });
  }
  catch (const Exception&)
  {
    return true;
  }
  return false;
}

struct NoMemory : std::bad_alloc
{
  explicit NoMemory(const char*) {}
};

TEST_F(Threads, Backends)
{
  for (const char* backend : { "Sequential", "STDThread", "TBB" })
  {
    if (!vtkSMPTools::SetBackend(backend))
    {
      continue;
    }
    std::cout << "backend " << backend << '\n';
    CheckRange();
    const std::size_t most = std::string(backend) == "Sequential" ? 1 : 2;
    vtkSMPTools::Initialize(static_cast<int>(most));
    EXPECT_EQ(CountThreads(64, most), most);
    EXPECT_TRUE(IsCarried<std::runtime_error>());
    EXPECT_TRUE(IsCarried<NoMemory>());
    EXPECT_EQ(std::string(vtkSMPTools::GetBackend()), std::string(backend));
  }
}

// The filter uses the backend and number of threads that a user has chosen, and does not change
// them.
TEST_F(Threads, Settings)
{
  auto volume = MakeVolume();
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.5, 0.0, 0.0));
  for (const char* backend : { "Sequential", "STDThread", "TBB" })
  {
    for (const int threads : { 1, 2 })
    {
      if (!vtkSMPTools::SetBackend(backend))
      {
        continue;
      }
      vtkSMPTools::Initialize(threads);
      const int estimated = vtkSMPTools::GetEstimatedNumberOfThreads();
      Deformed deformed(volume, mesh);
      deformed.Update();
      EXPECT_EQ(std::string(vtkSMPTools::GetBackend()), std::string(backend));
      EXPECT_EQ(vtkSMPTools::GetEstimatedNumberOfThreads(), estimated);
      if (!VTK_SMP_DEFAULT_IMPLEMENTATION_SEQUENTIAL)
      {
        EXPECT_LE(CountThreads(50), static_cast<std::size_t>(threads));
      }
      if (!VTK_SMP_DEFAULT_IMPLEMENTATION_SEQUENTIAL && backend == std::string("Sequential"))
      {
        EXPECT_EQ(CountThreads(50), 1U); // VTK has threads, but they are not used
      }
      EXPECT_EQ(vtkSMPTools::GetEstimatedNumberOfThreads(), estimated);
    }
  }
}

// With many processes on one machine each uses one thread.
TEST_F(Threads, Share)
{
  deformvolume::SetProcessesHere(1000000);
  EXPECT_EQ(CountThreads(50), 1U);
  deformvolume::SetProcessesHere(1);
}

} // namespace
