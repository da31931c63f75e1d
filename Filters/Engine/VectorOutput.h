// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorOutput_h
#define DeformVolumeVectorOutput_h

#include "DeviceVectors.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <memory>
#include <string>

class vtkFloatArray;

namespace deformvolume
{

/// Makes an array "Displacement" of vectors. Throws std::bad_alloc.
vtkSmartPointer<vtkFloatArray> MakeDisplacements(vtkIdType tuples);

/// An array "Displacement" that a model of the engine writes: a vtkFloatArray, or on a device with
/// memory of its own a vtkDeviceVectorArray, whose values stay there.
class VectorOutput
{
public:
  /// Sets the array as the output of a model. Makes a new array if the device or the number of
  /// tuples has changed. The model has overloads of SetOutput() for host memory and for
  /// DeviceVectors; `arguments` are their other arguments.
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

  /// Makes the array hold the values on the device again, if somebody has written other values to
  /// it.
  void Restore();

  vtkDataArray* GetArray() const { return this->Array; }

private:
  /// Makes or keeps the array. Returns whether its values are on the device.
  bool Allocate(const std::string& device, vtkIdType tuples);

  vtkSmartPointer<vtkDataArray> Array;
  std::string Device; // of the array
  float* Memory = nullptr;
  std::shared_ptr<DeviceVectors> Vectors;
};

} // namespace deformvolume

#endif
