// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldGeometry_h
#define DeformVolumeFieldGeometry_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "Extent.h"
#include "ImageGeometry.h"
#include "OutsideVoxels.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <array>

namespace deformvolume
{

/// DisplacementField::IndexToField of a field for a volume. toOutput: of an inverse field, whose
/// matrix takes indices of the output; else null.
DEFORMVOLUME_EXPORT std::array<double, 12> GetIndexToField(
  const ImageGeometry& field, const ImageGeometry& volume, const OutputMap* toOutput);

/// Where all voxels are points of a field and there are others between them, how many points they
/// are apart, the same on each axis; else 1. indexToField: see DisplacementField.
DEFORMVOLUME_EXPORT int GetStep(const Extent& voxels, const std::array<double, 12>& indexToField,
  const std::array<int, 3>& dimensions);

/// A grid of 2 x 2 x 2 points that holds all of a volume: of the field of zeros that stands in for
/// a deformation where there is none.
DEFORMVOLUME_EXPORT ImageGeometry GetGridAtRest(const ImageGeometry& volume);

/// Sets how a field treats voxels outside it. spacing: of its points, in world units.
DEFORMVOLUME_EXPORT void SetOutside(
  const OutsideVoxels& outside, const glm::dvec3& spacing, DisplacementField& field);

} // namespace deformvolume

#endif
