// SPDX-License-Identifier: BSD-3-Clause
// Prints what the first execution of a process costs on a device, and what a later one does: what
// is compiled makes the difference. Testing/drivers.sh makes a table of it.
//
// Usage: FirstUpdate [folded] [cells] [runs] [DEVICE]
//   folded   the volume is folded over, so that winners are chosen
//   cells    by the kernel that takes one cell after the other
//   runs     with runs in place of links
#include "DeformerCase.h"
#include "Device.h"

#include <chrono>
#include <cstdio>
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
  bool folded = false;
  Route route = Route::Mesh;
  DeformRequest deform;
  const char* request = "";
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    if (word == "folded")
    {
      folded = true;
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
  const int size = 31;
  const DeformerCase deformerCase = MakeCase({ { 0, size, 0, size, 0, size } }, { { 1, 1, 1 } },
    [&](const glm::dvec3& v)
    { return folded && v.x > size / 2 ? glm::dvec3(size - v.x, v.y, v.z) : v + 0.25; });
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
    const double first = Measure(
      [&]
      {
        Load(deformer, deformerCase, arrays, route);
        report = deformer.Deform(deform);
      });
    const double later = Measure(
      [&]
      {
        Load(deformer, deformerCase, arrays, route);
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
