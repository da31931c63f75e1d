// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorChoice_h
#define DeformVolumeVectorChoice_h

#include "Deformation.h"

#include <functional>

class vtkDataArray;
class vtkDataSet;
class vtkInformation;

namespace deformvolume
{

/// vtkAlgorithm::GetInputArrayToProcess() of a filter, for the choice of its displacements.
using ArrayFinder = std::function<vtkDataArray*(vtkDataSet* dataSet, int& association)>;

/// Sets how a source finds its displacements: by what was chosen with SetInputArrayToProcess().
/// choice: GetInputArrayInformation() of it.
void ChooseVectors(DeformationSource& source, vtkInformation* choice, const ArrayFinder& find);

} // namespace deformvolume

#endif
