// SPDX-License-Identifier: BSD-3-Clause
#include "Evaluation.h"
#include "Peers.h"

#include <vtkImageData.h>

#include <algorithm>

namespace
{
// All resamplers on one volume, each with a filter of its own, and the peers. Peers fill the same
// extent as the first filter.
struct ComparisonStage
{
  vtkSmartPointer<vtkImageData> Volume = MakeVolume(BenchmarkVolume);
  std::map<std::string, std::unique_ptr<BenchmarkCase>> Cases;
  std::map<std::string, std::unique_ptr<Peer>> Peers;

  BenchmarkCase& GetCase(const std::string& name) { return *this->Cases.at(name); }
};

struct NamedDeformation
{
  const char* Name;
  int NodesPerAxis;
};
constexpr NamedDeformation Deformations[] = { { "2197", CoarseNodes }, { "512000", FineNodes },
  { "field", DenseField } };

// A case, with its name in the results.
struct NamedCase
{
  std::string Name;
  int NodesPerAxis;
  int Resampler;
  bool IsInverse;
};

std::vector<NamedCase> MakeNamedCases(bool quick)
{
  std::vector<NamedCase> cases;
  for (const NamedDeformation& deformation : Deformations)
  {
    for (const NamedResampler& resampler : AllResamplers)
    {
      // A field has no tetrahedra that could be rasterized.
      const bool possible = deformation.NodesPerAxis != DenseField ||
        resampler.Resampler != vtkDeformVolumeFilter::MESH_RASTERIZATION;
      const bool wanted = !quick || deformation.NodesPerAxis == CoarseNodes ||
        resampler.Resampler == vtkDeformVolumeFilter::EXACT;
      if (possible && wanted)
      {
        cases.push_back({ std::string(deformation.Name) + "/" + resampler.Name,
          deformation.NodesPerAxis, resampler.Resampler, false });
      }
    }
  }
  // An inverse field needs another resampler.
  cases.push_back({ "inverse/automatic", DenseField, vtkDeformVolumeFilter::AUTOMATIC, true });
  return cases;
}

using PeerMaker = std::function<std::unique_ptr<Peer>(vtkImageData*)>;
const std::map<std::string, PeerMaker> PeerMakers = {
  { "reslice-affine", MakeAffineReslice },
  { "reslice-grid",
    [](vtkImageData* volume)
    { return MakeGridReslice(volume, CoarseNodes, GridDirection::Backward); } },
  { "reslice-grid-solved",
    [](vtkImageData* volume)
    { return MakeGridReslice(volume, CoarseNodes, GridDirection::Solved); } },
};

Contestant<ComparisonStage> MakeCaseContestant(const std::string& name, Pose pose)
{
  return { name,
    [name, pose](ComparisonStage& stage) { return Measure(stage.GetCase(name), pose); } };
}

Contestant<ComparisonStage> MakePeerContestant(
  const std::string& peer, const std::string& subject, Pose pose, bool warmUp)
{
  return { peer,
    [=](ComparisonStage& stage)
    {
      BenchmarkCase& first = stage.GetCase(subject);
      Measurement measurement;
      measurement.Seconds = stage.Peers.at(peer)->Update(
        pose, first.GetStep(), first.GetFilter()->GetOutput()->GetExtent());
      return measurement;
    },
    warmUp };
}

// Makes a stage with the filter and one peer.
std::shared_ptr<ComparisonStage> MakeStageOfTwo(
  const char* peer, std::unique_ptr<Peer> (*make)(vtkImageData*, int))
{
  auto stage = std::make_shared<ComparisonStage>();
  stage->Cases["exact"] = std::make_unique<BenchmarkCase>(stage->Volume, CoarseNodes);
  stage->Peers[peer] = make(stage->Volume, CoarseNodes);
  return stage;
}
}

void RegisterComparison(const EvaluationSize& size)
{
  for (const Pose pose : { Pose::NearIdentity, Pose::General })
  {
    std::vector<Contestant<ComparisonStage>> contestants;
    for (const NamedCase& named : MakeNamedCases(size.Quick))
    {
      contestants.push_back(MakeCaseContestant(named.Name, pose));
    }
    for (const auto& named : PeerMakers)
    {
      contestants.push_back(MakePeerContestant(named.first, "2197/exact", pose, size.GetWarmUp()));
    }
    // Contestants that the report compares are measured one after the other, because the speed of
    // the machine changes least within a short time.
    std::stable_partition(contestants.begin(), contestants.end(),
      [](const Contestant<ComparisonStage>& contestant)
      {
        return contestant.Name == "2197/exact" || contestant.Name == "512000/exact" ||
          contestant.Name == "reslice-affine";
      });
    RegisterRounds<ComparisonStage>(
      std::string("Deform/") + GetName(pose), size.GetRounds(),
      [size]()
      {
        auto stage = std::make_shared<ComparisonStage>();
        for (const NamedCase& named : MakeNamedCases(size.Quick))
        {
          stage->Cases[named.Name] =
            std::make_unique<BenchmarkCase>(stage->Volume, named.NodesPerAxis, named.Resampler);
          stage->Cases[named.Name]->GetFilter()->SetFieldIsInverse(named.IsInverse);
        }
        for (const auto& [name, make] : PeerMakers)
        {
          stage->Peers[name] = make(stage->Volume);
        }
        return stage;
      },
      contestants);
  }
}

void RegisterPublished(const EvaluationSize& size)
{
  for (const Pose pose : { Pose::NearIdentity, Pose::General })
  {
    Contestant<ComparisonStage> published =
      MakePeerContestant("published", "exact", pose, size.GetWarmUp());
    published.Measure = [measure = published.Measure](ComparisonStage& stage)
    {
      Measurement measurement = measure(stage);
      measurement.Counters["kernels"] = measurement.Seconds;
      return measurement;
    };
    RegisterRounds<ComparisonStage>(std::string("Published/") + GetName(pose), size.GetRounds(),
      []() { return MakeStageOfTwo("published", MakePublished); },
      { MakeCaseContestant("exact", pose), published });
  }
}

void RegisterProbe(const EvaluationSize& size)
{
  for (const Pose pose : { Pose::NearIdentity, Pose::General })
  {
    if (size.Quick && pose != Pose::NearIdentity)
    {
      continue;
    }
    RegisterRounds<ComparisonStage>(std::string("Probe/") + GetName(pose), size.Quick ? 1 : 2,
      []() { return MakeStageOfTwo("probe", MakeProbeChain); },
      { MakeCaseContestant("exact", pose), MakePeerContestant("probe", "exact", pose, false) });
  }
}
