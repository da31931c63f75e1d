// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldBoxes_h
#define DeformVolumeWorldBoxes_h

#include "DeformVolumeExport.h"

#include <string>

namespace deformvolume
{

struct ImageGeometry;
struct MeshAtRest;

/// Returns the world boxes of a displacement field and of the volume, as text for an error.
DEFORMVOLUME_EXPORT std::string DescribeBoxes(
  const ImageGeometry& field, const ImageGeometry& volume);

/// Throws an Error if the boxes of a mesh at rest and of the volume do not intersect.
DEFORMVOLUME_EXPORT void CheckBoxes(const MeshAtRest& mesh, const ImageGeometry& volume);

/// Returns a warning if a displacement field is so small that its unit is probably not that of the
/// volume: on each axis of the volume smaller than two voxels, and than a fourth of the volume.
/// Returns "" if it is not.
DEFORMVOLUME_EXPORT std::string GetSizeWarning(
  const ImageGeometry& field, const ImageGeometry& volume);
/// Returns such a warning for a mesh at rest, or one if its first tetrahedron is more than ten
/// times as long as the volume on each axis.
DEFORMVOLUME_EXPORT std::string GetSizeWarning(const MeshAtRest& mesh, const ImageGeometry& volume);

/// Returns a warning if single precision rounds rest positions in a volume by more than 1/256
/// voxel, because it is far from the origin; otherwise "".
DEFORMVOLUME_EXPORT std::string GetRoundingWarning(const ImageGeometry& volume);
/// Returns a warning if the points of a mesh, which are floats, are rounded by more than that, and
/// the mesh ends by less than the rounding before the outermost voxels; otherwise "".
DEFORMVOLUME_EXPORT std::string GetRoundingWarning(
  const MeshAtRest& mesh, const ImageGeometry& volume);

/// Returns the text of the error that a mesh at rest contains no voxel.
DEFORMVOLUME_EXPORT std::string DescribeMissedVolume(
  const MeshAtRest& mesh, const ImageGeometry& volume);

} // namespace deformvolume

#endif
