// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeFilterInternals.h"

#include "AbortCheck.h"
#include "FieldAtRest.h"
#include "FieldFolds.h"
#include "IndexBounds.h"
#include "InputUpdate.h"
#include "MaskArray.h"
#include "OutputExtent.h"
#include "OutsideMode.h"
#include "PipelineGeometry.h"
#include "ResamplerChoice.h"
#include "VectorChoice.h"
#include "VolumeArrays.h"

#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <sstream>
#include <thread>

using deformvolume::DeformationSource;
using deformvolume::Error;
using deformvolume::ImageGeometry;
using deformvolume::IndexBounds;

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::SelectState()
{
  const int factor = this->Self->SamplingFactor;
  if (factor != 1 && factor != 2 && factor != 4)
  {
    throw Error("SamplingFactor is " + std::to_string(factor) + ". Set 1, 2 or 4.");
  }
  this->State = &this->States[factor];
}

//------------------------------------------------------------------------------
std::uint64_t vtkDeformVolumeFilter::vtkInternals::GetDeviceMemory() const
{
  std::uint64_t bytes = 0;
  for (const auto& state : this->States)
  {
    bytes += state.second.Device.GetDeviceMemory();
  }
  return bytes;
}

//------------------------------------------------------------------------------
bool vtkDeformVolumeFilter::vtkInternals::ReleaseOtherStates()
{
  bool released = false;
  for (auto& state : this->States)
  {
    if (&state.second != this->State && state.second.HoldsMemory())
    {
      state.second.Release();
      released = true;
    }
  }
  return released;
}

//------------------------------------------------------------------------------
std::string vtkDeformVolumeFilter::vtkInternals::SelectDevice()
{
  auto limit = static_cast<std::uint64_t>(this->Self->MemoryLimit);
  if (limit > 0)
  {
    const std::uint64_t others = this->GetDeviceMemory() - this->State->Device.GetDeviceMemory();
    if (others < limit)
    {
      limit -= others;
    }
    else
    {
      this->ReleaseOtherStates();
    }
  }
  return this->State->Device.SetDevice(this->Self->Device, limit);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::CheckWithRoom(const std::function<void()>& check)
{
  try
  {
    check();
    return;
  }
  catch (const Error&)
  {
    if (!this->ReleaseOtherStates())
    {
      throw;
    }
  }
  this->SelectDevice();
  check();
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::ReleaseOldVolumes(
  const std::vector<deformvolume::SourceArray>& arrays)
{
  std::vector<const void*> inUse;
  for (const deformvolume::SourceArray& array : arrays)
  {
    inUse.push_back(array.Array);
  }
  const auto source = deformvolume::GetInputStamp(this->Self, 0);
  for (auto& state : this->States)
  {
    // Arrays that were changed are still there, and so are those of other parts of a volume.
    if (&state.second != this->State && state.second.ArraysInUse != inUse &&
      state.second.SourceInUse != source)
    {
      state.second.Release();
    }
  }
  this->State->ArraysInUse = inUse;
  this->State->SourceInUse = source;
}

//------------------------------------------------------------------------------
ImageGeometry vtkDeformVolumeFilter::vtkInternals::GetCoarseGeometry(
  const ImageGeometry& volume) const
{
  const ImageGeometry coarse = deformvolume::GetCoarse(volume, this->Self->SamplingFactor);
  deformvolume::CheckCoarse(coarse, this->Self->SamplingFactor);
  return coarse;
}

//------------------------------------------------------------------------------
deformvolume::OutsideVoxels vtkDeformVolumeFilter::vtkInternals::GetOutside() const
{
  return deformvolume::MakeOutsideVoxels(this->Self->OutsideMode, this->Self->FadeDistance);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::CheckOutside() const
{
  if (!this->GetOutside().AreKept() || this->Self->GetNumberOfInputConnections(1) == 0)
  {
    return;
  }
  if (!this->State->Deformation.IsField() && this->Self->OpenSplits)
  {
    throw Error("OutsideMode is KEEP and OpenSplits is on, but what is outside the mesh is on "
                "neither side of a split. Set OpenSplits off, or OutsideMode to DISCARD.");
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::ReadReference(vtkInformation* reference)
{
  const std::optional<ImageGeometry> last = this->Reference;
  this->Reference.reset();
  if (!reference)
  {
    return;
  }
  if (!reference->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    throw Error("The reference image on input port 3 announces no whole extent. Connect a "
                "vtkImageData; from a composite dataset, extract one block.");
  }
  const ImageGeometry geometry = deformvolume::GetGeometry(reference);
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
  this->Reference = geometry;
  if (this->Reference != last)
  {
    // Another grid wants other voxels, and none of those before.
    for (auto& state : this->States)
    {
      state.second.LastShare = {};
    }
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::CheckReferenceOfRanks(
  const deformvolume::Ranks& ranks) const
{
  if (!ranks.AreMany() || !ranks.IsAny(this->Reference.has_value()))
  {
    return;
  }
  const ImageGeometry grid = this->Reference.value_or(ImageGeometry());
  std::vector<double> numbers(grid.PointExtent.begin(), grid.PointExtent.end());
  for (int axis = 0; axis < 3; ++axis)
  {
    numbers.insert(numbers.end(), { grid.Origin[axis], grid.Spacing[axis] });
    for (int row = 0; row < 3; ++row)
    {
      numbers.push_back(grid.Direction[axis][row]);
    }
  }
  bool areEqual = true;
  for (const double number : numbers)
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof(bits));
    areEqual = ranks.AreEqual(bits) && areEqual;
  }
  if (!areEqual)
  {
    throw Error("The reference image on input port 3 has different grids on different ranks. "
                "Connect a source that announces the same grid on all.");
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::CheckOutputIndices(
  const deformvolume::VoxelGrid& voxelGrid) const
{
  if (!this->Reference)
  {
    return;
  }
  const IndexBounds bounds =
    deformvolume::GetOutputTransform(voxelGrid).ToOutput(deformvolume::GetBox(voxelGrid));
  for (int axis = 0; axis < 3; ++axis)
  {
    const double farthest = std::max(std::abs(bounds.Min[axis]), std::abs(bounds.Max[axis]));
    if (!(farthest <= deformvolume::MostOutputIndex))
    {
      std::ostringstream text;
      text << "The volume at rest reaches to the index " << farthest
           << " in the grid of the reference image on axis "
           << "xyz"[axis] << ", beyond 2^21. The reference image has "
           << deformvolume::DescribeTransform(*this->Reference)
           << ". Connect one that lies where the volume does, in the same world units, or whose "
              "spacing is greater.";
      throw Error(text.str());
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
      "The output has the grid of the reference image on input port 3. These settings have no "
      "effect: "
        << names << ". Disconnect the reference image where they are wanted.");
  }
  this->WarnedOfSettings = names;
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
        throw Error(std::string("CustomSpacing is ") + std::to_string(spacing) + " on axis " +
          "xyz"[axis] + ". Set a spacing greater than 0.");
      }
      // A volume with negative spacing keeps its sense.
      output.Spacing[axis] =
        std::copysign(this->Self->SamplingFactor * spacing, volume.Spacing[axis]);
    }
  }
  return output;
}

//------------------------------------------------------------------------------
DeformationSource vtkDeformVolumeFilter::vtkInternals::MakeSource(
  const ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest) const
{
  DeformationSource source =
    deformvolume::ChooseDeformation(shape, rest, this->Self->GetInputArrayInformation(0),
      [this](vtkDataSet* dataSet, int& association)
      { return this->Self->GetInputArrayToProcess(0, dataSet, association); },
      { this->Self->DisplacementScale, this->Self->PointsAreDeformed, this->Self->FieldIsInverse });
  source.Volume = volume;
  source.ToOutput = deformvolume::GetOutputMap(volume, this->GetOutputGeometry(volume));
  this->CheckOutputIndices({ volume.PointExtent, source.ToOutput, {} });
  return source;
}

//------------------------------------------------------------------------------
DeformationSource vtkDeformVolumeFilter::vtkInternals::MakeSourceAtRest(const ImageGeometry& volume)
{
  if (this->Self->GetNumberOfInputConnections(2) > 0)
  {
    deformvolume::ThrowRestAlone();
  }
  if (!this->FieldAtRest || !(this->VolumeAtRest == volume))
  {
    this->FieldAtRest = deformvolume::MakeFieldAtRest(volume);
    this->VolumeAtRest = volume;
  }
  DeformationSource source = this->MakeSource(volume, this->FieldAtRest, nullptr);
  source.Selector = [](vtkDataSet* dataSet) { return dataSet->GetPointData()->GetVectors(); };
  source.PointsAreDeformed = false;
  source.DisplacementScale = 1.0;
  // Both kinds of fields leave the volume where it is. The resampler that looks up needs an inverse
  // one.
  source.FieldIsInverse = this->Self->Resampler == MESH_RASTERIZATION;
  source.Choice = source.FieldIsInverse ? "at rest inverse" : "at rest";
  return source;
}

//------------------------------------------------------------------------------
deformvolume::Resampling vtkDeformVolumeFilter::vtkInternals::ChooseResampler(
  vtkImageData* volume, const std::function<void(deformvolume::Resampling)>& checkMemory) const
{
  deformvolume::ResamplerWish wish;
  switch (this->Self->Resampler)
  {
    case EXACT:
      wish.Method = deformvolume::Resampling::Exact;
      break;
    case MESH_RASTERIZATION:
      wish.Method = deformvolume::Resampling::MeshRasterization;
      break;
    default:
      break;
  }
  const deformvolume::Deformation& deformation = this->State->Deformation;
  using Kinds = deformvolume::ResamplerWish::Kinds;
  wish.Deformation = deformation.IsInverseField() ? Kinds::InverseField
    : deformation.IsField()                       ? Kinds::ForwardField
                                                  : Kinds::Mesh;
  wish.Outside = this->GetOutside();
  wish.HasSmoothCut = deformvolume::HasCut(volume);
  wish.NeedsJacobian = this->GetExtraArrays().NeedsJacobian();
  wish.CountsFolds = this->Self->GenerateFoldCount;
  if (wish.HasSmoothCut && this->Self->GetNumberOfInputConnections(1) == 0 &&
    this->State->Deformation.IsInverseField())
  {
    throw Error("The resampler MESH_RASTERIZATION cannot do smooth cuts. Set SmoothCut of "
                "vtkCutVolume to off, or Resampler to EXACT.");
  }
  const deformvolume::Resampling method = deformvolume::ChooseResampler(wish,
    [&](deformvolume::Resampling tried)
    {
      try
      {
        checkMemory(tried);
        return true;
      }
      catch (const Error&)
      {
        return false;
      }
    });
  this->SetResamplerInUse(method);
  return method;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::SetResamplerInUse(deformvolume::Resampling method) const
{
  this->Self->ResamplerInUse =
    method == deformvolume::Resampling::MeshRasterization ? MESH_RASTERIZATION : EXACT;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::TakeReport(
  const deformvolume::DeformReport& report, deformvolume::Resampling method)
{
  this->Report = report;
  this->Report.DeviceOutputs.clear(); // the arrays of the output have them
  this->StaticMappingTime = this->State->Mapping.TakeTime();
  this->Self->NumberOfInvertedTetrahedra = this->State->Deformation.IsInverseField()
    ? this->GetNumberOfFolds()
    : report.NumberOfInvertedTetrahedra;
  this->Self->NumberOfFlatTetrahedra = method == deformvolume::Resampling::MeshRasterization
    ? report.NumberOfFlatTetrahedra
    : this->State->Deformation.IsField() ? 0
                                         : this->State->Mapping.GetNumberOfFlatTetrahedra();
  this->Self->NumberOfCoveredVoxels = report.NumberOfCoveredVoxels;
  std::copy(report.ChangedExtent.begin(), report.ChangedExtent.end(), this->Self->ChangedExtent);
  if (report.NumberOfOverstretchedCells > 0)
  {
    vtkWarningWithObjectMacro(
      this->Self, << report.NumberOfOverstretchedCells
                  << " cells of the volume have a tetrahedron that is stretched over more than "
                     "4,000 output voxels; these tetrahedra are skipped. Check the deformation, "
                     "or "
                  << (this->Reference ? "connect a reference image of greater spacing."
                                      : "set a greater output spacing."));
  }
}

//------------------------------------------------------------------------------
vtkIdType vtkDeformVolumeFilter::vtkInternals::GetNumberOfFolds()
{
  const std::uint64_t version = this->State->Deformation.GetVectorsVersion();
  if (this->State->FoldsVersion != version)
  {
    this->State->NumberOfFolds =
      deformvolume::CountInvertedTetrahedra(this->State->Deformation.GetField(false));
    this->State->FoldsVersion = version;
  }
  return static_cast<vtkIdType>(this->State->NumberOfFolds);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfIgnored(
  vtkImageData* volume, const std::vector<std::string>& leftOut)
{
  const auto list = [](const std::vector<std::string>& names)
  {
    std::string text;
    for (const std::string& name : names)
    {
      text += (text.empty() ? "" : ", ") + name;
    }
    return text;
  };
  std::set<std::string> warnings;
  const std::string cellArrays = list(deformvolume::GetUnusedCellArrays(volume));
  if (!cellArrays.empty())
  {
    warnings.insert("Cell arrays of the volume are not resampled: " + cellArrays +
      ". Convert them to point arrays where they are wanted.");
  }
  if (!leftOut.empty())
  {
    warnings.insert("Point arrays of the volume of a type that cannot be resampled are left out: " +
      list(leftOut) + ".");
  }
  using Attributes = vtkDataSetAttributes;
  for (const auto& [role, kind] : { std::pair(Attributes::VECTORS, "vectors"),
         std::pair(Attributes::NORMALS, "normals"), std::pair(Attributes::TENSORS, "tensors") })
  {
    if (vtkDataArray* array = volume->GetPointData()->GetAttribute(role))
    {
      warnings.insert(std::string("The active ") + kind + " \"" +
        (array->GetName() ? array->GetName() : "") +
        "\" of the volume are interpolated component by component, and not rotated with the "
        "deformation. Rotate them afterwards where their directions matter.");
    }
  }
  if (!this->State->Deformation.IsField())
  {
    deformvolume::AddCellWarnings(
      this->State->Deformation.GetRestMesh(), this->Gathering, warnings);
  }
  std::string news;
  for (const std::string& warning : warnings)
  {
    news += this->WarnedOf.count(warning) > 0 ? "" : (news.empty() ? "" : " ") + warning;
  }
  if (!news.empty())
  {
    vtkWarningWithObjectMacro(this->Self, << news);
  }
  this->WarnedOf = warnings;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfLoss(const deformvolume::ExtraArrays::Loss& loss)
{
  std::string text;
  const auto hidden = static_cast<double>(this->Report.NumberOfHiddenSamples);
  if (!this->DensityArrays.empty() && hidden > 0.0)
  {
    std::ostringstream share;
    share << std::setprecision(2)
          << 100.0 * hidden / (hidden + static_cast<double>(this->Report.NumberOfCoveredVoxels));
    text = "The deformation folds the volume over. The sums of density arrays lack the " +
      share.str() + " % of the deformed volume that other parts of it hide.";
  }
  if (loss.NumberOfVoxels > 0)
  {
    text += (text.empty() ? "" : " ") + std::to_string(loss.NumberOfVoxels) +
      " voxels show the volume inside out, or pressed together to nothing: density arrays have "
      "BackgroundValue there.";
  }
  if (!text.empty() && text != this->WarnedOfLoss)
  {
    vtkWarningWithObjectMacro(this->Self, << text);
  }
  this->WarnedOfLoss = text;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfFading(
  const deformvolume::MappedVolume& mapped, const deformvolume::Extent& output)
{
  const deformvolume::Deformation& mesh = this->State->Deformation;
  if (mesh.IsField())
  {
    if (mapped.Outside.AreKept())
    {
      this->WarnOfFadingField(mapped, output);
    }
    return;
  }
  const deformvolume::FadedLinks& links = this->State->Mapping.GetMapping().Faded;
  if (!links.AreThere() || !this->State->Mapping.IsCurrent(mesh.GetMeshAtRest(), mapped))
  {
    return;
  }
  const std::pair<std::uint64_t, std::uint64_t> versions(
    this->State->Mapping.GetVersion(), mesh.GetVectorsVersion());
  if (this->State->VersionsOfFading == versions)
  {
    return;
  }
  this->State->VersionsOfFading = versions;
  const std::string text =
    deformvolume::FindFaultOfFading(links, mesh.GetTetrahedra(), mesh.GetNodeDisplacements(),
      this->GetOutputGeometry(mapped.Whole).Spacing, mapped.Outside.FadeDistance);
  if (!text.empty())
  {
    vtkWarningWithObjectMacro(this->Self, << text);
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfFadingField(
  const deformvolume::MappedVolume& mapped, const deformvolume::Extent& output)
{
  const deformvolume::Deformation& deformation = this->State->Deformation;
  const deformvolume::Extent& moved =
    deformation.IsInverseField() ? output : mapped.Whole.PointExtent;
  const std::string fault = deformvolume::FindFaultOfFading(deformation.GetField(mapped.Outside),
    deformvolume::GetBox({ moved, {}, {} }),
    glm::abs(this->GetOutputGeometry(mapped.Whole).Spacing), mapped.Outside.FadeDistance);
  if (!fault.empty() && fault != this->State->FaultOfFading)
  {
    vtkWarningWithObjectMacro(this->Self, << fault);
  }
  this->State->FaultOfFading = fault;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfNothing() const
{
  std::string text;
  if (this->Self->GetNumberOfInputConnections(1) > 0 && this->State->Deformation.IsInverseField())
  {
    text = "The inverse displacement field leads from no voxel of the output to the volume: all of "
           "the output is background. Check that the field holds points of ";
    text += this->Reference ? "the reference image" : "the output";
    text += ", that its vectors lead from there to the volume, and that all are in the same world "
            "coordinates.";
  }
  else
  {
    text = "The deformed volume covers no voxel of the output: all of it is background. Check ";
    text += this->Reference
      ? "that the reference image lies where the deformed volume does, in the same world "
        "coordinates,"
      : "the output bounds,";
    text += " and that the deformation mesh holds neighbouring voxels of the volume.";
  }
  vtkWarningWithObjectMacro(this->Self, << text);
}

//------------------------------------------------------------------------------
std::function<bool(double)> vtkDeformVolumeFilter::vtkInternals::GetProgress(
  double from, double to) const
{
  // Observers expect to be called where they live.
  const std::thread::id thread = std::this_thread::get_id();
  return [this, from, to, thread](double done)
  {
    if (std::this_thread::get_id() == thread)
    {
      this->Self->UpdateProgress(from + (to - from) * done);
      return !deformvolume::IsAborted(this->Self);
    }
    return this->Self->GetAbortExecute() == 0;
  };
}

//------------------------------------------------------------------------------
std::function<void(bool)> vtkDeformVolumeFilter::vtkInternals::GetCompilationReport() const
{
  const std::thread::id thread = std::this_thread::get_id();
  return [this, thread](bool begins)
  {
    if (std::this_thread::get_id() == thread)
    {
      this->Self->SetProgressText(begins ? "Compiling kernels" : nullptr);
      this->Self->UpdateProgress(this->Self->GetProgress());
    }
  };
}
