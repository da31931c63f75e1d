// SPDX-License-Identifier: BSD-3-Clause
// Makes and checks closed triangle surfaces for TetGen.
#ifndef DeformVolumeClosedSurface_h
#define DeformVolumeClosedSurface_h

#include "Error.h"

#include "vtkSmartPointer.h"

class vtkPolyData;

namespace deformvolume
{

/// Converts a surface to triangles in double precision, with coincident points merged, and without
/// unused points. Throws Error if a polygon uses a point that does not exist or is not finite.
vtkSmartPointer<vtkPolyData> CleanTriangles(vtkPolyData* surface);

/// Throws Error if a surface of triangles is empty, flat, not closed or not manifold. TetGen
/// crashes with such surfaces.
void CheckClosedSurface(vtkPolyData* surface);

/// Whether every edge belongs to exactly two triangles.
bool IsClosedManifold(vtkPolyData* surface);

/// Returns the surface with fewer triangles, whose edges have about the given length, also where
/// the surface is flat. Returns the surface itself if its edges are that long already, and null if
/// the decimated surface is not a closed manifold.
vtkSmartPointer<vtkPolyData> Decimate(vtkPolyData* surface, double edgeLength);

/// Returns the surface with edges that are split until none is longer than the given length.
vtkSmartPointer<vtkPolyData> SplitLongEdges(vtkPolyData* surface, double edgeLength);

} // namespace deformvolume

#endif
