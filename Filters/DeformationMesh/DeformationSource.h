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

/// The input of a deformation, and the grids that it is converted to.
struct DeformationSource
{
  /// The deformation and its mesh at rest; Rest may be null.
  vtkDataObject* Shape = nullptr;
  vtkDataObject* Rest = nullptr;
  /// The grids of Shape and Rest if they are meshes.
  MeshParts ShapeParts;
  MeshParts RestParts;
  /// Derived nodes that the cells of these grids use already (see ReadCells()), or null.
  const DerivedNodes* Derived = nullptr;
  /// Whether a filter has made Shape or Rest. False for data that were set directly (see
  /// MeshStamp).
  bool ShapeIsMade = false;
  bool RestIsMade = false;
  /// Finds the array of displacements. Wanted describes it in messages. Choice differs for
  /// different arrays.
  ArraySelector Selector;
  std::string Wanted;
  std::string Choice;
  double DisplacementScale = 1.0;
  /// Whether the points of the mesh are deformed. ShapeParts have the points at rest also then.
  bool PointsAreDeformed = false;
  /// Whether a field leads from the output to the volume at rest.
  bool FieldIsInverse = false;
  ImageGeometry Volume;
  /// The full name of a device that reads vectors in its own memory without a copy; empty: none.
  std::string Device;
  /// From indices of the volume to those of the output.
  OutputMap ToOutput;

  /// The grids with the positions at rest.
  const MeshParts& GetRestParts() const { return this->Rest ? this->RestParts : this->ShapeParts; }
};

/// Throws an Error if the inputs and settings do not match.
void CheckSource(const DeformationSource& source);

} // namespace deformvolume

#endif
