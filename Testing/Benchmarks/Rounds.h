// SPDX-License-Identifier: BSD-3-Clause
#ifndef Rounds_h
#define Rounds_h

#include <benchmark/benchmark.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// One measurement: wall-clock seconds, and further numbers.
struct Measurement
{
  double Seconds = 0.0;
  std::map<std::string, double> Counters;
};

/// The stage of the current group: the objects that its measurements need. Only one group has a
/// stage at a time, to save memory.
class CurrentStage
{
public:
  /// Returns the stage of this group. If another group has a stage, deletes it and returns null.
  static void* Find(const std::string& group)
  {
    if (Group != group)
    {
      Stage.reset();
    }
    return Stage.get();
  }

  static void Set(const std::string& group, std::shared_ptr<void> stage)
  {
    Group = group;
    Stage = std::move(stage);
  }

private:
  inline static std::string Group;
  inline static std::shared_ptr<void> Stage;
};

/// One of the alternatives that are compared in a group.
template <typename Stage>
struct Contestant
{
  std::string Name;
  std::function<Measurement(Stage&)> Measure;
  /// Whether the first measurement does not count. False for contestants that take too long.
  bool WarmUp = true;
};

/// If a run takes less than ShortRun seconds, a turn has several runs. The first run does not
/// count, because caches contain data of the other contestants, which is not the case in normal
/// use. The median of the other runs counts. For longer runs caches make no difference, so
/// contestants with one run and with several runs can be compared.
constexpr double ShortRun = 1.0;
constexpr int RunsAfterShortOne = 3;

template <typename Stage>
Measurement TakeTurn(const Contestant<Stage>& contestant, Stage& stage)
{
  Measurement first = contestant.Measure(stage);
  if (first.Seconds >= ShortRun)
  {
    return first;
  }
  std::vector<Measurement> runs;
  for (int run = 0; run < RunsAfterShortOne; ++run)
  {
    runs.push_back(contestant.Measure(stage));
  }
  const auto middle = runs.begin() + RunsAfterShortOne / 2;
  std::nth_element(runs.begin(), middle, runs.end(),
    [](const Measurement& a, const Measurement& b) { return a.Seconds < b.Seconds; });
  return *middle;
}

/// Registers measurements that are taken in turn, A B C A B C and so on. If the machine becomes
/// slower for a while, it does so for all contestants, and the ratios within a round do not change.
/// Each measurement is a turn, and a run of Google Benchmark with the name group/contestant. build
/// makes the stage at the first measurement of the group. Then each contestant has a turn that does
/// not count.
template <typename Stage>
void RegisterRounds(const std::string& group, int rounds,
  std::function<std::shared_ptr<Stage>()> build, std::vector<Contestant<Stage>> contestants)
{
  const auto run = [=](benchmark::State& state, const Contestant<Stage>& contestant)
  {
    try
    {
      auto* stage = static_cast<Stage*>(CurrentStage::Find(group));
      if (!stage)
      {
        const std::shared_ptr<Stage> built = build();
        CurrentStage::Set(group, built);
        stage = built.get();
        for (const auto& other : contestants)
        {
          if (other.WarmUp)
          {
            other.Measure(*stage);
          }
        }
      }
      for (auto _ : state)
      {
        const Measurement measurement = TakeTurn(contestant, *stage);
        state.SetIterationTime(measurement.Seconds);
        for (const auto& [name, value] : measurement.Counters)
        {
          state.counters[name] = value;
        }
      }
    }
    catch (const std::exception& error)
    {
      state.SkipWithError(error.what());
    }
  };
  for (int round = 0; round < rounds; ++round)
  {
    for (const auto& contestant : contestants)
    {
      benchmark::RegisterBenchmark((group + "/" + contestant.Name).c_str(),
        [run, contestant](benchmark::State& state) { run(state, contestant); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
    }
  }
}

#endif
