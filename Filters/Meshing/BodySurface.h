// SPDX-License-Identifier: BSD-3-Clause
// The surface of a body of voxels, as a closed triangle mesh.
#ifndef DeformVolumeBodySurface_h
#define DeformVolumeBodySurface_h

#include "BodyLevelSet.h"

#include "vtkSmartPointer.h"

class vtkPolyData;

namespace deformvolume
{

/// The surface on which the values are 0, in the positions of the grid: closed, of triangles, as a
/// manifold, without points that coincide.
vtkSmartPointer<vtkPolyData> ExtractSurface(const BodyLevelSet& grid);

/// The surface after so many iterations of windowed-sinc smoothing, 0: as it is.
vtkSmartPointer<vtkPolyData> Smooth(vtkPolyData* surface, int iterations);

} // namespace deformvolume

#endif
