// SPDX-License-Identifier: BSD-3-Clause
// DeformVolumeMemory: measures the memory that a process needs to deform a volume once, as a run of
// Google Benchmark. run.sh starts one process for each measurement. The highest resident memory
// includes the volume, the mesh, the result, VTK and the OpenCL driver.
//
// Usage: DeformVolumeMemory NX NY NZ uchar|ushort NODES_PER_AXIS RESAMPLER [option of Google
// Benchmark]...
#include "Evaluation.h"

#include <vtkImageData.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>

namespace
{
// Returns VmHWM in bytes.
double GetHighestResidentMemory()
{
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line))
  {
    std::istringstream words(line);
    std::string key;
    double kilobytes = 0.0;
    if (words >> key >> kilobytes && key == "VmHWM:")
    {
      return 1024.0 * kilobytes;
    }
  }
  throw std::runtime_error("/proc/self/status does not contain the resident memory");
}
}

int main(int argc, char* argv[])
{
  if (argc < 7)
  {
    std::cerr << "usage: DeformVolumeMemory NX NY NZ uchar|ushort NODES_PER_AXIS "
                 "exact|mesh-rasterization\n";
    return 2;
  }
  const std::array<int, 3> dimensions{ { std::atoi(argv[1]), std::atoi(argv[2]),
    std::atoi(argv[3]) } };
  const std::string type = argv[4];
  const int nodes = std::atoi(argv[5]);
  const std::string resampler = argv[6];
  const NamedResampler* chosen = nullptr;
  for (const NamedResampler& named : AllResamplers)
  {
    chosen = resampler == named.Name ? &named : chosen;
  }
  if (dimensions[0] < 2 || dimensions[1] < 2 || dimensions[2] < 2 || nodes < 2 || !chosen ||
    (type != "uchar" && type != "ushort"))
  {
    std::cerr << "DeformVolumeMemory: a size, a type or a resampler is wrong\n";
    return 2;
  }

  const std::string name =
    "Memory/" + GetName(dimensions) + "/" + type + "/" + std::to_string(nodes * nodes * nodes);
  Contestant<BenchmarkCase> only{ resampler,
    [](BenchmarkCase& subject)
    {
      Measurement measurement = Measure(subject, Pose::NearIdentity);
      const double resident = GetHighestResidentMemory();
      measurement.Counters["resident_bytes"] = resident;
      measurement.Counters["resident_bytes_per_voxel"] =
        resident / static_cast<double>(subject.GetNumberOfVoxels());
      return measurement;
    } };
  only.WarmUp = false;
  RegisterRounds<BenchmarkCase>(name, 1,
    [=]()
    {
      return std::make_shared<BenchmarkCase>(
        MakeVolume(dimensions, type == "uchar" ? VTK_UNSIGNED_CHAR : VTK_UNSIGNED_SHORT), nodes,
        chosen->Resampler);
    },
    { only });

  argv[6] = argv[0];
  argv += 6;
  argc -= 6;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
  {
    return 2;
  }
  benchmark::RunSpecifiedBenchmarks();
  CurrentStage::Find("");
  return 0;
}
