// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeInputUpdate_h
#define DeformVolumeInputUpdate_h

#include "Extent.h"
#include "Ranks.h"

#include "vtkType.h"

#include <initializer_list>
#include <utility>
#include <vector>

class vtkAlgorithm;
class vtkDataObject;
class vtkInformation;
class vtkInformationVector;

namespace deformvolume
{

/// Brings what is connected to an input port up to date, at a time or, where that is null, at the
/// time asked for at the output, and returns it; null where nothing is connected. Of an image each
/// rank gets all, of other data its piece. Meant for the information pass: a whole extent may
/// depend on the data of an input. Throws an Error, on all ranks, where a source fails. Collective.
vtkDataObject* UpdateInput(
  vtkAlgorithm* filter, int port, vtkInformation* output, const double* time, const Ranks& ranks);

/// Asks an input for the same: all of an image, of other data the piece of this rank, whatever part
/// of the output is asked for.
void RequestInput(vtkInformation* input, const Ranks& ranks);

/// Asks an input for an extent, and for nothing else.
void RequestExtent(vtkInformation* input, const Extent& extent);

/// Asks an image for no voxel, at the lower corner of its whole extent: where that does not begin
/// at 0, an empty extent there would be an error of its own.
void RequestNothing(vtkInformation* input);

/// Brings the inputs of the first ports up to date with what they have been asked for. The
/// executive would do it, too; but where a source fails on one rank, the executive ends the data
/// pass on that rank alone. Throws an Error, on all ranks. Collective.
void UpdateRequested(
  vtkAlgorithm* filter, int ports, vtkInformationVector** input, const Ranks& ranks);

/// The part of the output that is asked for while requests go upstream: of the extent the piece,
/// with its ghost levels.
Extent GetRequestedPart(vtkInformation* output);

/// Whether all that an image port's data come from can make a part of it. That a source can, it has
/// to say itself (CAN_PRODUCE_SUB_EXTENT); filters from images to images can.
bool CanProduceParts(vtkAlgorithm* filter, int port);

/// Whether an image port has its data already, as a whole.
bool IsInMemory(vtkAlgorithm* filter, int port);

/// The producer of an input and the time of the last change up to it.
std::pair<const void*, vtkMTimeType> GetInputStamp(vtkAlgorithm* filter, int port);

/// Brings a part of the image on an input port up to date, like UpdateInput() at the output's time.
vtkDataObject* UpdateInputPart(
  vtkAlgorithm* filter, int port, vtkInformation* output, const Extent& part, const Ranks& ranks);

/// The times that an input announces: its steps, or the ends of its range where it has no steps;
/// none for one that does not vary.
std::vector<double> GetTimes(vtkInformation* input);

/// Gives the output the time steps and the range of the inputs of the first ports.
void MergeTimes(vtkAlgorithm* filter, int ports, vtkInformation* output);

/// Gives output data the time asked for, or else that of the first input that has one. Inputs may
/// be null.
void SetTimeStep(
  vtkDataObject* data, vtkInformation* output, std::initializer_list<vtkDataObject*> inputs);

} // namespace deformvolume

#endif
