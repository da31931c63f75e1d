// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeArrays.h"

#include "CrossedTetrahedra.h"
#include "Error.h"
#include "FiveTetrahedra.h"
#include "MaskArray.h"
#include "WrittenTuples.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLookupTable.h"
#include "vtkPointData.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <type_traits>

namespace deformvolume
{

namespace
{

const char* const VOLUME = "volume"; // in messages

// Finds the element type with the size and kind of T. Several types of VTK can have the same
// element type.
template <typename T>
constexpr bool FindElementType(ElementType& type)
{
#define DEFORMVOLUME_MATCH(name, ctype, cl)                                                        \
  if (sizeof(T) == sizeof(ctype) && std::is_signed<T>::value == std::is_signed<ctype>::value &&    \
    std::is_floating_point<T>::value == std::is_floating_point<ctype>::value)                      \
  {                                                                                                \
    type = ElementType::name;                                                                      \
    return true;                                                                                   \
  }
  DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_MATCH)
#undef DEFORMVOLUME_MATCH
  return false;
}

bool FindElementType(int vtkType, ElementType& type)
{
  switch (vtkType)
  {
    vtkTemplateMacro(return FindElementType<VTK_TT>(type));
    default:
      return false;
  }
}

// The values of an array of structs (vtkAOSDataArrayTemplate); null for other layouts.
void* FindValues(vtkDataArray* array)
{
  switch (array->GetDataType())
  {
    vtkTemplateMacro({
      const auto common = vtkAOSDataArrayTemplate<VTK_TT>::FastDownCast(array);
      return common ? common->GetPointer(0) : nullptr;
    });
    default:
      return nullptr;
  }
}

std::shared_ptr<const void> MakeOwner(vtkDataArray* array)
{
  array->Register(nullptr);
  return { array, [](vtkDataArray* owned) { owned->UnRegister(nullptr); } };
}

std::string GetLabel(vtkAbstractArray* array, int index)
{
  return array->GetName() ? std::string("\"") + array->GetName() + "\""
                          : "number " + std::to_string(index);
}

// Indices of the arrays that masks are read from, see FindMasks(). GetMasksStamp() has two entries
// for each of them.
enum Mask
{
  BlankedPoints,
  ValidPoints,
  HiddenCells,
  ActiveCells,
  Distances,
  CutCells,
  CutPoints,
  NumberOfMasks
};

// Whether a cell is hidden by something else than an edit.
bool IsHidden(unsigned char value)
{
  constexpr unsigned char Hidden = vtkDataSetAttributes::HIDDENCELL;
  return (value & (Hidden | HiddenByEdit)) == Hidden;
}

std::array<vtkAbstractArray*, NumberOfMasks> FindMasks(vtkImageData* volume)
{
  const char* ghostName = vtkDataSetAttributes::GhostArrayName();
  return { { volume->GetPointData()->GetAbstractArray(ghostName),
    volume->GetPointData()->GetAbstractArray(ValidPointMaskName),
    volume->GetCellData()->GetAbstractArray(ghostName),
    volume->GetCellData()->GetAbstractArray(ActiveTetrahedraName),
    volume->GetPointData()->GetAbstractArray(BoundaryDistanceName),
    volume->GetCellData()->GetAbstractArray(CutTetrahedraName),
    volume->GetPointData()->GetAbstractArray(CutDistanceName) } };
}

// Whether one of the masks is the same object, with the same memory, as when a stamp was taken.
bool HasSameMask(
  const std::array<vtkAbstractArray*, NumberOfMasks>& arrays, Mask mask, const Stamp& last)
{
  Stamp now;
  AddArray(now, arrays[mask]);
  return last.size() >= 2 * NumberOfMasks && last[2 * mask].first == now[0].first &&
    last[2 * mask + 1] == now[1];
}

// Whether a mask has not changed since a stamp was taken.
bool IsUnchanged(
  const std::array<vtkAbstractArray*, NumberOfMasks>& arrays, Mask mask, const Stamp& last)
{
  return HasSameMask(arrays, mask, last) &&
    last[2 * mask].second == (arrays[mask] ? arrays[mask]->GetMTime() : 0);
}

// The tuples of a mask that were written since a stamp was taken, according to the log of its
// array. Empty: unknown.
std::optional<PointRanges> FindWrittenMask(
  const std::array<vtkAbstractArray*, NumberOfMasks>& arrays, Mask mask, const Stamp& last)
{
  if (!HasSameMask(arrays, mask, last))
  {
    return {};
  }
  return FindWritten(arrays[mask], last[2 * mask].first, last[2 * mask].second);
}

bool HasName(vtkAbstractArray* array, const char* name)
{
  return array->GetName() && std::strcmp(array->GetName(), name) == 0;
}

} // namespace

std::vector<SourceArray> SelectArrays(
  vtkImageData* volume, const std::set<std::string>& categorical, std::vector<std::string>& leftOut)
{
  vtkPointData* pointData = volume->GetPointData();
  // Ids must not be interpolated, so that their arrays are categorical, whatever their names are.
  int roles[vtkDataSetAttributes::NUM_ATTRIBUTES];
  pointData->GetAttributeIndices(roles);
  std::vector<SourceArray> arrays;
  std::set<std::string> names;
  for (int i = 0; i < pointData->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* abstract = pointData->GetAbstractArray(i);
    if (HasName(abstract, ValidPointMaskName) ||
      HasName(abstract, vtkDataSetAttributes::GhostArrayName()) ||
      HasName(abstract, BoundaryDistanceName) || HasName(abstract, CutDistanceName))
    {
      continue;
    }
    vtkDataArray* array = vtkDataArray::SafeDownCast(abstract);
    ElementType type;
    if (!array || !FindElementType(array->GetDataType(), type))
    {
      const bool isBits = abstract->GetDataType() == VTK_BIT;
      leftOut.push_back(GetLabel(abstract, i) + " (" + abstract->GetDataTypeAsString() +
        (isBits ? "; copy it into a vtkUnsignedCharArray by DeepCopy())" : ")"));
      continue;
    }
    if (array->GetNumberOfTuples() != volume->GetNumberOfPoints())
    {
      throw Error("The point array " + GetLabel(array, i) + " of the volume has " +
        std::to_string(array->GetNumberOfTuples()) + " tuples for " +
        std::to_string(volume->GetNumberOfPoints()) +
        " voxels. Remove the array, or give it one tuple for each voxel.");
    }
    if (array->GetNumberOfComponents() < 1)
    {
      continue;
    }
    if (array->GetName() && !names.insert(array->GetName()).second)
    {
      throw Error("The volume has several point arrays with the name " + GetLabel(array, i) +
        ", and point data hold one array of each name. Rename one of them.");
    }
    const bool isId =
      roles[vtkDataSetAttributes::GLOBALIDS] == i || roles[vtkDataSetAttributes::PEDIGREEIDS] == i;
    arrays.push_back(
      { array, i, isId || (array->GetName() && categorical.count(array->GetName()) > 0) });
  }
  if (arrays.empty())
  {
    std::string cellArrays;
    for (const std::string& name : GetUnusedCellArrays(volume))
    {
      cellArrays += (cellArrays.empty() ? "" : ", ") + name;
    }
    throw Error("The volume on input port 0 has no numeric point array, so there is nothing to "
                "deform. Connect a vtkImageData with point scalars." +
      (cellArrays.empty() ? ""
                          : " It has cell arrays: " + cellArrays +
            ". vtkCellDataToPointData (Cell Data to Point Data in ParaView) averages them at the "
            "points.") +
      (leftOut.empty() ? ""
                       : " The type of this array cannot be resampled: " + leftOut.front() + "."));
  }
  return arrays;
}

std::vector<VolumeArray> MakeVolumeArrays(const std::vector<SourceArray>& arrays, double background)
{
  std::vector<VolumeArray> described;
  for (const SourceArray& source : arrays)
  {
    VolumeArray array;
    FindElementType(source.Array->GetDataType(), array.Type);
    if (const void* values = FindValues(source.Array))
    {
      array.Data = values;
      array.Owner = MakeOwner(source.Array);
    }
    array.Components = source.Array->GetNumberOfComponents();
    array.Categorical = source.Categorical;
    array.Background = source.IsDensity ? 0.0 : background; // no amount where there is nothing
    described.push_back(array);
  }
  return described;
}

Stamp GetStamp(const std::vector<SourceArray>& arrays)
{
  Stamp stamp;
  for (const SourceArray& source : arrays)
  {
    AddArray(stamp, source.Array);
  }
  return stamp;
}

void CopyToAOS(vtkDataArray* array, VolumeArray& described)
{
  const auto copy =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(array->GetDataType()));
  copy->DeepCopy(array);
  described.Data = FindValues(copy);
  described.Owner = MakeOwner(copy);
}

vtkSmartPointer<vtkDataArray> MakeArrayLike(vtkDataArray* array, vtkIdType numberOfTuples)
{
  // The class of the array is kept, unless the kernels cannot write its layout.
  const auto made = vtkSmartPointer<vtkDataArray>::Take(
    FindValues(array) ? array->NewInstance() : vtkDataArray::CreateDataArray(array->GetDataType()));
  made->SetNumberOfComponents(array->GetNumberOfComponents());
  CopyDescription(array, made);
  made->SetNumberOfTuples(numberOfTuples);
  return made;
}

void CopyDescription(vtkDataArray* from, vtkDataArray* to)
{
  to->SetName(from->GetName());
  to->CopyComponentNames(from);
  to->SetLookupTable(from->GetLookupTable());
  if (to->HasInformation())
  {
    to->GetInformation()->Clear();
  }
  if (from->HasInformation())
  {
    to->CopyInformation(from->GetInformation(), 1);
  }
}

void* GetWritableValues(vtkDataArray* array)
{
  return FindValues(array);
}

void CopyAttributeRoles(
  vtkDataSetAttributes* from, vtkDataSetAttributes* to, const std::vector<SourceArray>& sources)
{
  int roles[vtkDataSetAttributes::NUM_ATTRIBUTES];
  from->GetAttributeIndices(roles);
  for (int role = 0; role < vtkDataSetAttributes::NUM_ATTRIBUTES; ++role)
  {
    for (std::size_t i = 0; i < sources.size(); ++i)
    {
      if (roles[role] == sources[i].Index)
      {
        to->SetActiveAttribute(static_cast<int>(i), role);
      }
    }
  }
}

VolumeMasks ReadMasks(vtkImageData* volume, const Stamp& last)
{
  const char* ghostName = vtkDataSetAttributes::GhostArrayName();
  const vtkIdType numberOfCells = volume->GetNumberOfCells();
  VolumeMasks masks;

  masks.Ghosts = FindPointGhosts(volume, VOLUME);
  if (masks.Ghosts.Values)
  {
    masks.Blanked = masks.Ghosts.Values;
    masks.BlankedBits = IgnoredPointBits;
  }

  if (const auto active =
        FindMask(volume->GetCellData(), ActiveTetrahedraName, numberOfCells, "cell", VOLUME))
  {
    masks.Active = active->GetPointer(0);
  }
  if (const auto ghosts = FindMask(volume->GetCellData(), ghostName, numberOfCells, "cell", VOLUME))
  {
    const unsigned char* values = ghosts->GetPointer(0);
    if (std::any_of(values, values + numberOfCells, IsHidden))
    {
      masks.Joined.assign(static_cast<std::size_t>(numberOfCells), DEFORMVOLUME_ALL_TETRAHEDRA);
      if (masks.Active)
      {
        std::copy_n(masks.Active, numberOfCells, masks.Joined.begin());
      }
      for (vtkIdType i = 0; i < numberOfCells; ++i)
      {
        masks.Joined[i] = IsHidden(values[i]) ? 0 : masks.Joined[i];
      }
      masks.Active = masks.Joined.data();
    }
  }
  masks.Distances = FindBoundaryDistances(volume);
  masks.Cut = FindCut(volume);
  const std::array<vtkAbstractArray*, NumberOfMasks> arrays = FindMasks(volume);
  masks.WrittenDistances = FindWrittenMask(arrays, Distances, last);
  masks.HasSameCut = IsUnchanged(arrays, CutCells, last) && IsUnchanged(arrays, CutPoints, last);
  if (!arrays[ValidPoints] && HasSameMask(arrays, ValidPoints, last))
  {
    masks.WrittenBlanked = FindWrittenMask(arrays, BlankedPoints, last);
  }
  if (masks.Joined.empty() && !arrays[HiddenCells] && HasSameMask(arrays, HiddenCells, last))
  {
    masks.WrittenActive = FindWrittenMask(arrays, ActiveCells, last);
  }
  return masks;
}

void SwitchOffCut(VolumeMasks& masks, std::size_t numberOfCells)
{
  if (!masks.Cut.Crossed)
  {
    return;
  }
  masks.Joined = SwitchOffCrossed(masks.Active, masks.Cut.Crossed, numberOfCells);
  masks.Active = masks.Joined.data();
  masks.WrittenActive.reset();
  masks.Cut = {};
}

Stamp GetMasksStamp(vtkImageData* volume)
{
  Stamp stamp;
  for (vtkAbstractArray* array : FindMasks(volume))
  {
    AddArray(stamp, array);
  }
  return stamp;
}

std::vector<std::string> GetUnusedCellArrays(vtkImageData* volume)
{
  vtkCellData* cellData = volume->GetCellData();
  std::vector<std::string> names;
  for (int i = 0; i < cellData->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = cellData->GetAbstractArray(i);
    if (!HasName(array, ActiveTetrahedraName) && !HasName(array, CutTetrahedraName) &&
      !HasName(array, vtkDataSetAttributes::GhostArrayName()))
    {
      names.push_back(GetLabel(array, i));
    }
  }
  return names;
}

} // namespace deformvolume
