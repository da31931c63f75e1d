// SPDX-License-Identifier: BSD-3-Clause
// Threads: what is thrown in them reaches the caller, the settings of vtkSMPTools are respected and
// stay as they are, and filters of several threads do not disturb each other.
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

// Every item once, whatever the backend and the grain.
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

// What a user has chosen holds meanwhile and afterwards.
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
        VERIFY_EQUAL(CountThreads(50), std::size_t{ 1 }); // VTK has threads; they are not wanted
      }
      VERIFY_EQUAL(vtkSMPTools::GetEstimatedNumberOfThreads(), estimated);
    }
  }
  vtkSMPTools::SetBackend(usual.c_str());
  vtkSMPTools::Initialize(0);
}

// Ranks of one machine share its processors.
void TestShare()
{
  deformvolume::SetProcessesHere(1000000);
  VERIFY_EQUAL(CountThreads(50), std::size_t{ 1 });
  deformvolume::SetProcessesHere(1);
}

// Filters in two threads, on inputs of their own, each with results as alone.
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
