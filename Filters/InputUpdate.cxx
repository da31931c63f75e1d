// SPDX-License-Identifier: BSD-3-Clause
#include "InputUpdate.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataObject.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <set>

namespace deformvolume
{

using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkDataObject* UpdateInput(
  vtkAlgorithm* filter, int port, vtkInformation* output, const double* time)
{
  if (filter->GetNumberOfInputConnections(port) == 0)
  {
    return nullptr;
  }
  vtkAlgorithmOutput* source = filter->GetInputConnection(port, 0);
  vtkNew<vtkInformationVector> requests;
  requests->SetNumberOfInformationObjects(source->GetIndex() + 1);
  vtkInformation* request = requests->GetInformationObject(source->GetIndex());
  request->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  request->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  request->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  vtkInformation* input = filter->GetInputInformation(port, 0);
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    request->Set(Pipeline::UPDATE_EXTENT(), input->Get(Pipeline::WHOLE_EXTENT()), 6);
  }
  if (time)
  {
    request->Set(Pipeline::UPDATE_TIME_STEP(), *time);
  }
  else if (output->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    request->Set(Pipeline::UPDATE_TIME_STEP(), output->Get(Pipeline::UPDATE_TIME_STEP()));
  }
  source->GetProducer()->Update(source->GetIndex(), requests);
  return source->GetProducer()->GetOutputDataObject(source->GetIndex());
}

void RequestWhole(vtkInformation* input)
{
  input->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  input->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    input->Set(Pipeline::UPDATE_EXTENT(), input->Get(Pipeline::WHOLE_EXTENT()), 6);
  }
  else
  {
    input->Remove(Pipeline::UPDATE_EXTENT());
  }
}

std::pair<const void*, vtkMTimeType> GetInputStamp(vtkAlgorithm* filter, int port)
{
  if (filter->GetNumberOfInputConnections(port) == 0)
  {
    return { nullptr, 0 };
  }
  vtkExecutive* executive = filter->GetInputExecutive(port, 0);
  const auto pipeline = vtkDemandDrivenPipeline::SafeDownCast(executive);
  // One producer may have several outputs.
  return { filter->GetInputConnection(port, 0), pipeline ? pipeline->GetPipelineMTime() : 0 };
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

void MergeTimes(vtkAlgorithm* filter, vtkInformation* output)
{
  std::set<double> steps;
  std::set<double> ends;
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
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

} // namespace deformvolume
