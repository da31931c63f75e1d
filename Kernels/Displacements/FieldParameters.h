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

/// Points of a field. Throws an Error where it has none.
std::size_t CountPoints(const DisplacementField& field);

/// What the kernels are told of a field that moves the voxels of a grid.
FieldParameters MakeFieldParameters(const DisplacementField& field, const VoxelGrid& voxelGrid);

/// The same of what takes vectors to displacements only: the matrix of a field.
FieldParameters MakeMatrixParameters(const DisplacementField& field);

/// The displacements of a field, three floats a point.
std::vector<float> MapVectors(const DisplacementField& field);
/// Those of some points of it, from the first one to one past the last.
void MapVectors(
  const DisplacementField& field, const std::array<std::size_t, 2>& range, float* displacements);

} // namespace deformvolume

#endif
