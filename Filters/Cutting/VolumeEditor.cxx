// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeEditor.h"

#include "DeformedPositions.h"
#include "Error.h"
#include "MaskArray.h"

#include "vtkArrayChanges.h"
#include "vtkCellData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <string>
#include <utility>

namespace deformvolume
{
namespace
{

// What reads a deformation calls it port 1, and the rest configuration port 2, as in
// vtkDeformVolumeFilter.
std::string RenamePorts(std::string text)
{
  for (const char port : { '2', '1' })
  {
    const std::string name = std::string("port ") + port;
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1))
    {
      text[at + name.size() - 1] = static_cast<char>(port + 1);
    }
  }
  return text;
}

} // namespace

bool VolumeEditor::SetVolume(vtkImageData* volume, vtkInformation* info)
{
  if (!volume)
  {
    throw Error("There is no volume. Connect a vtkImageData to input port 0.");
  }
  const ImageGeometry geometry = deformvolume::GetGeometry(volume);
  CheckVolume(geometry);
  ByteArray* base = FindMask(
    volume->GetCellData(), ActiveTetrahedraName, volume->GetNumberOfCells(), "cell", "volume");
  const unsigned char* bytes = base ? base->GetPointer(0) : nullptr;
  const Stamp stamp{ { base, base ? base->GetMTime() : 0 }, { bytes, 0 } };
  const bool isNew = !this->Mask || geometry != this->Geometry;
  if (isNew)
  {
    this->Mask = std::make_unique<MaskEditor>(geometry.PointExtent);
    this->Rest = std::make_unique<RestPositions>(geometry.PointExtent);
    this->Deformed.reset();
    this->Active = nullptr;
    this->Geometry = geometry;
  }
  const Extent whole = deformvolume::GetGeometry(info).PointExtent;
  this->Whole = Contains(whole, geometry.PointExtent) ? whole : geometry.PointExtent;
  if (isNew || stamp != this->BaseStamp)
  {
    this->Mask->SetBase(bytes);
    this->BaseStamp = stamp;
  }
  return isNew;
}

const VertexPositions& VolumeEditor::GetPositions(DeformationSource source, bool extrapolate)
{
  if (!source.Shape)
  {
    return *this->Rest;
  }
  source.Volume = this->Geometry;
  try
  {
    this->Deformation.Read(source);
    const bool isField = this->Deformation.IsField();
    // The mapping of a part has whole rows, and is that of the whole volume to the last bit.
    MappedVolume mapped{ this->Geometry, this->Geometry.PointExtent, extrapolate };
    mapped.Whole.PointExtent = this->Whole;
    mapped.Part[0] = this->Whole[0];
    mapped.Part[1] = this->Whole[1];
    mapped.Part = extrapolate ? this->Whole : mapped.Part;
    if (!isField)
    {
      this->Mapping.Update(this->Deformation, mapped, {});
    }
    const std::array<std::uint64_t, 4> version{ { this->Deformation.GetVectorsVersion(),
      isField ? 0 : this->Mapping.GetVersion(), isField ? 1U : 0U, extrapolate ? 1U : 0U } };
    if (!this->Deformed || version != this->DeformedVersion)
    {
      this->Deformed.reset();
      if (isField)
      {
        this->Deformed = std::make_unique<DeformedPositions>(
          this->Geometry.PointExtent, this->Deformation.GetField(extrapolate));
      }
      else
      {
        this->Deformed = std::make_unique<DeformedPositions>(this->Geometry.PointExtent,
          mapped.Part, this->Mapping.GetMapping(), this->Deformation.GetTetrahedra(),
          this->Deformation.GetNodeDisplacements());
      }
      this->DeformedVersion = version;
    }
  }
  catch (const Error& error)
  {
    throw Error(RenamePorts(error.what()));
  }
  return *this->Deformed;
}

void VolumeEditor::Put(std::uint64_t& edit, TetrahedronSet&& set, bool keep)
{
  if (!keep)
  {
    this->Mask->Remove(edit);
  }
  edit = this->Mask->Add(std::move(set));
}

void VolumeEditor::Drop(std::uint64_t& edit)
{
  this->Mask->Remove(edit);
  edit = 0;
}

bool VolumeEditor::Reset()
{
  if (!this->Mask ||
    (this->Mask->GetNumberOfEdits() == 0 && this->Mask->GetNumberOfUndoneEdits() == 0))
  {
    return false;
  }
  this->Mask->Reset();
  return true;
}

void VolumeEditor::Write(vtkImageData* volume, vtkImageData* output)
{
  output->ShallowCopy(volume);
  // The last output has let the array go. Who else holds it wants it as it is.
  if (!this->Active || this->Active->GetReferenceCount() > 1)
  {
    this->Active = vtkSmartPointer<vtkUnsignedCharArray>::New();
    this->Active->SetName(ActiveTetrahedraName);
    this->Active->SetNumberOfTuples(static_cast<vtkIdType>(this->Mask->GetMask().size()));
    std::copy(
      this->Mask->GetMask().begin(), this->Mask->GetMask().end(), this->Active->GetPointer(0));
    this->Mask->TakeChangedBricks();
    vtkNew<vtkArrayChanges> log; // which the array holds
    log->SetArray(this->Active);
  }
  else
  {
    this->WriteChanges(this->Active->GetPointer(0));
  }
  output->GetCellData()->AddArray(this->Active);
}

void VolumeEditor::WriteChanges(unsigned char* bytes)
{
  // Of so many bricks, consumers find the changes faster by a comparison.
  constexpr std::size_t mostLogged = 512;
  const std::vector<std::size_t> changed = this->Mask->TakeChangedBricks();
  vtkArrayChanges* log =
    changed.size() <= mostLogged ? vtkArrayChanges::FindLog(this->Active) : nullptr;
  const std::array<int, 3>& size = this->Mask->GetBricks().GetSize();
  for (const std::size_t brick : changed)
  {
    const Extent cells = this->Mask->GetBricks().GetCells(brick);
    for (std::int64_t z = cells[4]; z <= cells[5]; ++z)
    {
      for (std::int64_t y = cells[2]; y <= cells[3]; ++y)
      {
        const std::int64_t row = (z * size[1] + y) * size[0];
        const auto from = this->Mask->GetMask().begin() + row + cells[0];
        std::copy(from, from + (cells[1] - cells[0] + 1), bytes + row + cells[0]);
        if (log)
        {
          log->AddTuples(row + cells[0], row + cells[1]);
        }
      }
    }
  }
  if (!log && !changed.empty())
  {
    this->Active->Modified();
  }
}

} // namespace deformvolume
