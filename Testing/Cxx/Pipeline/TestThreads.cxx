// SPDX-License-Identifier: BSD-3-Clause
// Threads: exceptions in threads reach the caller, settings of vtkSMPTools are respected and not
// changed, and filters in several threads do not affect each other.
#include "FilterTesting.h"

#include "ParallelFor.h"
#include "Processors.h"

#include <vtkSMPTools.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>

using namespace filterTesting;

namespace
{

std::size_t CountThreads(vtkIdType parts)
{
  std::mutex mutex;
  std::set<std::thread::id> threads;
  deformvolume::ParallelFor(0, parts, 1,
    [&](vtkIdType, vtkIdType)
    {
      {
        const std::lock_guard<std::mutex> lock(mutex);
        threads.insert(std::this_thread::get_id());
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
  return threads.size();
}

// ParallelFor() processes every item once, with any backend and grain.
void TestRange()
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
      VERIFY_EQUAL(seen[static_cast<std::size_t>(i)].load(), i < 20 ? 0 : 1);
    }
  }
  deformvolume::ParallelFor(5, 5, 0, [](vtkIdType, vtkIdType) { VERIFY(false); });
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

void TestBackends()
{
  for (const char* backend : { "Sequential", "STDThread", "TBB" })
  {
    if (!vtkSMPTools::SetBackend(backend))
    {
      continue;
    }
    std::cout << "backend " << backend << '\n';
    TestRange();
    const std::size_t most = std::string(backend) == "Sequential" ? 1 : 2;
    vtkSMPTools::Initialize(static_cast<int>(most));
    VERIFY_EQUAL(CountThreads(64), most);
    VERIFY(IsCarried<std::runtime_error>());
    VERIFY(IsCarried<NoMemory>());
    VERIFY_EQUAL(std::string(vtkSMPTools::GetBackend()), std::string(backend));
  }
}

// The filter uses the backend and number of threads that a user has chosen, and does not change
// them.
void TestSettings(const std::string& usual)
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
      VERIFY_EQUAL(std::string(vtkSMPTools::GetBackend()), std::string(backend));
      VERIFY_EQUAL(vtkSMPTools::GetEstimatedNumberOfThreads(), estimated);
      if (!VTK_SMP_DEFAULT_IMPLEMENTATION_SEQUENTIAL)
      {
        VERIFY(CountThreads(50) <= static_cast<std::size_t>(threads));
      }
      if (!VTK_SMP_DEFAULT_IMPLEMENTATION_SEQUENTIAL && backend == std::string("Sequential"))
      {
        VERIFY_EQUAL(CountThreads(50), std::size_t{ 1 }); // VTK has threads, but they are not used
      }
      VERIFY_EQUAL(vtkSMPTools::GetEstimatedNumberOfThreads(), estimated);
    }
  }
  vtkSMPTools::SetBackend(usual.c_str());
  vtkSMPTools::Initialize(0);
}

// With many processes on one machine each uses one thread.
void TestShare()
{
  deformvolume::SetProcessesHere(1000000);
  VERIFY_EQUAL(CountThreads(50), std::size_t{ 1 });
  deformvolume::SetProcessesHere(1);
}

// Two filters in two threads, with inputs of their own, have the same results as one filter alone.
void TestTwoThreads()
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
  VERIFY(first);
  VERIFY(second);
  VERIFY_EQUAL(std::string(vtkSMPTools::GetBackend()), backend);
}

} // namespace

int main()
{
  const std::string usual = vtkSMPTools::GetBackend();
  TestTwoThreads();
  vtkSMPTools::SetBackend("Sequential");
  TestTwoThreads();
  vtkSMPTools::SetBackend(usual.c_str());
  TestShare();
  TestBackends();
  TestSettings(usual);
  return GetExitCode();
}
