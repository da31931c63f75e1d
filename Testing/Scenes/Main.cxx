// SPDX-License-Identifier: BSD-3-Clause
// Draws a scene, or all of them, and compares it with its baseline; or writes the baseline.
//
// Usage: DeformVolumeScenes SCENE|all -D FOLDER_OF_BASELINES -T FOLDER_OF_OUTPUT [--update]
#include "SceneTesting.h"

using namespace sceneTesting;

namespace
{

const Scene Scenes[] = {
  { "VolumeRendering", 3.5, DrawVolumeRendering },
  { "Isosurface", 3.3, DrawIsosurface },
  { "Slice", 2.7, DrawSlice },
  { "Labels", 0.8, DrawLabels },
  { "Fold", 0.8, DrawFold },
  { "HardCut", 1.5, DrawHardCut },
  { "SmoothCut", 1.0, DrawSmoothCut },
  { "SmoothBoundary", 0.8, DrawSmoothBoundary },
  { "Split", 0.7, DrawSplit },
  { "ChainMail", 5.5, DrawChainMail },
  { "FiniteElements", 4.0, DrawFiniteElements },
};

} // namespace

int main(int argc, char* argv[])
{
  std::string baselines;
  std::string output;
  bool isUpdate = false;
  for (int i = 2; i < argc; ++i)
  {
    const std::string option = argv[i];
    isUpdate = isUpdate || option == "--update";
    if (i + 1 < argc && option == "-D")
    {
      baselines = argv[++i];
    }
    else if (i + 1 < argc && option == "-T")
    {
      output = argv[++i];
    }
  }
  const std::string name = argc > 1 ? argv[1] : "";
  int drawn = 0;
  int failed = 0;
  for (const Scene& scene : Scenes)
  {
    if (name == scene.Name || name == "all")
    {
      ++drawn;
      failed += !(isUpdate ? WriteBaseline(scene, baselines) : Test(scene, baselines, output));
    }
  }
  if (drawn == 0 || baselines.empty() || (output.empty() && !isUpdate))
  {
    std::cerr << "Usage: " << argv[0] << " SCENE|all -D BASELINES -T OUTPUT [--update]\nScenes:";
    for (const Scene& scene : Scenes)
    {
      std::cerr << ' ' << scene.Name;
    }
    std::cerr << '\n';
    return EXIT_FAILURE;
  }
  return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
