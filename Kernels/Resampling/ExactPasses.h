// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExactPasses_h
#define DeformVolumeExactPasses_h

#include "DeferredCells.h"
#include "DeformRequest.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "ResamplingProgram.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class DisplacementSource;
class KernelLauncher;
class OutputSlab;
class WorkDevice;
struct VolumeChunk;

/// Runs the passes of exact resampling over the cells of the sampling mesh: chooses the kernel and
/// the launches. ExactResampler and KernelParameters.h describe the passes.
class ExactPasses
{
public:
  ExactPasses(WorkDevice& device, DeviceVolume& volume, const DisplacementSource& source,
    KernelLauncher& launcher);

  /// Chooses the kernel for cells: Cells, Lanes or Columns. Throws an Error if the requested method
  /// cannot be used.
  ResamplingKernel ChooseKernel(
    const DeformRequest& request, const OutputSlab& output, int pass = DEFORMVOLUME_PASS_DIRECT);

  /// Runs a pass (such as DEFORMVOLUME_PASS_DIRECT). bricks: the bricks to resample
  /// (DEFORMVOLUME_BRICK_BITS), for a volume with one chunk; null: all bricks. The mapping must be
  /// up to date (DisplacementSource::PrepareMapping).
  void Run(const DeformRequest& request, const OutputSlab& output, int pass,
    const std::vector<cl_uint>* bricks = nullptr);
  /// Resamples the cells that Run() has added to the list of large cells.
  void RunLargeCells(const DeformRequest& request, const OutputSlab& output, int pass);

  /// Returns the approximate number of launches of Run over all cells.
  std::size_t GetNumberOfLaunches() const;

  /// Sends a list of bricks, which must not be empty, to the device.
  const cl::Buffer& SendBricks(const std::vector<cl_uint>& list);

  /// Returns the memory on the device, in bytes, without short work lists.
  std::uint64_t GetMemory() const;

private:
  struct PlannedLaunch
  {
    const VolumeChunk& Chunk;
    KernelParameters Parameters;
  };
  /// Plans the launches of a pass over all bricks, and lists these bricks.
  std::vector<PlannedLaunch> PlanAll(
    const OutputSlab& output, int pass, std::vector<cl_uint>& bricks);
  /// Plans the launches of a pass over listed bricks.
  std::vector<PlannedLaunch> PlanSome(
    const OutputSlab& output, int pass, const std::vector<cl_uint>& bricks);
  /// Returns the number of cell layers in a launch, in whole bricks: few enough to report progress,
  /// and enough that CPUs do not wait at the end of each launch.
  int GetLayersPerLaunch() const;

  /// Launches a kernel of a form over the bricks of the list that the parameters select.
  void Launch(const DeformRequest& request, cl::Kernel& kernel, ResamplingKernel form,
    const KernelParameters& p);
  /// Launches the kernel for columns, each time followed by the kernels for deferred cells.
  void RunColumns(const DeformRequest& request, const OutputSlab& output, cl::Kernel& columns,
    const std::vector<PlannedLaunch>& launches);
  /// Returns the size of a work-group of the kernel for columns.
  std::size_t GetColumnGroup(const cl::Kernel& kernel);

  cl::Kernel MakeKernel(
    const DeformRequest& request, ResamplingKernel form, const OutputSlab& output, int pass);
  /// Compiles a kernel before it runs (OpenCLContext::Prepare).
  void PrepareKernel(cl::Kernel& kernel, const VolumeChunk& chunk, const OutputSlab& output,
    ResamplingKernel form, const KernelParameters& parameters);
  void SetArguments(cl::Kernel& kernel, const VolumeChunk& chunk, const OutputSlab& output,
    ResamplingKernel form, const KernelParameters& p);

  WorkDevice& Device;
  DeviceVolume& Volume;
  const DisplacementSource& Source;
  KernelLauncher& Launcher;
  cl::Buffer Bricks;               // the list of bricks to resample
  std::vector<cl_uint> SentBricks; // the content of Bricks
  cl::Buffer BrickRows;            // rows of vertices, if local memory is too small
  cl::Buffer TakenBricks;          // the number of bricks that the current launch has taken
  DeferredCells Deferred;          // cells deferred by a launch by columns
  cl::Buffer Pieces;               // pieces of large cells to resample
};

} // namespace deformvolume

#endif
