// SPDX-License-Identifier: BSD-3-Clause
// Draws one scene or all scenes, and compares them with their baselines, or writes the baselines.
//
// Usage: DeformVolumeScenes SCENE|all -D FOLDER_OF_BASELINES -T FOLDER_OF_OUTPUT [--update]
#include "SceneTesting.h"

#include <algorithm>
#include <iterator>

using namespace sceneTesting;

namespace
{

// CMakeLists.txt has the same list.
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
  bool isRight = argc > 1;
  for (int i = 2; i < argc; ++i)
  {
    const std::string option = argv[i];
    if (option == "--update")
    {
      isUpdate = true;
    }
    else if (i + 1 < argc && option == "-D")
    {
      baselines = argv[++i];
    }
    else if (i + 1 < argc && option == "-T")
    {
      output = argv[++i];
    }
    else
    {
      isRight = false;
    }
  }
  const std::string name = argc > 1 ? argv[1] : "";
  const bool isScene = name == "all" ||
    std::any_of(
      std::begin(Scenes), std::end(Scenes), [&](const Scene& scene) { return name == scene.Name; });
  if (!isRight || !isScene || baselines.empty() || (output.empty() && !isUpdate))
  {
    std::cerr << "Usage: " << argv[0] << " SCENE|all -D BASELINES -T OUTPUT [--update]\nScenes:";
    for (const Scene& scene : Scenes)
    {
      std::cerr << ' ' << scene.Name;
    }
    std::cerr << '\n';
    return EXIT_FAILURE;
  }
  int failed = 0;
  for (const Scene& scene : Scenes)
  {
    if (name == scene.Name || name == "all")
    {
      failed += !(isUpdate ? WriteBaseline(scene, baselines) : Test(scene, baselines, output));
    }
  }
  return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
