// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformationSource_h
#define DeformVolumeDeformationSource_h

#include "DeformationMesh.h"
#include "DerivedNodes.h"
#include "ImageGeometry.h"
#include "VoxelGrid.h" // for OutputMap

#include <string>

class vtkDataObject;

namespace deformvolume
{

/// Where a deformation comes from, and where it is wanted.
struct DeformationSource
{
  /// What is connected to port 1, and to port 2 or null.
  vtkDataObject* Shape = nullptr;
  vtkDataObject* Rest = nullptr;
  /// Their grids, where they are meshes.
  MeshParts ShapeParts;
  MeshParts RestParts;
  /// Derived nodes that their cells name already (see ReadCells), or null.
  const DerivedNodes* Derived = nullptr;
  /// Whether a filter makes these, and they are not data that somebody holds (see MeshStamp).
  bool ShapeIsMade = false;
  bool RestIsMade = false;
  /// Finds the displacements; Wanted names them in words, Choice tells two choices apart.
  ArraySelector Selector;
  std::string Wanted;
  std::string Choice;
  double DisplacementScale = 1.0;
  /// Whether the mesh is given by its deformed points; the grids above are at rest all the same.
  bool PointsAreDeformed = false;
  /// Whether a field leads from the output to the volume at rest.
  bool FieldIsInverse = false;
  ImageGeometry Volume;
  /// The whole name of a device with memory of its own that takes vectors where they lie there;
  /// empty: there is none.
  std::string Device;
  /// From indices of the volume to those of the output.
  OutputMap ToOutput;

  /// The grids that have the rest positions.
  const MeshParts& GetRestParts() const { return this->Rest ? this->RestParts : this->ShapeParts; }
};

/// Throws an Error where what is connected does not go together.
void CheckSource(const DeformationSource& source);

} // namespace deformvolume

#endif
