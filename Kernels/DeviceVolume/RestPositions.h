// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRestPositions_h
#define DeformVolumeRestPositions_h

#include "OpenCLContext.h"
#include "VoxelGrid.h"

namespace deformvolume
{

/// The undeformed positions of the voxels in the output, axis by axis: for each index on x, then y,
/// then z a RestPosition, or a RestVector if the axes of the volume are not those of the output
/// (KernelParameters.h). Throws an Error if the output would have indices beyond 2^21.
cl::Buffer MakeRestPositions(const OpenCLContext& context, const VoxelGrid& grid);

} // namespace deformvolume

#endif
