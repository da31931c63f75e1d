// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCubeFifths_h
#define DeformVolumeCubeFifths_h

#include "ElasticBody.h"
#include "Watch.h"

namespace deformvolume
{

/// The edge of the cubes, in m, of a mesh whose tetrahedra are all fifths of equal cubes: a corner
/// with three edges of the cube, or the middle of six diagonals of its faces. Edges may differ by a
/// thousandth. Otherwise an Error names the first other tetrahedron.
double FindCubeEdge(Watch& watch, const ElasticBody& body);

} // namespace deformvolume

#endif
