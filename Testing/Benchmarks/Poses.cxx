// SPDX-License-Identifier: BSD-3-Clause
// Measures updates in each pose.
#include "Evaluation.h"

#include <vtkImageData.h>

namespace
{
// Each pose has a filter of its own. With one filter, the extent of the output would change at each
// measurement, and all memory would be allocated again.
using PoseCases = std::map<Pose, std::unique_ptr<BenchmarkCase>>;
constexpr Pose ComparedPoses[] = { Pose::Undeformed, Pose::NearIdentity, Pose::General,
  Pose::LocalLoad, Pose::Rotated, Pose::VaryingScale, Pose::UniformScale, Pose::Folded };
}

void RegisterPoses(const EvaluationSize& size)
{
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
