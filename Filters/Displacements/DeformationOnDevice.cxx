// SPDX-License-Identifier: BSD-3-Clause
// The part of Deformation for vectors on a device.
#include "Deformation.h"

#include "vtkDeviceVectorArray.h"

#include <utility>

namespace deformvolume
{

bool Deformation::UseVectorsOnDevice(
  vtkDataArray* array, vtkIdType points, const DeformationSource& source)
{
  auto* const vectors = vtkDeviceVectorArray::SafeDownCast(array);
  std::shared_ptr<DeviceVectors> there;
  if (vectors && !source.Device.empty() && vectors->GetNumberOfTuples() == points)
  {
    there = vectors->GetVectors(source.Device);
  }
  this->OnDevice = std::move(there);
  this->ArrayOnDevice = this->OnDevice ? vectors : nullptr;
  this->IsOnHost = !this->OnDevice;
  if (this->IsOnHost)
  {
    return false;
  }
  this->VectorsStamp.clear();
  this->FieldInPlace = DisplacementField();
  this->VectorsAreWhole = false; // Vectors on the host are of another version
  this->MatrixOnDevice = GetRows(GetToDisplacement(source));
  ++this->VectorsVersion;
  return true;
}

void Deformation::BringToHost()
{
  if (this->IsOnHost)
  {
    return;
  }
  Stamp stamp = this->VectorsStamp;
  this->Memories.clear();
  if (this->Field)
  {
    this->ConvertField(this->ArrayOnDevice, this->VectorsSource);
  }
  else
  {
    this->Faults.Reset();
    this->ReplaceVectors(
      static_cast<std::size_t>(this->ArrayOnDevice->GetNumberOfTuples()),
      [&](const VectorTaker& take)
      {
        ReadVectors(this->ArrayOnDevice, take, "Displacement", "", nullptr,
          [&](vtkIdType node) { this->Faults.Mark(node, NodeFaults::NotFinite); });
        this->CheckFaults({}, this->VectorsSource);
      },
      this->VectorsSource);
  }
  this->VectorsStamp = std::move(stamp);
  this->IsOnHost = true;
}

} // namespace deformvolume
