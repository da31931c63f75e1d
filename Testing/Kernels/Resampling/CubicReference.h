// SPDX-License-Identifier: BSD-3-Clause
// An independent implementation of the cubic interpolation on the host, in extended precision. The
// rest position of a sample is the weighted sum of the voxel indices of its tetrahedron's vertices.
// IsCubicCell() examines each required voxel and cell. The code shares nothing with the kernels.
#ifndef CubicReference_h
#define CubicReference_h

#include "DeformerCase.h"

#include <cstdint>
#include <vector>

/// Whether samples in this cell are interpolated cubically: the volume has all 64 voxels of the
/// stencil, and none of the 27 cells among these voxels is cut.
bool IsCubicCell(const DeformerCase& deformerCase, std::int64_t cell);

/// Compares coverage and values of a result of Interpolation::Cubic with the reference. Returns the
/// number of voxels that were interpolated cubically.
std::int64_t ExpectEqualsCubicReference(const DeformerCase& deformerCase,
  const reference::Result& reference, const std::vector<deformvolume::VolumeArray>& arrays,
  const Deformed& deformed);

#endif
