// SPDX-License-Identifier: BSD-3-Clause
// Prints the times of the first and of a later execution of a process on a device. The difference
// is the time of compilation. Testing/drivers.sh makes a table of it. Prints a line "later:"
// between the two executions: Testing/gpu_tables.py reads only the counts of instructions that
// Oclgrind prints after this line.
//
// Usage: FirstUpdate [still | jittered | folded] [cells | columns] [runs] [mesh CELLS] [VOXELS]
// [DEVICE]
//   still      the volume does not move; otherwise it moves by a quarter of a voxel
//   jittered   each voxel is also moved at random, by up to 0.15 voxels
//   folded     the volume is folded over, so that winners are chosen
//   cells      by the kernel by cells
//   columns    by the kernel by columns, for graphics cards
//   runs       with runs instead of links
//   mesh       by mesh rasterization, with a mesh of CELLS cubes on each axis, each of six
//              tetrahedra
//   VOXELS     number of voxels on each axis, 32 by default
#include "DeformerCase.h"
#include "Device.h"
#include "RasterCase.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

using namespace deformvolume;

namespace
{

template <typename Function>
double Measure(Function&& function)
{
  const auto begin = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

} // namespace

int main(int argc, char* argv[])
{
  std::string shape;
  int size = 32;
  int meshCells = 0;
  Route route = Route::Mesh;
  DeformRequest deform;
  const char* request = "";
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    if (word == "still" || word == "jittered" || word == "folded")
    {
      shape = word;
    }
    else if (!word.empty() && word.find_first_not_of("0123456789") == std::string::npos)
    {
      size = std::atoi(word.c_str());
    }
    else if (word == "mesh" && i + 1 < argc)
    {
      deform.Method = Resampling::MeshRasterization;
      meshCells = std::atoi(argv[++i]);
    }
    else if (word == "cells")
    {
      deform.Method = Resampling::ExactByCell;
    }
    else if (word == "columns")
    {
      deform.Method = Resampling::ExactByColumns;
    }
    else if (word == "runs")
    {
      route = Route::Runs;
    }
    else
    {
      request = argv[i];
    }
  }
  const bool folded = shape == "folded";
  const auto jitter = MakeJitter(1, 0.15);
  const int last = size - 1;
  const auto move = [&](const glm::dvec3& v)
  {
    return folded && v.x > last / 2 ? glm::dvec3(last - v.x, v.y, v.z)
      : shape == "still"            ? v
      : shape == "jittered"         ? jitter(v + 0.25)
                                    : v + 0.25;
  };
  const Extent extent{ { 0, last, 0, last, 0, last } };
  DeformerCase deformerCase;
  RasterCase rasterCase;
  if (meshCells > 0)
  {
    rasterCase = MakeRasterCase(extent, meshCells, move);
    deformerCase.VoxelGrid = rasterCase.VoxelGrid;
    deformerCase.Output = rasterCase.Output;
  }
  else
  {
    deformerCase = MakeCase(extent, { { 1, 1, 1 } }, move);
  }
  const std::vector<short> values(
    static_cast<std::size_t>(deformerCase.GetNumberOfVoxels()), short{ 1 });
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  std::vector<short> output(static_cast<std::size_t>(GetNumberOfPoints(deformerCase.Output)));
  std::vector<signed char> coverage(output.size());
  deform.OutputExtent = deformerCase.Output;
  deform.Outputs = { output.data() };
  deform.Coverage = coverage.data();
  try
  {
    VolumeDeformer deformer;
    std::string device;
    const double start = Measure([&] { device = deformer.SetDevice(request); });
    DeformReport report;
    const auto load = [&]
    {
      meshCells > 0 ? Load(deformer, rasterCase, arrays)
                    : Load(deformer, deformerCase, arrays, route);
    };
    const double first = Measure(
      [&]
      {
        load();
        report = deformer.Deform(deform);
      });
    std::puts("later:");
    std::fflush(stdout);
    const double later = Measure(
      [&]
      {
        load();
        deformer.Deform(deform);
      });
    std::printf(
      "start %.3f first %.3f compilation %.3f later %.3f covered %lld overlapping %d device %s\n",
      start, first, report.CompilationTime, later,
      static_cast<long long>(report.NumberOfCoveredVoxels), report.Overlapping, device.c_str());
    return report.Overlapping == folded ? 0 : 1;
  }
  catch (const Error& error)
  {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
