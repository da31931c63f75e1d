// SPDX-License-Identifier: BSD-3-Clause
// What users may rely on for speed and memory, as a test: ratios within one run and on one device,
// so that a slow or busy machine does not matter; the one absolute limit is generous.
#include "BenchmarkCase.h"

#include <algorithm>
#include <iostream>
#include <vector>

namespace
{
constexpr double MaximumBytesPerVoxel = 31.0;
constexpr double MaximumPreprocessingTime = 5.0; // seconds
constexpr int NumberOfRounds = 7;

int Failures = 0;

void Demand(bool met, const std::string& what, double value)
{
  std::cout << (met ? "met:     " : "NOT MET: ") << what << ": " << value << "\n";
  Failures += !met;
}

double GetMedian(std::vector<double> values)
{
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void CheckSpeedAndMemory(int nodesPerAxis)
{
  BenchmarkCase subject(BenchmarkVolume, nodesPerAxis);
  vtkDeformVolumeFilter* filter = subject.GetFilter();
  const std::string nodes = std::to_string(nodesPerAxis * nodesPerAxis * nodesPerAxis) + " nodes, ";
  for (const Pose pose : { Pose::NearIdentity, Pose::General })
  {
    double phase = 0.0;
    const auto measure = [&](int resampler)
    {
      filter->SetResampler(resampler);
      subject.Move(pose, phase += 0.01);
      return subject.Update();
    };
    // The published kernel wants more memory, which is kept: it comes last.
    filter->ReleaseDeviceMemory();
    measure(vtkDeformVolumeFilter::EXACT);
    const double bytesPerVoxel =
      static_cast<double>(filter->GetDeviceMemory()) / subject.GetNumberOfVoxels();
    measure(vtkDeformVolumeFilter::PUBLISHED);
    const vtkIdType builds = filter->GetNumberOfMappingBuilds();
    const vtkIdType uploads = filter->GetNumberOfVolumeUploads();
    std::vector<double> ratios;
    double preprocessing = 0.0;
    for (int round = 0; round < NumberOfRounds; ++round)
    {
      const double ours = measure(vtkDeformVolumeFilter::EXACT);
      preprocessing += filter->GetPreprocessingTime();
      ratios.push_back(measure(vtkDeformVolumeFilter::PUBLISHED) / ours);
    }
    const std::string where = nodes + (pose == Pose::General ? "general pose" : "near identity");
    const double ratio = GetMedian(ratios);
    Demand(ratio >= 1.0, where + ": published time by default time", ratio);
    Demand(bytesPerVoxel <= MaximumBytesPerVoxel, where + ": bytes of device memory per voxel",
      bytesPerVoxel);
    Demand(filter->GetNumberOfMappingBuilds() == builds && preprocessing == 0.0,
      where + ": static mappings built for moved meshes",
      static_cast<double>(filter->GetNumberOfMappingBuilds() - builds));
    Demand(filter->GetNumberOfVolumeUploads() == uploads,
      where + ": uploads of the volume for moved meshes",
      static_cast<double>(filter->GetNumberOfVolumeUploads() - uploads));
  }
}

void CheckPreprocessing()
{
  BenchmarkCase subject(HeadVolume, FineNodes);
  subject.Move(Pose::NearIdentity, 0.0);
  subject.Update();
  const double seconds = subject.GetFilter()->GetPreprocessingTime();
  Demand(seconds > 0.0 && seconds < MaximumPreprocessingTime,
    "301 x 370 x 316 voxels, 512000 nodes: seconds of preprocessing", seconds);
}
}

int main()
{
  try
  {
    CheckSpeedAndMemory(CoarseNodes);
    CheckSpeedAndMemory(FineNodes);
    CheckPreprocessing();
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return Failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
