// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeInputUpdate_h
#define DeformVolumeInputUpdate_h

#include "vtkType.h"

#include <utility>
#include <vector>

class vtkAlgorithm;
class vtkDataObject;
class vtkInformation;

namespace deformvolume
{

/// Brings what is connected to an input port up to date, whole, at a time or, where that is null,
/// at the time asked for at the output, and returns it; null where nothing is connected. Meant for
/// the information pass: a whole extent may depend on the data of an input.
vtkDataObject* UpdateInput(
  vtkAlgorithm* filter, int port, vtkInformation* output, const double* time);

/// Asks an input for all of its data, whatever part of the output is asked for.
void RequestWhole(vtkInformation* input);

/// The producer of an input and the time of the last change up to it.
std::pair<const void*, vtkMTimeType> GetInputStamp(vtkAlgorithm* filter, int port);

/// The times at which an input can differ: its steps, or the ends of its range where it has no
/// steps; none for one that does not vary.
std::vector<double> GetTimes(vtkInformation* input);

/// Gives the output the time steps and the range of all inputs.
void MergeTimes(vtkAlgorithm* filter, vtkInformation* output);

} // namespace deformvolume

#endif
