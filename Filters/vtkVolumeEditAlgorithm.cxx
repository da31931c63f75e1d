// SPDX-License-Identifier: BSD-3-Clause
#include "vtkVolumeEditAlgorithm.h"

#include "vtkVolumeEditAlgorithmInternals.h"

#include "DeformationChoice.h"
#include "FiveTetrahedra.h"
#include "InputUpdate.h"
#include "MaskArray.h"
#include "PieceRequest.h"
#include "PipelineGeometry.h"
#include "ProgressReport.h"
#include "VTKThreads.h"

#include "vtkCellData.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

namespace
{

// Whether the data are a part without cells of a volume with cells, such as the part of a rank
// without work. Such a part is not edited.
bool IsPartWithoutCells(vtkImageData* volume, vtkInformation* info)
{
  return deformvolume::GetNumberOfCells(deformvolume::GetGeometry(volume).PointExtent) == 0 &&
    deformvolume::GetNumberOfCells(deformvolume::GetGeometry(info).PointExtent) > 0;
}

const unsigned char* FindBytes(vtkImageData* image, const char* name)
{
  auto* array = vtkArrayDownCast<deformvolume::ByteArray>(image->GetCellData()->GetArray(name));
  return array && array->GetNumberOfValues() == image->GetNumberOfCells() ? array->GetPointer(0)
                                                                          : nullptr;
}

// Hides cells with a tetrahedron that is switched off or divided from views, but not from
// vtkDeformVolumeFilter.
void HideEditedCells(vtkImageData* image)
{
  const char* ghostName = vtkDataSetAttributes::GhostArrayName();
  const unsigned char* active = FindBytes(image, deformvolume::ActiveTetrahedraName);
  const unsigned char* divided = FindBytes(image, deformvolume::CutTetrahedraName);
  const unsigned char* before = FindBytes(image, ghostName);
  vtkNew<vtkUnsignedCharArray> hidden;
  hidden->SetName(ghostName);
  hidden->SetNumberOfValues(image->GetNumberOfCells());
  unsigned char* values = hidden->GetPointer(0);
  vtkSMPTools::For(0, image->GetNumberOfCells(),
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin; i < end; ++i)
      {
        constexpr unsigned char Hidden = vtkDataSetAttributes::HIDDENCELL;
        const unsigned char value = before ? before[i] : 0;
        constexpr unsigned char All = DEFORMVOLUME_ALL_TETRAHEDRA;
        const bool isEdited =
          (active && (active[i] & All) != All) || (divided && (divided[i] & All) != 0);
        values[i] = isEdited && (value & Hidden) == 0
          ? static_cast<unsigned char>(value | Hidden | deformvolume::HiddenByEdit)
          : value;
      }
    });
  image->GetCellData()->AddArray(hidden);
}

} // namespace

//------------------------------------------------------------------------------
bool vtkVolumeEditAlgorithm::vtkEdits::SetVolume(vtkInformationVector** input)
{
  const bool isNew = this->Editor.SetVolume(vtkImageData::GetData(input[0]),
    input[0]->GetInformationObject(0), deformvolume::GetWrittenStamp(this->Self, 0));
  if (isNew)
  {
    this->Tool.Restart();
  }
  return isNew;
}

//------------------------------------------------------------------------------
deformvolume::EditFinder vtkVolumeEditAlgorithm::vtkEdits::MakeFinder(vtkInformationVector** input)
{
  deformvolume::EditFinder finder;
  finder.Volume = this->Editor.GetGeometry();
  finder.GetVertices = [this, input]() -> const deformvolume::VertexPositions&
  { return this->GetVertices(input); };
  finder.FarDistance = this->Editor.GetFarDistance();
  finder.Progress = this->Progress;
  return finder;
}

//------------------------------------------------------------------------------
const deformvolume::VertexPositions& vtkVolumeEditAlgorithm::vtkEdits::GetVertices(
  vtkInformationVector** input)
{
  if (vtkDataObject::GetData(input[3]) && !vtkDataObject::GetData(input[2]))
  {
    deformvolume::ThrowRestWithoutDeformation(3, 2);
  }
  const deformvolume::DeformationSource source =
    deformvolume::ChooseDeformation(vtkDataObject::GetData(input[2]),
      vtkDataObject::GetData(input[3]), this->Self->GetInputArrayInformation(0),
      [this](vtkDataSet* dataSet, int& association)
      { return this->Self->GetInputArrayToProcess(0, dataSet, association); },
      { this->Self->DisplacementScale, this->Self->PointsAreDeformed, false });
  return this->Editor.GetPositions(
    source, deformvolume::MakeOutsideVoxels(this->Self->OutsideMode, this->Self->FadeDistance));
}

//------------------------------------------------------------------------------
vtkVolumeEditAlgorithm::vtkVolumeEditAlgorithm()
  : Edits(new vtkEdits(this))
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(4);
  this->SetInputArrayToProcess(
    0, 2, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::VECTORS);
}

//------------------------------------------------------------------------------
vtkVolumeEditAlgorithm::~vtkVolumeEditAlgorithm() = default;

//------------------------------------------------------------------------------
void vtkVolumeEditAlgorithm::ClearToolPositions()
{
  if (this->Edits->Tool.GetNumberOfPositions() > 0)
  {
    this->Modified();
  }
  this->Edits->Tool.Clear();
}

//------------------------------------------------------------------------------
void vtkVolumeEditAlgorithm::ReplaceToolPositions()
{
  if (this->Edits->Tool.GetNumberOfPositions() > 0)
  {
    this->Edits->Tool.ClearForSameStroke();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkVolumeEditAlgorithm::GetNumberOfToolPositions()
{
  return static_cast<int>(this->Edits->Tool.GetNumberOfPositions());
}

//------------------------------------------------------------------------------
void vtkVolumeEditAlgorithm::Undo()
{
  if (this->Edits->Editor.Undo())
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkVolumeEditAlgorithm::Redo()
{
  if (this->Edits->Editor.Redo())
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkVolumeEditAlgorithm::Reset()
{
  if (this->Edits->Editor.Reset())
  {
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkIdType vtkVolumeEditAlgorithm::GetNumberOfSwitchedOffTetrahedra()
{
  return this->Edits->Editor.GetNumberOfSwitchedOffTetrahedra();
}

//------------------------------------------------------------------------------
int vtkVolumeEditAlgorithm::RequestInformation(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  // The executive copies all other information of the volume.
  // vtkImageAlgorithm::RequestInformation() would crash if an array of displacements is selected
  // and no deformation is connected.
  output->GetInformationObject(0)->CopyEntry(
    input[0]->GetInformationObject(0), vtkDataObject::DIRECTION());
  deformvolume::MergeTimes(this, 4, output->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkVolumeEditAlgorithm::FillInputPortInformation(int port, vtkInformation* info)
{
  switch (port)
  {
    case 0:
      info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
      deformvolume::AcceptBlocks(info);
      break;
    case 1:
      info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
      info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
      deformvolume::AcceptBlocks(info);
      break;
    default:
      deformvolume::FillDeformationPort(info);
      break;
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkVolumeEditAlgorithm::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* outInfo = output->GetInformationObject(0);
  input[0]->GetInformationObject(0)->Set(
    Pipeline::UPDATE_EXTENT(), outInfo->Get(Pipeline::UPDATE_EXTENT()), 6);
  deformvolume::AskForAll(input, 1, 4);
  return 1;
}

//------------------------------------------------------------------------------
int vtkVolumeEditAlgorithm::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkImageData* volume = vtkImageData::GetData(input[0]);
  vtkImageData* image = vtkImageData::GetData(output);
  image->Initialize();
  if (volume && IsPartWithoutCells(volume, input[0]->GetInformationObject(0)))
  {
    image->ShallowCopy(volume);
    return 1;
  }
  deformvolume::ProgressReport progress(this);
  this->Edits->Progress = [&](double done) { return progress.Report(done); };
  const int result = this->Edits->Execution.Run(this,
    "The memory of this machine does not suffice for the edits. Use a smaller volume.",
    [&]
    {
      deformvolume::RefuseBlocks(2, input);
      deformvolume::CheckTimes(4, input, output->GetInformationObject(0));
      deformvolume::CheckDisplacementScale(this->DisplacementScale);
      this->UpdateEdits(input);
      this->Edits->Tool.Finish();
      this->Edits->Editor.Write(volume, image);
      if (this->BlankCells)
      {
        HideEditedCells(image);
      }
    });
  this->Edits->Progress = nullptr;
  return result;
}

//------------------------------------------------------------------------------
int vtkVolumeEditAlgorithm::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Edits->Execution.Renew(this);
  *mtime = deformvolume::GetMTimeWithInputs(this);
  return 1;
}

//------------------------------------------------------------------------------
void vtkVolumeEditAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Accumulate: " << (this->Accumulate ? "on" : "off") << "\n";
  os << indent << "NumberOfToolPositions: " << this->GetNumberOfToolPositions() << "\n";
  os << indent << "DisplacementScale: " << this->DisplacementScale << "\n";
  os << indent << "PointsAreDeformed: " << (this->PointsAreDeformed ? "on" : "off") << "\n";
  os << indent << "OutsideMode: " << this->OutsideMode << "\n";
  os << indent << "FadeDistance: " << this->FadeDistance << "\n";
  os << indent << "BlankCells: " << (this->BlankCells ? "on" : "off") << "\n";
  os << indent << "NumberOfSwitchedOffTetrahedra: " << this->GetNumberOfSwitchedOffTetrahedra()
     << "\n";
}
