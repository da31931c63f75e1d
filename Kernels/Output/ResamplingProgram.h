// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeResamplingProgram_h
#define DeformVolumeResamplingProgram_h

#include "MappingProgram.h"
#include "OpenCLContext.h"
#include "VolumeArray.h"

#include <cstddef>
#include <vector>

namespace deformvolume
{

/// The kernels of exact resampling.
enum class ResamplingKernel
{
  /// One cell at a time: Resample in Resampling.cl.
  Cells,
  /// Cells in lanes (CPUs): ResampleBricks in BrickResampling.cl.
  Lanes,
  /// Columns of cells (GPUs): ResampleColumns in ColumnResampling.cl.
  Columns,
  /// Cells that Columns defers, decided by floats and 32-bit integers: ResampleDeferredInt32 in
  /// ColumnResampling.cl.
  DeferredInt32,
  /// Cells that Columns and DeferredInt32 defer, decided also by 64-bit integers:
  /// ResampleDeferredInt64 in DeferredResampling.cl.
  DeferredInt64,
  /// Large cells that the other kernels skip: ResampleLargeCells in LargeCells.cl.
  LargeCells
};

/// The options of a resampling program.
struct ResamplingOptions
{
  ResamplingKernel Form;
  /// Whether there are too many cells for the 30 bits of a four-byte winner's key.
  bool WideKeys;
  /// Whether coverage is stored as bits (VoxelWinners.cl), for columns.
  bool CoverageBits;
  /// Whether there is a smooth cut (CutCells.cl).
  bool WithCut;
  /// Whether the program is used in the pass DIRECT only (PASS_IS_DIRECT), for columns.
  bool IsDirect = false;
  /// Whether interpolation is cubic where possible. Only for the forms Cells and LargeCells.
  bool IsCubic = false;
  /// See DeviceVolume::HasTurnedAxes.
  bool HasTurnedAxes = false;
};

/// Returns the program of a variant for arrays of these types. Throws an Error if the device lacks
/// a feature that the arrays need.
cl::Program GetResamplingProgram(OpenCLContext& context, MappingKind mapping,
  const std::vector<VolumeArray>& arrays, const ResamplingOptions& variant);

/// Whether the kernel ResampleBricks works in local memory, because there is enough of it.
/// Otherwise it works in a global buffer with a section for each work-item.
bool HasLocalBricks(const OpenCLContext& context, bool hasTurnedAxes);
/// Returns the memory of a work-item of the kernel ResampleBricks, in bytes.
std::size_t GetBrickMemory(
  const OpenCLContext& context, bool hasTurnedAxes, const std::vector<VolumeArray>& arrays);

/// Whether the device has enough local memory for the kernel ResampleColumns.
bool HasLocalColumns(const OpenCLContext& context);
/// Returns the local memory of a work-group, in bytes, of a kernel for columns or deferred cells.
std::size_t GetColumnMemory(
  const OpenCLContext& context, const std::vector<VolumeArray>& arrays, ResamplingKernel form);

/// Returns the program of the other kernels on the output (CoverageCount.cl, OutputClearing.cl).
cl::Program GetOutputProgram(OpenCLContext& context);

} // namespace deformvolume

#endif
