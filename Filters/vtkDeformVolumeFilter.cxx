// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformVolumeFilter.h"

#include "vtkDeformVolumeFilterInternals.h"

#include "Device.h"
#include "FailureReport.h"
#include "InputUpdate.h"
#include "OutputExtent.h"
#include "VolumeArrays.h"

#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <iterator>

using deformvolume::DeformationSource;
using deformvolume::Error;
using deformvolume::Extent;
using deformvolume::ImageGeometry;

vtkStandardNewMacro(vtkDeformVolumeFilter);

//------------------------------------------------------------------------------
vtkDeformVolumeFilter::vtkDeformVolumeFilter()
  : Internals(new vtkInternals(this))
{
  this->SetNumberOfInputPorts(3);
  this->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::VECTORS);
}

//------------------------------------------------------------------------------
vtkDeformVolumeFilter::~vtkDeformVolumeFilter() = default;

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::SetDeformationConnection(vtkAlgorithmOutput* output)
{
  this->SetInputConnection(1, output);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::SetDeformationData(vtkDataObject* data)
{
  this->SetInputDataInternal(1, data);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::SetRestConnection(vtkAlgorithmOutput* output)
{
  this->SetInputConnection(2, output);
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::SetRestData(vtkDataObject* data)
{
  this->SetInputDataInternal(2, data);
}

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
vtkStringArray* vtkDeformVolumeFilter::GetDeviceNames()
{
  vtkStringArray* names = vtkStringArray::New();
  for (const std::string& name : deformvolume::GetDeviceNames())
  {
    names->InsertNextValue(name);
  }
  return names;
}

//------------------------------------------------------------------------------
vtkStringArray* vtkDeformVolumeFilter::GetDeviceChoices()
{
  vtkStringArray* choices = this->Internals->DeviceChoices;
  choices->Initialize();
  for (const char* kind : { deformvolume::BEST_DEVICE, "cpu", "gpu" })
  {
    choices->InsertNextValue(kind);
  }
  for (const std::string& name : deformvolume::GetDeviceNames())
  {
    choices->InsertNextValue(name);
  }
  return choices;
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkDeformVolumeFilter::GetDeviceMemory()
{
  return static_cast<vtkTypeInt64>(this->Internals->Device.GetDeviceMemory());
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::ReleaseDeviceMemory()
{
  this->Internals->Device.ReleaseMemory();
  this->Internals->Outputs.Forget();
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  // All ports are optional for the executive: its message about a missing input would not say what
  // to connect.
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  if (port == 0)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
    return 1;
  }
  // Composite datasets come first, or the executive would iterate over their leaves.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  if (port == 1)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  if (this->Internals->Aborted)
  {
    this->Internals->Aborted = false;
    this->Internals->AbortTime.Modified();
  }
  *mtime = std::max(this->GetMTime(), this->Internals->AbortTime.GetMTime());
  return 1;
}

//------------------------------------------------------------------------------
vtkTypeBool vtkDeformVolumeFilter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output)
{
  std::string message;
  try
  {
    if (!this->Superclass::ProcessRequest(request, input, output))
    {
      return deformvolume::Fail(this);
    }
    if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()))
    {
      this->Internals->ToldMessage.clear();
    }
    return 1;
  }
  catch (const deformvolume::Aborted&)
  {
    this->Internals->Aborted = true;
  }
  catch (const std::bad_alloc&)
  {
    message = "The memory of this machine does not suffice for the deformed volume. Use a smaller "
              "volume, a coarser output spacing or narrower output bounds.";
  }
  catch (const std::exception& error)
  {
    message = error.what();
  }

  vtkInformation* outInfo = output->GetInformationObject(0);
  if (vtkDataObject* data = vtkDataObject::GetData(outInfo))
  {
    data->Initialize();
  }
  this->Internals->Outputs.Forget();
  if (message.empty())
  {
    return 1;
  }
  vtkInternals::ForgetRequestedExtent(outInfo);
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_INFORMATION()))
  {
    // Nothing is offered, so that a pass that goes on in spite of the failure finds nothing.
    const int empty[6] = { 0, -1, 0, -1, 0, -1 };
    outInfo->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), empty, 6);
    outInfo->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), empty, 6);
    // Told with the data: who asks for information may be about to choose inputs and arrays.
    this->Internals->InformationFailed = true;
    this->Internals->PostponedError = message;
    return 1;
  }
  if (this->Internals->IsNews(message))
  {
    vtkErrorMacro(<< message);
  }
  return deformvolume::Fail(this);
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::RequestInformation(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkInformation* outInfo = output->GetInformationObject(0);
  if (this->Internals->InformationFailed)
  {
    // The executive then asks for the whole extent anew.
    outInfo->Remove(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT_INITIALIZED());
    this->Internals->InformationFailed = false;
    this->Internals->PostponedError.clear();
  }
  const deformvolume::Ranks ranks;
  if (ranks.AreMany())
  {
    ranks.GetNeighbours(); // before anything asks for a device
  }
  vtkInformation* volumeInfo = input[0]->GetInformationObject(0);
  ImageGeometry volume;
  ImageGeometry outputGeometry;
  ranks.Attempt(
    [&]
    {
      if (this->GetNumberOfInputConnections(0) == 0)
      {
        throw Error("There is no volume. Connect a vtkImageData to input port 0.");
      }
      if (this->GetNumberOfInputConnections(1) == 0)
      {
        throw Error("There is no deformation. Connect a vtkUnstructuredGrid with tetrahedra or a "
                    "vtkImageData with displacements to input port 1.");
      }
      if (!volumeInfo->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
      {
        throw Error("The volume on input port 0 announces no whole extent. Connect a "
                    "vtkImageData; from a composite dataset, extract one block.");
      }
      volume = deformvolume::GetGeometry(volumeInfo);
      deformvolume::CheckVolume(volume);
      outputGeometry = this->Internals->GetOutputGeometry(volume);
      // Here, since ParaView's views complain, too, where data fail that were announced.
      deformvolume::DeviceSession::CheckDevice(this->Device);
    });
  deformvolume::MergeTimes(this, outInfo);

  deformvolume::IndexBounds deformed;
  if (this->OutputBoundsMode == DEFORMED_BOUNDS)
  {
    deformed = this->Internals->GetDeformedBounds(ranks, volume, outInfo);
  }
  Extent whole;
  switch (this->OutputBoundsMode)
  {
    case VOLUME_BOUNDS:
      whole = deformvolume::GetExtentAround(
        deformvolume::GetVolumeBounds(volume, volume.Spacing / outputGeometry.Spacing));
      break;
    case CUSTOM_BOUNDS:
      whole = deformvolume::GetExtentAround(
        deformvolume::GetWorldBoxBounds(this->CustomBounds, outputGeometry));
      break;
    default:
      whole = deformvolume::GetExtentInside(deformed);
  }
  whole = deformvolume::GetPadded(whole, this->Padding);

  const glm::dmat3 rows = glm::transpose(outputGeometry.Direction);
  outInfo->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data(), 6);
  outInfo->Set(vtkDataObject::ORIGIN(), glm::value_ptr(outputGeometry.Origin), 3);
  outInfo->Set(vtkDataObject::SPACING(), glm::value_ptr(outputGeometry.Spacing), 3);
  outInfo->Set(vtkDataObject::DIRECTION(), glm::value_ptr(rows), 9);
  outInfo->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
    volumeInfo, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  if (scalars && scalars->Has(vtkDataObject::FIELD_ARRAY_TYPE()))
  {
    const int components = scalars->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
      ? scalars->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
      : 1;
    vtkDataObject::SetPointDataActiveScalarInfo(
      outInfo, scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE()), components);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  if (this->Internals->InformationFailed)
  {
    throw Error(this->Internals->PostponedError);
  }
  const deformvolume::Ranks ranks;
  for (int port = 1; port < this->GetNumberOfInputPorts(); ++port)
  {
    if (input[port]->GetNumberOfInformationObjects() > 0)
    {
      deformvolume::RequestInput(input[port]->GetInformationObject(0), ranks);
    }
  }
  vtkInformation* volumeInfo = input[0]->GetInformationObject(0);
  deformvolume::RequestExtent(volumeInfo,
    this->Internals->GetNeededExtent(ranks, volumeInfo, output->GetInformationObject(0)));
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformVolumeFilter::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkInformation* outInfo = output->GetInformationObject(0);
  vtkImageData* image = vtkImageData::GetData(outInfo);
  if (this->Internals->InformationFailed || !image)
  {
    if (vtkDataObject* data = vtkDataObject::GetData(outInfo))
    {
      data->Initialize();
    }
    vtkInternals::ForgetRequestedExtent(outInfo);
    return 0;
  }
  // Nothing of an earlier execution is left standing beside a failure.
  image->Initialize();
  this->PreprocessingTime = this->TransferTime = this->MappingTime = this->ResamplingTime = 0.0;
  this->NumberOfInvertedTetrahedra = this->NumberOfFlatTetrahedra = this->NumberOfCoveredVoxels = 0;
  this->NumberOfBricks = this->NumberOfResampledBricks = 0;
  const deformvolume::Ranks ranks;
  vtkImageData* volume = vtkImageData::GetData(input[0]);
  deformvolume::MappedVolume mapped;
  ranks.Attempt(
    [&]
    {
      if (!volume)
      {
        throw Error("There is no volume. Connect a vtkImageData to input port 0.");
      }
      mapped = this->Internals->GetMappedVolume(ranks, volume, input[0]->GetInformationObject(0));
    });
  const ImageGeometry& geometry = mapped.Whole;
  const DeformationSource source = this->Internals->ReadDeformation(
    ranks, geometry, vtkDataObject::GetData(input[1]), vtkDataObject::GetData(input[2]));
  deformvolume::Deformation& deformation = this->Internals->Deformation;

  std::vector<deformvolume::SourceArray> arrays;
  ranks.Attempt(
    [&]
    {
      std::vector<std::string> leftOut;
      arrays = deformvolume::SelectArrays(volume, this->Internals->CategoricalArrays, leftOut);
      this->Internals->WarnOfIgnored(volume, leftOut);
    });

  deformvolume::DeformRequest request;
  outInfo->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), request.OutputExtent.data());
  const vtkIdType numberOfPoints = deformvolume::GetNumberOfPoints(request.OutputExtent);
  if (numberOfPoints == 0 && !ranks.AreMany())
  {
    return 1;
  }
  deformvolume::Lattice lattice{ mapped.Part,
    { { source.Scale.x, source.Scale.y, source.Scale.z } }, geometry.PointExtent };
  deformvolume::DeviceSession& device = this->Internals->Device;
  const std::vector<deformvolume::VolumeArray> described =
    deformvolume::Describe(arrays, this->BackgroundValue);
  Extent whole;
  outInfo->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
  request.WholeOutputExtent = whole;
  request.Interpolation = this->Interpolation == CUBIC_INTERPOLATION
    ? deformvolume::Interpolation::Cubic
    : deformvolume::Interpolation::Linear;
  std::uint64_t heldBytes = 0;
  const std::function<void(const Extent&, deformvolume::Resampling)> checkMemory =
    [&](const Extent& extent, deformvolume::Resampling method)
  {
    const bool isMapped = method != deformvolume::Resampling::MeshRasterization;
    device.CheckMemory(lattice, described, extent, heldBytes, deformation,
      isMapped ? this->Internals->Mapping.GetRunBytes(deformation, mapped) : 0, method);
  };
  std::string form = "field";
  ranks.Attempt(
    [&]
    {
      if (numberOfPoints == 0)
      {
        return;
      }
      this->DeviceInUse =
        device.SetDevice(this->Device, static_cast<std::uint64_t>(this->MemoryLimit),
          static_cast<std::size_t>(this->WorkGroupSize));
      heldBytes = this->Internals->Outputs.Prepare(arrays, numberOfPoints);
      // The memory for the whole decides, so that all parts are made alike. A volume that is read
      // in parts need never fit.
      request.Method = this->Internals->ChooseResampler(
        [&](deformvolume::Resampling method)
        {
          if (mapped.IsWhole())
          {
            checkMemory(whole, method);
          }
        });
      if (!deformation.IsField() && request.Method != deformvolume::Resampling::MeshRasterization)
      {
        form = this->Internals->Mapping.GetRunBytes(deformation, mapped) > 0 ? "runs" : "links";
      }
    });
  if (ranks.IsAny(request.Method == deformvolume::Resampling::MeshRasterization))
  {
    request.Method = deformvolume::Resampling::MeshRasterization;
    this->Internals->SetResamplerInUse(request.Method);
  }
  deformvolume::DeformReport report;
  const auto deform = [&]
  {
    checkMemory(request.OutputExtent, request.Method);
    device.SetVolume(lattice, volume, arrays, this->BackgroundValue, request.Method);
    if (request.Method == deformvolume::Resampling::MeshRasterization)
    {
      device.SetRestMesh(deformation);
    }
    else
    {
      device.SetDeformation(
        deformation, this->Internals->Mapping, mapped, this->Internals->GetProgress(0.0, 0.3));
    }
    request.Progress = this->Internals->GetProgress(0.3, 1.0);
    if (!request.Progress(0.0))
    {
      throw deformvolume::Aborted();
    }

    const ImageGeometry outputGeometry = this->Internals->GetOutputGeometry(geometry);
    const glm::dmat3 rows = glm::transpose(outputGeometry.Direction);
    image->SetExtent(request.OutputExtent.data());
    image->SetOrigin(glm::value_ptr(outputGeometry.Origin));
    image->SetSpacing(glm::value_ptr(outputGeometry.Spacing));
    image->SetDirectionMatrix(glm::value_ptr(rows));
    image->GetFieldData()->ShallowCopy(volume->GetFieldData());
    this->Internals->Outputs.Make(arrays, image, request);
    request.Incremental = this->Incremental;
    deformvolume::CopyRoles(volume->GetPointData(), image->GetPointData(), arrays);

    report = device.Deform(request);
  };
  this->Internals->RunInTurn(ranks,
    deformvolume::DescribeKernels(this->DeviceInUse, request, form, described), numberOfPoints > 0,
    deform);
  if (numberOfPoints == 0)
  {
    return 1;
  }
  if (vtkInternals::IsReleased(outInfo))
  {
    this->Internals->Outputs.Forget();
  }
  else
  {
    this->Internals->Outputs.Keep();
  }
  this->PreprocessingTime = this->Internals->Mapping.TakeTime();
  this->TransferTime = report.TransferTime;
  this->MappingTime = report.MappingTime;
  this->ResamplingTime = report.ResamplingTime;
  this->NumberOfInvertedTetrahedra = report.NumberOfInvertedTetrahedra;
  this->NumberOfFlatTetrahedra = request.Method == deformvolume::Resampling::MeshRasterization
    ? report.NumberOfFlatTetrahedra
    : deformation.IsField() ? 0
                            : this->Internals->Mapping.GetNumberOfFlatTetrahedra();
  this->NumberOfCoveredVoxels = report.NumberOfCoveredVoxels;
  this->NumberOfBricks = report.NumberOfBricks;
  this->NumberOfResampledBricks = report.NumberOfResampledBricks;
  this->NumberOfMappingBuilds = this->Internals->Mapping.GetNumberOfBuilds();
  this->NumberOfVolumeUploads = device.GetNumberOfVolumeUploads();
  if (report.NumberOfOverstretchedCells > 0)
  {
    vtkWarningMacro(<< report.NumberOfOverstretchedCells
                    << " cells of the volume have a tetrahedron that is stretched over more than "
                       "4,000 output voxels; these tetrahedra are skipped. Check the deformation, "
                       "or set a greater output spacing.");
  }
  if (report.NumberOfCoveredVoxels == 0 && whole == request.OutputExtent)
  {
    vtkWarningMacro("The deformed volume covers no voxel of the output: all of it is background. "
                    "Check the output bounds, and that the deformation mesh holds neighbouring "
                    "voxels of the volume.");
  }
  vtkInformation* imageInfo = image->GetInformation();
  if (outInfo->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
  {
    imageInfo->Set(vtkDataObject::DATA_TIME_STEP(),
      outInfo->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()));
  }
  else
  {
    for (vtkDataObject* data : { source.Shape, static_cast<vtkDataObject*>(volume) })
    {
      if (data->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
      {
        imageInfo->Set(vtkDataObject::DATA_TIME_STEP(),
          data->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
        break;
      }
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "DisplacementScale: " << this->DisplacementScale << "\n";
  os << indent << "OutputBoundsMode: " << this->OutputBoundsMode << "\n";
  os << indent << "CustomBounds:";
  for (double bound : this->CustomBounds)
  {
    os << " " << bound;
  }
  os << "\n";
  os << indent << "Padding: " << this->Padding << "\n";
  os << indent << "OutputSpacingMode: " << this->OutputSpacingMode << "\n";
  os << indent << "CustomSpacing: " << this->CustomSpacing[0] << " " << this->CustomSpacing[1]
     << " " << this->CustomSpacing[2] << "\n";
  os << indent << "BackgroundValue: " << this->BackgroundValue << "\n";
  os << indent << "OutsideMode: " << this->OutsideMode << "\n";
  os << indent << "CategoricalArrays:";
  for (const std::string& name : this->Internals->CategoricalArrays)
  {
    os << " \"" << name << "\"";
  }
  os << "\n";
  os << indent << "Resampler: " << this->Resampler << "\n";
  os << indent << "Interpolation: " << this->Interpolation << "\n";
  os << indent << "ResamplerInUse: " << this->ResamplerInUse << "\n";
  os << indent << "Incremental: " << (this->Incremental ? "on" : "off") << "\n";
  os << indent << "StreamInput: " << (this->StreamInput ? "on" : "off") << "\n";
  os << indent << "Device: \"" << this->Device << "\"\n";
  os << indent << "MemoryLimit: " << this->MemoryLimit << "\n";
  os << indent << "WorkGroupSize: " << this->WorkGroupSize << "\n";
  os << indent << "PreprocessingTime: " << this->PreprocessingTime << "\n";
  os << indent << "TransferTime: " << this->TransferTime << "\n";
  os << indent << "MappingTime: " << this->MappingTime << "\n";
  os << indent << "ResamplingTime: " << this->ResamplingTime << "\n";
  os << indent << "NumberOfInvertedTetrahedra: " << this->NumberOfInvertedTetrahedra << "\n";
  os << indent << "NumberOfFlatTetrahedra: " << this->NumberOfFlatTetrahedra << "\n";
  os << indent << "NumberOfCoveredVoxels: " << this->NumberOfCoveredVoxels << "\n";
  os << indent << "NumberOfBricks: " << this->NumberOfBricks << "\n";
  os << indent << "NumberOfResampledBricks: " << this->NumberOfResampledBricks << "\n";
  os << indent << "NumberOfMappingBuilds: " << this->NumberOfMappingBuilds << "\n";
  os << indent << "NumberOfVolumeUploads: " << this->NumberOfVolumeUploads << "\n";
  os << indent << "DeviceInUse: \"" << this->DeviceInUse << "\"\n";
}
