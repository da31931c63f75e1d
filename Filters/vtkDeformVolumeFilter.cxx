// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeFilter.h"

#include "vtkDeformVolumeFilterInternals.h"

#include "DeformationChoice.h"
#include "Device.h"
#include "InputUpdate.h"
#include "VTKThreads.h"

#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <sstream>

vtkStandardNewMacro(vtkDeformVolumeFilter);

//------------------------------------------------------------------------------
vtkDeformVolumeFilter::vtkDeformVolumeFilter()
  : Internals(new vtkInternals(this))
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(4);
  this->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::VECTORS);
}

//------------------------------------------------------------------------------
vtkDeformVolumeFilter::~vtkDeformVolumeFilter() = default;

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::AddCategoricalArray(const char* name)
{
  if (name && this->Internals->CategoricalArrays.insert(name).second)
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::RemoveCategoricalArray(const char* name)
{
  if (name && this->Internals->CategoricalArrays.erase(name) > 0)
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::ClearCategoricalArrays()
{
  if (!this->Internals->CategoricalArrays.empty())
  {
    this->Internals->CategoricalArrays.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::GetNumberOfCategoricalArrays()
{
  return static_cast<int>(this->Internals->CategoricalArrays.size());
}

//------------------------------------------------------------------------------
const char* vtkDeformVolumeFilter::GetCategoricalArray(int index)
{
  if (index < 0 || index >= this->GetNumberOfCategoricalArrays())
  {
    return nullptr;
  }
  return std::next(this->Internals->CategoricalArrays.begin(), index)->c_str();
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::AddDensityArray(const char* name)
{
  if (name && this->Internals->DensityArrays.insert(name).second)
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::RemoveDensityArray(const char* name)
{
  if (name && this->Internals->DensityArrays.erase(name) > 0)
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::ClearDensityArrays()
{
  if (!this->Internals->DensityArrays.empty())
  {
    this->Internals->DensityArrays.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::GetNumberOfDensityArrays()
{
  return static_cast<int>(this->Internals->DensityArrays.size());
}

//------------------------------------------------------------------------------
const char* vtkDeformVolumeFilter::GetDensityArray(int index)
{
  if (index < 0 || index >= this->GetNumberOfDensityArrays())
  {
    return nullptr;
  }
  return std::next(this->Internals->DensityArrays.begin(), index)->c_str();
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::SetResampler(int resampler)
{
  if (resampler == 1)
  {
    vtkErrorMacro("Resampler is 1, the published kernel, which was removed. Set Resampler to EXACT "
                  "(0), MESH_RASTERIZATION (2) or AUTOMATIC (3).");
    return;
  }
  resampler = std::clamp<int>(resampler, EXACT, AUTOMATIC);
  if (this->Resampler != resampler)
  {
    this->Resampler = resampler;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::SetFromState(const char* property, int value)
{
  struct RemovedProperty
  {
    const char* Name;
    int Default;
    const char* Replacement;
  };
  constexpr RemovedProperty removed[] = {
    { "StreamInput", 0,
      "with the output bounds mode CUSTOM_BOUNDS the input is streamed where its sources can make "
      "parts" },
    { "WorkGroupSize", 0, "the size is chosen for the device" },
    { "NumberOfTimeSamples", 11,
      "the output extent holds the times that were requested. For an extent that stays, set the "
      "output bounds mode to CUSTOM_BOUNDS or VOLUME_BOUNDS" },
  };
  const std::string name = property ? property : "";
  if (name == "Resampler")
  {
    if (value == 1)
    {
      vtkWarningMacro("Resampler is 1, the published kernel, which was removed: AUTOMATIC is set.");
    }
    this->SetResampler(value == 1 ? AUTOMATIC : value);
    return;
  }
  const auto* found = std::find_if(std::begin(removed), std::end(removed),
    [&](const RemovedProperty& one) { return name == one.Name; });
  if (found == std::end(removed))
  {
    vtkErrorMacro("SetFromState() does not know the property \"" << name << "\".");
  }
  else if (value != found->Default)
  {
    vtkWarningMacro(<< name << " was removed, and its value " << value
                    << " is ignored: " << found->Replacement << ".");
  }
}

//------------------------------------------------------------------------------
vtkStringArray* vtkDeformVolumeFilter::GetDeviceNames()
{
  deformvolume::Ranks().ShareProcessorsAlone();
  vtkStringArray* names = vtkStringArray::New();
  try
  {
    for (const std::string& name : deformvolume::GetDeviceNames())
    {
      names->InsertNextValue(name);
    }
  }
  catch (const std::exception& error)
  {
    vtkGenericWarningMacro(<< error.what());
  }
  return names;
}

//------------------------------------------------------------------------------
std::string vtkDeformVolumeFilter::GetSummary()
{
  if (this->DeviceInUse.empty())
  {
    return "";
  }
  const auto count = [](vtkIdType number)
  {
    std::string text = std::to_string(number);
    for (auto at = static_cast<int>(text.size()) - 3; at > 0; at -= 3)
    {
      text.insert(static_cast<std::size_t>(at), ",");
    }
    return text;
  };
  std::ostringstream text;
  const deformvolume::DeformReport& report = this->Internals->Report;
  const auto sum = [this](const auto& getCount)
  {
    vtkIdType all = 0;
    for (const auto& state : this->Internals->States)
    {
      all += static_cast<vtkIdType>(getCount(state.second));
    }
    return all;
  };
  using State = deformvolume::ExecutionState;
  text << "Device: " << this->DeviceInUse << "\n"
       << "Resampler: "
       << (this->ResamplerInUse == MESH_RASTERIZATION ? "mesh rasterization" : "exact") << "\n"
       << "Covered voxels: " << count(this->NumberOfCoveredVoxels) << "\n"
       << "Inverted tetrahedra: " << count(this->NumberOfInvertedTetrahedra) << "\n"
       << "Hidden voxels: " << count(this->NumberOfHiddenVoxels) << "\n"
       << "Flat tetrahedra: " << count(this->NumberOfFlatTetrahedra) << "\n"
       << "Bricks resampled: " << count(report.NumberOfResampledBricks) << "\n"
       << "Bricks of the volume: " << count(report.NumberOfBricks) << "\n"
       << "Static mappings made: "
       << count(sum([](const State& state) { return state.Mapping.GetNumberOfBuilds(); })) << "\n"
       << "Volumes sent: "
       << count(sum([](const State& state) { return state.Device.GetNumberOfVolumeUploads(); }))
       << "\n"
       << "Arrays on the device: " << this->Internals->State->Outputs.GetNumberOfUnread() << "\n"
       << "Seconds for the static mapping: " << this->Internals->StaticMappingTime << "\n"
       << "Seconds for transfer: " << report.TransferTime << "\n"
       << "Seconds for mapping: " << report.MappingTime << "\n"
       << "Seconds for resampling: " << report.ResamplingTime << "\n"
       << "Seconds for compilation: " << report.CompilationTime;
  return text.str();
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkDeformVolumeFilter::GetDeviceMemory()
{
  return static_cast<vtkTypeInt64>(this->Internals->GetDeviceMemory());
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::ReleaseDeviceMemory()
{
  for (auto& state : this->Internals->States)
  {
    state.second.Device.ReleaseMemory();
    state.second.Outputs.Forget();
  }
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1 || port == 2)
  {
    deformvolume::FillDeformationPort(info);
    return 1;
  }
  if (port == 3)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Internals->MarkModifiedIfBoundsHaveGrown();
  this->Internals->Execution.Renew(this);
  *mtime = deformvolume::GetMTimeWithInputs(this);
  return 1;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "DisplacementScale: " << this->DisplacementScale << "\n";
  os << indent << "PointsAreDeformed: " << (this->PointsAreDeformed ? "on" : "off") << "\n";
  os << indent << "FieldIsInverse: " << (this->FieldIsInverse ? "on" : "off") << "\n";
  os << indent << "OutputBoundsMode: " << this->OutputBoundsMode << "\n";
  os << indent << "CustomBounds:";
  for (double bound : this->CustomBounds)
  {
    os << " " << bound;
  }
  os << "\n";
  os << indent << "Padding: " << this->Padding << "\n";
  os << indent << "BoundsGranularity: " << this->BoundsGranularity << "\n";
  os << indent << "OutputSpacingMode: " << this->OutputSpacingMode << "\n";
  os << indent << "CustomSpacing: " << this->CustomSpacing[0] << " " << this->CustomSpacing[1]
     << " " << this->CustomSpacing[2] << "\n";
  os << indent << "SamplingFactor: " << this->SamplingFactor << "\n";
  os << indent << "BackgroundValue: " << this->BackgroundValue << "\n";
  os << indent << "OutsideMode: " << this->OutsideMode << "\n";
  os << indent << "FadeDistance: " << this->FadeDistance << "\n";
  os << indent << "CategoricalArrays:";
  for (const std::string& name : this->Internals->CategoricalArrays)
  {
    os << " \"" << name << "\"";
  }
  os << "\n";
  os << indent << "DensityArrays:";
  for (const std::string& name : this->Internals->DensityArrays)
  {
    os << " \"" << name << "\"";
  }
  os << "\n";
  os << indent << "GenerateRestPositions: " << (this->GenerateRestPositions ? "on" : "off") << "\n";
  os << indent << "GenerateJacobian: " << (this->GenerateJacobian ? "on" : "off") << "\n";
  os << indent << "GenerateFoldCount: " << (this->GenerateFoldCount ? "on" : "off") << "\n";
  os << indent << "Resampler: " << this->Resampler << "\n";
  os << indent << "Interpolation: " << this->Interpolation << "\n";
  os << indent << "ResamplerInUse: " << this->ResamplerInUse << "\n";
  os << indent << "OpenSplits: " << (this->OpenSplits ? "on" : "off") << "\n";
  os << indent << "Incremental: " << (this->Incremental ? "on" : "off") << "\n";
  os << indent << "OutputOnDevice: " << (this->OutputOnDevice ? "on" : "off") << "\n";
  os << indent << "Device: \"" << this->Device << "\"\n";
  os << indent << "MemoryLimit: " << this->MemoryLimit << "\n";
  os << indent << "NumberOfInvertedTetrahedra: " << this->NumberOfInvertedTetrahedra << "\n";
  os << indent << "NumberOfHiddenVoxels: " << this->NumberOfHiddenVoxels << "\n";
  os << indent << "NumberOfFlatTetrahedra: " << this->NumberOfFlatTetrahedra << "\n";
  os << indent << "NumberOfCoveredVoxels: " << this->NumberOfCoveredVoxels << "\n";
  os << indent << "ChangedExtent:";
  for (const int end : this->ChangedExtent)
  {
    os << " " << end;
  }
  os << "\n";
  os << indent << "DeviceInUse: \"" << this->DeviceInUse << "\"\n";
}
