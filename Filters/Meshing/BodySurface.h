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
  double Resolution = 0.0; // approximate spacing of the grid, in world units
  double Margin = 0.0;     // world units
  int SmoothingIterations = 0;
  double DecimatedLength = 0.0; // edge length after decimation, in world units; 0: no decimation
  bool WholeCells = false; // whether all grid cells that contain the center of a voxel are inside
};

/// The isosurface of the distance from the meshed pieces of a body on a grid that is coarser than
/// the volume: closed and without cavities. It does not intersect itself, unless it is smoothed or
/// decimated. With WholeCells it encloses the body, with the same exceptions. Throws
/// SurfaceRejected if decimation fails, and Error if the grid is too large.
vtkSmartPointer<vtkPolyData> MakeBodySurface(
  const BodyVoxels& body, const SurfaceParameters& parameters);

/// Moves vertices of a surface outwards, towards positions that lie outside. After enough calls the
/// positions lie inside, at the distance `beyond` from the surface. Throws SurfaceRejected if a
/// position is farther away than `limit`.
void GrowAround(
  vtkPolyData* surface, const std::vector<glm::dvec3>& outside, double beyond, double limit);

/// Returns the surface with each vertex moved inwards by a distance.
vtkSmartPointer<vtkPolyData> Shrink(vtkPolyData* surface, double distance);

} // namespace deformvolume

#endif
