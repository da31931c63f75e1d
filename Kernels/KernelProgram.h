// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelProgram_h
#define DeformVolumeKernelProgram_h

#include "OpenCLContext.h"
#include "VolumeDeformer.h"

namespace deformvolume
{

/// Whether the device has double precision.
bool HasDouble(const OpenCLContext& context);

/// The deformation mapping (DeformationMapping.cl and RunMapping.cl).
cl::Program GetMappingProgram(OpenCLContext& context);

/// The exact resampling (Resampling.cl) for arrays of these types. wideKeys: cells are too many for
/// the 31 bits of a narrow winner's key. Throws Error where the device lacks what the arrays need.
cl::Program GetResamplingProgram(
  OpenCLContext& context, const std::vector<VolumeArray>& arrays, bool wideKeys);

/// Whether the kernel ResampleByLanes (LaneResampling.cl) can take these arrays. The program for
/// the exact resampling holds it only then.
bool FitsLanes(const std::vector<VolumeArray>& arrays);

/// The published resampling (PublishedResampling.cl) for arrays of these types.
cl::Program GetPublishedProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays);

} // namespace deformvolume

#endif
