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

/// The mesh rasterisation (MeshRasterization.cl, RestSampling.cl), or for a field the look-up
/// through it (FieldLookup.cl), for arrays of these types. masks: whether the volume has some: what
/// looks at them takes twice the registers of all else. Throws Error where the device lacks what
/// the arrays need.
cl::Program GetRasterizationProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const VoxelGrid& voxelGrid, Interpolation interpolation, bool field, bool masks);

} // namespace deformvolume

#endif
