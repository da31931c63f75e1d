// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeFilterInternals.h"

#include "DeformationChoice.h"
#include "FieldFolds.h"
#include "FieldGeometry.h"
#include "InputUpdate.h"
#include "IsAborted.h"
#include "MaskArray.h"
#include "MemoryError.h"
#include "OutputExtent.h"
#include "PipelineGeometry.h"
#include "ResamplerChoice.h"
#include "VolumeArrays.h"

#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <algorithm>
#include <thread>

using deformvolume::DeformationSource;
using deformvolume::Error;
using deformvolume::ImageGeometry;

namespace
{

// Makes a displacement field of zeros that contains the whole volume, for use if no deformation is
// connected. The zeros are its active vectors.
vtkSmartPointer<vtkImageData> MakeFieldAtRest(const ImageGeometry& volume)
{
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->SetDimensions(2, 2, 2);
  deformvolume::SetTransform(field, deformvolume::GetGridAtRest(volume));
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName("Displacement");
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(field->GetNumberOfPoints());
  vectors->Fill(0.0);
  field->GetPointData()->SetVectors(vectors);
  return field;
}

} // namespace

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
  return this->State->Device.SetDevice(this->GetDeviceRequest(), limit);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::CheckWithRoom(const std::function<void()>& check)
{
  try
  {
    check();
    return;
  }
  catch (const deformvolume::MemoryError&)
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
    // A volume is still connected if it has the same arrays, even if their values have changed, or
    // if its source is unchanged, which may have given another part of it.
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
  const ImageGeometry coarse = deformvolume::CoarsenExtent(volume, this->Self->SamplingFactor);
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
  if (this->Reference)
  {
    deformvolume::CheckReferenceIndices(
      { volume.PointExtent, source.ToOutput, {} }, *this->Reference);
  }
  return source;
}

//------------------------------------------------------------------------------
DeformationSource vtkDeformVolumeFilter::vtkInternals::MakeSourceAtRest(const ImageGeometry& volume)
{
  if (this->Self->GetNumberOfInputConnections(2) > 0)
  {
    deformvolume::ThrowRestWithoutDeformation(2, 1);
  }
  if (!this->FieldAtRest || !(this->VolumeAtRest == volume))
  {
    this->FieldAtRest = MakeFieldAtRest(volume);
    this->VolumeAtRest = volume;
  }
  DeformationSource source = this->MakeSource(volume, this->FieldAtRest, nullptr);
  source.Selector = [](vtkDataSet* dataSet) { return dataSet->GetPointData()->GetVectors(); };
  source.PointsAreDeformed = false;
  source.DisplacementScale = 1.0;
  // Displacements of zero have the same effect in a forward and in an inverse field. Mesh
  // rasterization needs an inverse field.
  source.FieldIsInverse = this->Self->Resampler == MESH_RASTERIZATION;
  source.Choice = source.FieldIsInverse ? "at rest inverse" : "at rest";
  return source;
}

//------------------------------------------------------------------------------
deformvolume::Resampling vtkDeformVolumeFilter::vtkInternals::ChooseResampler(
  vtkImageData* volume, const std::function<void(deformvolume::Resampling)>& checkMemory) const
{
  deformvolume::ResamplerRequest request;
  switch (this->Self->Resampler)
  {
    case EXACT:
      request.Method = deformvolume::Resampling::Exact;
      break;
    case MESH_RASTERIZATION:
      request.Method = deformvolume::Resampling::MeshRasterization;
      break;
    default:
      break;
  }
  request.Outside = this->GetOutside();
  request.HasSmoothCut = deformvolume::HasCut(volume);
  request.NeedsJacobian = this->GetExtraArrays().NeedsJacobian();
  request.CountsFolds = this->Self->GenerateFoldCount;
  if (request.HasSmoothCut && this->Self->GetNumberOfInputConnections(1) == 0 &&
    this->State->Deformation.IsInverseField())
  {
    throw Error("The resampler MESH_RASTERIZATION cannot do smooth cuts. Set SmoothCut of "
                "vtkCutVolume to off, or Resampler to EXACT.");
  }
  const deformvolume::Resampling method =
    deformvolume::ChooseResampler(this->State->Deformation, request, checkMemory);
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
  this->Report.DeviceOutputs.clear(); // the arrays of the output hold them
  this->StaticMappingTime = this->State->Mapping.TakeTime();
  this->Self->NumberOfInvertedTetrahedra = this->State->Deformation.IsInverseField()
    ? this->GetNumberOfFolds()
    : report.NumberOfInvertedTetrahedra;
  this->Self->NumberOfFlatTetrahedra = method == deformvolume::Resampling::MeshRasterization
    ? report.NumberOfFlatTetrahedra
    : this->State->Deformation.IsField() ? 0
                                         : this->State->Mapping.GetNumberOfFlatTetrahedra();
  this->Self->NumberOfCoveredVoxels = report.NumberOfCoveredVoxels;
  this->Self->NumberOfHiddenVoxels = report.NumberOfHiddenSamples;
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
std::function<bool(double)> vtkDeformVolumeFilter::vtkInternals::GetProgress(
  double from, double to) const
{
  // Observers may be called only in the thread that updates the filter.
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
