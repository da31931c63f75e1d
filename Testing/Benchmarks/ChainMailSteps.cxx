// SPDX-License-Identifier: BSD-3-Clause
// Measures steps of ChainMail in a volume of 189 x 305 x 229 voxels: times, and voxels that move.
//
// Usage: ChainMailSteps [DEVICE]. Times are medians of the steps of a drag, in milliseconds.
#include "ChainMailModel.h"
#include "Timing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

constexpr Extent Volume{ { 0, 188, 0, 304, 0, 228 } };

double Measure(ChainMailModel& model, const ChainMailRequest& request, ChainMailReport& report)
{
  return 1e3 * Time([&] { report = model.Step(request); });
}

double GetMedian(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Measures the steps of a drag to and fro. The distance decides how many voxels move.
void RunDrag(ChainMailModel& model, const char* name, double distance, int sweeps)
{
  model.Reset();
  ChainMailRequest request;
  request.RelaxationSweeps = sweeps;
  request.Handles.resize(1);
  request.Handles[0].RestPosition = { { 94, 152, 114 } };
  request.Handles[0].Radius = 3.0;
  ChainMailReport report;
  request.Handles[0].Displacement = { { distance, distance / 3.0, 0.0 } };
  const double first = Measure(model, request, report);
  const auto firstMoved = report.NumberOfMovedVoxels;
  std::vector<double> times;
  std::vector<double> moved;
  for (int step = 1; step <= 30; ++step)
  {
    const double angle = 0.3 * step;
    request.Handles[0].Displacement = { { distance * std::cos(angle), distance / 3.0,
      distance * std::sin(angle) } };
    times.push_back(Measure(model, request, report));
    moved.push_back(static_cast<double>(report.NumberOfMovedVoxels));
  }
  std::printf("| %s | %d | %.1f | %lld | %.1f | %.0f | %.2f |\n", name, sweeps, first,
    static_cast<long long>(firstMoved), GetMedian(times), GetMedian(moved),
    report.LargestViolation);
}

void Run(const std::string& device)
{
  ChainMailModel model;
  std::printf("%s\n\n", model.SetDevice(device).c_str());
  double seconds = Time([&] { model.SetVoxelGrid(Volume); });
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(Volume));
  std::vector<unsigned char> materials(voxels);
  // Bodies of stiffer tissue, about 30 voxels wide, in soft tissue.
  std::size_t voxel = 0;
  for (int z = 0; z < 229; ++z)
  {
    for (int y = 0; y < 305; ++y)
    {
      for (int x = 0; x < 189; ++x, ++voxel)
      {
        const double wave = std::sin(0.2 * x) + std::sin(0.17 * y) + std::sin(0.23 * z);
        materials[voxel] = wave > 1.2 ? 2 : wave > 0.8 ? 1 : 0;
      }
    }
  }
  std::vector<float> output(3 * voxels);
  seconds += Time([&] { model.SetOutput(output.data()); });
  std::printf("set up: %.0f ms; %.1f bytes a voxel\n\n", 1e3 * seconds,
    static_cast<double>(model.GetDeviceMemory()) / static_cast<double>(voxels));
  std::printf("| drag | sweeps of relaxation | first step | voxels moved | step | voxels moved | "
              "violation |\n"
              "|---|---|---|---|---|---|---|\n");
  const std::vector<ChainMailMaterial> table{ { 0.5, 1.5, 0.5 }, { 0.8, 1.2, 0.2 },
    { 0.95, 1.05, 0.05 } };
  RunDrag(model, "warming up", 5.0, 1);
  for (const int sweeps : { 0, 1, 5 })
  {
    model.Reset();
    model.SetMaterials(table);
    RunDrag(model, "soft, short", 8.0, sweeps);
    RunDrag(model, "soft", 19.0, sweeps);
    RunDrag(model, "soft, long", 40.0, sweeps);
    model.Reset();
    model.SetMaterials(table, materials.data());
    RunDrag(model, "three tissues, short", 3.0, sweeps);
    RunDrag(model, "three tissues", 8.0, sweeps);
  }
  std::vector<unsigned char> active(static_cast<std::size_t>(GetNumberOfCells(Volume)), 31);
  const auto cut = [&](const char* name)
  {
    const double seconds = Time([&] { model.SetActiveTetrahedra(active.data()); });
    std::printf("%s: %.1f ms\n", name, 1e3 * seconds);
  };
  std::printf("\n");
  cut("a mask without cuts");
  for (std::size_t y = 0; y < 304; ++y)
  {
    for (std::size_t x = 0; x < 188; ++x)
    {
      active[(100 * 304 + y) * 188 + x] = 0;
    }
  }
  cut("a cut through the volume");
  active[active.size() / 2] = 0;
  cut("a cell more");
}

} // namespace

int main(int argc, char* argv[])
{
  try
  {
    Run(argc > 1 ? argv[1] : "");
    return 0;
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
