// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBodyCoverage_h
#define DeformVolumeBodyCoverage_h

#include "BodyVoxels.h"

class vtkImageData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// Voxels whose centres lie in no tetrahedron.
struct UncoveredVoxels
{
  vtkIdType OfMeshed = 0; // of pieces that are to be meshed
  vtkIdType OfBody = 0;   // of pieces that are no specks, those left out included
  vtkIdType OfSpecks = 0;
};

/// Looks each voxel of the body up in a mesh of tetrahedra. Positions are rounded to 1/256 of a
/// voxel.
UncoveredVoxels FindUncovered(
  vtkUnstructuredGrid* mesh, vtkImageData* volume, const BodyVoxels& body);

} // namespace deformvolume

#endif
