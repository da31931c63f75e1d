// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelSize_h
#define DeformVolumeVoxelSize_h

#include "vtkImageData.h"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <algorithm>

namespace deformvolume
{

/// Returns the distance of neighboring voxels on each axis, in world units. A spacing can be
/// negative; this is its absolute value.
inline glm::dvec3 GetVoxelSize(vtkImageData* image)
{
  const double* spacing = image->GetSpacing();
  return glm::abs(glm::dvec3(spacing[0], spacing[1], spacing[2]));
}

///@{
/// Return the distance of neighboring voxels on the axis where it is the smallest or the largest.
inline double GetSmallestVoxelSize(vtkImageData* image)
{
  const glm::dvec3 size = GetVoxelSize(image);
  return std::min({ size.x, size.y, size.z });
}
inline double GetLargestVoxelSize(vtkImageData* image)
{
  const glm::dvec3 size = GetVoxelSize(image);
  return std::max({ size.x, size.y, size.z });
}
///@}

} // namespace deformvolume

#endif
