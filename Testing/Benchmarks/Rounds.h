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

/// One measurement: wall-clock seconds, and what else belongs to it.
struct Measurement
{
  double Seconds = 0.0;
  std::map<std::string, double> Counters;
};

/// What is built for a group of measurements; there is one at a time, so that only the memory of
/// one group is needed.
class CurrentStage
{
public:
  /// The stage of this group, or null; then the one that stood has been taken down.
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

/// One of those that are compared in a group.
template <typename Stage>
struct Contestant
{
  std::string Name;
  std::function<Measurement(Stage&)> Measure;
  /// False: its first measurement counts, because a second one would take too long.
  bool WarmUp = true;
};

/// A turn. Where a run takes less than this many seconds it is several: the first one finds the
/// caches full of what others left there, which is not so while a volume is worked with, and of the
/// rest the one in the middle counts. In longer runs that makes no difference, so that it does not
/// matter on which side of the limit one of two that are compared is.
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

/// Registers measurements that are taken in turn, A B C A B C and so on: when the machine becomes
/// slower for a while it does so for all, and the ratio within a round stays. Each measurement is a
/// turn, and a run of Google Benchmark of its own, named group/contestant, in the order of the
/// rounds. build makes what is measured, at the first measurement; then each contestant has a run
/// that does not count.
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
