// SPDX-License-Identifier: BSD-3-Clause
// Measures updates after changes between two frames.
#include "../Reported.h"
#include "Evaluation.h"
#include "LiveCase.h"

namespace
{
const std::string LoggedSuffix = "-logged";
constexpr std::array<double, 3> some{ { 0.215, 0.215, 0.215 } }; // 1 % of the nodes
constexpr std::array<double, 3> few{ { 0.02, 0.30, 0.02 } };     // nodes that affect 14 bricks

using LiveCases = std::map<std::string, std::unique_ptr<LiveCase>>;

// Returns a contestant that makes an edit, which is not measured, and measures the next update.
Contestant<LiveCases> MakeEdit(const std::string& name, const std::function<void(LiveCase&)>& edit)
{
  return { name,
    [=](LiveCases& cases)
    {
      LiveCase& live = *cases.at(name);
      edit(live);
      Measurement measurement;
      measurement.Seconds = live.Update();
      vtkDeformVolumeFilter* filter = live.GetFilter();
      measurement.Counters["kernels"] = GetReportedSeconds(filter, "Seconds for mapping") +
        GetReportedSeconds(filter, "Seconds for resampling");
      measurement.Counters["transfer"] = GetReportedSeconds(filter, "Seconds for transfer");
      measurement.Counters["preprocessing"] =
        GetReportedSeconds(filter, "Seconds for the static mapping");
      measurement.Counters["bricks"] = static_cast<double>(GetReported(filter, "Bricks resampled"));
      return measurement;
    } };
}
}

void RegisterLive(const EvaluationSize& size)
{
  constexpr int splitTetrahedra = 2000;
  constexpr int splitNodes = 1000;
  const std::array<int, 3> maskCells{ { 2, 30, 30 } };
  const std::pair<const char*, std::function<void(LiveCase&)>> kinds[] = {
    { "all-move", [](LiveCase& live) { live.MoveAll(); } },
    { "some-move", [](LiveCase& live) { live.MoveSome(some); } },
    { "nothing", [](LiveCase& live) { live.Touch(); } },
    { "split", [](LiveCase& live) { live.Split(splitTetrahedra, splitNodes); } },
    { "masks", [=](LiveCase& live) { live.ChangeMask(maskCells); } },
    { "split-and-masks",
      [=](LiveCase& live)
      {
        live.Split(splitTetrahedra, splitNodes);
        live.ChangeMask(maskCells);
      } },
    { "another-mesh", [](LiveCase& live) { live.MoveAtRest(); } },
    { "few-move", [](LiveCase& live) { live.MoveSome(few); } },
  };
  std::vector<Contestant<LiveCases>> edits;
  for (const auto& [name, edit] : kinds)
  {
    edits.push_back(MakeEdit(name, edit));
  }
  // The same edits, with logs of the changes.
  for (const int kind : { 1, 3, 4, 5 })
  {
    edits.push_back(MakeEdit(kinds[kind].first + LoggedSuffix, kinds[kind].second));
  }
  RegisterRounds<LiveCases>(
    "Live", size.GetRounds(),
    [=]()
    {
      auto cases = std::make_shared<LiveCases>();
      for (const Contestant<LiveCases>& edit : edits)
      {
        const bool logged = edit.Name.find(LoggedSuffix) != std::string::npos;
        (*cases)[edit.Name] = std::make_unique<LiveCase>(BenchmarkVolume, FineNodes, logged);
        (*cases)[edit.Name]->Update();
      }
      return cases;
    },
    edits);
}
