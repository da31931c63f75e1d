// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeFilterInternals.h"

#include "AbortCheck.h"
#include "FieldFolds.h"
#include "InputUpdate.h"
#include "LookupBounds.h"
#include "OutputExtent.h"
#include "ResamplerChoice.h"
#include "VectorArray.h"
#include "VolumeArrays.h"

#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <thread>

using deformvolume::DeformationSource;
using deformvolume::Error;
using deformvolume::ImageGeometry;
using deformvolume::IndexBounds;

//------------------------------------------------------------------------------
ImageGeometry vtkDeformVolumeFilter::vtkInternals::GetOutputGeometry(
  const ImageGeometry& volume) const
{
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
      output.Spacing[axis] = std::copysign(spacing, volume.Spacing[axis]);
    }
  }
  return output;
}

//------------------------------------------------------------------------------
DeformationSource vtkDeformVolumeFilter::vtkInternals::MakeSource(
  const ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest) const
{
  DeformationSource source;
  source.Shape = shape;
  source.Rest = rest;
  vtkInformation* choice = this->Self->GetInputArrayInformation(0);
  const char* name = choice->Get(vtkDataObject::FIELD_NAME());
  const bool unnamed = name && !*name;
  source.Selector = [this, unnamed](vtkDataSet* dataSet)
  {
    int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
    vtkDataArray* array = unnamed ? deformvolume::FindVectors(dataSet)
                                  : this->Self->GetInputArrayToProcess(0, dataSet, association);
    return association == vtkDataObject::FIELD_ASSOCIATION_POINTS ? array : nullptr;
  };
  if (name && *name)
  {
    source.Wanted = std::string("point array \"") + name + "\"";
  }
  else
  {
    const char* attribute = unnamed ? "Vectors"
                                    : vtkDataSetAttributes::GetAttributeTypeAsString(
                                        choice->Get(vtkDataObject::FIELD_ATTRIBUTE_TYPE()));
    source.Wanted = std::string("active ") + (attribute ? attribute : "Vectors") + " of its points";
  }
  source.FieldIsInverse = this->Self->FieldIsInverse;
  source.Choice = source.Wanted + " " +
    std::to_string(choice->Get(vtkDataObject::FIELD_ASSOCIATION())) +
    (source.FieldIsInverse ? " inverse" : "");
  source.DisplacementScale = this->Self->DisplacementScale;
  if (!std::isfinite(source.DisplacementScale))
  {
    throw Error("DisplacementScale is not finite. Set a finite one.");
  }
  source.Volume = volume;
  source.Scale = volume.Spacing / this->GetOutputGeometry(volume).Spacing;
  return source;
}

//------------------------------------------------------------------------------
IndexBounds vtkDeformVolumeFilter::vtkInternals::ReadBounds(const deformvolume::Ranks& ranks,
  const ImageGeometry& volume, vtkInformation* output, const double* time)
{
  vtkDataObject* shape = deformvolume::UpdateInput(this->Self, 1, output, time, ranks);
  vtkDataObject* rest = deformvolume::UpdateInput(this->Self, 2, output, time, ranks);
  const DeformationSource source = this->ReadDeformation(ranks, volume, shape, rest);
  IndexBounds bounds;
  ranks.Attempt([&] { bounds = this->ComputeBounds(volume, source); });
  this->VersionsInBounds = this->GetVersions();
  return bounds;
}

//------------------------------------------------------------------------------
std::pair<std::uint64_t, std::uint64_t> vtkDeformVolumeFilter::vtkInternals::GetVersions() const
{
  return { this->Deformation.GetRestVersion(), this->Deformation.GetVectorsVersion() };
}

//------------------------------------------------------------------------------
IndexBounds vtkDeformVolumeFilter::vtkInternals::ComputeBounds(
  const ImageGeometry& volume, const DeformationSource& source)
{
  const deformvolume::VoxelGrid voxelGrid{ volume.PointExtent,
    { { source.Scale.x, source.Scale.y, source.Scale.z } } };
  const bool extrapolate = this->Self->OutsideMode == EXTRAPOLATE;
  if (this->Deformation.IsField())
  {
    const deformvolume::DisplacementField field = this->Deformation.GetField(extrapolate);
    const IndexBounds* known = this->Deformation.GetFieldBounds();
    const IndexBounds bounds = known       ? *known
      : this->Deformation.IsInverseField() ? deformvolume::ComputeLookupBounds(voxelGrid, field)
                                           : deformvolume::ComputeDeformedBounds(voxelGrid, field);
    if (bounds.IsEmpty())
    {
      throw Error("The displacement field on input port 1 holds no voxel of the volume. Check "
                  "that both are in the same world coordinates and overlap.");
    }
    return bounds;
  }
  if (extrapolate)
  {
    // The links are made before any output is asked for: what they need is checked here.
    this->Device.SetDevice(this->Self->Device, static_cast<std::uint64_t>(this->Self->MemoryLimit),
      static_cast<std::size_t>(this->Self->WorkGroupSize));
    this->Device.CheckMemory(voxelGrid, {}, { { 0, -1, 0, -1, 0, -1 } }, 0, this->Deformation,
      this->Mapping.GetRunBytes(this->Deformation, { volume, volume.PointExtent, true }));
    this->Mapping.Update(this->Deformation, { volume, volume.PointExtent, true }, {});
    return deformvolume::ComputeDeformedBounds(voxelGrid, this->Mapping.GetLinks(),
      this->Deformation.GetTetrahedra(), this->Deformation.GetNodeDisplacements());
  }
  const deformvolume::Deformation& mesh = this->Deformation;
  if (this->BoundsRestVersion != mesh.GetRestVersion() ||
    this->BoundsGrid.VertexExtent != voxelGrid.VertexExtent ||
    this->BoundsGrid.Scale != voxelGrid.Scale)
  {
    this->BoundsRestVersion = 0; // nothing, if this fails
    this->BoundsOfMesh.SetMesh(voxelGrid, mesh.GetRestPoints(), mesh.GetTetrahedra());
    this->BoundsRestVersion = mesh.GetRestVersion();
    this->BoundsGrid = voxelGrid;
  }
  const deformvolume::PointRanges changes = mesh.GetChanges(this->BoundsVectorsVersion);
  const IndexBounds bounds = this->BoundsOfMesh.Compute(
    mesh.GetRestPoints(), mesh.GetTetrahedra(), mesh.GetNodeDisplacements(), &changes);
  this->BoundsVectorsVersion = mesh.GetVectorsVersion();
  if (bounds.IsEmpty())
  {
    // Tells what is wrong.
    this->Mapping.Update(this->Deformation, { volume, volume.PointExtent, false }, {});
    throw Error("The deformed volume has no bounds. Check the deformation mesh.");
  }
  return bounds;
}

//------------------------------------------------------------------------------
IndexBounds vtkDeformVolumeFilter::vtkInternals::GetDeformedBounds(
  const deformvolume::Ranks& ranks, const ImageGeometry& volume, vtkInformation* output)
{
  BoundsKey key;
  std::set<double> times;
  for (int port = 1; port < 3; ++port)
  {
    if (this->Self->GetNumberOfInputConnections(port) > 0)
    {
      const std::vector<double> inputTimes =
        deformvolume::GetSampleTimes(this->Self, port, this->Self->NumberOfTimeSamples);
      times.insert(inputTimes.begin(), inputTimes.end());
    }
    key.Inputs.push_back(deformvolume::GetInputStamp(this->Self, port));
  }
  key.Volume = volume;
  const DeformationSource source = this->MakeSource(volume, nullptr, nullptr);
  key.Scale = source.Scale;
  key.DisplacementScale = source.DisplacementScale;
  key.Choice = source.Choice;
  key.OutsideMode = this->Self->OutsideMode;
  key.NumberOfTimeSamples = this->Self->NumberOfTimeSamples;
  if (!ranks.IsAny(!(key == this->Key)))
  {
    return this->Bounds;
  }
  if (!ranks.AreEqual(times.size()))
  {
    throw Error("The deformation has different time steps on different ranks. Connect a source "
                "that announces the same on all.");
  }

  IndexBounds bounds;
  if (times.empty())
  {
    bounds = this->ReadBounds(ranks, volume, output, nullptr);
  }
  // The first step comes last: it is what an input then holds where no time is asked for.
  for (auto time = times.rbegin(); time != times.rend(); ++time)
  {
    const double step = *time;
    bounds.Add(this->ReadBounds(ranks, volume, output, &step));
  }
  this->Key = key;
  this->Bounds = bounds;
  this->TimesInBounds = times;
  return bounds;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::KeepInBounds(const deformvolume::Ranks& ranks,
  const ImageGeometry& volume, const DeformationSource& source, vtkInformation* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  if (this->Self->OutputBoundsMode != DEFORMED_BOUNDS || !output->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    return;
  }
  const double time = output->Get(Pipeline::UPDATE_TIME_STEP());
  if (!ranks.IsAny(
        this->TimesInBounds.count(time) == 0 && this->VersionsInBounds != this->GetVersions()))
  {
    return;
  }
  IndexBounds bounds = this->Bounds;
  ranks.Attempt([&] { bounds.Add(this->ComputeBounds(volume, source)); });
  this->VersionsInBounds = this->GetVersions();
  if (deformvolume::GetExtentInside(bounds) == deformvolume::GetExtentInside(this->Bounds))
  {
    return;
  }
  this->Bounds = bounds;
  this->BoundsHaveGrown = true;
  vtkWarningWithObjectMacro(this->Self,
    << "The deformed volume at time " << time
    << " leaves the extent of the output, which was found from other times, and is cut off there. "
       "The next update has an extent that holds it. Set a greater NumberOfTimeSamples or Padding, "
       "or CustomBounds.");
}

//------------------------------------------------------------------------------
deformvolume::Resampling vtkDeformVolumeFilter::vtkInternals::ChooseResampler(
  const std::function<void(deformvolume::Resampling)>& checkMemory) const
{
  deformvolume::ResamplerWish wish;
  switch (this->Self->Resampler)
  {
    case EXACT:
      wish.Method = deformvolume::Resampling::Exact;
      break;
    case PUBLISHED:
      wish.Method = deformvolume::Resampling::Published;
      break;
    case MESH_RASTERIZATION:
      wish.Method = deformvolume::Resampling::MeshRasterization;
      break;
    default:
      break;
  }
  if (this->Self->Interpolation == CUBIC_INTERPOLATION)
  {
    wish.Interpolation = deformvolume::Interpolation::Cubic;
  }
  wish.Extrapolate = this->Self->OutsideMode == EXTRAPOLATE;
  const deformvolume::Resampling method = deformvolume::ChooseResampler(wish, this->Deformation,
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
  this->Self->ResamplerInUse = method == deformvolume::Resampling::MeshRasterization
    ? MESH_RASTERIZATION
    : method == deformvolume::Resampling::Published ? PUBLISHED
                                                    : EXACT;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::TakeReport(
  const deformvolume::DeformReport& report, deformvolume::Resampling method)
{
  this->Self->PreprocessingTime = this->Mapping.TakeTime();
  this->Self->TransferTime = report.TransferTime;
  this->Self->MappingTime = report.MappingTime;
  this->Self->ResamplingTime = report.ResamplingTime;
  this->Self->CompilationTime = report.CompilationTime;
  this->Self->NumberOfInvertedTetrahedra = this->Deformation.IsInverseField()
    ? this->GetNumberOfFolds()
    : report.NumberOfInvertedTetrahedra;
  this->Self->NumberOfFlatTetrahedra = method == deformvolume::Resampling::MeshRasterization
    ? report.NumberOfFlatTetrahedra
    : this->Deformation.IsField() ? 0
                                  : this->Mapping.GetNumberOfFlatTetrahedra();
  this->Self->NumberOfCoveredVoxels = report.NumberOfCoveredVoxels;
  this->Self->NumberOfBricks = report.NumberOfBricks;
  this->Self->NumberOfResampledBricks = report.NumberOfResampledBricks;
  this->Self->NumberOfMappingBuilds = this->Mapping.GetNumberOfBuilds();
  this->Self->NumberOfVolumeUploads = this->Device.GetNumberOfVolumeUploads();
  if (report.NumberOfOverstretchedCells > 0)
  {
    vtkWarningWithObjectMacro(
      this->Self, << report.NumberOfOverstretchedCells
                  << " cells of the volume have a tetrahedron that is stretched over more than "
                     "4,000 output voxels; these tetrahedra are skipped. Check the deformation, "
                     "or set a greater output spacing.");
  }
}

//------------------------------------------------------------------------------
vtkIdType vtkDeformVolumeFilter::vtkInternals::GetNumberOfFolds()
{
  const std::uint64_t version = this->Deformation.GetVectorsVersion();
  if (this->FoldsVersion != version)
  {
    this->NumberOfFolds = deformvolume::CountInvertedTetrahedra(this->Deformation.GetField(false));
    this->FoldsVersion = version;
  }
  return static_cast<vtkIdType>(this->NumberOfFolds);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::ForgetRequestedExtent(vtkInformation* output)
{
  output->Remove(vtkStreamingDemandDrivenPipeline::COMBINED_UPDATE_EXTENT());
}

//------------------------------------------------------------------------------
bool vtkDeformVolumeFilter::vtkInternals::IsReleased(vtkInformation* output)
{
  return vtkDataObject::GetGlobalReleaseDataFlag() != 0 ||
    output->Get(vtkDemandDrivenPipeline::RELEASE_DATA()) != 0;
}

//------------------------------------------------------------------------------
bool vtkDeformVolumeFilter::vtkInternals::IsNews(const std::string& message)
{
  auto* pipeline = vtkDemandDrivenPipeline::SafeDownCast(this->Self->GetExecutive());
  const vtkMTimeType time = pipeline ? pipeline->GetPipelineMTime() : this->Self->GetMTime();
  if (message == this->ToldMessage && time == this->ToldTime)
  {
    return false;
  }
  this->ToldMessage = message;
  this->ToldTime = time;
  return true;
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
  std::string warning;
  const std::string cellArrays = list(deformvolume::GetUnusedCellArrays(volume));
  if (!cellArrays.empty())
  {
    warning += "Cell arrays of the volume are not resampled: " + cellArrays +
      ". Convert them to point arrays where they are wanted. ";
  }
  if (!leftOut.empty())
  {
    warning += "Point arrays of the volume of a type that cannot be resampled are left out: " +
      list(leftOut) + ". ";
  }
  const std::string& cells = this->Deformation.GetIgnoredCells().empty()
    ? this->Gathering.GetIgnoredCells()
    : this->Deformation.GetIgnoredCells();
  if (!this->Deformation.IsField() && !cells.empty())
  {
    warning += "Cells of the deformation mesh that are not three-dimensional, or of a type that "
               "cannot be split into tetrahedra, are ignored: " +
      cells + ". ";
  }
  if (warning != this->WarnedOf && !warning.empty())
  {
    vtkWarningWithObjectMacro(this->Self, << warning);
  }
  this->WarnedOf = warning;
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
