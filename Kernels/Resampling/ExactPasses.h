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
class Launches;
class OutputSlab;
class WorkDevice;
struct VolumeChunk;

/// The passes of the exact resampling over the cells of the sampling mesh: which kernel does them,
/// in which launches. What the passes are for is told by ExactResampler and KernelParameters.h.
class ExactPasses
{
public:
  ExactPasses(
    WorkDevice& device, DeviceVolume& volume, const DisplacementSource& source, Launches& launches);

  /// The kernel for cells: Cells, Lanes or Columns. Throws an Error where the method demands one
  /// that it cannot be.
  ResamplingForm ChooseForm(
    const DeformRequest& request, const OutputSlab& output, int pass = DEFORMVOLUME_PASS_DIRECT);

  /// Runs a pass (DEFORMVOLUME_PASS_DIRECT and so on). bricks: those to run
  /// (DEFORMVOLUME_BRICK_BITS), where the volume is one chunk; null: all. The mapping is up to date
  /// (DisplacementSource::PrepareMapping).
  void Run(const DeformRequest& request, const OutputSlab& output, int pass,
    const std::vector<cl_uint>* bricks = nullptr);
  /// Runs the large cells that Run has put off.
  void RunLargeCells(const DeformRequest& request, const OutputSlab& output, int pass);

  /// Launches of Run over all cells, about.
  std::size_t GetNumberOfLaunches() const;

  /// Makes a list, which is not empty, the one that the device has.
  const cl::Buffer& SendBricks(const std::vector<cl_uint>& list);

  /// Bytes on the device, but for lists of work that are short.
  std::uint64_t GetMemory() const;

private:
  struct PlannedLaunch
  {
    const VolumeChunk& Chunk;
    KernelParameters Parameters;
  };
  /// The launches of a pass over all bricks, which are put into a list.
  std::vector<PlannedLaunch> PlanAll(
    const OutputSlab& output, int pass, std::vector<cl_uint>& bricks);
  /// Those of a pass over a list of some.
  std::vector<PlannedLaunch> PlanSome(
    const OutputSlab& output, int pass, const std::vector<cl_uint>& bricks);
  /// Cell layers in a launch, whole bricks of them: few enough that progress is reported, and
  /// enough that processors are not kept waiting at its end.
  int GetLayersPerLaunch() const;

  /// Launches a kernel of a form over the bricks that the parameters have of the list.
  void Launch(const DeformRequest& request, cl::Kernel& kernel, ResamplingForm form,
    const KernelParameters& p);
  /// Launches the kernel for columns, and after each launch those for what that leaves.
  void RunColumns(const DeformRequest& request, const OutputSlab& output, cl::Kernel& columns,
    const std::vector<PlannedLaunch>& launches);
  /// Work-items of a group of the kernel for columns.
  std::size_t GetColumnGroup(const cl::Kernel& kernel);

  cl::Kernel MakeKernel(
    const DeformRequest& request, ResamplingForm form, const OutputSlab& output, int pass);
  /// Has a kernel compiled before it runs (OpenCLContext::Prepare).
  void PrepareKernel(cl::Kernel& kernel, const VolumeChunk& chunk, const OutputSlab& output,
    ResamplingForm form, const KernelParameters& parameters);
  void SetArguments(cl::Kernel& kernel, const VolumeChunk& chunk, const OutputSlab& output,
    ResamplingForm form, const KernelParameters& p);

  WorkDevice& Device;
  DeviceVolume& Volume;
  const DisplacementSource& Source;
  Launches& Launched;
  cl::Buffer Bricks;               // the list of those to work on
  std::vector<cl_uint> SentBricks; // what it has
  cl::Buffer BrickRows;            // what these need, where local memory is too small
  cl::Buffer TakenBricks;          // how many of these the launch that runs has taken
  DeferredCells Deferred;          // of a launch by columns
  cl::Buffer Pieces;               // of large cells, to work on
};

} // namespace deformvolume

#endif
