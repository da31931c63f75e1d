// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeviceOutputArray.h"

#include "VolumeArrays.h"

#include "vtkArrayIteratorTemplate.h"
#include "vtkGenericDataArray.txx"
#include "vtkObjectFactory.h"

#include <string>

//------------------------------------------------------------------------------
template <typename T>
vtkDeviceOutputArray<T>* vtkDeviceOutputArray<T>::New()
{
  VTK_STANDARD_NEW_BODY(vtkDeviceOutputArray<T>);
}

//------------------------------------------------------------------------------
template <typename T>
vtkDeviceOutputArray<T>::vtkDeviceOutputArray()
  : DataType(vtkTypeTraits<T>::VTK_TYPE_ID)
{
  this->SetSize(0, 0);
}

//------------------------------------------------------------------------------
template <typename T>
vtkDeviceOutputArray<T>::~vtkDeviceOutputArray()
{
  this->Drop();
}

//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::Drop()
{
  if (this->Output)
  {
    this->Output->Drop();
    this->Output.reset();
  }
}

//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::Modified()
{
  if (this->Values)
  {
    this->Host->Modified(); // its memory may have other values than the filter has written
  }
  this->Superclass::Modified();
}

//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::SetOutput(
  vtkDataArray* host, const std::shared_ptr<deformvolume::DeviceOutput>& output)
{
  this->DataType = host->GetDataType(); // VTK_ID_TYPE differs from the type of T
  this->NumberOfComponents = host->GetNumberOfComponents();
  this->Size = this->MaxId = host->GetNumberOfValues();
  --this->MaxId;
  this->Host = host;
  this->Output = output;
  this->Values = nullptr;
  this->DataChanged();
  this->Modified();
}

//------------------------------------------------------------------------------
template <typename T>
T* vtkDeviceOutputArray<T>::BringToHost() const
{
  std::string message;
  T* values = nullptr;
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    values = this->Values;
    if (values)
    {
      return values; // another thread was first
    }
    try
    {
      if (this->Output)
      {
        this->Output->Read();
      }
    }
    catch (const std::exception& error)
    {
      message = error.what();
    }
    values = static_cast<T*>(this->Host->GetVoidPointer(0));
    this->Values.store(values, std::memory_order_release);
  }
  if (!message.empty())
  {
    // Report the error without the lock: observers may read this array.
    vtkErrorWithObjectMacro(const_cast<vtkDeviceOutputArray<T>*>(this), << message);
  }
  return values;
}

//------------------------------------------------------------------------------
template <typename T>
bool vtkDeviceOutputArray<T>::SetSize(vtkIdType values, vtkIdType kept)
{
  // Do not resize the last memory: the filter still refers to it.
  const auto host =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(this->DataType));
  if (!host->Resize(values))
  {
    return false;
  }
  auto* const memory = static_cast<T*>(host->GetVoidPointer(0));
  if (kept > 0)
  {
    std::copy_n(this->GetValues(), kept, memory);
  }
  this->Drop();
  this->Host = host;
  this->Values = memory;
  return true;
}

//------------------------------------------------------------------------------
template <typename T>
bool vtkDeviceOutputArray<T>::IsLikeHost() const
{
  return this->Host->GetNumberOfComponents() == this->NumberOfComponents &&
    this->Host->GetNumberOfValues() == this->GetNumberOfValues();
}

//------------------------------------------------------------------------------
template <typename T>
vtkDataArray* vtkDeviceOutputArray<T>::GetHost() const
{
  this->GetValues();
  return this->IsLikeHost() ? this->Host.Get() : nullptr;
}

#ifdef DEFORMVOLUME_RANGES_OF_GHOSTS
//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::ComputeRange(
  double range[2], int component, const unsigned char* ghosts, unsigned char ghostsToSkip)
{
  if (vtkDataArray* const host = this->GetHost())
  {
    host->GetRange(range, component, ghosts, ghostsToSkip);
  }
  else
  {
    this->Superclass::ComputeRange(range, component, ghosts, ghostsToSkip);
  }
}

//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::ComputeFiniteRange(
  double range[2], int component, const unsigned char* ghosts, unsigned char ghostsToSkip)
{
  if (vtkDataArray* const host = this->GetHost())
  {
    host->GetFiniteRange(range, component, ghosts, ghostsToSkip);
  }
  else
  {
    this->Superclass::ComputeFiniteRange(range, component, ghosts, ghostsToSkip);
  }
}
#else
//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::ComputeRange(double range[2], int component)
{
  if (vtkDataArray* const host = this->GetHost())
  {
    host->GetRange(range, component);
  }
  else
  {
    this->Superclass::ComputeRange(range, component);
  }
}

//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::ComputeFiniteRange(double range[2], int component)
{
  if (vtkDataArray* const host = this->GetHost())
  {
    host->GetFiniteRange(range, component);
  }
  else
  {
    this->Superclass::ComputeFiniteRange(range, component);
  }
}
#endif

//------------------------------------------------------------------------------
template <typename T>
bool vtkDeviceOutputArray<T>::AllocateTuples(vtkIdType tuples)
{
  return this->SetSize(tuples * this->NumberOfComponents, 0);
}

//------------------------------------------------------------------------------
template <typename T>
bool vtkDeviceOutputArray<T>::ReallocateTuples(vtkIdType tuples)
{
  const vtkIdType values = tuples * this->NumberOfComponents;
  return this->SetSize(values, std::min(values, this->Size));
}

//------------------------------------------------------------------------------
template <typename T>
void* vtkDeviceOutputArray<T>::WriteVoidPointer(vtkIdType value, vtkIdType count)
{
  const vtkIdType end = value + count;
  if (end > this->Size)
  {
    const vtkIdType components = this->NumberOfComponents;
    if (!this->Resize((end + components - 1) / components))
    {
      return nullptr;
    }
  }
  this->MaxId = std::max(this->MaxId, end - 1);
  this->DataChanged();
  return this->GetValues() + value;
}

//------------------------------------------------------------------------------
template <typename T>
vtkArrayIterator* vtkDeviceOutputArray<T>::NewIterator()
{
  vtkArrayIterator* iterator = vtkArrayIteratorTemplate<T>::New();
  iterator->Initialize(this);
  return iterator;
}

//------------------------------------------------------------------------------
template <typename T>
void vtkDeviceOutputArray<T>::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "IsOnDevice: " << (this->Values ? "false" : "true") << "\n";
}

namespace deformvolume
{

vtkSmartPointer<vtkDataArray> MakeDeviceOutputArray(
  vtkDataArray* host, const std::shared_ptr<DeviceOutput>& output)
{
  vtkSmartPointer<vtkDataArray> made;
  switch (host->GetDataType())
  {
    vtkTemplateMacro({
      const auto array = vtkSmartPointer<vtkDeviceOutputArray<VTK_TT>>::New();
      array->SetOutput(host, output);
      made = array;
    });
    default:
      return host; // there are no other types
  }
  CopyDescription(host, made);
  return made;
}

} // namespace deformvolume
