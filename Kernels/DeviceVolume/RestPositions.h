// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRestPositions_h
#define DeformVolumeRestPositions_h

#include "OpenCLContext.h"
#include "VoxelGrid.h"

namespace deformvolume
{

/// Makes a buffer of the undeformed positions of voxels in the output: one element for each index
/// on x, then y, then z. The elements are RestPosition, or RestVector if the axes of the volume are
/// not those of the output (KernelParameters.h). Throws Error if an output index exceeds 2^21.
cl::Buffer MakeRestPositions(const OpenCLContext& context, const VoxelGrid& grid);

} // namespace deformvolume

#endif
