// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeInputUpdate_h
#define DeformVolumeInputUpdate_h

#include "Extent.h"
#include "Ranks.h"

#include "vtkType.h"

#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

class vtkAlgorithm;
class vtkDataObject;
class vtkInformation;
class vtkInformationVector;

namespace deformvolume
{

/// Updates an input and returns its data; null if nothing is connected. time: the time step to
/// request; null: the one that is requested from the output. Each rank gets the whole of an image,
/// and its piece of other data. For the information pass, since a whole extent may depend on the
/// data of an input. Throws an Error on all ranks if a source fails. Collective.
vtkDataObject* UpdateInput(
  vtkAlgorithm* filter, int port, vtkInformation* output, const double* time, const Ranks& ranks);

/// For the pass for update extents: requests the data that UpdateInput() returns, which are the
/// whole of an image, or the piece of this rank of other data. The request does not depend on the
/// requested part of the output.
void RequestInput(vtkInformation* input, const Ranks& ranks);

/// Requests an extent as one piece without ghost levels.
void RequestExtent(vtkInformation* input, const Extent& extent);

/// Requests no voxel of an image: an empty extent at the lower corner of the whole extent. An empty
/// extent at 0 would be an error if the whole extent begins elsewhere.
void RequestNothing(vtkInformation* input);

/// Updates the inputs of the first ports as requested. The executive would do the same, but if a
/// source fails on one rank, the executive ends the data pass on that rank only. Throws an Error on
/// all ranks. Collective.
void UpdateRequested(
  vtkAlgorithm* filter, int ports, vtkInformationVector** input, const Ranks& ranks);

/// The requested part of the output in the pass for update extents: the requested piece of the
/// update extent, with ghost levels.
Extent GetRequestedPart(vtkInformation* output);

/// Whether all producers upstream of an image port can produce a part of the image. A source has to
/// announce this with CAN_PRODUCE_SUB_EXTENT. Filters from images to images are assumed to be able
/// to, except for cuts and carvings.
bool CanProduceParts(vtkAlgorithm* filter, int port);

/// Whether the data of a port were set directly, so that the whole data are in memory.
bool IsInMemory(vtkAlgorithm* filter, int port);

/// The data of a port, and the last modification time of the data object itself, if the data were
/// set directly. A program that has written values of an array may have called Modified() of the
/// data object only. Data that a source makes have the time 0: the source marks what it writes.
std::pair<const void*, vtkMTimeType> GetWrittenStamp(vtkAlgorithm* filter, int port);

/// For ComputePipelineMTime: the last modification time of the filter, and of all input data that
/// were set directly, with their blocks and coordinates. The time of a composite data set does not
/// include its blocks, and that of a vtkRectilinearGrid does not include its coordinates.
vtkMTimeType GetMTimeWithInputs(vtkAlgorithm* filter);

///@{
/// For filters that keep data of the last execution. The executive would split composite data into
/// blocks, and execute such a filter for each. AcceptBlocks(), for FillInputPortInformation(),
/// keeps the executive from that. RefuseBlocks() throws an Error if one of the first ports has
/// composite data.
void AcceptBlocks(vtkInformation* port);
void RefuseBlocks(int ports, vtkInformationVector** input);
///@}

/// The connection of an input, and the last modification time of the pipeline upstream of it.
std::pair<const void*, vtkMTimeType> GetInputStamp(vtkAlgorithm* filter, int port);

/// The time to request from the inputs of the ports from first to before last in the information
/// pass: that of the output, or else the first time of inputs that need a requested one. Empty: the
/// inputs have no times, or choose one.
std::optional<double> FindTime(vtkAlgorithm* filter, int first, int last, vtkInformation* output);

/// Updates a part of the image on an input port, at the time of FindTime().
vtkDataObject* UpdateInputPart(
  vtkAlgorithm* filter, int port, vtkInformation* output, const Extent& part, const Ranks& ranks);

/// The times that an input announces: its time steps, or else the two ends of its time range. Empty
/// if it announces no times.
std::vector<double> GetTimes(vtkInformation* input);

/// Sets the time steps and the time range of the output to the union of those of the first ports.
void MergeTimes(vtkAlgorithm* filter, int ports, vtkInformation* output);

/// Throws an Error if a source upstream of one of the first ports gave another time than that of
/// the output: the source is also upstream of another input, which needs that time.
void CheckTimes(int ports, vtkInformationVector** input, vtkInformation* output);

/// Sets the time step of the output data to the requested one if the output has times, or else to
/// that of the first input that has one. Inputs may be null.
void SetTimeStep(
  vtkDataObject* data, vtkInformation* output, std::initializer_list<vtkDataObject*> inputs);

} // namespace deformvolume

#endif
