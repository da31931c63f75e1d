// SPDX-License-Identifier: BSD-3-Clause
#include "OutputArrays.h"

#include "vtkCharArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLookupTable.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace deformvolume
{

namespace
{

vtkSmartPointer<vtkDataArray> MakeMask(vtkIdType numberOfTuples)
{
  const auto mask = vtkSmartPointer<vtkCharArray>::New();
  mask->SetName("vtkValidPointMask");
  mask->SetNumberOfTuples(numberOfTuples);
  return mask;
}

// Whether an array can be made into what MakeLike() would make of another, given without tuples.
// The size of the output follows the deformation, and memory for some voxels more or less serves as
// well.
bool CanServe(vtkDataArray* last, vtkDataArray* wanted, vtkIdType numberOfTuples)
{
  constexpr vtkIdType mostWaste = 2;
  return std::strcmp(last->GetClassName(), wanted->GetClassName()) == 0 &&
    last->GetNumberOfComponents() == wanted->GetNumberOfComponents() &&
    numberOfTuples >= last->GetSize() / last->GetNumberOfComponents() / mostWaste &&
    last->HasAComponentName() == wanted->HasAComponentName();
}

// Gives an array its size, for values to be written. Where it must grow it may soon grow again.
void SetSize(vtkDataArray* array, vtkIdType numberOfTuples)
{
  constexpr vtkIdType reserve = 32; // one part in so many
  if (numberOfTuples > array->GetSize() / array->GetNumberOfComponents())
  {
    array->Allocate((numberOfTuples + numberOfTuples / reserve) * array->GetNumberOfComponents());
  }
  array->SetNumberOfTuples(numberOfTuples);
}

bool IsHeldByOthers(vtkDataArray* array)
{
  return array->GetReferenceCount() > 1;
}

// What tells that arrays have their values still.
Stamp GetStamp(const std::vector<vtkSmartPointer<vtkDataArray>>& arrays)
{
  Stamp stamp;
  for (const auto& array : arrays)
  {
    stamp.emplace_back(GetWritableValues(array), array->GetMTime());
  }
  return stamp;
}

// Names and the like; values are not touched.
void CopyDescription(vtkDataArray* array, vtkDataArray* wanted)
{
  array->SetName(wanted->GetName());
  array->CopyComponentNames(wanted);
  array->SetLookupTable(wanted->GetLookupTable());
  if (array->HasInformation())
  {
    array->GetInformation()->Clear();
  }
  if (wanted->HasInformation())
  {
    array->CopyInformation(wanted->GetInformation(), 1);
  }
}

} // namespace

std::uint64_t OutputArrays::Prepare(
  const std::vector<SourceArray>& sources, vtkIdType numberOfTuples)
{
  this->Made.clear();
  this->NumberOfTuples = numberOfTuples;
  Arrays wanted;
  for (const SourceArray& source : sources)
  {
    wanted.push_back(MakeLike(source.Array, 0));
  }
  wanted.push_back(MakeMask(0));
  bool serve = this->Last.size() == wanted.size();
  for (std::size_t i = 0; serve && i < wanted.size(); ++i)
  {
    serve = CanServe(this->Last[i], wanted[i], numberOfTuples);
  }
  if (!serve)
  {
    this->Last.clear();
  }
  std::uint64_t bytes = 0;
  for (const auto& array : this->Last)
  {
    const vtkIdType values =
      std::min(array->GetSize(), numberOfTuples * array->GetNumberOfComponents());
    bytes += IsHeldByOthers(array)
      ? 0
      : static_cast<std::uint64_t>(values) * static_cast<std::uint64_t>(array->GetDataTypeSize());
  }
  return bytes;
}

void OutputArrays::Make(
  const std::vector<SourceArray>& sources, vtkImageData* image, DeformRequest& request)
{
  if (!this->Last.empty() && this->Last.back()->GetNumberOfTuples() == this->NumberOfTuples &&
    GetStamp(this->Last) == this->LastStamp)
  {
    for (std::size_t i = 0; i < sources.size(); ++i)
    {
      request.LastOutputs.push_back(GetWritableValues(this->Last[i]));
    }
    request.LastCoverage = static_cast<signed char*>(GetWritableValues(this->Last.back()));
  }
  for (std::size_t i = 0; i <= sources.size(); ++i)
  {
    const bool isMask = i == sources.size();
    vtkSmartPointer<vtkDataArray> made;
    if (!this->Last.empty() && !IsHeldByOthers(this->Last[i]))
    {
      made = this->Last[i];
      if (made->GetNumberOfTuples() != this->NumberOfTuples)
      {
        this->LastStamp.clear(); // it holds the last output no more
        SetSize(made, this->NumberOfTuples);
      }
      CopyDescription(made, isMask ? MakeMask(0) : MakeLike(sources[i].Array, 0));
    }
    else
    {
      made =
        isMask ? MakeMask(this->NumberOfTuples) : MakeLike(sources[i].Array, this->NumberOfTuples);
    }
    if (isMask)
    {
      request.Coverage = static_cast<signed char*>(GetWritableValues(made));
    }
    else
    {
      request.Outputs.push_back(GetWritableValues(made));
    }
    image->GetPointData()->AddArray(made);
    this->Made.push_back(made);
  }
}

void OutputArrays::Keep()
{
  this->Last = std::exchange(this->Made, Arrays());
  for (const auto& array : this->Last)
  {
    array->Modified(); // ranges that were found of earlier values do not hold
  }
  this->LastStamp = GetStamp(this->Last);
}

void OutputArrays::Forget()
{
  this->Last.clear();
  this->Made.clear();
}

} // namespace deformvolume
