// SPDX-License-Identifier: BSD-3-Clause
#include "OutputArrays.h"

#include "vtkDeviceOutputArray.h"

#include "vtkCharArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>

namespace deformvolume
{

namespace
{

vtkSmartPointer<vtkDataArray> MakeMask(vtkIdType numberOfTuples)
{
  const auto mask = vtkSmartPointer<vtkCharArray>::New();
  mask->SetName(ValidPointMaskName);
  mask->SetNumberOfTuples(numberOfTuples);
  return mask;
}

// Whether an array of an earlier output can be used for an array like `wanted`, which has no
// tuples. The memory of the array may be smaller than needed, or up to twice as large, since the
// size of the output changes with the deformation.
bool CanReuse(vtkDataArray* last, vtkDataArray* wanted, vtkIdType numberOfTuples)
{
  constexpr vtkIdType mostWaste = 2;
  return std::strcmp(last->GetClassName(), wanted->GetClassName()) == 0 &&
    last->GetNumberOfComponents() == wanted->GetNumberOfComponents() &&
    numberOfTuples >= last->GetSize() / last->GetNumberOfComponents() / mostWaste &&
    last->HasAComponentName() == wanted->HasAComponentName();
}

// Sets the size of an array whose values will be overwritten. If the array grows, some memory is
// reserved, since it may soon grow again.
void SetSize(vtkDataArray* array, vtkIdType numberOfTuples)
{
  constexpr vtkIdType reserve = 32; // reserve this fraction of the size: 1/32
  if (numberOfTuples > array->GetSize() / array->GetNumberOfComponents())
  {
    array->Allocate((numberOfTuples + numberOfTuples / reserve) * array->GetNumberOfComponents());
  }
  array->SetNumberOfTuples(numberOfTuples);
}

std::uint64_t CountBytes(vtkDataArray* array, vtkIdType numberOfTuples)
{
  const vtkIdType values =
    std::min(array->GetSize(), numberOfTuples * array->GetNumberOfComponents());
  return static_cast<std::uint64_t>(values) * static_cast<std::uint64_t>(array->GetDataTypeSize());
}

// Whether the values can be in an array of a class that VTK does not know. VTK reads such values as
// doubles, which do not hold all integers of 64 bits.
bool CanStayOnDevice(vtkDataArray* array)
{
  constexpr int mostBytes = 4;
  const int type = array->GetDataType();
  return type == VTK_FLOAT || type == VTK_DOUBLE || array->GetDataTypeSize() <= mostBytes;
}

} // namespace

bool OutputArrays::KeptArray::IsUnchanged(vtkIdType numberOfTuples) const
{
  return this->Array && this->Array->GetNumberOfTuples() == numberOfTuples &&
    GetWritableValues(this->Array) == this->Values && this->Array->GetMTime() == this->Modified &&
    (!this->OnDevice || this->OnDevice->IsRead());
}

bool OutputArrays::KeptArray::IsHeldByOthers() const
{
  return this->Array && this->Array->GetReferenceCount() > 1;
}

OutputArrays::KeptArray& OutputArrays::GetReusable(std::size_t array)
{
  return this->Last[array].IsHeldByOthers() ? this->BeforeLast[array] : this->Last[array];
}

std::uint64_t OutputArrays::GetReusableRevision()
{
  std::uint64_t revision = 0;
  for (std::size_t i = 0; i < this->Last.size(); ++i)
  {
    const KeptArray& reusable = this->GetReusable(i);
    if (&reusable == &this->Last[i])
    {
      continue; // the last output itself
    }
    if (!reusable.IsUnchanged(this->NumberOfTuples) || (revision && reusable.Revision != revision))
    {
      return 0;
    }
    revision = reusable.Revision;
  }
  return revision;
}

void OutputArrays::Prepare(const std::vector<SourceArray>& sources, vtkIdType numberOfTuples)
{
  this->Made.clear();
  this->NumberOfTuples = numberOfTuples;
  std::vector<vtkSmartPointer<vtkDataArray>> wanted;
  for (const SourceArray& source : sources)
  {
    wanted.push_back(MakeArrayLike(source.Array, 0));
  }
  wanted.push_back(MakeMask(0));
  const bool areReusable =
    std::equal(this->Last.begin(), this->Last.end(), wanted.begin(), wanted.end(),
      [=](const KeptArray& last, const auto& array)
      { return last.Array && CanReuse(last.Array, array, numberOfTuples); });
  if (!areReusable)
  {
    this->Last.assign(wanted.size(), KeptArray());
  }
  this->BeforeLast.resize(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
  {
    KeptArray& beforeLast = this->BeforeLast[i];
    if (!this->Last[i].IsHeldByOthers() || beforeLast.IsHeldByOthers() ||
      (beforeLast.Array && !CanReuse(beforeLast.Array, wanted[i], numberOfTuples)))
    {
      beforeLast = KeptArray();
    }
  }
}

std::uint64_t OutputArrays::GetReusableBytes()
{
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < this->Last.size(); ++i)
  {
    const KeptArray& reusable = this->GetReusable(i);
    bytes += reusable.Array ? CountBytes(reusable.Array, this->NumberOfTuples) : 0;
  }
  return bytes;
}

void OutputArrays::Make(const std::vector<SourceArray>& sources, DeformRequest& request)
{
  if (std::all_of(this->Last.begin(), this->Last.end(),
        [this](const KeptArray& last) { return last.IsUnchanged(this->NumberOfTuples); }))
  {
    for (std::size_t i = 0; i < sources.size(); ++i)
    {
      request.LastOutputs.push_back(GetWritableValues(this->Last[i].Array));
    }
    request.LastCoverage = static_cast<signed char*>(GetWritableValues(this->Last.back().Array));
  }
  request.OutputRevision = this->GetReusableRevision();
  for (std::size_t i = 0; i <= sources.size(); ++i)
  {
    const bool isMask = i == sources.size();
    KeptArray& reusable = this->GetReusable(i);
    request.HeldRevisions.push_back(
      reusable.IsUnchanged(this->NumberOfTuples) ? reusable.Revision : 0);
    vtkSmartPointer<vtkDataArray> made = reusable.Array;
    if (made)
    {
      if (made->GetNumberOfTuples() != this->NumberOfTuples)
      {
        SetSize(made, this->NumberOfTuples); // loses the values of the earlier output
        reusable.Values = nullptr;
      }
      CopyDescription(isMask ? MakeMask(0) : MakeArrayLike(sources[i].Array, 0), made);
    }
    else
    {
      made = isMask ? MakeMask(this->NumberOfTuples)
                    : MakeArrayLike(sources[i].Array, this->NumberOfTuples);
    }
    if (isMask)
    {
      request.Coverage = static_cast<signed char*>(GetWritableValues(made));
    }
    else
    {
      request.Outputs.push_back(GetWritableValues(made));
    }
    this->Made.push_back(made);
  }
}

void OutputArrays::Give(DeformReport& report, vtkImageData* image)
{
  for (std::size_t i = 0; i < this->Made.size(); ++i)
  {
    vtkSmartPointer<vtkDataArray> given = this->Made[i];
    if (!report.DeviceOutputs.empty() && CanStayOnDevice(given))
    {
      given = MakeDeviceOutputArray(given, report.DeviceOutputs[i]);
    }
    else if (!report.DeviceOutputs.empty())
    {
      const auto begin = std::chrono::steady_clock::now();
      report.DeviceOutputs[i]->Read();
      report.TransferTime +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    image->GetPointData()->AddArray(given);
  }
}

void OutputArrays::Keep(const DeformReport& report)
{
  for (std::size_t i = 0; i < this->Made.size(); ++i)
  {
    if (this->Made[i] != this->Last[i].Array)
    {
      this->BeforeLast[i] = this->Last[i];
    }
    KeptArray& last = this->Last[i];
    last.Array = std::exchange(this->Made[i], nullptr);
    last.Array->Modified(); // invalidates ranges of earlier values
    last.Values = GetWritableValues(last.Array);
    last.Modified = last.Array->GetMTime();
    last.Revision = report.Revision;
    last.OnDevice = report.DeviceOutputs.empty() ? nullptr : report.DeviceOutputs[i];
  }
  this->Made.clear();
}

void OutputArrays::Forget()
{
  this->Last.clear();
  this->BeforeLast.clear();
  this->Made.clear();
}

int OutputArrays::GetNumberOfUnread() const
{
  return static_cast<int>(std::count_if(this->Last.begin(), this->Last.end(),
    [](const KeptArray& last) { return last.OnDevice && last.OnDevice->IsOnDevice(); }));
}

} // namespace deformvolume
