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

/// From where to where a viewer looks through a pixel.
struct LineOfSight
{
  glm::dvec3 Near;
  glm::dvec3 Far;
};

///@{
/// Between pixels, with their depth from 0 to 1, and the world.
glm::dvec3 GetWorld(vtkRenderer* renderer, double x, double y, double z);
glm::dvec3 GetDisplay(vtkRenderer* renderer, const glm::dvec3& position);
LineOfSight GetLineOfSight(vtkRenderer* renderer, int x, int y);
///@}

struct SlicePlane
{
  glm::dvec3 Point;
  glm::dvec3 Normal;
};

///@{
/// Each finds the voxel on a line of sight that is first visible in an output of
/// vtkDeformVolumeFilter, among those that the body covers; -1 where there is none.

/// Where voxels have absorbed half of what all of them absorb, or half of all light. opacity: of
/// a way of unitDistance; null: each voxel absorbs everything.
vtkIdType FindAbsorbingVoxel(
  vtkImageData* image, const LineOfSight& line, vtkPiecewiseFunction* opacity, double unitDistance);

/// Where the value is isovalue or more.
vtkIdType FindSurfaceVoxel(vtkImageData* image, const LineOfSight& line, double isovalue);

/// Where one of the planes is.
vtkIdType FindSliceVoxel(
  vtkImageData* image, const LineOfSight& line, const std::vector<SlicePlane>& planes);
///@}

} // namespace deformvolume

#endif
