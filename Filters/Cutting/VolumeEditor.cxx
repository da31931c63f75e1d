// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeEditor.h"

#include "DeformedPositions.h"
#include "Error.h"
#include "MaskArray.h"
#include "PipelineGeometry.h"
#include "WrittenTuples.h"

#include "vtkArrayChanges.h"
#include "vtkCellData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace deformvolume
{
namespace
{

// Writes values into an array of the output. changed: the bricks whose values differ from those of
// the last call; they are marked as written. Makes a new array if there is none, or if somebody
// else holds a reference to the last one, which must then keep its values. The output itself holds
// no reference at this time.
template <typename ArrayT, typename T>
void WriteOutput(vtkSmartPointer<ArrayT>& array, const char* name, const std::vector<T>& values,
  const CellBricks& bricks, const std::vector<std::size_t>& changed)
{
  if (!array || array->GetReferenceCount() > 1)
  {
    array = vtkSmartPointer<ArrayT>::New();
    array->SetName(name);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    vtkNew<vtkArrayChanges> log; // the array holds a reference to it
    log->SetArray(array);
    return;
  }
  // Consumers find the changes of more bricks faster by comparing all values.
  constexpr std::size_t mostLogged = 512;
  vtkArrayChanges* log = changed.size() <= mostLogged ? vtkArrayChanges::FindLog(array) : nullptr;
  const std::array<int, 3>& size = bricks.GetSize();
  for (const std::size_t brick : changed)
  {
    const Extent cells = bricks.GetCells(brick);
    for (std::int64_t z = cells[4]; z <= cells[5]; ++z)
    {
      for (std::int64_t y = cells[2]; y <= cells[3]; ++y)
      {
        const std::int64_t row = (z * size[1] + y) * size[0];
        const auto from = values.begin() + row + cells[0];
        std::copy(from, from + (cells[1] - cells[0] + 1), array->GetPointer(row + cells[0]));
        if (log)
        {
          log->AddTuples(row + cells[0], row + cells[1]);
        }
      }
    }
  }
  if (!log && !changed.empty())
  {
    array->Modified();
  }
}

// Stamp of the arrays of the smooth cut of a volume; empty if there is none.
Stamp GetCutStamp(vtkImageData* volume)
{
  Stamp stamp;
  vtkAbstractArray* const arrays[2] = { volume->GetCellData()->GetAbstractArray(CutTetrahedraName),
    volume->GetPointData()->GetAbstractArray(CutDistanceName) };
  for (vtkAbstractArray* array : arrays)
  {
    if (array)
    {
      AddArray(stamp, array);
    }
  }
  return stamp;
}

} // namespace

bool VolumeEditor::SetVolume(
  vtkImageData* volume, vtkInformation* info, const Stamp::value_type& written)
{
  const ImageGeometry geometry = deformvolume::GetGeometry(volume);
  CheckVolume(geometry);
  ByteArray* base = FindMask(
    volume->GetCellData(), ActiveTetrahedraName, volume->GetNumberOfCells(), "cell", "volume");
  const unsigned char* bytes = base ? base->GetPointer(0) : nullptr;
  Stamp stamp;
  AddArray(stamp, base);
  stamp.push_back(written);
  vtkAbstractArray* distances = volume->GetPointData()->GetAbstractArray(BoundaryDistanceName);
  Stamp distancesStamp;
  AddArray(distancesStamp, distances);
  distancesStamp.push_back(written);
  const bool isNew = !this->Mask || geometry != this->Geometry;
  if (distancesStamp != this->DistancesStamp)
  {
    FindBoundaryDistances(volume); // throws if they cannot be used
  }
  Stamp cutStamp = GetCutStamp(volume);
  cutStamp.push_back(written);
  if (cutStamp != this->CutStamp)
  {
    FindCut(volume); // throws if it cannot be used
  }
  const Extent whole = deformvolume::GetGeometry(info).PointExtent;
  this->Whole = Contains(whole, geometry.PointExtent) ? whole : geometry.PointExtent;
  if (isNew)
  {
    this->Mask = std::make_unique<MaskEditor>(
      geometry.PointExtent, deformvolume::GetFarDistance(this->Whole, geometry.Spacing));
    this->Rest = std::make_unique<RestPositions>(geometry.PointExtent);
    this->Deformed.reset();
    this->Active = nullptr;
    this->Distances = nullptr;
    this->CutTetrahedra = nullptr;
    this->CutDistances = nullptr;
    this->BaseDistancesStamp.clear();
    this->BaseCutStamp.clear();
    this->Geometry = geometry;
  }
  this->DistancesStamp = distancesStamp;
  this->CutStamp = cutStamp;
  if (isNew || stamp != this->BaseStamp)
  {
    std::optional<PointRanges> changes;
    if (base && this->BaseStamp.size() == stamp.size() &&
      std::equal(stamp.begin() + 1, stamp.end(), this->BaseStamp.begin() + 1))
    {
      changes = FindWritten(base, this->BaseStamp[0].first, this->BaseStamp[0].second);
    }
    this->Mask->SetBase(bytes, changes ? &*changes : nullptr);
    this->BaseStamp = stamp;
  }
  return isNew;
}

const VertexPositions& VolumeEditor::GetPositions(
  DeformationSource source, const OutsideVoxels& outside)
{
  if (!source.Shape)
  {
    return *this->Rest;
  }
  source.Volume = this->Geometry;
  this->Grids.Find(source);
  this->Deformation.Read(source);
  const bool isField = this->Deformation.IsField();
  // The part has whole rows, so that its mapping equals that of the whole volume bit for bit.
  MappedVolume mapped{ this->Geometry, this->Geometry.PointExtent, outside };
  mapped.Whole.PointExtent = this->Whole;
  mapped.Part[0] = this->Whole[0];
  mapped.Part[1] = this->Whole[1];
  mapped.Part = outside.AreDiscarded() ? mapped.Part : this->Whole;
  if (!isField)
  {
    this->Mapping.Update(this->Deformation.GetMeshAtRest(), mapped, {});
  }
  const PositionsKey mapping{ isField ? 0 : this->Mapping.GetVersion(), isField, outside };
  const std::uint64_t vectors = this->Deformation.GetVectorsVersion();
  if (this->Deformed && mapping == this->DeformedMapping && vectors == this->DeformedVectors)
  {
    return *this->Deformed;
  }
  const std::vector<Tetrahedron>* tetrahedra = &this->Deformation.GetTetrahedra();
  const float* displacements = this->Deformation.GetNodeDisplacements();
  if (!isField && outside.AreKept())
  {
    const std::size_t nodes = this->Deformation.GetRestPoints().size();
    this->Faded.Set(this->Mapping.GetMapping().Faded, *tetrahedra, nodes);
    this->Faded.Move(displacements, nodes, nullptr);
    tetrahedra = &this->Faded.GetTetrahedra();
    displacements = this->Faded.GetDisplacements().data();
  }
  if (this->Deformed && mapping == this->DeformedMapping && !isField)
  {
    static_cast<DeformedMeshPositions&>(*this->Deformed).SetDisplacements(displacements);
  }
  else if (this->Deformed && mapping == this->DeformedMapping)
  {
    const PointRanges changes = this->Deformation.GetChanges(this->DeformedVectors);
    static_cast<DeformedFieldPositions&>(*this->Deformed)
      .SetField(this->Deformation.GetField(outside), &changes);
  }
  else if (isField)
  {
    this->Deformed = std::make_unique<DeformedFieldPositions>(
      this->Geometry.PointExtent, this->Deformation.GetField(outside));
  }
  else
  {
    this->Deformed.reset();
    this->Deformed = std::make_unique<DeformedMeshPositions>(this->Geometry.PointExtent,
      mapped.Part, this->Mapping.GetMapping(), *tetrahedra, displacements);
  }
  this->DeformedMapping = mapping;
  this->DeformedVectors = vectors;
  return *this->Deformed;
}

void VolumeEditor::Put(std::uint64_t& edit, VolumeEdit&& next, bool keep)
{
  if (!keep)
  {
    this->Mask->Remove(edit);
  }
  edit = this->Mask->Add(
    std::move(next.Tetrahedra), std::move(next.Distances), std::move(next.Crossings));
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
  const bool hasSmoothCuts = this->Mask->HasSmoothCuts();
  if (hasSmoothCuts && this->BaseCutStamp != this->CutStamp)
  {
    const CutValues cut = FindCut(volume);
    this->Mask->SetBaseCut(cut.Crossed, cut.Distances.Values);
    this->BaseCutStamp = this->CutStamp;
  }
  WriteOutput(this->Active, ActiveTetrahedraName, this->Mask->GetMask(), this->Mask->GetBricks(),
    this->Mask->TakeChangedBricks());
  output->GetCellData()->AddArray(this->Active);
  // Without such edits, the output shares the distances of the volume.
  if (this->Mask->HasDistanceEdits())
  {
    if (this->BaseDistancesStamp != this->DistancesStamp)
    {
      this->Mask->SetBaseDistances(FindBoundaryDistances(volume).Values);
      this->BaseDistancesStamp = this->DistancesStamp;
    }
    deformvolume::BoundaryDistances& distances = this->Mask->GetBoundaryDistances();
    WriteOutput(this->Distances, BoundaryDistanceName, distances.Get(), distances.GetBricks(),
      distances.TakeChangedBricks());
    output->GetPointData()->AddArray(this->Distances);
  }
  else
  {
    this->Distances = nullptr;
  }
  if (hasSmoothCuts)
  {
    SmoothCrossings& cut = this->Mask->GetSmoothCrossings();
    WriteOutput(this->CutTetrahedra, CutTetrahedraName, cut.GetCrossed(), cut.GetBricks(),
      cut.TakeChangedBricks());
    WriteOutput(this->CutDistances, CutDistanceName, cut.GetDistances(), cut.GetVertexBricks(),
      cut.TakeChangedVertexBricks());
    output->GetCellData()->AddArray(this->CutTetrahedra);
    output->GetPointData()->AddArray(this->CutDistances);
  }
  else
  {
    this->CutTetrahedra = nullptr;
    this->CutDistances = nullptr;
  }
}

} // namespace deformvolume
