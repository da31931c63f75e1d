// SPDX-License-Identifier: BSD-3-Clause
#include "OutputArrays.h"

#include "vtkCharArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLookupTable.h"
#include "vtkPointData.h"

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
bool CanServe(vtkDataArray* last, vtkDataArray* wanted, vtkIdType numberOfTuples)
{
  return std::strcmp(last->GetClassName(), wanted->GetClassName()) == 0 &&
    last->GetNumberOfComponents() == wanted->GetNumberOfComponents() &&
    last->GetNumberOfTuples() == numberOfTuples &&
    last->HasAComponentName() == wanted->HasAComponentName();
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
void Describe(vtkDataArray* array, vtkDataArray* wanted)
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
    bytes += IsHeldByOthers(array) ? 0
                                   : static_cast<std::uint64_t>(array->GetNumberOfValues()) *
        static_cast<std::uint64_t>(array->GetDataTypeSize());
  }
  return bytes;
}

void OutputArrays::Make(
  const std::vector<SourceArray>& sources, vtkImageData* image, DeformRequest& request)
{
  if (!this->Last.empty() && GetStamp(this->Last) == this->LastStamp)
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
      Describe(made, isMask ? MakeMask(0) : MakeLike(sources[i].Array, 0));
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
