// SPDX-License-Identifier: BSD-3-Clause
// Measures frames of finite elements, each of which starts from the last one: times and residual
// forces.
//
// Usage: FiniteElementFrames [FRAMES [NEWTON [ITERATIONS [SCENE [MODEL]]]]]. Times are in
// milliseconds. The body is a block that is fixed at its lower end. In some scenes a handle of
// 2 x 2 cm, or as large as one cell, in the middle of the other end moves along a circle, by 0.005
// of the length of the body in each frame. In the other scenes the body bends under its weight.
// MODEL: 0 stable neo-Hookean, 1 corotational.
#include "FiniteElementModel.h"
#include "LatticeBody.h"
#include "Timing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <vector>

using namespace deformvolume;

namespace
{

struct Scene
{
  LatticeBody::Place Corners;
  double PoissonRatio;
  bool HasHandle;
};

// Returns the displacement of the handle relative to the length of the body: it moves along a
// circle, by 0.005 in each frame.
glm::dvec3 GetHandlePlace(int frame)
{
  constexpr double radius = 0.1;
  const double angle = 0.005 / radius * (frame + 1);
  return radius * glm::dvec3(std::sin(angle), 1.0 - std::cos(angle), 0.0);
}

double GetMedian(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void RunScene(
  const Scene& scene, int frames, const EquilibriumLimits& limits, MaterialModel materialModel)
{
  ElasticMaterial material;
  material.PoissonRatio = scene.PoissonRatio;
  const double spacing = 0.02;
  LatticeBody lattice(scene.Corners, spacing, material);
  lattice.Fix([](const LatticeBody::Place& place) { return place[2] == 0; });
  AddMidSideNodes(lattice.Body);
  FiniteElementModel model;
  model.SetMaterialModel(materialModel);
  const double setTime = 1e3 * Time([&] { model.SetBody(lattice.Body); });
  const double length = spacing * (scene.Corners[2] - 1);
  EquilibriumRequest request;
  request.Limits = limits;
  std::vector<double> times;
  std::vector<double> processorTimes;
  double firstTime = 0.0;
  int newton = 0;
  int iterations = 0;
  double residual = 0.0;
  EquilibriumReport report;
  for (int frame = 0; frame <= frames; ++frame)
  {
    request.Held.clear();
    if (scene.HasHandle)
    {
      const glm::dvec3 middle =
        0.5 * spacing * glm::dvec3(scene.Corners[0] - 1, scene.Corners[1] - 1, 0.0);
      const double radius = 0.505 * spacing;
      for (std::size_t node = 0; node < lattice.Body.Points.size(); ++node)
      {
        const glm::dvec3 place = lattice.Body.Points[node] - middle;
        if (std::abs(place.x) < radius && std::abs(place.y) < radius && place.z > length - 1e-9)
        {
          request.Held.push_back(
            { static_cast<std::int32_t>(node), length * GetHandlePlace(frame) });
        }
      }
    }
    else
    {
      // Vary the load, so that each frame differs from the previous one.
      const double angle = 0.05 * frame;
      request.Loads.Gravity = 0.2 * glm::dvec3(std::sin(angle), std::cos(angle), 0.0);
    }
    const std::clock_t before = std::clock();
    const double time = 1e3 * Time([&] { report = model.Solve(request); });
    const double processor = 1e3 * double(std::clock() - before) / CLOCKS_PER_SEC;
    if (frame == 0)
    {
      firstTime = time;
      std::printf("| first: %d Newton, %d iterations, residual %.1e ", report.NewtonSteps,
        report.LinearIterations, report.RelativeResidual);
      continue;
    }
    times.push_back(time);
    processorTimes.push_back(processor);
    newton += report.NewtonSteps;
    iterations += report.LinearIterations;
    residual = std::max(residual, report.RelativeResidual);
  }
  std::printf("| %zu nodes %zu tetrahedra %s | set %.1f | first %.1f | frame %.2f (least %.2f, of "
              "processors %.2f) | "
              "%.2f Newton %.1f iterations | residual at most %.1e | inverted %lld |\n",
    lattice.Body.Points.size(), lattice.Body.Tetrahedra.size(),
    scene.HasHandle ? "handle" : "weight", setTime, firstTime, GetMedian(times),
    *std::min_element(times.begin(), times.end()), GetMedian(processorTimes),
    double(newton) / frames, double(iterations) / frames, residual,
    static_cast<long long>(report.NumberOfInvertedTetrahedra));
}

} // namespace

int main(int argc, char* argv[])
{
  try
  {
    const int frames = argc > 1 ? std::atoi(argv[1]) : 20;
    EquilibriumLimits limits;
    limits.NewtonSteps = argc > 2 ? std::atoi(argv[2]) : 0;
    limits.LinearIterations = argc > 3 ? std::atoi(argv[3]) : 0;
    const int wanted = argc > 4 ? std::atoi(argv[4]) : -1;
    const auto model = argc > 5 && std::atoi(argv[5]) == 1 ? MaterialModel::Corotational
                                                           : MaterialModel::StableNeoHookean;
    int number = 0;
    for (const Scene& scene : { Scene{ { 3, 3, 3 }, 0.45, true }, Scene{ { 6, 8, 10 }, 0.45, true },
           Scene{ { 6, 8, 10 }, 0.45, false }, Scene{ { 8, 8, 39 }, 0.3, true },
           Scene{ { 8, 8, 39 }, 0.3, false } })
    {
      if (wanted < 0 || number == wanted)
      {
        RunScene(scene, frames, limits, model);
      }
      ++number;
    }
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
