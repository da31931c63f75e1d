// SPDX-License-Identifier: BSD-3-Clause
// Sources of pipelines: one that makes any part of a volume, and one whose mesh varies in time.
#ifndef Sources_h
#define Sources_h

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataObject.h>
#include <vtkImageAlgorithm.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridAlgorithm.h>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

/// Makes the requested extent of a volume, and records the extents that it has made.
class PartSource : public vtkImageAlgorithm
{
public:
  static PartSource* New();
  vtkTypeMacro(PartSource, vtkImageAlgorithm);

  void SetVolume(vtkImageData* volume)
  {
    this->Volume = volume;
    this->Modified();
  }
  /// Whether the source sets CAN_PRODUCE_SUB_EXTENT and makes only the requested extent.
  bool CanMakeParts = true;
  /// Whether RequestInformation() announces the cell arrays.
  bool AnnouncesArrays = true;
  /// Whether the source makes an extent that differs from the requested one.
  bool GivesOtherParts = false;
  /// Announced instead of the extent of the volume, unless it is empty.
  std::array<int, 6> WholeExtent{ { 0, -1, 0, -1, 0, -1 } };

  std::vector<std::array<int, 6>> Made;
  /// The number of voxels of the largest part made so far.
  vtkIdType GetMost() const
  {
    vtkIdType most = 0;
    for (const std::array<int, 6>& extent : this->Made)
    {
      vtkIdType size = 1;
      for (int axis = 0; axis < 3; ++axis)
      {
        size *= extent[2 * axis + 1] - extent[2 * axis] + 1;
      }
      most = std::max(most, size);
    }
    return most;
  }

protected:
  PartSource() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    vtkInformation* info = output->GetInformationObject(0);
    const bool isOther = this->WholeExtent[0] <= this->WholeExtent[1];
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(),
      isOther ? this->WholeExtent.data() : this->Volume->GetExtent(), 6);
    info->Set(vtkDataObject::ORIGIN(), this->Volume->GetOrigin(), 3);
    info->Set(vtkDataObject::SPACING(), this->Volume->GetSpacing(), 3);
    info->Set(vtkDataObject::DIRECTION(), this->Volume->GetDirectionMatrix()->GetData(), 9);
    if (vtkDataArray* scalars = this->Volume->GetPointData()->GetScalars())
    {
      vtkDataObject::SetPointDataActiveScalarInfo(
        info, scalars->GetDataType(), scalars->GetNumberOfComponents());
    }
    if (this->CanMakeParts)
    {
      info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
    }
    if (this->AnnouncesArrays)
    {
      vtkNew<vtkInformationVector> arrays;
      for (int i = 0; i < this->Volume->GetCellData()->GetNumberOfArrays(); ++i)
      {
        vtkNew<vtkInformation> array;
        array->Set(vtkDataObject::FIELD_NAME(), this->Volume->GetCellData()->GetArrayName(i));
        arrays->Append(array);
      }
      info->Set(vtkDataObject::CELL_DATA_VECTOR(), arrays);
    }
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    vtkInformation* info = output->GetInformationObject(0);
    vtkImageData* image = vtkImageData::GetData(info);
    std::array<int, 6> asked;
    info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), asked.data());
    image->ShallowCopy(this->Volume);
    if (this->CanMakeParts)
    {
      asked[1] -= this->GivesOtherParts ? 1 : 0;
      // In the VTK of ParaView 5.13, Crop() fails for an empty extent.
      if (asked[0] <= asked[1] && asked[2] <= asked[3] && asked[4] <= asked[5])
      {
        image->Crop(asked.data());
      }
      else
      {
        image->Initialize();
      }
    }
    std::array<int, 6>& made = this->Made.emplace_back();
    image->GetExtent(made.data());
    return 1;
  }

  vtkSmartPointer<vtkImageData> Volume;
};
inline vtkStandardNewMacro(PartSource);

/// Makes a mesh that varies in time, from 0 to LastTime.
class TimedMesh : public vtkUnstructuredGridAlgorithm
{
public:
  static TimedMesh* New();
  vtkTypeMacro(TimedMesh, vtkUnstructuredGridAlgorithm);

  std::function<vtkSmartPointer<vtkUnstructuredGrid>(double time)> GetMesh;
  double LastTime = 0.0;
  /// The time steps. They are announced unless there are none.
  std::vector<double> Steps;
  int Executions = 0;

protected:
  TimedMesh() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    const double range[2] = { 0.0, this->LastTime };
    vtkInformation* info = output->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
    info->Remove(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
    if (!this->Steps.empty())
    {
      info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), this->Steps.data(),
        static_cast<int>(this->Steps.size()));
    }
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    ++this->Executions;
    vtkInformation* info = output->GetInformationObject(0);
    const double asked = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      : 0.0;
    const double time = std::clamp(asked, 0.0, this->LastTime);
    vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::GetData(output);
    mesh->ShallowCopy(this->GetMesh(time));
    mesh->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    return 1;
  }
};
inline vtkStandardNewMacro(TimedMesh);

#endif
