// SPDX-License-Identifier: BSD-3-Clause
// Measures updates in each pose.
#include "Evaluation.h"
#include "SampleCount.h"

#include <vtkImageData.h>

namespace
{
constexpr std::array<int, 3> Table2Volume{ { 256, 256, 113 } };

struct Table2Stage
{
  SampleCount Samples;
  std::map<std::string, std::unique_ptr<BenchmarkCase>> Cases;
};

void RegisterTable2(Pose pose, const EvaluationSize& size)
{
  std::vector<Contestant<Table2Stage>> contestants;
  for (const NamedResampler& resampler : AllResamplers)
  {
    const std::string name = resampler.Name;
    contestants.push_back({ name,
      [=](Table2Stage& stage)
      {
        Measurement measurement = Measure(*stage.Cases.at(name), pose);
        measurement.Counters["tetrahedra"] = static_cast<double>(stage.Samples.Tetrahedra);
        measurement.Counters["samples"] = static_cast<double>(stage.Samples.Samples);
        measurement.Counters["fewest_samples"] = static_cast<double>(stage.Samples.Fewest);
        measurement.Counters["most_samples"] = static_cast<double>(stage.Samples.Most);
        return measurement;
      } });
  }
  RegisterRounds<Table2Stage>(
    std::string("Table2/") + GetName(pose), size.GetRounds(),
    [pose]()
    {
      auto stage = std::make_shared<Table2Stage>();
      stage->Samples = CountSamples(Table2Volume, pose);
      const auto volume = MakeVolume(Table2Volume);
      for (const NamedResampler& resampler : AllResamplers)
      {
        stage->Cases[resampler.Name] =
          std::make_unique<BenchmarkCase>(volume, CoarseNodes, resampler.Resampler);
      }
      return stage;
    },
    contestants);
}

// Each pose has a filter of its own. With one filter, the extent of the output would change at each
// measurement, and all memory would be allocated again.
using PoseCases = std::map<Pose, std::unique_ptr<BenchmarkCase>>;
constexpr Pose ComparedPoses[] = { Pose::NearIdentity, Pose::General, Pose::Rotated,
  Pose::UniformScale, Pose::Folded };
}

void RegisterPoses(const EvaluationSize& size)
{
  for (const Pose pose :
    { Pose::Undeformed, Pose::LocalLoad, Pose::Rotated, Pose::VaryingScale, Pose::UniformScale })
  {
    RegisterTable2(pose, size);
  }

  std::vector<Contestant<PoseCases>> contestants;
  for (const Pose pose : ComparedPoses)
  {
    contestants.push_back(
      { GetName(pose), [pose](PoseCases& cases) { return Measure(*cases.at(pose), pose); } });
  }
  RegisterRounds<PoseCases>(
    "Poses", size.GetRounds(),
    []()
    {
      auto cases = std::make_shared<PoseCases>();
      const auto volume = MakeVolume(BenchmarkVolume);
      for (const Pose pose : ComparedPoses)
      {
        (*cases)[pose] = std::make_unique<BenchmarkCase>(volume, CoarseNodes);
      }
      return cases;
    },
    contestants);
}
