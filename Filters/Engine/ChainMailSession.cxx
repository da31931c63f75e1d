// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailSession.h"

#include "ExtentRanges.h"
#include "HandlePositions.h"
#include "PipelineGeometry.h"
#include "ShapedArray.h"
#include "VolumeArrays.h"
#include "WorldHandles.h"

#include "vtkArrayChanges.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace deformvolume
{

namespace
{

const char* const PINNED = "Pinned";

Stamp GetStampOf(vtkDataArray* array, const Stamp::value_type& written)
{
  Stamp stamp{ written };
  AddArray(stamp, array);
  return stamp;
}

// Null if there is no array of this name.
vtkDataArray* FindVolumeArray(vtkImageData* volume, const char* name)
{
  return FindShapedArray(
    volume->GetPointData(), name, 1, volume->GetNumberOfPoints(), "point array", "the volume");
}

// Reads the masks without the tetrahedra that a smooth cut crosses, which must not link voxels.
VolumeMasks ReadLinkMasks(vtkImageData* volume)
{
  VolumeMasks masks = ReadMasks(volume, {});
  SwitchOffCut(masks, static_cast<std::size_t>(volume->GetNumberOfCells()));
  return masks;
}

// Bytes of a snapshot without its blocks.
std::uint64_t GetIndexMemory(const ChainMailSnapshot& snapshot)
{
  return snapshot.Numbers.size() *
    (sizeof(std::uint32_t) + sizeof(std::shared_ptr<const ChainMailSnapshot::Block>));
}

} // namespace

void ChainMailSession::Forget()
{
  this->HasVolume = false;
  this->KeyOfMaterials = MaterialsKey();
  this->StampOfMasks.clear();
  this->StampOfPins.clear();
}

void ChainMailSession::SetVolume(const ImageGeometry& geometry, const ChainMailSettings& settings)
{
  this->Model.SetMemoryLimit(static_cast<std::uint64_t>(settings.MemoryLimit));
  const std::string device = this->Model.SetDevice(settings.Device);
  if (this->HasVolume && this->Device == device && this->Geometry == geometry)
  {
    return;
  }
  this->Forget();
  this->Model.SetVoxelGrid(geometry.PointExtent, GetVoxelMatrix(geometry));
  this->Device = device;
  this->MakeOutput(GetNumberOfPoints(geometry.PointExtent));
  this->Geometry = geometry;
  this->HasVolume = true;
}

std::int64_t ChainMailSession::SaveState()
{
  std::shared_ptr<const ChainMailSnapshot> state = this->ToRestore;
  if (!state && !this->IsToReset && this->HasVolume)
  {
    const auto last = this->States.empty() ? nullptr : this->States.rbegin()->second;
    state = this->Model.TakeSnapshot(last);
  }
  state = state ? state : std::make_shared<ChainMailSnapshot>(); // at rest
  this->States[++this->LastState] = state;
  this->StateMemory += GetIndexMemory(*state);
  for (const auto& block : state->Blocks)
  {
    this->StateMemory += this->Owners[block.get()]++ == 0 ? sizeof(ChainMailSnapshot::Block) : 0;
  }
  return this->LastState;
}

bool ChainMailSession::RestoreState(std::int64_t number)
{
  const auto found = this->States.find(number);
  if (found == this->States.end())
  {
    return false;
  }
  const ChainMailSnapshot& state = *found->second;
  if (state.Numbers.empty())
  {
    this->Reset();
    return true;
  }
  if (!this->HasVolume || state.Voxels != this->Geometry.PointExtent)
  {
    return false;
  }
  this->IsToReset = false;
  this->ToRestore = found->second;
  return true;
}

bool ChainMailSession::RemoveState(std::int64_t number)
{
  const auto found = this->States.find(number);
  if (found == this->States.end())
  {
    return false;
  }
  const auto state = found->second;
  this->States.erase(found);
  this->StateMemory -= GetIndexMemory(*state);
  for (const auto& block : state->Blocks)
  {
    const auto owners = this->Owners.find(block.get());
    if (--owners->second == 0)
    {
      this->Owners.erase(owners);
      this->StateMemory -= sizeof(ChainMailSnapshot::Block);
    }
  }
  return true;
}

void ChainMailSession::MakeOutput(vtkIdType voxels)
{
  this->Output.Make(this->Model, this->Device, voxels);
  vtkNew<vtkArrayChanges> log; // the array holds a reference to it
  log->SetArray(this->Output.GetArray());
}

const ChainMailReport& ChainMailSession::Step(const Stamp& source, vtkImageData* volume,
  const Stamp::value_type& written, vtkPointSet* handles, const ChainMailSettings& settings,
  ChainMailRequest request)
{
  // Check all inputs before anything is changed.
  const ImageGeometry geometry = GetGeometry(volume);
  CheckVolume(geometry);
  vtkDataArray* materialArray =
    FindMaterialArray(volume, settings.ArrayName, !settings.Table.Ranges.empty());
  vtkDataArray* pins = FindVolumeArray(volume, PINNED);
  const bool isNew = !this->HasVolume || this->Geometry != geometry;
  Stamp maskStamp = GetMasksStamp(volume);
  const bool usesArrays = materialArray || pins ||
    std::any_of(maskStamp.begin(), maskStamp.end(), [](const auto& one) { return one.first; });
  std::optional<double> time;
  if (usesArrays && volume->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
  {
    time = volume->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP());
  }
  const HandlePositions positions = ReadHandlePositions(handles, "volume");
  StepKey stepKey(source, time, positions.Rest, positions.Now);
  if (!isNew && stepKey == this->KeyOfStep)
  {
    this->Output.Restore();
    return this->Report;
  }
  maskStamp.push_back(written);
  std::optional<VolumeMasks> masks;
  if (isNew || maskStamp != this->StampOfMasks)
  {
    masks = ReadLinkMasks(volume);
  }
  request.Handles = MakeHandles(geometry, positions.Rest, positions.Now, settings.HandleRadius);
  std::vector<double> numbers{ 1.0 * settings.DefaultMaterial };
  std::vector<ChainMailMaterial> table;
  for (std::size_t i = 0; i < settings.Table.Exists.size(); ++i)
  {
    numbers.push_back(settings.Table.Exists[i] ? 1.0 : 0.0);
    if (settings.Table.Exists[i])
    {
      const ChainMailMaterial& material = settings.Table.Materials[i];
      table.resize(i + 1);
      table[i] = material;
      numbers.insert(
        numbers.end(), { material.MinimumStretch, material.MaximumStretch, material.Shear });
    }
  }
  for (const MaterialRange& range : settings.Table.Ranges)
  {
    settings.Table.Get(range.Index, "The range's material");
    numbers.insert(numbers.end(), { range.Minimum, range.Maximum, 1.0 * range.Index });
  }
  const MaterialsKey key(GetStampOf(materialArray, written), numbers);
  if (!materialArray || !settings.Table.Ranges.empty())
  {
    settings.Table.Get(settings.DefaultMaterial, "DefaultMaterial");
  }
  const auto readMaterials = [&]
  {
    return ReadMaterials(materialArray, volume->GetNumberOfPoints(), settings.Table.Ranges,
      settings.DefaultMaterial, settings.Table.Exists);
  };
  std::vector<unsigned char> materials;
  if (isNew || key != this->KeyOfMaterials)
  {
    ChainMailModel::CheckMaterials(table);
    materials = readMaterials();
  }
  ChainMailModel::CheckRequest(geometry.PointExtent, request);
  const Stamp pinStamp = GetStampOf(pins, written);
  try
  {
    this->SetVolume(geometry, settings);
    if (key != this->KeyOfMaterials)
    {
      if (materials.empty()) // the device has changed
      {
        materials = readMaterials();
      }
      this->Model.SetMaterials(table, materials.data());
      this->KeyOfMaterials = key;
    }
    if (maskStamp != this->StampOfMasks)
    {
      if (!masks) // the device has changed
      {
        masks = ReadLinkMasks(volume);
      }
      this->Model.SetActiveTetrahedra(masks->Active);
      this->StampOfMasks = maskStamp;
    }
    if (pinStamp != this->StampOfPins)
    {
      const std::vector<unsigned char> flags =
        pins ? ReadFlags(pins) : std::vector<unsigned char>();
      this->Model.SetPinned(pins ? flags.data() : nullptr);
      this->StampOfPins = pinStamp;
    }
    // Reset and restore after the calls above. Otherwise the voxels that these calls release or
    // hold would be visited and begin to relax.
    if (this->IsToReset)
    {
      this->Model.Reset();
      this->IsToReset = false;
    }
    if (this->ToRestore && this->ToRestore->Voxels == geometry.PointExtent)
    {
      this->Model.Restore(*this->ToRestore);
    }
    this->ToRestore = nullptr;
    this->Report = this->Model.Step(request);
    this->LogChanges(this->Report);
    this->Output.Restore();
    this->KeyOfStep = std::move(stepKey);
    return this->Report;
  }
  catch (const Error&)
  {
    if (this->Model.GetDeviceMemory() == 0)
    {
      this->Forget(); // the device has failed
    }
    throw;
  }
}

void ChainMailSession::LogChanges(const ChainMailReport& report)
{
  const auto rows = FindRows(report.Changes, this->Geometry.PointExtent);
  if (!rows)
  {
    this->Output.GetArray()->Modified();
    return;
  }
  vtkArrayChanges* log = vtkArrayChanges::FindLog(this->Output.GetArray());
  for (const auto& row : *rows)
  {
    log->AddTuples(static_cast<vtkIdType>(row[0]), static_cast<vtkIdType>(row[1]) - 1);
  }
}

void ChainMailSession::GiveOutput(vtkImageData* output) const
{
  const Extent& extent = this->Geometry.PointExtent;
  output->SetExtent(extent[0], extent[1], extent[2], extent[3], extent[4], extent[5]);
  SetTransform(output, this->Geometry);
  output->GetPointData()->SetVectors(this->Output.GetArray());
}

} // namespace deformvolume
