// SPDX-License-Identifier: BSD-3-Clause
// The grid of the output: that of the reference image, or that of the volume.
#include "vtkDeformVolumeFilterInternals.h"

#include "InputUpdate.h"
#include "OutputExtent.h"
#include "PipelineGeometry.h"

#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <vector>

using deformvolume::Error;
using deformvolume::ImageGeometry;

namespace
{

void CheckReference(const ImageGeometry& geometry)
{
  if (deformvolume::GetNumberOfPoints(geometry.PointExtent) == 0)
  {
    throw Error("The reference image is empty: its extent is " +
      deformvolume::DescribeExtent(geometry.PointExtent) + ". Connect a vtkImageData with voxels.");
  }
  deformvolume::CheckTransform(geometry, "the reference image");
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    voxels *= static_cast<double>(deformvolume::GetSize(geometry.PointExtent, axis));
  }
  if (voxels > deformvolume::MostOutputVoxels)
  {
    throw Error("The reference image has more than 2^48 voxels: its extent is " +
      deformvolume::DescribeExtent(geometry.PointExtent) + ". Connect a smaller one.");
  }
}

} // namespace

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::ReadReference(
  const deformvolume::Ranks& ranks, vtkInformation* output)
{
  const std::optional<ImageGeometry> last = this->Reference;
  this->Reference.reset();
  vtkInformation* info = this->Self->GetNumberOfInputConnections(ReferencePort) > 0
    ? this->Self->GetInputInformation(ReferencePort, 0)
    : nullptr;
  if (!info)
  {
    return; // on all ranks
  }
  ranks.Attempt(
    [&]
    {
      if (!info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
      {
        throw Error("The reference image on input port 3 announces no whole extent. Connect a "
                    "vtkImageData; from a composite dataset, extract one block.");
      }
    });
  const ImageGeometry& geometry =
    this->ReferenceGeometry.Find(this->Self, ReferencePort, output, ranks);
  ranks.Attempt([&] { CheckReference(geometry); });
  this->ReferenceGeometry.CheckRanks(ranks, "The reference image on input port 3");
  this->Reference = geometry;
  if (this->Reference != last)
  {
    // Another grid needs other voxels, and no longer the previous ones.
    for (auto& state : this->States)
    {
      state.second.LastPart = {};
    }
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfReference()
{
  std::string names;
  const auto add = [&](bool isSet, const char* name)
  { names += isSet && this->Reference ? (names.empty() ? "" : ", ") + std::string(name) : ""; };
  add(this->Self->OutputBoundsMode != DEFORMED_BOUNDS, "OutputBoundsMode");
  add(this->Self->Padding != 0, "Padding");
  add(this->Self->BoundsGranularity > 1, "BoundsGranularity");
  add(this->Self->OutputSpacingMode != VOLUME_SPACING, "OutputSpacingMode");
  if (!names.empty() && names != this->WarnedOfSettings)
  {
    vtkWarningWithObjectMacro(this->Self,
      "The output has the grid of the reference image on input port 3. These properties have no "
      "effect: "
        << names << ". Disconnect the reference image to use them.");
  }
  this->WarnedOfSettings = names;

  std::vector<double> times;
  if (this->Reference)
  {
    times = deformvolume::GetTimes(this->Self->GetInputInformation(ReferencePort, 0));
  }
  const bool isTimed = !times.empty() && times.front() != times.back();
  if (isTimed && !this->WarnedOfTimes)
  {
    vtkWarningWithObjectMacro(this->Self,
      "The reference image on input port 3 varies in time. The output keeps the grid that was read "
      "first, and does not follow it if the grid of the reference image moves.");
  }
  this->WarnedOfTimes = isTimed;
}

//------------------------------------------------------------------------------
ImageGeometry vtkDeformVolumeFilter::vtkInternals::GetOutputGeometry(
  const ImageGeometry& volume) const
{
  if (this->Reference)
  {
    return *this->Reference;
  }
  ImageGeometry output = volume;
  output.PointExtent = ImageGeometry().PointExtent;
  if (this->Self->OutputSpacingMode == CUSTOM_SPACING)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double spacing = this->Self->CustomSpacing[axis];
      if (!std::isfinite(spacing) || spacing <= 0.0)
      {
        throw Error(std::string("CustomSpacing is ") + deformvolume::FormatNumber(spacing) +
          " on axis " + "xyz"[axis] + ". Set a spacing greater than 0.");
      }
      // The spacing keeps the sign of the volume's spacing.
      output.Spacing[axis] =
        std::copysign(this->Self->SamplingFactor * spacing, volume.Spacing[axis]);
    }
  }
  return output;
}
