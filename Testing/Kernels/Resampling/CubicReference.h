// SPDX-License-Identifier: BSD-3-Clause
// The cubic interpolation of the exact resampling done once more on the host, in extended
// precision: where a sample lies at rest is the weighted sum of the indices of its tetrahedron's
// vertices, and whether all that it wants is there is asked of each voxel and cell. It shares
// nothing with the kernels.
#ifndef CubicReference_h
#define CubicReference_h

#include "DeformerCase.h"

#include <cstdint>
#include <vector>

/// Whether a cell, by its number, and all that surrounds it is there: 64 voxels of the volume, and
/// 27 cells that are not cut.
bool IsCubicCell(const DeformerCase& deformerCase, std::int64_t cell);

/// Coverage and all values of what was made with Interpolation::Cubic against the reference.
/// Returns how many voxels were interpolated cubically.
std::int64_t ExpectEqualsCubicReference(const DeformerCase& deformerCase,
  const reference::Result& reference, const std::vector<deformvolume::VolumeArray>& arrays,
  const Deformed& deformed);

#endif
