// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeviceVectorArray
 * @brief   array of vectors whose values lie in the memory of an OpenCL device
 *
 * An array of floats whose tuples of three components vtkDeformVolumeFilter reads in the memory of
 * its device. Use it for the vectors of a deformation mesh or of a displacement field that several
 * filters use: they are uploaded once, not once for each filter. Values that a simulation computes
 * on the device, such as those of vtkChainMailDeformation, are not copied to the host unless
 * somebody accesses them.
 *
 * Values are downloaded to the host at the first access through VTK, and again after they have
 * changed on the device. After something has written values through VTK, the values of the host are
 * the valid ones. They are uploaded when a filter needs them on the device (see SetDevice()): all
 * values, or those that a vtkArrayChanges has logged as written. After values are written through a
 * pointer, call Modified(), as for any array.
 *
 * On CPU devices this array is equivalent to a vtkFloatArray, since these use the memory of the
 * host. A filter on another device than that of the array reads the values on the host. So does a
 * filter that needs the bounds of a volume that a mesh deforms
 * (vtkDeformVolumeFilter::SetOutputBoundsMode()).
 *
 * Arrays of another number of components than three stay on the host.
 */
#ifndef vtkDeviceVectorArray_h
#define vtkDeviceVectorArray_h

#include "vtkDataArray.h"          // for the wrappers
#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkGenericDataArray.h"   // the superclass

#include <algorithm> // for std::copy_n
#include <atomic>    // for std::atomic
#include <cstdint>   // for std::uint64_t
#include <memory>    // for std::shared_ptr
#include <mutex>     // for std::mutex
#include <string>    // for std::string
#include <vector>    // for std::vector

namespace deformvolume
{
class DeviceVectors;
}

class vtkDeviceVectorArray;
// VTK's wrappers do not support superclasses that are templates.
#ifdef __VTK_WRAP__
#define vtkDeviceVectorArrayBase vtkDataArray
#else
using vtkDeviceVectorArrayBase = vtkGenericDataArray<vtkDeviceVectorArray, float>;
#endif

class VTKDEFORMVOLUME_EXPORT vtkDeviceVectorArray : public vtkDeviceVectorArrayBase
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkDeviceVectorArray* New();
  vtkTypeMacro(vtkDeviceVectorArray, vtkDeviceVectorArrayBase);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Set/Get the OpenCL device to which values of the host are uploaded, see
   * vtkDeformVolumeFilter::SetDevice(). Default: "", the best device. Values that were computed on
   * a device stay there.
   */
  vtkSetMacro(Device, std::string);
  vtkGetMacro(Device, std::string);
  ///@}

  /**
   * Whether a device with memory of its own has the values, and nothing has been written on the
   * host since.
   */
  bool IsOnDevice() const;

  ///@{
  /**
   * Get the numbers of uploads to the device, and of downloads to the host.
   */
  vtkGetMacro(NumberOfUploads, vtkIdType);
  vtkGetMacro(NumberOfDownloads, vtkIdType);
  ///@}

  /**
   * Mark the values as changed, after they were written through a pointer or on the device.
   */
  void Modified() override;

#ifndef __VTK_WRAP__
  /// Set the vectors with the values, which the array shares with others. After writing them on the
  /// device, call Modified(), or AddTuples() of a vtkArrayChanges. Null makes the array empty.
  void SetVectors(const std::shared_ptr<deformvolume::DeviceVectors>& vectors);

  /// Whether the values are these vectors.
  bool IsOf(const std::shared_ptr<deformvolume::DeviceVectors>& vectors) const
  {
    return !this->IsOfHost && this->Vectors == vectors;
  }

  /// Returns the values in the memory of a device. device: its full name. Values of the host are
  /// uploaded first. Returns null if it is not the device of the array, if it has no memory of its
  /// own, or if the tuples do not have three components. Throws deformvolume::Error.
  std::shared_ptr<deformvolume::DeviceVectors> GetVectors(const std::string& device);

  /// The values on the host, read-only.
  const float* GetValues() const
  {
    const float* values = this->Values.load(std::memory_order_acquire);
    return values ? values : this->BringToHost();
  }

  ///@{
  /// Functions that vtkGenericDataArray requires of its subclasses.
  float GetValue(vtkIdType value) const
  {
    return this->GetValues()[value];
  }
  void SetValue(vtkIdType value, float number)
  {
    this->Write()[value] = number;
  }
  void GetTypedTuple(vtkIdType tuple, float* numbers) const
  {
    std::copy_n(
      this->GetValues() + tuple * this->NumberOfComponents, this->NumberOfComponents, numbers);
  }
  void SetTypedTuple(vtkIdType tuple, const float* numbers)
  {
    std::copy_n(
      numbers, this->NumberOfComponents, this->Write() + tuple * this->NumberOfComponents);
  }
  float GetTypedComponent(vtkIdType tuple, int component) const
  {
    return this->GetValues()[tuple * this->NumberOfComponents + component];
  }
  void SetTypedComponent(vtkIdType tuple, int component, float number)
  {
    this->Write()[tuple * this->NumberOfComponents + component] = number;
  }
  bool AllocateTuples(vtkIdType tuples);
  bool ReallocateTuples(vtkIdType tuples);
  ///@}

  ///@{
  /// On the host the values are an array of structs.
  bool HasStandardMemoryLayout() const override
  {
    return true;
  }
  void* GetVoidPointer(vtkIdType value) override;
  void* WriteVoidPointer(vtkIdType value, vtkIdType count) override;
  VTK_NEWINSTANCE vtkArrayIterator* NewIterator() override;
  ///@}
#endif

protected:
  vtkDeviceVectorArray();
  ~vtkDeviceVectorArray() override;

private:
  vtkDeviceVectorArray(const vtkDeviceVectorArray&) = delete;
  void operator=(const vtkDeviceVectorArray&) = delete;

#ifndef __VTK_WRAP__
  const float* BringToHost() const;
  /// Makes the values of the host the valid ones, and returns them for writing.
  float* Write()
  {
    if (!this->IsOfHost.load(std::memory_order_acquire))
    {
      this->Detach();
    }
    this->IsWritten.store(true, std::memory_order_relaxed);
    return this->Memory.data();
  }
  void Detach();
  bool SetSize(std::size_t values, bool keep);
  void Send(const std::string& device);

  mutable std::mutex Mutex; // protects the members that an access changes
  std::vector<float> Memory;
  mutable std::atomic<const float*> Values{ nullptr }; // null: not yet downloaded
  std::atomic<bool> IsOfHost{ true };
  std::atomic<bool> IsWritten{ false }; // whether values were written since the last upload
  std::shared_ptr<deformvolume::DeviceVectors> Vectors;
  vtkMTimeType SentTime = 0;
  std::uint64_t Revision = 0;   // of the vectors at the last Modified()
  bool HasGivenPointer = false; // whether somebody has a pointer to a copy of values of the device
#endif

  std::string Device;
  vtkIdType NumberOfUploads = 0;
  mutable vtkIdType NumberOfDownloads = 0;
};

#endif
