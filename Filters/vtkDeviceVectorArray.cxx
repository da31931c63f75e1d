// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeviceVectorArray.h"

#include "Device.h"
#include "DeviceVectors.h"
#include "WrittenTuples.h"

#include "vtkArrayIteratorTemplate.h"
#include "vtkGenericDataArray.txx"
#include "vtkObjectFactory.h"

#include <algorithm>
#include <new>

vtkStandardNewMacro(vtkDeviceVectorArray);

//------------------------------------------------------------------------------
vtkDeviceVectorArray::vtkDeviceVectorArray() = default;

//------------------------------------------------------------------------------
vtkDeviceVectorArray::~vtkDeviceVectorArray() = default;

//------------------------------------------------------------------------------
bool vtkDeviceVectorArray::IsOnDevice() const
{
  return this->Vectors && !this->Vectors->AreInHostMemory() &&
    (!this->IsOfHost || (!this->IsWritten && this->SentTime == this->MTime.GetMTime()));
}

//------------------------------------------------------------------------------
void vtkDeviceVectorArray::Modified()
{
  if (!this->IsOfHost)
  {
    const std::uint64_t revision = this->Vectors->GetRevision();
    if (revision != this->Revision)
    {
      this->Revision = revision;
      this->HasGivenPointer = false;
      this->Values = nullptr;
      this->DataChanged();
    }
    else if (this->HasGivenPointer)
    {
      this->Detach(); // somebody has written through the pointer
    }
  }
  this->Superclass::Modified();
}

//------------------------------------------------------------------------------
void vtkDeviceVectorArray::SetVectors(const std::shared_ptr<deformvolume::DeviceVectors>& vectors)
{
  if (!vectors)
  {
    this->Initialize();
    this->Modified();
    return;
  }
  this->SetNumberOfComponents(3);
  std::vector<float>().swap(this->Memory);
  this->Vectors = vectors;
  this->Revision = vectors->GetRevision();
  this->HasGivenPointer = false;
  this->IsOfHost = false;
  this->Values = nullptr;
  this->Size = 3 * static_cast<vtkIdType>(vectors->GetNumberOfPoints());
  this->MaxId = this->Size - 1;
  this->DataChanged();
  this->Superclass::Modified();
}

//------------------------------------------------------------------------------
std::shared_ptr<deformvolume::DeviceVectors> vtkDeviceVectorArray::GetVectors(
  const std::string& device)
{
  constexpr int components = 3;
  if (this->NumberOfComponents != components || this->GetNumberOfTuples() == 0)
  {
    return {};
  }
  if (!this->IsOfHost)
  {
    const bool isThere = !this->Vectors->AreInHostMemory() && this->Vectors->GetDevice() == device;
    return isThere ? this->Vectors : nullptr;
  }
  if (!deformvolume::GetDeviceAbilities(device).OwnMemory ||
    deformvolume::ResolveDevice(this->Device) != device)
  {
    return {};
  }
  this->Send(device);
  return this->Vectors;
}

//------------------------------------------------------------------------------
void vtkDeviceVectorArray::Send(const std::string& device)
{
  const auto tuples = static_cast<std::size_t>(this->GetNumberOfTuples());
  const bool isThere = this->Vectors && this->Vectors->GetDevice() == device &&
    this->Vectors->GetNumberOfPoints() == tuples;
  if (isThere && !this->IsWritten && this->SentTime == this->GetMTime())
  {
    return;
  }
  std::optional<deformvolume::PointRanges> written;
  if (isThere)
  {
    written = deformvolume::FindWritten(this, this, this->SentTime);
  }
  else
  {
    this->Vectors.reset(); // frees its memory before new memory is allocated
    this->Vectors = std::make_shared<deformvolume::DeviceVectors>(device, tuples);
  }
  this->SentTime = 0; // stays 0 if a call below throws
  if (written && !written->empty())
  {
    this->Vectors->Write(this->Memory.data(), *written);
  }
  else
  {
    this->Vectors->Write(this->Memory.data());
  }
  ++this->NumberOfUploads;
  this->IsWritten = false;
  this->SentTime = this->GetMTime();
}

//------------------------------------------------------------------------------
const float* vtkDeviceVectorArray::BringToHost() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const float* values = this->Values;
  if (!values)
  {
    // An array of no values has no vectors.
    values = this->IsOfHost ? this->Memory.data() : this->Vectors->Read();
    this->NumberOfDownloads += !this->IsOfHost && !this->Vectors->AreInHostMemory() ? 1 : 0;
    this->Values.store(values, std::memory_order_release);
  }
  return values;
}

//------------------------------------------------------------------------------
void vtkDeviceVectorArray::Detach()
{
  const float* values = this->GetValues();
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (this->IsOfHost) // another thread was first
  {
    return;
  }
  if (values != this->Memory.data())
  {
    this->Memory.assign(values, values + this->Size);
  }
  this->Values = this->Memory.data();
  this->Vectors.reset();
  this->SentTime = 0;
  this->IsWritten = true;
  this->IsOfHost.store(true, std::memory_order_release);
}

//------------------------------------------------------------------------------
bool vtkDeviceVectorArray::SetSize(std::size_t values, bool keep)
{
  if (keep && !this->IsOfHost)
  {
    this->Detach();
  }
  try
  {
    if (!keep)
    {
      this->Memory.clear();
    }
    this->Memory.resize(values);
    if (values == 0)
    {
      this->Memory.shrink_to_fit();
    }
  }
  catch (const std::bad_alloc&)
  {
    return false;
  }
  this->Vectors.reset();
  this->SentTime = 0;
  this->IsWritten = true;
  this->IsOfHost = true;
  this->Values = this->Memory.data();
  return true;
}

//------------------------------------------------------------------------------
bool vtkDeviceVectorArray::AllocateTuples(vtkIdType tuples)
{
  return this->SetSize(static_cast<std::size_t>(tuples * this->NumberOfComponents), false);
}

//------------------------------------------------------------------------------
bool vtkDeviceVectorArray::ReallocateTuples(vtkIdType tuples)
{
  return this->SetSize(static_cast<std::size_t>(tuples * this->NumberOfComponents), true);
}

//------------------------------------------------------------------------------
void* vtkDeviceVectorArray::GetVoidPointer(vtkIdType value)
{
  if (!this->IsOfHost && this->GetValues() != this->Memory.data())
  {
    // Return a copy: other readers of the vectors must not see what is written through the pointer.
    const float* values = this->GetValues();
    this->Memory.assign(values, values + this->Size);
    this->Values = this->Memory.data();
  }
  this->HasGivenPointer = !this->IsOfHost;
  return this->Memory.data() + value;
}

//------------------------------------------------------------------------------
void* vtkDeviceVectorArray::WriteVoidPointer(vtkIdType value, vtkIdType count)
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
  return this->Write() + value;
}

//------------------------------------------------------------------------------
vtkArrayIterator* vtkDeviceVectorArray::NewIterator()
{
  vtkArrayIterator* iterator = vtkArrayIteratorTemplate<float>::New();
  iterator->Initialize(this);
  return iterator;
}

//------------------------------------------------------------------------------
void vtkDeviceVectorArray::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Device: " << this->Device << "\n";
  os << indent << "IsOnDevice: " << (this->IsOnDevice() ? "true" : "false") << "\n";
  os << indent << "NumberOfUploads: " << this->NumberOfUploads << "\n";
  os << indent << "NumberOfDownloads: " << this->NumberOfDownloads << "\n";
}
