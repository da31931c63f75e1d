// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVisiblePositions_h
#define DeformVolumeVisiblePositions_h

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <vector>

class vtkImageData;
class vtkPiecewiseFunction;
class vtkRenderer;

namespace deformvolume
{

/// The line that a viewer sees through a pixel, from the near to the far clipping plane.
struct LineOfSight
{
  glm::dvec3 Near;
  glm::dvec3 Far;
};

///@{
/// Convert between display coordinates (pixels, and a depth from 0 to 1) and world coordinates.
glm::dvec3 DisplayToWorld(vtkRenderer* renderer, double x, double y, double z);
glm::dvec3 WorldToDisplay(vtkRenderer* renderer, const glm::dvec3& position);
LineOfSight GetLineOfSight(vtkRenderer* renderer, int x, int y);
///@}

struct SlicePlane
{
  glm::dvec3 Point;
  glm::dvec3 Normal;
};

///@{
/// Each returns the voxel on a line of sight that is visible in an output of vtkDeformVolumeFilter,
/// or -1. Voxels outside the deformed volume are not visible.

/// The first voxel after which at least half of the absorbed light has been absorbed; -1 if all
/// voxels together absorb less than a tenth of the light. opacity: opacity per unitDistance; null:
/// each voxel is opaque.
vtkIdType FindAbsorbingVoxel(
  vtkImageData* image, const LineOfSight& line, vtkPiecewiseFunction* opacity, double unitDistance);

/// The first voxel whose value is at least the isovalue.
vtkIdType FindSurfaceVoxel(vtkImageData* image, const LineOfSight& line, double isovalue);

/// The first voxel on one of the planes.
vtkIdType FindSliceVoxel(
  vtkImageData* image, const LineOfSight& line, const std::vector<SlicePlane>& planes);
///@}

} // namespace deformvolume

#endif
