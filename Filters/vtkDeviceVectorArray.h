// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeviceVectorArray
 * @brief   array of vectors whose values lie in the memory of an OpenCL device
 *
 * An array of floats as any other, whose tuples of three components vtkDeformVolumeFilter reads in
 * the memory of its device. Use it for the vectors of a deformation mesh or of a displacement field
 * that several filters use: they take one copy to the device, not one each. Values that a
 * simulation on the device makes, such as those of vtkChainMailDeformation, never pass through the
 * host unless somebody asks for them.
 *
 * Values are brought to the host at the first access by VTK, and again where they have changed on
 * the device since. Once something writes them by VTK, they are values of the host. A filter that
 * wants them on the device then gets them there (see SetDevice()): all of them, or those that a
 * vtkArrayChanges says have been written. Values that are written through a pointer need a call of
 * Modified(), as in any array.
 *
 * A device that is a processor works in the memory of the host. There this array is as good as a
 * vtkFloatArray, and no better. A filter on another device than that of the array reads the values
 * on the host, and so does a filter that needs the bounds of a volume that a mesh deforms
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
// The wrappers know no superclass that is a template.
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
   * Set/Get the OpenCL device that values of the host are taken to, in the words of
   * vtkDeformVolumeFilter::SetDevice(). Default: "", the best one. Values that have been made on a
   * device stay there.
   */
  vtkSetMacro(Device, std::string);
  vtkGetMacro(Device, std::string);
  ///@}

  /**
   * Whether the values are those of a device with memory of its own, and nothing has been written
   * on the host since.
   */
  bool IsOnDevice() const;

  ///@{
  /**
   * How often values have been taken to the device, and brought to the host.
   */
  vtkGetMacro(NumberOfUploads, vtkIdType);
  vtkGetMacro(NumberOfDownloads, vtkIdType);
  ///@}

  /**
   * Mark the values as changed, after they were written through a pointer or on the device.
   */
  void Modified() override;

#ifndef __VTK_WRAP__
  /// The values become these vectors, which the array and others share. Whoever writes them on the
  /// device calls Modified(), or AddTuples() of a vtkArrayChanges. Null: the array gets empty.
  void SetVectors(const std::shared_ptr<deformvolume::DeviceVectors>& vectors);

  /// Whether the values are these vectors.
  bool IsOf(const std::shared_ptr<deformvolume::DeviceVectors>& vectors) const
  {
    return !this->IsOfHost && this->Vectors == vectors;
  }

  /// The values in the memory of a device, of which the whole name is given; values of the host are
  /// taken there first. Null where that is not the device of the array, or has no memory of its
  /// own, or the tuples have not three components. Throws deformvolume::Error.
  std::shared_ptr<deformvolume::DeviceVectors> GetVectors(const std::string& device);

  /// The values on the host, to be read only.
  const float* GetValues() const
  {
    const float* values = this->Values.load(std::memory_order_acquire);
    return values ? values : this->BringToHost();
  }

  ///@{
  /// What vtkGenericDataArray asks of its subclasses.
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
  /// On the host the values lie tuple by tuple.
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
  /// Has the values be those of the host, and returns them.
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

  mutable std::mutex Mutex; // of what an access changes
  std::vector<float> Memory;
  mutable std::atomic<const float*> Values{ nullptr }; // null: they have to be brought
  std::atomic<bool> IsOfHost{ true };
  std::atomic<bool> IsWritten{ false }; // since they were taken to the device
  std::shared_ptr<deformvolume::DeviceVectors> Vectors;
  vtkMTimeType SentTime = 0;
  std::uint64_t Revision = 0;   // that the vectors had when the array was modified last
  bool HasGivenPointer = false; // to values that the device has, too
#endif

  std::string Device;
  vtkIdType NumberOfUploads = 0;
  mutable vtkIdType NumberOfDownloads = 0;
};

#endif
