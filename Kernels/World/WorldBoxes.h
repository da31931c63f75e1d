// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldBoxes_h
#define DeformVolumeWorldBoxes_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"

#include <functional>
#include <string>

namespace deformvolume
{

struct ImageGeometry;
struct MeshAtRest;
struct OutsideVoxels;

/// Returns the world boxes of a displacement field and of the volume, as text for an error.
DEFORMVOLUME_EXPORT std::string DescribeBoxes(
  const ImageGeometry& field, const ImageGeometry& volume);

/// Throws an Error if the boxes of a mesh at rest and of the volume do not intersect.
DEFORMVOLUME_EXPORT void CheckBoxes(const MeshAtRest& mesh, const ImageGeometry& volume);

/// Returns a warning if the unit of a displacement field is probably not that of the volume: if the
/// field is, on each axis of the volume, smaller than two voxels and than a fourth of the volume,
/// or more than a hundred times as long as the volume. Returns "" otherwise, and if all vectors are
/// equal and all voxels have a vector. getField: returns the field; called only if its size is
/// unusual.
DEFORMVOLUME_EXPORT std::string GetSizeWarning(const ImageGeometry& field,
  const ImageGeometry& volume, const OutsideVoxels& outside,
  const std::function<DisplacementField()>& getField);
/// Returns such a warning for a mesh at rest that is so small, or if a tetrahedron is more than ten
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
