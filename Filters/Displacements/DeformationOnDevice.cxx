// SPDX-License-Identifier: BSD-3-Clause
// The part of Deformation for vectors on a device.
#include "Deformation.h"

#include "FieldReading.h"
#include "VectorConversion.h"

#include "vtkDeviceVectorArray.h"

#include <utility>

namespace deformvolume
{

bool Deformation::UseVectorsOnDevice(
  vtkDataArray* array, vtkIdType points, double factor, const DeformationSource& source)
{
  auto* const vectors = vtkDeviceVectorArray::SafeDownCast(array);
  std::shared_ptr<DeviceVectors> there;
  if (vectors && !source.Device.empty() && vectors->GetNumberOfTuples() == points)
  {
    there = vectors->GetVectors(source.Device);
  }
  this->ForgetVectorsOnDevice();
  if (!there)
  {
    return false;
  }
  this->VectorsStamp.clear();
  this->FieldInPlace = DisplacementField();
  this->VectorsAreWhole = false; // Vectors on the host are of another version
  this->OnDevice = std::move(there);
  this->ArrayOnDevice = vectors;
  this->FactorOnDevice = factor;
  this->IsOnHost = false;
  this->MatrixOnDevice = GetRows(GetToDisplacement(source, factor));
  ++this->VectorsVersion;
  return true;
}

void Deformation::ForgetVectorsOnDevice()
{
  this->OnDevice.reset();
  this->ArrayOnDevice = nullptr;
  this->IsOnHost = true;
}

void Deformation::BringToHost()
{
  if (this->IsOnHost)
  {
    return;
  }
  Stamp stamp = this->VectorsStamp;
  this->Faults.Reset();
  this->Memories.clear();
  this->ReplaceVectors(
    static_cast<std::size_t>(this->ArrayOnDevice->GetNumberOfTuples()),
    [&](const VectorTaker& take)
    {
      if (!this->Field)
      {
        ReadVectors(this->ArrayOnDevice, take, "Displacement", "", nullptr,
          [&](vtkIdType node) { this->Faults.Mark(node, NodeFaults::NotFinite); });
        this->CheckFaults({}, this->VectorsSource);
        return;
      }
      ReadFieldVectors(this->ArrayOnDevice, {}, take);
      if (this->Faults.MayHaveAny())
      {
        ThrowTooFar();
      }
    },
    this->FactorOnDevice, this->VectorsSource);
  this->VectorsStamp = std::move(stamp);
  this->IsOnHost = true;
}

} // namespace deformvolume
