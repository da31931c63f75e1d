// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorOutput_h
#define DeformVolumeVectorOutput_h

#include "DeviceVectors.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <memory>
#include <string>

namespace deformvolume
{

/// An array "Displacement" that a model of the engine writes: a vtkFloatArray, or on a device with
/// memory of its own a vtkDeviceVectorArray, whose values stay there.
class VectorOutput
{
public:
  /// Gives the array to a model, which has a function SetOutput for memory of the host and for
  /// vectors; makes another one where device or number have changed. arguments: what else that
  /// takes.
  template <typename Model, typename... Arguments>
  void Make(
    Model& model, const std::string& device, vtkIdType tuples, const Arguments&... arguments)
  {
    if (this->Allocate(device, tuples))
    {
      model.SetOutput(this->Vectors, arguments...);
    }
    else
    {
      model.SetOutput(this->Memory, arguments...);
    }
  }

  /// Has the array hold what the device has, also where somebody has written to it.
  void Restore();

  vtkDataArray* GetArray() const { return this->Array; }

private:
  /// Whether the values are on the device.
  bool Allocate(const std::string& device, vtkIdType tuples);

  vtkSmartPointer<vtkDataArray> Array;
  std::string Device; // of the array
  float* Memory = nullptr;
  std::shared_ptr<DeviceVectors> Vectors;
};

} // namespace deformvolume

#endif
