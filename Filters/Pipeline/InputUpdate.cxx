// SPDX-License-Identifier: BSD-3-Clause
#include "InputUpdate.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkElasticDeformation.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationIntegerRequestKey.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkRectilinearGrid.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTrivialProducer.h"
#include "vtkVolumeEditAlgorithm.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>

namespace deformvolume
{

using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{

std::array<vtkInformationIntegerKey*, 3> GetPieceKeys()
{
  return { { Pipeline::UPDATE_PIECE_NUMBER(), Pipeline::UPDATE_NUMBER_OF_PIECES(),
    Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS() } };
}

void RequestPiece(vtkInformation* request, int piece, int pieces)
{
  request->Set(Pipeline::UPDATE_PIECE_NUMBER(), piece);
  request->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), pieces);
  request->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
}

// Sets the request for an input: the whole extent if it announces one, else the piece of this rank.
void Request(vtkInformation* input, vtkInformation* request, const Ranks& ranks)
{
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    RequestPiece(request, 0, 1);
    request->Set(Pipeline::UPDATE_EXTENT(), input->Get(Pipeline::WHOLE_EXTENT()), 6);
  }
  else
  {
    RequestPiece(request, ranks.GetRank(), ranks.GetCount());
    request->Remove(Pipeline::UPDATE_EXTENT());
  }
}

// Updates an input. If the source fails on one rank, all ranks throw. Otherwise the other ranks
// would wait for the failed one.
vtkDataObject* Update(vtkAlgorithm* filter, int port, vtkInformation* request, const Ranks& ranks)
{
  const bool isVolume = vtkImageData::SafeDownCast(filter->GetInputDataObject(0, 0)) != nullptr;
  const char* const names[4] = { isVolume ? "volume" : "points", "deformation", "mesh at rest",
    "reference image" };
  vtkAlgorithmOutput* source = filter->GetInputConnection(port, 0);
  vtkNew<vtkInformationVector> requests;
  requests->SetNumberOfInformationObjects(source->GetIndex() + 1);
  requests->SetInformationObject(source->GetIndex(), request);
  const bool done = source->GetProducer()->Update(source->GetIndex(), requests) != 0;
  ranks.Attempt(
    [&]
    {
      if (!done)
      {
        throw Error(std::string("The source of the ") + names[port] + " on input port " +
          std::to_string(port) + " failed. Correct the error that the source reports.");
      }
    });
  return source->GetProducer()->GetOutputDataObject(source->GetIndex());
}

// The connection of a port; null if nothing is connected.
vtkAlgorithmOutput* FindSource(vtkAlgorithm* filter, int port)
{
  return filter->GetNumberOfInputConnections(port) > 0 ? filter->GetInputConnection(port, 0)
                                                       : nullptr;
}

vtkMTimeType GetTimeWithCoordinates(vtkDataObject* data)
{
  vtkMTimeType time = data->GetMTime();
  if (const auto grid = vtkRectilinearGrid::SafeDownCast(data))
  {
    for (vtkDataArray* array :
      { grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates() })
    {
      time = std::max(time, array ? array->GetMTime() : 0);
    }
  }
  return time;
}

// Whether a simulation is upstream of an algorithm, or is the algorithm itself.
bool IsSimulated(vtkAlgorithm* algorithm, int depth)
{
  constexpr int deepest = 1000;
  if (vtkElasticDeformation::SafeDownCast(algorithm))
  {
    return true;
  }
  for (int port = 0; port < algorithm->GetNumberOfInputPorts() && depth < deepest; ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
    {
      if (IsSimulated(algorithm->GetInputAlgorithm(port, i), depth + 1))
      {
        return true;
      }
    }
  }
  return false;
}

bool CanProduceParts(vtkAlgorithm* producer, int index, int depth)
{
  constexpr int deepest = 1000;
  if (vtkVolumeEditAlgorithm::SafeDownCast(producer))
  {
    return false; // edits belong to an extent, and are removed if another one is requested
  }
  vtkInformation* information = producer->GetOutputInformation(index);
  if ((information && information->Has(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT())) ||
    vtkTrivialProducer::SafeDownCast(producer))
  {
    return true;
  }
  int inputs = 0;
  for (int port = 0; port < producer->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < producer->GetNumberOfInputConnections(port); ++i, ++inputs)
    {
      vtkAlgorithmOutput* source = producer->GetInputConnection(port, i);
      if (depth > deepest || !vtkImageData::SafeDownCast(producer->GetInputDataObject(port, i)) ||
        !CanProduceParts(source->GetProducer(), source->GetIndex(), depth + 1))
      {
        return false;
      }
    }
  }
  return inputs > 0;
}

/// Restores the requested extents and pieces of all producers upstream of a connection. Without
/// that, an update of such a producer by itself, as by ParaView, would make the part again that was
/// requested last.
class RequestKeeper
{
public:
  explicit RequestKeeper(vtkAlgorithmOutput* source) { this->Keep(source); }
  ~RequestKeeper()
  {
    for (const auto& [request, before] : this->Kept)
    {
      Copy(before, request);
    }
  }
  RequestKeeper(const RequestKeeper&) = delete;
  RequestKeeper& operator=(const RequestKeeper&) = delete;

private:
  static void Copy(vtkInformation* from, vtkInformation* to)
  {
    to->CopyEntry(from, Pipeline::UPDATE_EXTENT());
    for (vtkInformationIntegerKey* key : GetPieceKeys())
    {
      to->CopyEntry(from, key);
    }
  }

  void Keep(vtkAlgorithmOutput* source)
  {
    vtkAlgorithm* producer = source->GetProducer();
    vtkInformation* request = producer->GetOutputInformation(source->GetIndex());
    if (!request || this->Kept.count(request) > 0)
    {
      return;
    }
    const auto before = vtkSmartPointer<vtkInformation>::New();
    Copy(request, before);
    this->Kept[request] = before;
    for (int port = 0; port < producer->GetNumberOfInputPorts(); ++port)
    {
      for (int i = 0; i < producer->GetNumberOfInputConnections(port); ++i)
      {
        this->Keep(producer->GetInputConnection(port, i));
      }
    }
  }

  std::map<vtkSmartPointer<vtkInformation>, vtkSmartPointer<vtkInformation>> Kept;
};

} // namespace

vtkDataObject* UpdateInput(
  vtkAlgorithm* filter, int port, vtkInformation* output, const double* time, const Ranks& ranks)
{
  if (filter->GetNumberOfInputConnections(port) == 0)
  {
    return nullptr;
  }
  vtkNew<vtkInformation> request;
  Request(filter->GetInputInformation(port, 0), request, ranks);
  if (time)
  {
    request->Set(Pipeline::UPDATE_TIME_STEP(), *time);
  }
  else
  {
    request->CopyEntry(output, Pipeline::UPDATE_TIME_STEP());
  }
  return Update(filter, port, request, ranks);
}

std::optional<double> FindTime(vtkAlgorithm* filter, int first, int last, vtkInformation* output)
{
  if (output->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    return output->Get(Pipeline::UPDATE_TIME_STEP());
  }
  std::optional<double> time;
  for (int port = first; port < last; ++port)
  {
    if (filter->GetNumberOfInputConnections(port) == 0)
    {
      continue;
    }
    vtkInformation* input = filter->GetInputInformation(port, 0);
    // A source of continuous times, such as vtkTemporalInterpolator, may fail without a time. A
    // reader has a current step, which a program may have chosen, and a simulation advances.
    if (!input->Has(Pipeline::TIME_STEPS()) && input->Has(Pipeline::TIME_RANGE()) &&
      !input->Has(Pipeline::UPDATE_TIME_STEP()) &&
      !IsSimulated(filter->GetInputAlgorithm(port, 0), 0))
    {
      const double begin = input->Get(Pipeline::TIME_RANGE())[0];
      time = std::min(time.value_or(begin), begin);
    }
  }
  return time;
}

vtkDataObject* UpdateInputPart(
  vtkAlgorithm* filter, int port, vtkInformation* output, const Extent& part, const Ranks& ranks)
{
  vtkNew<vtkInformation> request;
  RequestExtent(request, part);
  if (const std::optional<double> time = FindTime(filter, port, port + 1, output))
  {
    request->Set(Pipeline::UPDATE_TIME_STEP(), *time);
  }
  const RequestKeeper keeper(filter->GetInputConnection(port, 0));
  return Update(filter, port, request, ranks);
}

void UpdateRequested(
  vtkAlgorithm* filter, int ports, vtkInformationVector** input, const Ranks& ranks)
{
  for (int port = 0; port < ports; ++port)
  {
    if (input[port]->GetNumberOfInformationObjects() == 0)
    {
      continue;
    }
    vtkInformation* requested = input[port]->GetInformationObject(0);
    vtkNew<vtkInformation> request;
    for (vtkInformationIntegerKey* key : GetPieceKeys())
    {
      request->CopyEntry(requested, key);
    }
    request->CopyEntry(requested, Pipeline::UPDATE_EXTENT());
    request->CopyEntry(requested, Pipeline::UPDATE_TIME_STEP());
    Update(filter, port, request, ranks);
  }
}

void RequestInput(vtkInformation* input, const Ranks& ranks)
{
  Request(input, input, ranks);
}

void RequestExtent(vtkInformation* input, const Extent& extent)
{
  RequestPiece(input, 0, 1);
  input->Set(Pipeline::UPDATE_EXTENT(), extent.data(), 6);
}

void RequestNothing(vtkInformation* input)
{
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    Extent extent;
    input->Get(Pipeline::WHOLE_EXTENT(), extent.data());
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      extent[2 * axis + 1] = extent[2 * axis] - 1;
    }
    RequestExtent(input, extent);
  }
}

Extent GetRequestedPart(vtkInformation* output)
{
  Extent asked;
  output->Get(Pipeline::UPDATE_EXTENT(), asked.data());
  const auto get = [&](vtkInformationIntegerKey* key, int otherwise)
  { return output->Has(key) ? output->Get(key) : otherwise; };
  const int pieces = get(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  if (pieces <= 1 || GetNumberOfPoints(asked) == 0)
  {
    return asked;
  }
  // The executive computes the same extent before the data pass.
  const int mode = output->Has(vtkExtentTranslator::UPDATE_SPLIT_MODE())
    ? output->Get(vtkExtentTranslator::UPDATE_SPLIT_MODE())
    : vtkExtentTranslator::BLOCK_MODE;
  Extent part = asked;
  vtkNew<vtkExtentTranslator> translator;
  translator->PieceToExtentThreadSafe(get(Pipeline::UPDATE_PIECE_NUMBER(), 0), pieces,
    get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0), asked.data(), part.data(), mode, 0);
  return part;
}

bool CanProduceParts(vtkAlgorithm* filter, int port)
{
  vtkAlgorithmOutput* source = FindSource(filter, port);
  return source && CanProduceParts(source->GetProducer(), source->GetIndex(), 0);
}

bool IsInMemory(vtkAlgorithm* filter, int port)
{
  vtkAlgorithmOutput* source = FindSource(filter, port);
  return source && vtkTrivialProducer::SafeDownCast(source->GetProducer());
}

std::pair<const void*, vtkMTimeType> GetWrittenStamp(vtkAlgorithm* filter, int port)
{
  if (!IsInMemory(filter, port))
  {
    return { nullptr, 0 };
  }
  vtkDataObject* data = filter->GetInputDataObject(port, 0);
  return { data, data ? data->vtkObject::GetMTime() : 0 };
}

namespace
{

/// The last modification time of data that were set directly on a port, with their blocks and
/// coordinates; 0 for other inputs.
vtkMTimeType GetTimeOfData(vtkAlgorithm* filter, int port)
{
  vtkDataObject* data = IsInMemory(filter, port) ? filter->GetInputDataObject(port, 0) : nullptr;
  vtkMTimeType time = data ? GetTimeWithCoordinates(data) : 0;
  if (const auto composite = vtkCompositeDataSet::SafeDownCast(data))
  {
    const auto leaves = vtk::TakeSmartPointer(composite->NewIterator());
    for (leaves->InitTraversal(); !leaves->IsDoneWithTraversal(); leaves->GoToNextItem())
    {
      time = std::max(time, GetTimeWithCoordinates(leaves->GetCurrentDataObject()));
    }
  }
  return time;
}

} // namespace

vtkMTimeType GetMTimeWithInputs(vtkAlgorithm* filter)
{
  vtkMTimeType time = filter->GetMTime();
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
  {
    time = std::max(time, GetTimeOfData(filter, port));
  }
  return time;
}

std::pair<const void*, vtkMTimeType> GetInputStamp(vtkAlgorithm* filter, int port)
{
  if (filter->GetNumberOfInputConnections(port) == 0)
  {
    return { nullptr, 0 };
  }
  vtkExecutive* executive = filter->GetInputExecutive(port, 0);
  const auto pipeline = vtkDemandDrivenPipeline::SafeDownCast(executive);
  // The connection identifies an output: a producer may have several.
  const vtkMTimeType made = pipeline ? pipeline->GetPipelineMTime() : 0;
  return { filter->GetInputConnection(port, 0), std::max(made, GetTimeOfData(filter, port)) };
}

std::vector<double> GetTimes(vtkInformation* input)
{
  for (vtkInformationDoubleVectorKey* key : { Pipeline::TIME_STEPS(), Pipeline::TIME_RANGE() })
  {
    if (input->Has(key) && input->Length(key) > 0)
    {
      const double* times = input->Get(key);
      return std::vector<double>(times, times + input->Length(key));
    }
  }
  return {};
}

void MergeTimes(vtkAlgorithm* filter, int ports, vtkInformation* output)
{
  std::set<double> steps;
  std::set<double> ends;
  for (int port = 0; port < ports; ++port)
  {
    if (filter->GetNumberOfInputConnections(port) == 0)
    {
      continue;
    }
    vtkInformation* input = filter->GetInputInformation(port, 0);
    const std::vector<double> times = GetTimes(input);
    ends.insert(times.begin(), times.end());
    if (input->Has(Pipeline::TIME_STEPS()))
    {
      steps.insert(times.begin(), times.end());
    }
  }
  output->Remove(Pipeline::TIME_STEPS());
  output->Remove(Pipeline::TIME_RANGE());
  if (!steps.empty())
  {
    const std::vector<double> sorted(steps.begin(), steps.end());
    output->Set(Pipeline::TIME_STEPS(), sorted.data(), static_cast<int>(sorted.size()));
  }
  if (!ends.empty())
  {
    const double range[2] = { *ends.begin(), *ends.rbegin() };
    output->Set(Pipeline::TIME_RANGE(), range, 2);
  }
}

namespace
{

[[noreturn]] void ThrowOfTimes(const std::string& source, double time, double other)
{
  std::ostringstream text;
  text
    << "The source " << source << " was asked for the time " << time
    << ", but another filter has asked it for the time " << other
    << ". A source gives one time in each update. Use vtkForceTime (Force Time in ParaView) where "
       "the time is fixed, or read the file a second time.";
  throw Error(text.str());
}

std::optional<double> GetDataTime(vtkInformation* info)
{
  vtkDataObject* data = vtkDataObject::GetData(info);
  return data && data->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP())
    ? std::make_optional(data->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()))
    : std::nullopt;
}

} // namespace

void CheckTimes(int ports, vtkInformationVector** input, vtkInformation* output)
{
  if (!output->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    return;
  }
  const double time = output->Get(Pipeline::UPDATE_TIME_STEP());
  // Times of data that differ from the requested time: by the port, if the port announces the
  // requested time, or else the times that ports choose.
  std::map<int, double> wrong;
  std::set<double> fixed;
  for (int port = 0; port < ports; ++port)
  {
    vtkInformation* info = input[port]->GetInformationObject(0);
    const std::vector<double> times = info ? GetTimes(info) : std::vector<double>();
    // A source without times gives the same data for all requests.
    if (times.empty())
    {
      continue;
    }
    if (info->Has(Pipeline::UPDATE_TIME_STEP()) && info->Get(Pipeline::UPDATE_TIME_STEP()) != time)
    {
      ThrowOfTimes(
        "on input port " + std::to_string(port), time, info->Get(Pipeline::UPDATE_TIME_STEP()));
    }
    const std::optional<double> found = GetDataTime(info);
    if (!found || *found == time)
    {
      continue;
    }
    if (std::find(times.begin(), times.end(), time) != times.end())
    {
      wrong[port] = *found;
    }
    else
    {
      fixed.insert(*found);
    }
  }
  // If filters lie between the source and the port, only the data show which time the source gave.
  // Some sources store other times in their data than they announce. Thus the data of a port are
  // wrong only if they have the time that another port chooses.
  for (const auto& [port, found] : wrong)
  {
    if (fixed.count(found) > 0)
    {
      ThrowOfTimes("upstream of input port " + std::to_string(port), time, found);
    }
  }
}

void AcceptBlocks(vtkInformation* port)
{
  port->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
}

void RefuseBlocks(int ports, vtkInformationVector** input)
{
  for (int port = 0; port < ports; ++port)
  {
    const auto* blocks = vtkCompositeDataSet::GetData(input[port]);
    if (blocks)
    {
      throw Error("The data on input port " + std::to_string(port) + " are a " +
        blocks->GetClassName() +
        ", but the filter needs a single dataset. Join the blocks with vtkAppendFilter, with "
        "vtkAppendPolyData, or in ParaView with Merge Blocks; in a mesh, merge points, too.");
    }
  }
}

void SetTimeStep(
  vtkDataObject* data, vtkInformation* output, std::initializer_list<vtkDataObject*> inputs)
{
  vtkInformation* info = data->GetInformation();
  // Without times, the executive does not update the output for another requested time.
  if (output->Has(Pipeline::UPDATE_TIME_STEP()) && !GetTimes(output).empty())
  {
    info->Set(vtkDataObject::DATA_TIME_STEP(), output->Get(Pipeline::UPDATE_TIME_STEP()));
    return;
  }
  for (vtkDataObject* input : inputs)
  {
    if (input && input->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
    {
      info->Set(vtkDataObject::DATA_TIME_STEP(),
        input->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
      return;
    }
  }
}

} // namespace deformvolume
