// SPDX-License-Identifier: BSD-3-Clause
// DeformVolumeDevice: describes the default OpenCL device, and measures how fast its memory is
// copied, which gives a lower bound of the time of any resampling. Options are those of Google
// Benchmark. Returns 125 if there is no such device.
#include "Error.h"
#include "OpenCLContext.h"

#include <benchmark/benchmark.h>

#include <iostream>
#include <string>

namespace
{
using deformvolume::OpenCLDevice;

const char* const CopySource = "kernel void copy(global const float16* from, global float16* to)\n"
                               "{\n"
                               "  size_t i = get_global_id(0);\n"
                               "  to[i] = from[i];\n"
                               "}\n";

void Describe(const OpenCLDevice& device)
{
  const cl::Device& cl = device.Device;
  benchmark::AddCustomContext("device", device.Name);
  benchmark::AddCustomContext("device_is_processor", device.IsProcessor ? "1" : "0");
  benchmark::AddCustomContext("driver", cl.getInfo<CL_DRIVER_VERSION>());
  benchmark::AddCustomContext("version", cl.getInfo<CL_DEVICE_VERSION>());
  benchmark::AddCustomContext(
    "compute_units", std::to_string(cl.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()));
  benchmark::AddCustomContext(
    "vector_width", std::to_string(cl.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>()));
}

// Copies 256 MiB from one buffer to another. The rate counts bytes that are read and written.
void Copy(benchmark::State& state, const OpenCLDevice& device)
{
  constexpr std::size_t bytes = std::size_t{ 256 } << 20;
  constexpr std::size_t items = bytes / (16 * sizeof(float));
  try
  {
    auto& shared = deformvolume::OpenCLContext::Get(device);
    const cl::Context& context = shared.GetContext();
    const cl::CommandQueue queue(context, device.Device, CL_QUEUE_PROFILING_ENABLE);
    const cl::Buffer from(context, CL_MEM_READ_ONLY, bytes);
    const cl::Buffer to(context, CL_MEM_WRITE_ONLY, bytes);
    queue.enqueueFillBuffer(from, 1.0F, 0, bytes);
    cl::Kernel kernel(shared.GetProgram(CopySource, ""), "copy");
    kernel.setArg(0, from);
    kernel.setArg(1, to);
    const auto launch = [&]()
    {
      cl::Event event;
      queue.enqueueNDRangeKernel(kernel, cl::NullRange, items, cl::NullRange, nullptr, &event);
      event.wait();
      return 1e-9 *
        static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
          event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
    };
    launch();
    double seconds = 0.0;
    for (auto _ : state)
    {
      seconds = launch();
      state.SetIterationTime(seconds);
    }
    state.counters["bytes_per_second"] = 2.0 * static_cast<double>(bytes) / seconds;
  }
  catch (const cl::Error& error)
  {
    state.SkipWithError(deformvolume::GetMessage(error).c_str());
  }
}
}

int main(int argc, char* argv[])
{
  OpenCLDevice device;
  try
  {
    device = deformvolume::FindDevice("");
  }
  catch (const deformvolume::Error& error)
  {
    std::cerr << "DeformVolumeDevice: " << error.what() << "\n";
    return 125;
  }
  Describe(device);
  for (int round = 0; round < 7; ++round)
  {
    benchmark::RegisterBenchmark(
      "Device/copy", [&device](benchmark::State& state) { Copy(state, device); })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
  {
    return 2;
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
