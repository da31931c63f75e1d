// SPDX-License-Identifier: BSD-3-Clause
// DeformVolumeBenchmarks: measures the default resampler against the published kernel, in one run
// on one device. Options are those of Google Benchmark; run.sh makes a report of its result.
#include "BenchmarkCase.h"

#include <benchmark/benchmark.h>

#include <iostream>
#include <map>
#include <memory>

namespace
{
BenchmarkCase& GetCase(int nodesPerAxis)
{
  static std::map<int, std::unique_ptr<BenchmarkCase>> cases;
  std::unique_ptr<BenchmarkCase>& known = cases[nodesPerAxis];
  if (!known)
  {
    known = std::make_unique<BenchmarkCase>(BenchmarkVolume, nodesPerAxis);
  }
  return *known;
}

// The time of an iteration is that of mapping and resampling. Each iteration moves the mesh.
void Deform(benchmark::State& state, int nodesPerAxis, Pose pose, int resampler)
{
  BenchmarkCase& subject = GetCase(nodesPerAxis);
  vtkDeformVolumeFilter* filter = subject.GetFilter();
  filter->SetResampler(resampler);
  static double phase = 0.0;
  const auto move = [&subject, pose]()
  {
    phase = phase > 0.09 ? 0.0 : phase + 0.01;
    subject.Move(pose, phase);
  };
  // The published kernel wants more memory, which would be kept for the other one.
  filter->ReleaseDeviceMemory();
  // Not measured: building the kernels, and the static mapping.
  move();
  subject.Update();
  const vtkIdType builds = filter->GetNumberOfMappingBuilds();
  const vtkIdType uploads = filter->GetNumberOfVolumeUploads();

  double mapping = 0.0;
  double resampling = 0.0;
  double transfer = 0.0;
  for (auto _ : state)
  {
    move();
    state.SetIterationTime(subject.Update());
    mapping += filter->GetMappingTime();
    resampling += filter->GetResamplingTime();
    transfer += filter->GetTransferTime();
  }
  const auto average = benchmark::Counter::kAvgIterations;
  state.counters["mapping"] = benchmark::Counter(mapping, average);
  state.counters["resampling"] = benchmark::Counter(resampling, average);
  state.counters["transfer"] = benchmark::Counter(transfer, average);
  state.counters["bytes_per_voxel"] =
    static_cast<double>(filter->GetDeviceMemory()) / subject.GetNumberOfVoxels();
  state.counters["mapping_builds"] =
    static_cast<double>(filter->GetNumberOfMappingBuilds() - builds);
  state.counters["volume_uploads"] =
    static_cast<double>(filter->GetNumberOfVolumeUploads() - uploads);
}

// Finding the tetrahedron of each voxel.
void Preprocess(benchmark::State& state, const std::array<int, 3>& dimensions, int nodesPerAxis)
{
  for (auto _ : state)
  {
    BenchmarkCase subject(dimensions, nodesPerAxis);
    subject.Move(Pose::NearIdentity, 0.0);
    subject.Update();
    state.SetIterationTime(subject.GetFilter()->GetPreprocessingTime());
  }
}

void Register()
{
  for (const int nodes : { CoarseNodes, FineNodes })
  {
    const std::string count = std::to_string(nodes * nodes * nodes);
    for (const Pose pose : { Pose::NearIdentity, Pose::General })
    {
      for (const int resampler : { vtkDeformVolumeFilter::EXACT, vtkDeformVolumeFilter::PUBLISHED })
      {
        const std::string name = std::string("Deform/189x305x229/") + count + "/" +
          (pose == Pose::General ? "general" : "near-identity") + "/" +
          (resampler == vtkDeformVolumeFilter::EXACT ? "default" : "published");
        benchmark::RegisterBenchmark(
          name.c_str(), [=](benchmark::State& state) { Deform(state, nodes, pose, resampler); })
          ->UseManualTime()
          ->Iterations(3)
          ->Unit(benchmark::kMillisecond);
      }
    }
    benchmark::RegisterBenchmark(("Preprocess/189x305x229/" + count).c_str(),
      [=](benchmark::State& state) { Preprocess(state, BenchmarkVolume, nodes); })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
  }
  benchmark::RegisterBenchmark("Preprocess/301x370x316/512000",
    [](benchmark::State& state) { Preprocess(state, HeadVolume, FineNodes); })
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
}
}

int main(int argc, char* argv[])
{
  Register();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
  {
    return 2;
  }
  try
  {
    BenchmarkCase small({ { 8, 8, 8 } }, 2);
    small.Move(Pose::NearIdentity, 0.0);
    small.Update();
    benchmark::AddCustomContext("device", small.GetFilter()->GetDeviceInUse());
    benchmark::RunSpecifiedBenchmarks();
  }
  catch (const std::exception& error)
  {
    std::cerr << "DeformVolumeBenchmarks: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
