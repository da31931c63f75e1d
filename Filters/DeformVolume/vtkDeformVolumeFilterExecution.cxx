// SPDX-License-Identifier: BSD-3-Clause
// How vtkDeformVolumeFilter makes its output.
#include "vtkDeformVolumeFilter.h"

#include "vtkDeformVolumeFilterInternals.h"

#include "InputUpdate.h"
#include "PipelineGeometry.h"
#include "VolumeArrays.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLogger.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

using deformvolume::Extent;

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* outInfo = output->GetInformationObject(0);
  vtkImageData* image = vtkImageData::GetData(outInfo);
  // If this execution fails, no results of an earlier one may remain.
  image->Initialize();
  const bool hasComparableOutput = this->Internals->FactorOfOutput == this->SamplingFactor;
  this->Internals->ResetResults();
  if (this->Internals->Execution.HasFailed())
  {
    return 0; // RequestUpdateExtent() has failed, which the executive ignores
  }
  this->Internals->SelectState();
  const deformvolume::Ranks ranks;
  const vtkInternals::Inputs inputs = this->Internals->ReadInputs(ranks, input, outInfo);

  deformvolume::DeformRequest request;
  outInfo->Get(Pipeline::UPDATE_EXTENT(), request.OutputExtent.data());
  outInfo->Get(Pipeline::WHOLE_EXTENT(), request.WholeOutputExtent.data());
  const vtkIdType numberOfPoints = deformvolume::GetNumberOfPoints(request.OutputExtent);
  if (numberOfPoints == 0 && !ranks.AreMany())
  {
    return 1;
  }
  this->Internals->ChooseMethod(ranks, inputs, input[0]->GetInformationObject(0), outInfo, request);
  vtkInternals::Results results;
  ranks.Attempt(
    [&]
    {
      if (numberOfPoints > 0)
      {
        results = this->Internals->Resample(inputs, request, image);
      }
    });
  if (numberOfPoints > 0)
  {
    this->Internals->TakeReport(results.Report, request.Method);
    this->Internals->WarnOfSplits(inputs.MaskedVolume);
    this->Internals->WarnOfOverlap(inputs.Mapped);
    this->Internals->WarnOfFading(inputs.MaskedVolume, inputs.Mapped, request.WholeOutputExtent);
    this->Internals->WarnOfLoss(results.Loss);
  }
  this->Internals->AddUpCounts(ranks);
  const std::uint64_t pointsOfRanks = ranks.GetSum(static_cast<std::uint64_t>(numberOfPoints));
  if (numberOfPoints == 0)
  {
    return 1;
  }
  this->Internals->KeepOutputs(results.Report, outInfo);
  vtkVLogF(
    vtkLogger::VERBOSITY_TRACE, "%s:\n%s", vtkLogIdentifier(this), this->GetSummary().c_str());
  if (!hasComparableOutput)
  {
    std::copy(request.OutputExtent.begin(), request.OutputExtent.end(), this->ChangedExtent);
  }
  this->Internals->FactorOfOutput = this->SamplingFactor;
  // The pieces of the ranks share planes. Together they have at least as many points as the whole
  // output.
  const bool isWhole = pointsOfRanks >=
    static_cast<std::uint64_t>(deformvolume::GetNumberOfPoints(request.WholeOutputExtent));
  if (this->NumberOfCoveredVoxels == 0 && isWhole)
  {
    this->Internals->WarnOfNothing();
  }
  deformvolume::SetTimeStep(image, outInfo, { vtkDataObject::GetData(input[1]), inputs.Volume });
  return 1;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::ResetResults()
{
  this->FactorOfOutput = 0;
  this->Report = {};
  this->StaticMappingTime = 0.0;
  this->Self->NumberOfInvertedTetrahedra = 0;
  this->Self->NumberOfHiddenVoxels = 0;
  this->Self->NumberOfFlatTetrahedra = 0;
  this->Self->NumberOfCoveredVoxels = 0;
  const Extent& nothing = deformvolume::EmptyExtent;
  std::copy(nothing.begin(), nothing.end(), this->Self->ChangedExtent);
}

//------------------------------------------------------------------------------
vtkDeformVolumeFilter::vtkInternals::Inputs vtkDeformVolumeFilter::vtkInternals::ReadInputs(
  const deformvolume::Ranks& ranks, vtkInformationVector** input, vtkInformation* output)
{
  Inputs inputs;
  ranks.Attempt(
    [&]
    {
      deformvolume::CheckTimes(vtkInternals::ReferencePort, input, output);
      vtkInformation* volumeInfo = input[0]->GetInformationObject(0);
      this->ForgetModifiedImage();
      inputs.Volume = this->CropToWholeExtent(vtkImageData::GetData(input[0]), volumeInfo);
      inputs.Mapped = this->GetMappedVolume(inputs.Volume, volumeInfo);
    });
  this->WarnOfTooSmallExtent(output);
  this->WarnOfReference();
  const deformvolume::ImageGeometry& geometry = inputs.Mapped.Whole;
  inputs.Deformation = this->ReadDeformation(
    ranks, geometry, vtkDataObject::GetData(input[1]), vtkDataObject::GetData(input[2]));
  this->IncludeDataInBounds(ranks, geometry, inputs.Deformation, output);
  ranks.Attempt(
    [&]
    {
      inputs.MaskedVolume =
        this->ReadArrays(inputs.Volume, inputs.Mapped, inputs.Deformation, inputs.Arrays);
    });
  return inputs;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::CheckMemory(
  const Inputs& inputs, const Extent& output, deformvolume::Resampling method)
{
  deformvolume::ExecutionState& state = *this->State;
  this->CheckWithRoom(
    [&]
    {
      state.Device.CheckMemory(inputs.GetVoxelGrid(),
        deformvolume::MakeVolumeArrays(inputs.Arrays, this->Self->BackgroundValue), output,
        state.Outputs.GetReusableBytes(), state.Deformation, state.Mapping, inputs.Mapped, method);
    });
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::ChooseMethod(const deformvolume::Ranks& ranks,
  const Inputs& inputs, vtkInformation* volumeInfo, vtkInformation* output,
  deformvolume::DeformRequest& request)
{
  const bool isPart = ranks.IsAny(this->WantsPart(output));
  ranks.Attempt(
    [&]
    {
      const vtkIdType numberOfPoints = deformvolume::GetNumberOfPoints(request.OutputExtent);
      if (numberOfPoints == 0)
      {
        return;
      }
      this->Self->DeviceInUse = this->SelectDevice();
      this->State->Outputs.Prepare(inputs.Arrays, numberOfPoints);
      // The resampler is chosen by the memory that the whole output needs, so that all parts of the
      // output have the same one. A volume that can be read in parts does not have to fit, even if
      // this part of the output needs all of it.
      request.Method = this->ChooseResampler(inputs.MaskedVolume,
        [&](deformvolume::Resampling method)
        {
          if (!isPart || !this->CanTakePart(volumeInfo))
          {
            this->CheckMemory(inputs, request.WholeOutputExtent, method);
          }
        });
    });
  if (ranks.IsAny(request.Method == deformvolume::Resampling::MeshRasterization))
  {
    request.Method = deformvolume::Resampling::MeshRasterization;
    this->SetResamplerInUse(request.Method);
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::SendVolume(
  const Inputs& inputs, deformvolume::Resampling method)
{
  deformvolume::DeviceSession& device = this->State->Device;
  std::vector<deformvolume::VolumeArray> arrays =
    deformvolume::MakeVolumeArrays(inputs.Arrays, this->Self->BackgroundValue);
  device.SetVoxelGrid(inputs.GetVoxelGrid(), arrays, method);
  const deformvolume::Stamp arraysStamp = deformvolume::GetStamp(inputs.Arrays);
  for (std::size_t i = 0; i < arrays.size() && device.GetArraysStamp() != arraysStamp; ++i)
  {
    if (!arrays[i].Data)
    {
      deformvolume::CopyToAOS(inputs.Arrays[i].Array, arrays[i]);
    }
  }
  device.SetArrays(arrays, arraysStamp);

  const deformvolume::Deformation& deformation = this->State->Deformation;
  const deformvolume::OutsideVoxels& outside = inputs.Mapped.Outside;
  const deformvolume::Stamp last = device.GetMasksStamp();
  deformvolume::Stamp stamp = deformvolume::GetMasksStamp(inputs.MaskedVolume);
  const bool isDefined = deformation.GetUndefinedVersion() == 0;
  if (!isDefined)
  {
    std::uint64_t fadeDistance = 0;
    std::memcpy(&fadeDistance, &outside.FadeDistance, sizeof(fadeDistance));
    stamp.emplace_back(nullptr, deformation.GetUndefinedVersion());
    stamp.emplace_back(nullptr, static_cast<std::uint64_t>(outside.Mode));
    stamp.emplace_back(nullptr, fadeDistance);
  }
  if (stamp == last)
  {
    return;
  }
  deformvolume::VolumeMasks masks = deformvolume::ReadMasks(inputs.MaskedVolume, last);
  std::vector<unsigned char> blanked;
  if (!isDefined)
  {
    blanked = deformation.FindUndefinedVoxels(
      inputs.Mapped.Part, outside, masks.Blanked, masks.BlankedBits);
    masks.Blanked = blanked.data();
    masks.BlankedBits = 1;
  }
  if (!isDefined || last.size() > stamp.size())
  {
    masks.WrittenBlanked.reset();
  }
  const auto written = [](const std::optional<deformvolume::PointRanges>& ranges)
  { return ranges ? &*ranges : nullptr; };
  device.SetMasks(
    { masks.Blanked, masks.Active, masks.Distances.Values, masks.Cut.Crossed,
      masks.Cut.Distances.Values, masks.BlankedBits, written(masks.WrittenBlanked),
      written(masks.WrittenActive), written(masks.WrittenDistances), masks.HasSameCut },
    stamp);
}

//------------------------------------------------------------------------------
vtkDeformVolumeFilter::vtkInternals::Results vtkDeformVolumeFilter::vtkInternals::Resample(
  const Inputs& inputs, deformvolume::DeformRequest& request, vtkImageData* image)
{
  deformvolume::ExecutionState& state = *this->State;
  const deformvolume::MappedVolume& mapped = inputs.Mapped;
  this->CheckMemory(inputs, request.OutputExtent, request.Method);
  state.Extra.Compute(state.Deformation, state.Mapping, mapped, inputs.MaskedVolume,
    this->Self->OpenSplits, inputs.Deformation.ToOutput, this->GetProgress(0.0, 0.3));
  this->SendVolume(inputs, request.Method);
  state.Device.SetDeformation(state.Deformation, state.Mapping, mapped, request.Method,
    this->Self->OpenSplits, this->GetProgress(0.0, 0.3));
  request.Progress = this->GetProgress(0.3, 1.0);
  request.Compiling = this->GetCompilationReport();
  if (!request.Progress(0.0))
  {
    throw deformvolume::Aborted();
  }

  image->SetExtent(request.OutputExtent.data());
  deformvolume::SetTransform(image, this->GetOutputGeometry(mapped.Whole));
  image->GetFieldData()->ShallowCopy(inputs.Volume->GetFieldData());
  state.Outputs.Make(inputs.Arrays, request);
  request.Interpolation = this->Self->Interpolation == CUBIC_INTERPOLATION
    ? deformvolume::Interpolation::Cubic
    : deformvolume::Interpolation::Linear;
  // Samples that folds hide are counted only if the whole output is resampled.
  request.Incremental =
    this->Self->Incremental && !this->Self->GenerateFoldCount && this->DensityArrays.empty();
  request.FoldCounts =
    state.Extra.MakeFoldCounts(deformvolume::GetNumberOfPoints(request.OutputExtent));
  request.MayStayOnDevice = this->Self->OutputOnDevice;

  Results results;
  results.Report = state.Device.Deform(request);
  state.Outputs.Give(results.Report, image);
  deformvolume::CopyAttributeRoles(
    inputs.Volume->GetPointData(), image->GetPointData(), inputs.Arrays);
  results.Loss =
    state.Extra.Finish(state.Deformation, mapped.Outside, this->Self->BackgroundValue, image);
  return results;
}
