// SPDX-License-Identifier: BSD-3-Clause
#ifndef Rounds_h
#define Rounds_h

#include <benchmark/benchmark.h>

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

/// Registers measurements that are taken in turn, A B C A B C and so on: when the machine becomes
/// slower for a while it does so for all, and the ratio within a round stays. Each measurement is a
/// run of Google Benchmark of its own, named group/contestant, in the order of the rounds. build
/// makes what is measured, at the first measurement; then each contestant has a turn that does
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
        const Measurement measurement = contestant.Measure(*stage);
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
