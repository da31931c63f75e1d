// SPDX-License-Identifier: BSD-3-Clause
#include "Sources.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMatrix3x3.h>
#include <vtkObjectFactory.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fuzz
{

using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkStandardNewMacro(PartSource);
vtkStandardNewMacro(TimeSource);

int PartSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  vtkInformation* info = output->GetInformationObject(0);
  info->Set(Pipeline::WHOLE_EXTENT(), this->Volume->GetExtent(), 6);
  info->Set(vtkDataObject::SPACING(), this->Volume->GetSpacing(), 3);
  info->Set(vtkDataObject::ORIGIN(), this->Volume->GetOrigin(), 3);
  info->Set(vtkDataObject::DIRECTION(), this->Volume->GetDirectionMatrix()->GetData(), 9);
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  return 1;
}

int PartSource::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  vtkInformation* info = output->GetInformationObject(0);
  vtkImageData* image = vtkImageData::GetData(output);
  image->DeepCopy(this->Volume);
  image->Crop(info->Get(Pipeline::UPDATE_EXTENT()));
  return 1;
}

int TimeSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  std::vector<double> times(this->Steps.size());
  std::iota(times.begin(), times.end(), 0.0);
  const double range[2] = { times.front(), times.back() };
  vtkInformation* info = output->GetInformationObject(0);
  info->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
  info->Set(Pipeline::TIME_RANGE(), range, 2);
  return 1;
}

int TimeSource::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  vtkInformation* info = output->GetInformationObject(0);
  const double asked =
    info->Has(Pipeline::UPDATE_TIME_STEP()) ? info->Get(Pipeline::UPDATE_TIME_STEP()) : 0.0;
  const double time =
    std::clamp(std::floor(asked), 0.0, static_cast<double>(this->Steps.size()) - 1.0);
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::GetData(output);
  mesh->ShallowCopy(this->Steps[static_cast<std::size_t>(time)]);
  mesh->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
  return 1;
}

} // namespace fuzz
