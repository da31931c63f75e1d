// SPDX-License-Identifier: BSD-3-Clause
// How vtkDeformVolumeFilter answers the requests of the pipeline.
#include "vtkDeformVolumeFilter.h"

#include "vtkDeformVolumeFilterInternals.h"

#include "Device.h"
#include "InputUpdate.h"
#include "OutputExtent.h"
#include "PipelineGeometry.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationInformationVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationStringKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <exception>

using deformvolume::Error;
using deformvolume::Extent;
using deformvolume::ImageGeometry;

//------------------------------------------------------------------------------
vtkTypeBool vtkDeformVolumeFilter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* outInfo = output->GetInformationObject(0);
  vtkTypeBool result = 0;
  bool done = false;
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()))
  {
    this->Internals->DataRequest = request;
  }
  const auto process = [&]
  {
    result = this->Superclass::ProcessRequest(request, input, output);
    if (request->Has(Pipeline::REQUEST_TIME_DEPENDENT_INFORMATION()))
    {
      this->Internals->IncludeRequestedTimeInBounds(outInfo);
    }
    done = true;
  };
  if (request->Has(Pipeline::REQUEST_INFORMATION()))
  {
    try
    {
      process();
    }
    catch (const std::exception&)
    {
      // The error is reported when data are requested: a program that requests information may not
      // have set all inputs and arrays yet. Until then the output has an empty extent.
      this->Internals->InformationFailure = std::current_exception();
      const int empty[6] = { 0, -1, 0, -1, 0, -1 };
      outInfo->Set(Pipeline::WHOLE_EXTENT(), empty, 6);
      outInfo->Set(Pipeline::UPDATE_EXTENT(), empty, 6);
      result = 1;
    }
  }
  else
  {
    const int outcome = this->Internals->Execution.Run(this,
      this->Internals->Reference
        ? "The memory of this machine does not suffice for the deformed volume. Use a smaller "
          "volume, or a reference image of fewer voxels."
        : "The memory of this machine does not suffice for the deformed volume. Use a smaller "
          "volume, a coarser output spacing or narrower output bounds.",
      process);
    result = done ? result : outcome;
  }
  if (done)
  {
    return result;
  }
  // The executive continues with the data pass all the same, but on ranks whose inputs have failed
  // it stops at these inputs. Therefore request nothing from the inputs on any rank. (Nothing is
  // ever requested from the reference image.)
  for (int port = 0; port < 2 && request->Has(Pipeline::REQUEST_UPDATE_EXTENT()); ++port)
  {
    if (vtkInformation* info = input[port]->GetInformationObject(0))
    {
      deformvolume::RequestNothing(info);
    }
  }
  if (vtkDataObject* data = vtkDataObject::GetData(outInfo))
  {
    data->Initialize();
  }
  // The executive unites the extents that are requested until an execution succeeds.
  outInfo->Remove(Pipeline::COMBINED_UPDATE_EXTENT());
  this->Internals->State->Outputs.Forget();
  this->Internals->FactorOfOutput = 0;
  return result;
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::ModifyRequest(vtkInformation* request, int when)
{
  // Hide the reference image from the executive, which would execute its source for an empty
  // extent.
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()))
  {
    vtkInformationVector* reference =
      this->GetExecutive()->GetInputInformation(vtkInternals::ReferencePort);
    if (when == vtkExecutive::BeforeForward && reference->GetNumberOfInformationObjects() > 0)
    {
      this->Internals->ReferenceInfo = reference->GetInformationObject(0);
      const vtkNew<vtkInformation> withoutProducer;
      reference->SetInformationObject(0, withoutProducer);
    }
    else if (when == vtkExecutive::AfterForward && this->Internals->ReferenceInfo)
    {
      reference->SetInformationObject(0, this->Internals->ReferenceInfo);
      this->Internals->ReferenceInfo = nullptr;
    }
  }
  return this->Superclass::ModifyRequest(request, when);
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::RequestInformation(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkInformation* outInfo = output->GetInformationObject(0);
  if (this->Internals->InformationFailure)
  {
    // Makes the executive request the whole extent again.
    outInfo->Remove(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT_INITIALIZED());
    this->Internals->InformationFailure = nullptr;
  }
  const deformvolume::Ranks ranks;
  if (ranks.AreMany())
  {
    ranks.ShareProcessors(); // has to be called before a device is selected
  }
  this->Internals->CheckSettings(ranks);
  vtkInformation* volumeInfo = input[0]->GetInformationObject(0);
  ImageGeometry volume;
  ImageGeometry outputGeometry;
  ranks.Attempt(
    [&]
    {
      this->Internals->SelectState();
      if (!volumeInfo->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
      {
        throw Error("The volume on input port 0 announces no whole extent. Connect a "
                    "vtkImageData; from a composite dataset, extract one block.");
      }
    });
  this->Internals->ReadReference(ranks, outInfo);
  volume = this->Internals->VolumeGeometry.Find(this, 0, outInfo, ranks);
  ranks.Attempt([&] { deformvolume::CheckVolume(volume); });
  // With different grids the pieces of the ranks would be pieces of different outputs.
  this->Internals->VolumeGeometry.CheckRanks(ranks, "The volume on input port 0");
  ranks.Attempt(
    [&]
    {
      volume = this->Internals->GetCoarseGeometry(volume);
      outputGeometry = this->Internals->GetOutputGeometry(volume);
      // The device is checked here, because ParaView's views report errors of their own if
      // RequestData() fails after this pass has succeeded.
      deformvolume::ResolveDevice(this->Internals->GetDeviceRequest());
    });
  deformvolume::MergeTimes(this, vtkInternals::ReferencePort, outInfo);
  this->Internals->AnnounceScalars(outInfo);

  Extent whole;
  if (this->Internals->Reference)
  {
    this->Internals->ForgetDeformedExtent();
    whole = outputGeometry.PointExtent;
  }
  else if (this->OutputBoundsMode == DEFORMED_BOUNDS)
  {
    whole = this->Internals->GetDeformedExtent(ranks, volume, outInfo);
  }
  else
  {
    this->Internals->ForgetDeformedExtent();
    const deformvolume::IndexBounds bounds = this->OutputBoundsMode == VOLUME_BOUNDS
      ? deformvolume::GetVolumeBounds(volume, volume.Spacing / outputGeometry.Spacing)
      : deformvolume::GetWorldBoxBounds(this->CustomBounds, outputGeometry);
    whole = deformvolume::GetPadded(deformvolume::GetExtentAround(bounds), this->Padding);
  }

  const glm::dmat3 rows = glm::transpose(outputGeometry.Direction);
  outInfo->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data(), 6);
  outInfo->Set(vtkDataObject::ORIGIN(), glm::value_ptr(outputGeometry.Origin), 3);
  outInfo->Set(vtkDataObject::SPACING(), glm::value_ptr(outputGeometry.Spacing), 3);
  outInfo->Set(vtkDataObject::DIRECTION(), glm::value_ptr(rows), 9);
  outInfo->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  // The requested time is known only after this pass.
  outInfo->Set(vtkStreamingDemandDrivenPipeline::TIME_DEPENDENT_INFORMATION(), 1);
  return 1;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::AnnounceScalars(vtkInformation* output) const
{
  // The executive has copied this information from the volume.
  vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
    output, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  if (!scalars || this->DensityArrays.empty())
  {
    return;
  }
  const char* name = scalars->Get(vtkDataObject::FIELD_NAME());
  const auto volume = vtkImageData::SafeDownCast(this->Self->GetInputDataObject(0, 0));
  vtkDataArray* array = volume ? volume->GetPointData()->GetScalars() : nullptr;
  name = !name && array ? array->GetName() : name;
  if (!name || this->DensityArrays.count(name) == 0 ||
    scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE()) == VTK_DOUBLE)
  {
    return;
  }
  const int components = scalars->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
    ? scalars->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
    : 1;
  // The output shares the information with the volume.
  vtkNew<vtkInformation> copy;
  copy->CopyEntry(output, vtkDataObject::POINT_DATA_VECTOR(), 1);
  output->CopyEntry(copy, vtkDataObject::POINT_DATA_VECTOR());
  vtkDataObject::SetPointDataActiveScalarInfo(output, VTK_FLOAT, components);
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  if (this->Internals->InformationFailure)
  {
    std::rethrow_exception(this->Internals->InformationFailure);
  }
  this->Internals->SelectState();
  const deformvolume::Ranks ranks;
  // Before the requests for the other ports: if one of these has the same source, its request
  // replaces this one.
  if (input[vtkInternals::ReferencePort]->GetNumberOfInformationObjects() > 0)
  {
    deformvolume::RequestNothing(input[vtkInternals::ReferencePort]->GetInformationObject(0));
  }
  for (int port = 1; port < vtkInternals::ReferencePort; ++port)
  {
    if (input[port]->GetNumberOfInformationObjects() > 0)
    {
      deformvolume::RequestInput(input[port]->GetInformationObject(0), ranks);
    }
  }
  vtkInformation* volumeInfo = input[0]->GetInformationObject(0);
  deformvolume::RequestExtent(volumeInfo,
    this->Internals->GetNeededExtent(ranks, volumeInfo, output->GetInformationObject(0)));
  if (ranks.AreMany())
  {
    deformvolume::UpdateRequested(this, vtkInternals::ReferencePort, input, ranks);
  }
  return 1;
}
