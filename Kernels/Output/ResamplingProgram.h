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

/// The kernels of the exact resampling.
enum class ResamplingForm
{
  /// Cell by cell: Resample in Resampling.cl.
  Cells,
  /// By lanes: ResampleBricks in BrickResampling.cl.
  Lanes,
  /// By columns: ResampleColumns in ColumnResampling.cl.
  Columns,
  /// Cells that these defer, by floats and integers of 32 bits: ResampleDeferredInt32 in
  /// ColumnResampling.cl.
  DeferredInt32,
  /// Cells that both defer, by integers of 64 bits as well: ResampleDeferredInt64 in
  /// DeferredResampling.cl.
  DeferredInt64,
  /// What all of them put off: ResampleLargeCells in LargeCells.cl.
  LargeCells
};

/// What a program of the exact resampling is made for.
struct ResamplingVariant
{
  ResamplingForm Form;
  /// Whether cells are too many for the 30 bits of a narrow winner's key.
  bool WideKeys;
  /// Whether coverage is bits (VoxelWinners.cl): where columns are resampled.
  bool CoverageBits;
  /// Whether there is a smooth cut (CutCells.cl).
  bool WithCut;
  /// Whether columns are resampled in the direct pass only.
  bool IsDirect = false;
  /// Whether the interpolation is cubic where it can be; of the forms Cells and LargeCells.
  bool IsCubic = false;
  /// See DeviceVolume::HasTurnedAxes.
  bool HasTurnedAxes = false;
};

/// The exact resampling for arrays of these types. Throws Error where the device lacks what the
/// arrays need.
cl::Program GetResamplingProgram(OpenCLContext& context, MappingForm mapping,
  const std::vector<VolumeArray>& arrays, const ResamplingVariant& variant);

/// Whether the kernel ResampleBricks works in local memory: where there is enough. Else it does so
/// in a buffer, which has room for each work-item.
bool HasLocalBricks(const OpenCLContext& context, bool hasTurnedAxes);
/// Bytes of that for a work-item.
std::size_t GetBrickMemory(
  const OpenCLContext& context, bool hasTurnedAxes, const std::vector<VolumeArray>& arrays);

/// Whether there is enough local memory for the kernel ResampleColumns.
bool HasLocalColumns(const OpenCLContext& context);
/// Bytes of that for a work-group of one of the kernels for columns and for what these leave.
std::size_t GetColumnMemory(
  const OpenCLContext& context, const std::vector<VolumeArray>& arrays, ResamplingForm form);

/// What is done with the output besides resampling (CoverageCount.cl, OutputClearing.cl).
cl::Program GetOutputProgram(OpenCLContext& context);

} // namespace deformvolume

#endif
