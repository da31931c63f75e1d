// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRasterizationProgram_h
#define DeformVolumeRasterizationProgram_h

#include "DeformRequest.h"
#include "OpenCLContext.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <vector>

namespace deformvolume
{

/// Returns the program of mesh rasterization (MeshRasterization.cl, RestSampling.cl) or, for a
/// field, of the lookup through it (FieldLookup.cl), for arrays of these types. masks: whether the
/// volume has masks; code for masks doubles the number of registers. Throws an Error if the device
/// lacks a feature that the arrays need.
cl::Program GetRasterizationProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const VoxelGrid& voxelGrid, Interpolation interpolation, bool field, bool masks);

} // namespace deformvolume

#endif
