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
  /// What either puts off: ResampleLargeCells in LargeCells.cl.
  LargeCells
};

/// The exact resampling for arrays of these types. wideKeys: cells are too many for the 30 bits of
/// a narrow winner's key. withCut: there is a smooth cut (CutCells.cl). Throws Error where the
/// device lacks what the arrays need.
cl::Program GetResamplingProgram(OpenCLContext& context, MappingForm mapping,
  const std::vector<VolumeArray>& arrays, bool wideKeys, ResamplingForm form, bool withCut = false);

/// Whether the kernel ResampleBricks works in local memory: where there is enough. Else it does so
/// in a buffer, which has room for each work-item.
bool HasLocalBricks(const OpenCLContext& context);
/// Bytes of that for a work-item.
std::size_t GetBrickMemory(const OpenCLContext& context, const std::vector<VolumeArray>& arrays);

/// What is done with the output besides resampling (CoverageCount.cl, OutputClearing.cl).
cl::Program GetOutputProgram(OpenCLContext& context);

/// The published resampling (PublishedResampling.cl) for arrays of these types.
cl::Program GetPublishedProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays);

} // namespace deformvolume

#endif
