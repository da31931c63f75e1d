// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorChoice_h
#define DeformVolumeVectorChoice_h

#include "Deformation.h"

#include <functional>

class vtkDataArray;
class vtkDataObject;
class vtkDataSet;
class vtkInformation;

namespace deformvolume
{

/// vtkAlgorithm::GetInputArrayToProcess() of a filter, for the choice of its displacements.
using ArrayFinder = std::function<vtkDataArray*(vtkDataSet* dataSet, int& association)>;

/// Sets how a source finds its displacements: by what was chosen with SetInputArrayToProcess().
/// choice: GetInputArrayInformation() of it.
void ChooseVectors(DeformationSource& source, vtkInformation* choice, const ArrayFinder& find);

/// What filters that take a deformation are told of it. Throws an Error where DisplacementScale is
/// not finite. rest: null where port 2 is not connected.
struct DeformationSettings
{
  double DisplacementScale = 1.0;
  bool PointsAreDeformed = false;
  bool FieldIsInverse = false;
};
DeformationSource ChooseDeformation(vtkDataObject* shape, vtkDataObject* rest,
  vtkInformation* choice, const ArrayFinder& find, const DeformationSettings& settings);

/// What port 1, or port 2, of such a filter takes.
void FillDeformationPort(int port, vtkInformation* info);

/// For filters with nothing on port 1 but something on port 2.
[[noreturn]] void ThrowRestAlone();

} // namespace deformvolume

#endif
