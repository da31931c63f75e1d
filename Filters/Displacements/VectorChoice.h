// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorChoice_h
#define DeformVolumeVectorChoice_h

#include "DeformationSource.h"

#include <functional>

class vtkDataArray;
class vtkDataObject;
class vtkDataSet;
class vtkInformation;

namespace deformvolume
{

/// vtkAlgorithm::GetInputArrayToProcess() of a filter, for the choice of its displacements.
using ArrayFinder = std::function<vtkDataArray*(vtkDataSet* dataSet, int& association)>;

/// The settings of filters that take a deformation.
struct DeformationSettings
{
  double DisplacementScale = 1.0;
  bool PointsAreDeformed = false;
  bool FieldIsInverse = false;
};
/// A deformation with such settings, and the displacements that were chosen with
/// SetInputArrayToProcess(): choice is what GetInputArrayInformation() gives of it. Throws an Error
/// where DisplacementScale is not finite. rest: null where it is not connected.
DeformationSource ChooseDeformation(vtkDataObject* shape, vtkDataObject* rest,
  vtkInformation* choice, const ArrayFinder& find, const DeformationSettings& settings);

/// Throws an Error where it is not finite.
void CheckDisplacementScale(double scale);

/// What a port for the deformation takes, or one for its rest configuration.
void FillDeformationPort(bool isRest, vtkInformation* info);

/// For filters with nothing on port 1 but something on port 2.
[[noreturn]] void ThrowRestAlone();

} // namespace deformvolume

#endif
