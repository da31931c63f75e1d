// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldGeometry_h
#define DeformVolumeFieldGeometry_h

#include "DeformVolumeExport.h"
#include "Extent.h"
#include "FieldPointMap.h"
#include "ImageGeometry.h"
#include "VoxelGrid.h"

#include <array>

namespace deformvolume
{

/// Returns DisplacementField::IndexToField of a field for a volume. toOutput: for an inverse field,
/// whose matrix takes indices of the output, the map from the volume to the output; null for a
/// forward field.
DEFORMVOLUME_EXPORT std::array<double, 12> GetIndexToField(
  const ImageGeometry& field, const ImageGeometry& volume, const OutputMap* toOutput);

/// Returns a grid of 2 x 2 x 2 points that contains a volume. A field of zeros on this grid is used
/// if there is no deformation.
DEFORMVOLUME_EXPORT ImageGeometry GetGridAtRest(const ImageGeometry& volume);

/// Returns a field of points in world coordinates, which needs vectors.
DEFORMVOLUME_EXPORT WorldField MakeWorldField(const ImageGeometry& grid);

} // namespace deformvolume

#endif
