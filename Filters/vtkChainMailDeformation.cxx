// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChainMailDeformation.h"

#include "ChainMailSession.h"
#include "InputUpdate.h"
#include "NewWarnings.h"
#include "PieceRequest.h"
#include "PipelineExecution.h"
#include "ProgressReport.h"
#include "VTKThreads.h"

#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationInformationVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"

#include <algorithm>
#include <exception>
#include <set>
#include <sstream>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkChainMailDeformation);

namespace
{

// Describes handles that hold no voxel; "" if there are none.
std::string FindIdleHandles(const std::vector<deformvolume::ChainMailHandleReport>& handles)
{
  const auto isIdle = [](const deformvolume::ChainMailHandleReport& handle)
  { return handle.NumberOfVoxels == 0; };
  const auto first = std::find_if(handles.begin(), handles.end(), isIdle);
  return first == handles.end() ? ""
                                : std::to_string(std::count_if(first, handles.end(), isIdle)) +
      " handles hold no voxel that can move: their voxels are pinned, have no active tetrahedra, "
      "or belong to handles before them. The first of these handles is point " +
      std::to_string(first - handles.begin()) + " on input port 1.";
}

} // namespace

class vtkChainMailDeformation::vtkInternals
{
public:
  deformvolume::ChainMailSession Session;
  deformvolume::ChainMailSettings Settings;
  deformvolume::PipelineExecution Execution;
  std::set<std::string> Warnings; // of the last execution
};

vtkChainMailDeformation::vtkChainMailDeformation()
  : Internals(new vtkInternals)
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(2);
  for (std::size_t i = 0; i < deformvolume::DefaultChainMailMaterials.size(); ++i)
  {
    const deformvolume::ChainMailMaterial& material = deformvolume::DefaultChainMailMaterials[i];
    this->SetMaterial(
      static_cast<double>(i), material.MinimumStretch, material.MaximumStretch, material.Shear);
  }
}

vtkChainMailDeformation::~vtkChainMailDeformation() = default;

void vtkChainMailDeformation::SetMaterial(
  double index, double minimumStretch, double maximumStretch, double shear)
{
  this->Internals->Settings.Table.Set(this, index, { minimumStretch, maximumStretch, shear });
}

bool vtkChainMailDeformation::GetMaterialLimits(int index, double limits[3])
{
  return this->Internals->Settings.Table.GetNumbers(index, limits);
}

void vtkChainMailDeformation::ClearMaterials()
{
  this->Internals->Settings.Table.Clear(this);
}

int vtkChainMailDeformation::GetNumberOfMaterials()
{
  return this->Internals->Settings.Table.GetNumber();
}

void vtkChainMailDeformation::AddMaterialRange(double minimum, double maximum, double index)
{
  this->Internals->Settings.Table.AddRange(this, minimum, maximum, index);
}

void vtkChainMailDeformation::ClearMaterialRanges()
{
  this->Internals->Settings.Table.ClearRanges(this);
}

int vtkChainMailDeformation::GetNumberOfMaterialRanges()
{
  return static_cast<int>(this->Internals->Settings.Table.Ranges.size());
}

vtkIdType vtkChainMailDeformation::SaveState()
{
  try
  {
    return static_cast<vtkIdType>(this->Internals->Session.SaveState());
  }
  catch (const std::exception& error)
  {
    vtkErrorMacro(<< "The state cannot be saved: " << error.what());
    return -1;
  }
}

//------------------------------------------------------------------------------
bool vtkChainMailDeformation::RestoreState(vtkIdType state)
{
  if (!this->Internals->Session.RestoreState(state))
  {
    return false;
  }
  this->Modified();
  return true;
}

//------------------------------------------------------------------------------
bool vtkChainMailDeformation::RemoveState(vtkIdType state)
{
  return this->Internals->Session.RemoveState(state);
}

//------------------------------------------------------------------------------
int vtkChainMailDeformation::GetNumberOfStates()
{
  return static_cast<int>(this->Internals->Session.GetNumberOfStates());
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkChainMailDeformation::GetStateMemory()
{
  return static_cast<vtkTypeInt64>(this->Internals->Session.GetStateMemory());
}

//------------------------------------------------------------------------------
void vtkChainMailDeformation::Reset()
{
  this->Internals->Session.Reset();
  this->Modified();
}

int vtkChainMailDeformation::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkPointSet");
  deformvolume::AcceptBlocks(info);
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

int vtkChainMailDeformation::RequestInformation(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  // The executive has copied the information of the volume without its direction, but with its
  // scalars.
  constexpr int components = 3;
  vtkInformation* info = output->GetInformationObject(0);
  info->CopyEntry(input[0]->GetInformationObject(0), vtkDataObject::DIRECTION());
  deformvolume::MergeTimes(this, 2, info);
  info->Remove(vtkDataObject::POINT_DATA_VECTOR());
  vtkDataObject::SetActiveAttributeInfo(info, vtkDataObject::FIELD_ASSOCIATION_POINTS,
    vtkDataSetAttributes::VECTORS, "Displacement", VTK_FLOAT, components, -1);
  return 1;
}

int vtkChainMailDeformation::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  deformvolume::AskForAll(input, 0, 2);
  return 1;
}

int vtkChainMailDeformation::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Internals->Execution.Renew(this);
  *mtime = this->GetMTime();
  return 1;
}

int vtkChainMailDeformation::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* outputVector)
{
  vtkImageData* output = vtkImageData::GetData(outputVector);
  output->Initialize();
  deformvolume::ChainMailSettings settings = this->Internals->Settings;
  settings.Device = this->Device;
  settings.MemoryLimit = this->MemoryLimit;
  settings.ArrayName = this->MaterialArrayName;
  settings.DefaultMaterial = this->DefaultMaterial;
  settings.HandleRadius = this->HandleRadius;
  deformvolume::ChainMailRequest request;
  request.RelaxationSweeps = this->RelaxationSweeps;
  request.Elasticity = this->Elasticity;
  request.PlasticityThreshold = this->PlasticityThreshold;
  deformvolume::ProgressReport progress(this);
  request.Progress = [&] { return progress.Report(); };
  this->DeviceInUse.clear();
  this->LargestViolation = 0.0;
  this->NumberOfSweeps = 0;
  this->NumberOfMovedVoxels = 0;
  this->NumberOfReducedHandles = 0;
  this->NumberOfReleasedHandles = 0;
  std::fill_n(this->ChangedExtent, 6, -1);
  this->ChangedExtent[0] = this->ChangedExtent[2] = this->ChangedExtent[4] = 0;
  return this->Internals->Execution.Run(this,
    "There is not enough memory for the displacements. Use a smaller volume, or free "
    "memory.",
    [&]
    {
      deformvolume::RefuseBlocks(2, input);
      const deformvolume::ChainMailReport& report = this->Internals->Session.Step(
        { { this, this->GetMTime() }, deformvolume::GetInputStamp(this, 0) },
        vtkImageData::GetData(input[0]), deformvolume::GetWrittenStamp(this, 0),
        vtkPointSet::GetData(input[1]), settings, request);
      this->DeviceInUse = this->Internals->Session.GetDevice();
      this->LargestViolation = report.LargestViolation;
      this->NumberOfSweeps = report.NumberOfSweeps;
      this->NumberOfMovedVoxels = report.NumberOfMovedVoxels;
      std::copy(report.ChangedExtent.begin(), report.ChangedExtent.end(), this->ChangedExtent);
      this->NumberOfReducedHandles = report.CountReducedHandles();
      this->NumberOfReleasedHandles = report.CountReleasedHandles();
      this->Internals->Session.GiveOutput(output);
      const std::string warning = deformvolume::ReplaceWarnings(
        this->Internals->Warnings, { FindIdleHandles(report.Handles) });
      if (!warning.empty())
      {
        vtkWarningMacro(<< warning);
      }
    });
}

std::string vtkChainMailDeformation::GetSummary()
{
  if (this->DeviceInUse.empty())
  {
    return std::string();
  }
  std::ostringstream text;
  text << "Device: " << this->DeviceInUse << "\n"
       << "Voxels moved: " << this->NumberOfMovedVoxels << "\n"
       << "Sweeps: " << this->NumberOfSweeps << "\n"
       << "Largest violation: " << this->LargestViolation << " of the spacing";
  if (this->NumberOfReducedHandles > 0)
  {
    text << "\nHandles moved less than asked for, so that others stay: "
         << this->NumberOfReducedHandles;
  }
  if (this->NumberOfReleasedHandles > 0)
  {
    text << "\nHandles released, which hold no voxel or no possible displacement: "
         << this->NumberOfReleasedHandles;
  }
  return text.str();
}

void vtkChainMailDeformation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "HandleRadius: " << this->HandleRadius << "\n";
  this->Internals->Settings.Table.Print(os, indent);
  os << indent << "MaterialArrayName: " << this->MaterialArrayName << "\n";
  os << indent << "DefaultMaterial: " << this->DefaultMaterial << "\n";
  os << indent << "RelaxationSweeps: " << this->RelaxationSweeps << "\n";
  os << indent << "Elasticity: " << this->Elasticity << "\n";
  os << indent << "PlasticityThreshold: " << this->PlasticityThreshold << "\n";
  os << indent << "Device: " << this->Device << "\n";
  os << indent << "MemoryLimit: " << this->MemoryLimit << "\n";
  os << indent << "LargestViolation: " << this->LargestViolation << "\n";
  os << indent << "NumberOfSweeps: " << this->NumberOfSweeps << "\n";
  os << indent << "NumberOfMovedVoxels: " << this->NumberOfMovedVoxels << "\n";
  os << indent << "NumberOfReducedHandles: " << this->NumberOfReducedHandles << "\n";
  os << indent << "NumberOfReleasedHandles: " << this->NumberOfReleasedHandles << "\n";
  os << indent << "ChangedExtent:";
  for (const int bound : this->ChangedExtent)
  {
    os << " " << bound;
  }
  os << "\n" << indent << "DeviceInUse: " << this->DeviceInUse << "\n";
}
