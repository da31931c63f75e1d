// SPDX-License-Identifier: BSD-3-Clause
// The surface of a body of voxels, as a closed triangle mesh. Positions are offsets from the first
// voxel, along the axes of the volume, in world units.
#ifndef DeformVolumeBodySurface_h
#define DeformVolumeBodySurface_h

#include "BodyVoxels.h"

#include "vtkSmartPointer.h"

#include <vector>

class vtkPolyData;

namespace deformvolume
{

struct SurfaceParameters
{
  double Resolution = 0.0; // about the distance of the nodes of the grid, world units
  double Margin = 0.0;     // world units
  int SmoothingIterations = 0;
  double DecimatedLength = 0.0; // of the edges, in world units; 0: no decimation
  bool WholeCells = false;      // whether all cells of the grid that hold a voxel are inside
};

/// The isosurface of the distance from the meshed pieces of a body on a grid that is coarser than
/// the volume: closed and without cavities. It does not intersect itself, unless it is smoothed or
/// decimated. With WholeCells it encloses the body, with the same exceptions. Throws
/// SurfaceRejected where decimation fails, and Error where the grid is too large.
vtkSmartPointer<vtkPolyData> MakeBodySurface(
  const BodyVoxels& body, const SurfaceParameters& parameters);

/// Moves vertices of a surface outwards, so that it comes closer to enclosing these positions,
/// which lie outside. After enough calls they lie inside, at the distance `beyond`. Throws
/// SurfaceRejected where one is farther away than `limit`.
void GrowAround(
  vtkPolyData* surface, const std::vector<glm::dvec3>& outside, double beyond, double limit);

/// The same surface with each vertex so far inwards.
vtkSmartPointer<vtkPolyData> Shrink(vtkPolyData* surface, double distance);

} // namespace deformvolume

#endif
