// SPDX-License-Identifier: BSD-3-Clause
// The volume of vtkDeformVolumeFilter: the information that its source announces, and its data.
#include "vtkDeformVolumeFilterInternals.h"

#include "InputUpdate.h"
#include "MaskArray.h"
#include "PipelineGeometry.h"
#include "VolumeArrays.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

using deformvolume::Error;
using deformvolume::Extent;
using deformvolume::ImageGeometry;

namespace
{

// vtkImageData::Crop() copies all arrays, and would read short ones beyond their ends.
void CheckSizes(vtkDataSetAttributes* attributes, vtkIdType size, const std::string& what)
{
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = attributes->GetAbstractArray(i);
    if (array->GetNumberOfTuples() != size)
    {
      throw Error("The " + what + " array number " + std::to_string(i) + " of the volume has " +
        std::to_string(array->GetNumberOfTuples()) + " tuples for " + std::to_string(size) + " " +
        what + "s. Remove the array, or give it one tuple for each " + what + ".");
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
deformvolume::MappedVolume vtkDeformVolumeFilter::vtkInternals::GetMappedVolume(
  vtkImageData* volume, vtkInformation* info) const
{
  const ImageGeometry given = deformvolume::GetGeometry(volume);
  deformvolume::MappedVolume mapped;
  mapped.Whole = this->VolumeGeometry.Get();
  mapped.Part = given.PointExtent;
  mapped.Outside = this->GetOutside();
  Extent asked = mapped.Whole.PointExtent;
  info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), asked.data());
  if (!deformvolume::Contains(mapped.Part, asked) ||
    !deformvolume::Contains(mapped.Whole.PointExtent, mapped.Part))
  {
    throw Error("The source of the volume on input port 0 was asked for an extent of it, " +
      deformvolume::DescribeExtent(asked) + ", and gave another one, " +
      deformvolume::DescribeExtent(mapped.Part) +
      ". Give all files of a series the same grid, correct the WHOLE_EXTENT that the source "
      "announces or what it makes, or read the volume into memory first.");
  }
  deformvolume::CheckTransform(given, "the volume on input port 0");
  if (!deformvolume::AreSamePositions(mapped.Whole, given, mapped.Whole.PointExtent))
  {
    const bool isAnnounced = info->Has(vtkDataObject::ORIGIN()) &&
      info->Has(vtkDataObject::SPACING()) && info->Has(vtkDataObject::DIRECTION());
    const std::string grid = deformvolume::DescribeTransform(mapped.Whole);
    throw Error("The volume on input port 0 has " + deformvolume::DescribeTransform(given) +
      (isAnnounced ? ", but its source announced " + grid +
            ", from which the extent of the output follows. Give all files of a series the same "
            "grid, or set ORIGIN(), SPACING() and DIRECTION() of vtkDataObject in the source's "
            "RequestInformation()."
                   : ", but had " + grid +
            " before, from which the extent of the output follows. All time steps need one grid: "
            "resample them, for example by vtkResampleToImage (Resample To Image in ParaView)."));
  }
  deformvolume::CheckVolume(mapped.Whole);
  mapped.Whole = this->GetCoarseGeometry(mapped.Whole);
  mapped.Part = deformvolume::CoarsenExtent(mapped.Part, this->Self->SamplingFactor);
  return mapped;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::ForgetModifiedImage()
{
  const std::pair<const void*, vtkMTimeType> now = deformvolume::GetWrittenStamp(this->Self, 0);
  // An image that was modified may share arrays with the last image, and its owner may have written
  // to them.
  if (now.first && now.second > this->ImageRead.GetMTime())
  {
    for (auto& state : this->States)
    {
      state.second.ForgetValues();
    }
  }
  this->ImageRead.Modified();
}

//------------------------------------------------------------------------------
vtkImageData* vtkDeformVolumeFilter::vtkInternals::CropToWholeExtent(
  vtkImageData* volume, vtkInformation* info)
{
  const Extent whole = deformvolume::GetGeometry(info).PointExtent;
  const Extent given = deformvolume::GetGeometry(volume).PointExtent;
  if (deformvolume::Contains(whole, given) || !deformvolume::Contains(given, whole))
  {
    this->CroppedVolume = nullptr;
    return volume;
  }
  const std::pair<const void*, vtkMTimeType> stamp(volume, volume->GetMTime());
  if (!this->CroppedVolume || stamp != this->CroppedStamp ||
    deformvolume::GetGeometry(this->CroppedVolume).PointExtent != whole)
  {
    CheckSizes(volume->GetPointData(), volume->GetNumberOfPoints(), "point");
    CheckSizes(volume->GetCellData(), volume->GetNumberOfCells(), "cell");
    this->CroppedVolume = vtkSmartPointer<vtkImageData>::New();
    this->CroppedVolume->ShallowCopy(volume);
    this->CroppedVolume->Crop(whole.data());
    this->CroppedStamp = stamp;
    vtkWarningWithObjectMacro(this->Self,
      << "The volume on input port 0 has the extent " << deformvolume::DescribeExtent(given)
      << ", more than the whole extent " << deformvolume::DescribeExtent(whole)
      << " that its source announces. Only the latter is deformed. If that is not intended, "
         "correct "
         "the WHOLE_EXTENT of the source.");
  }
  return this->CroppedVolume;
}

//------------------------------------------------------------------------------
vtkImageData* vtkDeformVolumeFilter::vtkInternals::ReadArrays(vtkImageData* volume,
  const deformvolume::MappedVolume& mapped, const deformvolume::DeformationSource& source,
  std::vector<deformvolume::SourceArray>& arrays)
{
  deformvolume::ExecutionState& state = *this->State;
  std::vector<std::string> leftOut;
  arrays = deformvolume::SelectArrays(volume, this->CategoricalArrays, leftOut);
  for (deformvolume::SourceArray& array : arrays)
  {
    array.Categorical |= this->Self->Interpolation == NEAREST_INTERPOLATION;
  }
  this->WarnOfInputs(volume, leftOut, mapped, source);
  this->ReleaseOldVolumes(arrays);
  vtkImageData* const maskedVolume =
    state.Volume.Update(volume, this->Self->SamplingFactor, arrays);
  state.Extra.Select(this->GetExtraArrays(), mapped.Whole, mapped.Part, state.Deformation, arrays);
  this->HadCut = deformvolume::HasCut(maskedVolume);
  if (this->HadCut && !mapped.IsWhole())
  {
    throw Error("The source of the volume was asked for a part of it, but the smooth cut (the "
                "array \"CutTetrahedra\") needs the whole volume. Update again: from the next "
                "update on, the whole volume is requested.");
  }
  return maskedVolume;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::KeepOutputs(
  const deformvolume::DeformReport& report, vtkInformation* output)
{
  if (vtkDataObject::GetGlobalReleaseDataFlag() == 0 &&
    output->Get(vtkDemandDrivenPipeline::RELEASE_DATA()) == 0)
  {
    this->State->Outputs.Keep(report);
    return;
  }
  for (auto& state : this->States)
  {
    state.second.Outputs.Forget();
  }
}
