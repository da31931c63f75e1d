// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldBoxes_h
#define DeformVolumeWorldBoxes_h

#include "DeformVolumeExport.h"

#include <string>

namespace deformvolume
{

struct ImageGeometry;
struct MeshAtRest;

/// Where a displacement field and the volume that it is given for lie in the world, in words for an
/// error.
DEFORMVOLUME_EXPORT std::string DescribeBoxes(
  const ImageGeometry& field, const ImageGeometry& volume);

/// Throws an Error where the boxes of a mesh at rest and of the volume do not meet.
DEFORMVOLUME_EXPORT void CheckBoxes(const MeshAtRest& mesh, const ImageGeometry& volume);

/// What is wrong where no voxel lies in a mesh at rest.
DEFORMVOLUME_EXPORT std::string DescribeMiss(const MeshAtRest& mesh, const ImageGeometry& volume);

} // namespace deformvolume

#endif
