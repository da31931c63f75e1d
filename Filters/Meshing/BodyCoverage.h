// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBodyCoverage_h
#define DeformVolumeBodyCoverage_h

#include "BodyVoxels.h"

#include <vector>

class vtkUnstructuredGrid;

namespace deformvolume
{

/// Voxels whose centres lie in no tetrahedron.
struct UncoveredVoxels
{
  std::vector<glm::dvec3> OfMeshed; // positions of those of pieces that are to be meshed
  vtkIdType OfBody = 0;             // of pieces that are no specks, those left out included
};

/// Looks each voxel of the body up in a mesh of tetrahedra. Positions are offsets from the first
/// voxel in world units, and rounded to 1/256 of a voxel.
UncoveredVoxels FindUncovered(vtkUnstructuredGrid* mesh, const BodyVoxels& body);

} // namespace deformvolume

#endif
