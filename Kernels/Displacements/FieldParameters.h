// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldParameters_h
#define DeformVolumeFieldParameters_h

#include "DisplacementField.h"
#include "KernelParameters.h"
#include "VoxelGrid.h"

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Throws Error if a field has no points or no vectors.
void CheckHasPoints(const DisplacementField& field);

/// Makes the kernel parameters of a field that moves the voxels of a grid.
FieldParameters MakeFieldParameters(const DisplacementField& field, const VoxelGrid& voxelGrid);

/// Makes kernel parameters with ToDisplacement and IsMapped only.
FieldParameters MakeMatrixParameters(const DisplacementField& field);

/// Returns the displacements of a field, three floats per point.
std::vector<float> MapVectors(const DisplacementField& field);
/// Computes the displacements of the points range[0] to range[1] - 1. displacements: three floats
/// for each point of the field.
void MapVectors(
  const DisplacementField& field, const std::array<std::size_t, 2>& range, float* displacements);

} // namespace deformvolume

#endif
