// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBodyCoverage_h
#define DeformVolumeBodyCoverage_h

#include "BodyVoxels.h"

#include <vector>

class vtkUnstructuredGrid;

namespace deformvolume
{

/// Voxels whose centers lie in no tetrahedron.
struct UncoveredVoxels
{
  std::vector<glm::dvec3> OfMeshed; // positions of such voxels in pieces that are meshed
  vtkIdType OfBody = 0;             // number of such voxels in all pieces except specks
};

/// Finds the voxels of the body that are not in a mesh of tetrahedra. Positions are offsets from
/// the first voxel, in world units. They are rounded to 1/256 of a voxel.
UncoveredVoxels FindUncovered(vtkUnstructuredGrid* mesh, const BodyVoxels& body);

} // namespace deformvolume

#endif
