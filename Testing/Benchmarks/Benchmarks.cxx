// SPDX-License-Identifier: BSD-3-Clause
// DeformVolumeBenchmarks: repeats the published evaluation, and compares with VTK's own classes.
// Options are --quick (few rounds, no volume over 30 million voxels) and those of Google Benchmark.
// run.sh makes a report of the results.
#include "Evaluation.h"

#include <algorithm>
#include <cstring>

int main(int argc, char* argv[])
{
  EvaluationSize size;
  char** end = std::remove_if(
    argv + 1, argv + argc, [](const char* word) { return std::strcmp(word, "--quick") == 0; });
  if (end != argv + argc)
  {
    argc = static_cast<int>(end - argv);
    size.Quick = true;
  }
  RegisterComparison(size);
  RegisterNodes(size);
  RegisterReadback(size);
  RegisterPublished(size);
  RegisterProbe(size);
  RegisterPoses(size);
  RegisterTightMeshes(size);
  RegisterTetrahedra(size);
  RegisterVoxels(size);
  RegisterPreprocessing(size);
  RegisterGivenMeshes(size);
  RegisterIncremental(size);
  RegisterLive(size);
  RegisterEdits(size);
  RegisterMasks(size);
  RegisterChainMail(size);
  RegisterPhysics(size);
#ifdef DEFORMVOLUME_HAS_INTERACTION
  RegisterSession(size);
#endif

  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
  {
    return 2;
  }
  benchmark::RunSpecifiedBenchmarks();
  CurrentStage::Find("");
  return 0;
}
