// SPDX-License-Identifier: BSD-3-Clause
#include "vtkArrayChanges.h"

#include "vtkAbstractArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkObjectFactory.h"
#include "vtkSmartPointer.h"

#include <algorithm>

vtkStandardNewMacro(vtkArrayChanges);
vtkInformationKeyMacro(vtkArrayChanges, LOG, ObjectBase);

namespace
{

constexpr std::size_t MostEntries = 65536;

} // namespace

//------------------------------------------------------------------------------
vtkArrayChanges::vtkArrayChanges() = default;

//------------------------------------------------------------------------------
vtkArrayChanges::~vtkArrayChanges() = default;

//------------------------------------------------------------------------------
vtkArrayChanges* vtkArrayChanges::FindLog(vtkAbstractArray* array)
{
  // GetInformation() would create the information.
  if (!array || !array->HasInformation())
  {
    return nullptr;
  }
  auto* log = vtkArrayChanges::SafeDownCast(array->GetInformation()->Get(vtkArrayChanges::LOG()));
  // Copies of an array have the same information.
  return log && log->Array == array ? log : nullptr;
}

//------------------------------------------------------------------------------
void vtkArrayChanges::SetArray(vtkAbstractArray* array)
{
  if (this->Array == array)
  {
    return;
  }
  // The last array may hold the only reference to this log.
  const vtkSmartPointer<vtkArrayChanges> self = this;
  if (vtkArrayChanges::FindLog(this->Array) == this)
  {
    this->Array->GetInformation()->Remove(vtkArrayChanges::LOG());
  }
  this->Array = array;
  this->Entries.clear();
  if (array)
  {
    array->GetInformation()->Set(vtkArrayChanges::LOG(), this);
    array->Modified(); // values may have been written since the array was read
  }
  this->Begin = this->End = array ? array->GetMTime() : 0;
  this->Modified();
}

//------------------------------------------------------------------------------
vtkAbstractArray* vtkArrayChanges::GetArray()
{
  return this->Array;
}

//------------------------------------------------------------------------------
void vtkArrayChanges::AddTuples(vtkIdType first, vtkIdType last)
{
  if (!this->Array || last < first)
  {
    return;
  }
  if (this->Array->GetMTime() != this->End)
  {
    this->Entries.clear();
    this->Begin = this->Array->GetMTime();
  }
  this->Array->Modified();
  this->End = this->Array->GetMTime();
  this->Entries.push_back({ this->End, std::max<vtkIdType>(first, 0), last });
  if (this->Entries.size() > MostEntries)
  {
    this->Begin = this->Entries.front().Time;
    this->Entries.pop_front();
  }
}

//------------------------------------------------------------------------------
bool vtkArrayChanges::GetTuplesSince(
  vtkMTimeType time, std::vector<std::array<std::size_t, 2>>& ranges) const
{
  ranges.clear();
  if (!this->Array || this->Array->GetMTime() != this->End || time < this->Begin ||
    time > this->End)
  {
    return false;
  }
  auto entry = std::upper_bound(this->Entries.begin(), this->Entries.end(), time,
    [](vtkMTimeType wanted, const Entry& next) { return wanted < next.Time; });
  for (; entry != this->Entries.end(); ++entry)
  {
    ranges.push_back(
      { { static_cast<std::size_t>(entry->First), static_cast<std::size_t>(entry->Last) + 1 } });
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkArrayChanges::GetTuplesSince(vtkMTimeType time, vtkIdTypeArray* ranges)
{
  if (!ranges)
  {
    vtkErrorMacro("The second argument of GetTuplesSince() is null. Give a vtkIdTypeArray.");
    return false;
  }
  std::vector<std::array<std::size_t, 2>> found;
  const bool isKnown = this->GetTuplesSince(time, found);
  ranges->SetNumberOfComponents(2);
  ranges->SetNumberOfTuples(static_cast<vtkIdType>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i)
  {
    ranges->SetTypedComponent(static_cast<vtkIdType>(i), 0, static_cast<vtkIdType>(found[i][0]));
    ranges->SetTypedComponent(
      static_cast<vtkIdType>(i), 1, static_cast<vtkIdType>(found[i][1]) - 1);
  }
  return isKnown;
}

//------------------------------------------------------------------------------
void vtkArrayChanges::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Array: " << this->Array.GetPointer() << "\n";
  os << indent << "NumberOfRanges: " << this->Entries.size() << "\n";
}
