// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformationChoice_h
#define DeformVolumeDeformationChoice_h

#include "DeformationSource.h"
#include "Fading.h"

#include <functional>

class vtkDataArray;
class vtkDataObject;
class vtkDataSet;
class vtkInformation;

namespace deformvolume
{

/// vtkAlgorithm::GetInputArrayToProcess() of a filter, for the choice of its displacements.
using ArrayFinder = std::function<vtkDataArray*(vtkDataSet* dataSet, int& association)>;

/// The settings of filters with a deformation as an input.
struct DeformationSettings
{
  double DisplacementScale = 1.0;
  bool PointsAreDeformed = false;
  bool FieldIsInverse = false;
};
/// Makes a source with these settings, and with the displacements that SetInputArrayToProcess() has
/// selected. choice: GetInputArrayInformation() of the filter. rest: null if it is not connected.
/// Throws an Error if DisplacementScale is not finite.
DeformationSource ChooseDeformation(vtkDataObject* shape, vtkDataObject* rest,
  vtkInformation* choice, const ArrayFinder& find, const DeformationSettings& settings);

/// Throws an Error if the scale is not finite.
void CheckDisplacementScale(double scale);

/// Converts the properties OutsideMode and FadeDistance of the filters. Throws an Error if
/// OutsideMode is KEEP and FadeDistance is negative or not finite.
OutsideVoxels MakeOutsideVoxels(int outsideMode, double fadeDistance);

/// Sets the data types of the ports for the deformation and for the mesh at rest.
void FillDeformationPort(vtkInformation* info);

/// Throws the Error of filters with a mesh at rest but no deformation. The numbers are those
/// of the input ports.
[[noreturn]] void ThrowRestWithoutDeformation(int restPort, int deformationPort);

} // namespace deformvolume

#endif
