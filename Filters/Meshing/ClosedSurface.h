// SPDX-License-Identifier: BSD-3-Clause
// Closed triangle surfaces: what TetGen needs, and what it must not be given.
#ifndef DeformVolumeClosedSurface_h
#define DeformVolumeClosedSurface_h

#include "Error.h"

#include "vtkSmartPointer.h"

class vtkPolyData;

namespace deformvolume
{

/// Triangles only, coincident points merged, unused points dropped, double precision. Throws Error
/// where a point is not finite.
vtkSmartPointer<vtkPolyData> CleanTriangles(vtkPolyData* surface);

/// Throws Error unless these triangles are some, closed, manifold and not flat. TetGen ends by a
/// crash on anything else.
void CheckClosedSurface(vtkPolyData* surface);

/// Whether every edge belongs to exactly two triangles.
bool IsClosedManifold(vtkPolyData* surface);

/// The surface with fewer triangles, so that their edges have about the length, or as it is where
/// they are that long already. Null where decimation does not keep it a closed manifold.
vtkSmartPointer<vtkPolyData> Decimate(vtkPolyData* surface, double edgeLength);

/// The same surface with edges no longer than the length.
vtkSmartPointer<vtkPolyData> SplitLongEdges(vtkPolyData* surface, double edgeLength);

} // namespace deformvolume

#endif
