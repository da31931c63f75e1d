// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCubeFifths_h
#define DeformVolumeCubeFifths_h

#include "ElasticBody.h"
#include "Watch.h"

namespace deformvolume
{

/// Returns the cube edge, in m, of a mesh whose tetrahedra are the five tetrahedra of equal cubes.
/// Each tetrahedron has either three edges of the cube that meet at a corner, or six face
/// diagonals. Edge lengths may deviate by a thousandth. Throws an Error with the number of the
/// first tetrahedron that has another shape or size.
double FindCubeEdge(Watch& watch, const ElasticBody& body);

} // namespace deformvolume

#endif
