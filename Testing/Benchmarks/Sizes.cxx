// SPDX-License-Identifier: BSD-3-Clause
// Measures updates with deformation meshes and volumes of different sizes, and with moving parts of
// meshes.
#include "Evaluation.h"

#include <vtkImageData.h>

namespace
{
// The filter chooses the resampler, and the report states which one.
const char* const Automatic = "automatic";

using CaseMap = std::map<std::string, std::unique_ptr<BenchmarkCase>>;

Contestant<CaseMap> MakeContestant(const std::string& name, Pose pose)
{
  return { name, [=](CaseMap& cases) { return Measure(*cases.at(name), pose); } };
}

// Returns the nodes on each axis of meshes with few and with many nodes, by their names in the
// results.
std::map<std::string, int> GetNodesPerAxis()
{
  std::map<std::string, int> nodesPerAxis;
  for (const int nodes : { CoarseNodes, FineNodes })
  {
    nodesPerAxis[std::to_string(nodes * nodes * nodes)] = nodes;
  }
  return nodesPerAxis;
}

std::shared_ptr<CaseMap> MakeCasesByNodes(const std::array<int, 3>& dimensions)
{
  auto cases = std::make_shared<CaseMap>();
  const auto volume = MakeVolume(dimensions);
  for (const auto& [name, nodes] : GetNodesPerAxis())
  {
    (*cases)[name] = std::make_unique<BenchmarkCase>(volume, nodes);
  }
  return cases;
}
}

void RegisterNodes(const EvaluationSize& size)
{
  for (const Pose pose : { Pose::NearIdentity, Pose::General })
  {
    std::vector<Contestant<CaseMap>> contestants;
    for (const auto& named : GetNodesPerAxis())
    {
      contestants.push_back(MakeContestant(named.first, pose));
    }
    RegisterRounds<CaseMap>(
      std::string("Nodes/") + GetName(pose), size.GetManyRounds(),
      []() { return MakeCasesByNodes(BenchmarkVolume); }, contestants);
  }
}

void RegisterTetrahedra(const EvaluationSize& size)
{
  for (const int nodes : { 5, 9, 13, 21, 41, 80 })
  {
    if (size.Quick && (nodes == 9 || nodes == 21 || nodes == 41))
    {
      continue;
    }
    const int cells = nodes - 1;
    std::vector<Contestant<CaseMap>> contestants;
    for (const NamedResampler& resampler : AllResamplers)
    {
      contestants.push_back(MakeContestant(resampler.Name, Pose::NearIdentity));
    }
    contestants.push_back(MakeContestant(Automatic, Pose::NearIdentity));
    RegisterRounds<CaseMap>(
      "Tetrahedra/" + std::to_string(5 * cells * cells * cells), size.GetRounds(),
      [nodes]()
      {
        auto cases = std::make_shared<CaseMap>();
        const auto volume = MakeVolume(BenchmarkVolume);
        for (const NamedResampler& resampler : AllResamplers)
        {
          (*cases)[resampler.Name] =
            std::make_unique<BenchmarkCase>(volume, nodes, resampler.Resampler);
        }
        (*cases)[Automatic] =
          std::make_unique<BenchmarkCase>(volume, nodes, vtkDeformVolumeFilter::AUTOMATIC);
        return cases;
      },
      contestants);
  }
}

void RegisterVoxels(const EvaluationSize& size)
{
  // 1, 4, 13.2, 30, 60 and 100 million.
  constexpr std::array<int, 3> all[] = { { { 100, 100, 100 } }, { { 160, 160, 160 } },
    BenchmarkVolume, { { 311, 311, 311 } }, { { 391, 391, 391 } }, { { 464, 464, 464 } } };
  // The other resampler is measured up to this size, which suffices to show a trend.
  constexpr int largestCompared = 311;
  struct Wanted
  {
    std::array<int, 3> Dimensions;
    int Resampler;
  };
  // All volumes exist at the same time, so that a round has all of them.
  std::map<std::string, Wanted> wanted;
  std::vector<Contestant<CaseMap>> contestants;
  for (const auto& dimensions : all)
  {
    const bool compared = dimensions[0] <= largestCompared;
    if (size.Quick && !compared)
    {
      continue;
    }
    for (const NamedResampler& resampler : AllResamplers)
    {
      if (resampler.Resampler != ExactResampler.Resampler && !compared)
      {
        continue;
      }
      const std::string name = GetName(dimensions) + "/" + resampler.Name;
      wanted[name] = { dimensions, resampler.Resampler };
      contestants.push_back(MakeContestant(name, Pose::NearIdentity));
    }
  }
  RegisterRounds<CaseMap>(
    "Voxels", size.GetSlowRounds(),
    [wanted]()
    {
      auto cases = std::make_shared<CaseMap>();
      for (const auto& [name, one] : wanted)
      {
        (*cases)[name] =
          std::make_unique<BenchmarkCase>(MakeVolume(one.Dimensions), CoarseNodes, one.Resampler);
      }
      return cases;
    },
    contestants);
}

void RegisterPreprocessing(const EvaluationSize& size)
{
  for (const auto& dimensions : { BenchmarkVolume, HeadVolume })
  {
    std::vector<Contestant<CaseMap>> contestants;
    for (const auto& named : GetNodesPerAxis())
    {
      const std::string name = named.first;
      contestants.push_back({ name,
        [name](CaseMap& cases)
        {
          BenchmarkCase& subject = *cases.at(name);
          subject.GetFilter()->ReleaseDeviceMemory();
          Measurement measurement = Measure(subject, Pose::NearIdentity);
          measurement.Seconds = measurement.Counters.at("preprocessing");
          // Otherwise the device would have less memory for the next volume.
          subject.GetFilter()->ReleaseDeviceMemory();
          return measurement;
        },
        size.GetWarmUp() });
    }
    RegisterRounds<CaseMap>(
      "Preprocess/" + GetName(dimensions), size.GetSlowRounds(),
      [dimensions]() { return MakeCasesByNodes(dimensions); }, contestants);
  }
}

void RegisterGivenMeshes(const EvaluationSize& size)
{
  // Returns a contestant for a form of the deformation, with its name in the results.
  const auto contestant = [](const std::string& name, Grid grid)
  {
    return Contestant<CaseMap>{ name,
      [=](CaseMap& cases) { return Measure(*cases.at(name), Pose::NearIdentity, grid); } };
  };
  RegisterRounds<CaseMap>("Given", size.GetManyRounds(),
    []()
    {
      auto cases = std::make_shared<CaseMap>();
      const auto volume = MakeVolume(BenchmarkVolume);
      for (const char* name : { "same-grid", "shared-arrays", "two-meshes" })
      {
        (*cases)[name] = std::make_unique<BenchmarkCase>(volume, FineNodes);
      }
      (*cases)["two-meshes"]->ConnectRest();
      (*cases)["dense-field"] = std::make_unique<BenchmarkCase>(volume, DenseField);
      return cases;
    },
    { contestant("same-grid", Grid::Same), contestant("shared-arrays", Grid::SharingArrays),
      contestant("two-meshes", Grid::Same), contestant("dense-field", Grid::Same) });
}

void RegisterIncremental(const EvaluationSize& size)
{
  RegisterRounds<CaseMap>("Incremental", size.GetRounds(),
    []()
    {
      auto cases = std::make_shared<CaseMap>();
      const auto volume = MakeVolume(BenchmarkVolume);
      for (const Pose pose : { Pose::NearIdentity, Pose::LocalEdit, Pose::LocalEditAtSide })
      {
        (*cases)[GetName(pose)] = std::make_unique<BenchmarkCase>(volume, FineNodes);
      }
      return cases;
    },
    { MakeContestant(GetName(Pose::NearIdentity), Pose::NearIdentity),
      MakeContestant(GetName(Pose::LocalEdit), Pose::LocalEdit),
      MakeContestant(GetName(Pose::LocalEditAtSide), Pose::LocalEditAtSide) });
}
