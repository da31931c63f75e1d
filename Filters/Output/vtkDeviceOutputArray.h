// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkDeviceOutputArray_h
#define vtkDeviceOutputArray_h

#include "DeviceOutput.h"
#include "RangesOfGhosts.h"

#include "vtkDataArray.h"
#include "vtkGenericDataArray.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>

namespace deformvolume
{

/// Makes an array for output values on a device, with the name, component names and other
/// descriptions of `host`. The values are downloaded to the memory of `host` at the first access.
vtkSmartPointer<vtkDataArray> MakeDeviceOutputArray(
  vtkDataArray* host, const std::shared_ptr<DeviceOutput>& output);

} // namespace deformvolume

/// The array that MakeDeviceOutputArray() makes. It has the interface of vtkDataArray. To get an
/// array of structs, such as a vtkFloatArray, copy the array or its dataset with DeepCopy().
/// NewInstance() makes an array of structs. Several threads may read at once.
///
/// If the values cannot be downloaded, this object reports an error, and the values are the
/// background.
template <typename T>
class vtkDeviceOutputArray : public vtkGenericDataArray<vtkDeviceOutputArray<T>, T>
{
  using Generic = vtkGenericDataArray<vtkDeviceOutputArray<T>, T>;

public:
  static vtkDeviceOutputArray* New();
  vtkAbstractTemplateTypeMacro(vtkDeviceOutputArray<T>, Generic);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Sets the output that has the values. host: an array of T with the size of the output, to which
  /// the values are downloaded. Call this before anybody else has this array.
  void SetOutput(vtkDataArray* host, const std::shared_ptr<deformvolume::DeviceOutput>& output);

  void Modified() override;
  int GetDataType() const override { return this->DataType; }

  /// The values on the host.
  T* GetValues() const
  {
    T* const values = this->Values.load(std::memory_order_acquire);
    return values ? values : this->BringToHost();
  }

  ///@{
  /// Functions that vtkGenericDataArray requires of its subclasses.
  T GetValue(vtkIdType value) const { return this->GetValues()[value]; }
  void SetValue(vtkIdType value, T number) { this->GetValues()[value] = number; }
  void GetTypedTuple(vtkIdType tuple, T* numbers) const
  {
    std::copy_n(
      this->GetValues() + tuple * this->NumberOfComponents, this->NumberOfComponents, numbers);
  }
  void SetTypedTuple(vtkIdType tuple, const T* numbers)
  {
    std::copy_n(
      numbers, this->NumberOfComponents, this->GetValues() + tuple * this->NumberOfComponents);
  }
  T GetTypedComponent(vtkIdType tuple, int component) const
  {
    return this->GetValues()[tuple * this->NumberOfComponents + component];
  }
  void SetTypedComponent(vtkIdType tuple, int component, T number)
  {
    this->GetValues()[tuple * this->NumberOfComponents + component] = number;
  }
  bool AllocateTuples(vtkIdType tuples);
  bool ReallocateTuples(vtkIdType tuples);
  ///@}

  ///@{
  /// On the host the values are an array of structs.
  bool HasStandardMemoryLayout() const override { return true; }
  void* GetVoidPointer(vtkIdType value) override { return this->GetValues() + value; }
  void* WriteVoidPointer(vtkIdType value, vtkIdType count) override;
  VTK_NEWINSTANCE vtkArrayIterator* NewIterator() override;
  ///@}

protected:
  ///@{
  /// Ranges are computed by Host, which does not read the values as doubles.
#ifdef DEFORMVOLUME_RANGES_OF_GHOSTS
  // VTK calls these also for ranges without ghosts.
  void ComputeRange(double range[2], int component, const unsigned char* ghosts,
    unsigned char ghostsToSkip = 0xff) override;
  void ComputeFiniteRange(double range[2], int component, const unsigned char* ghosts,
    unsigned char ghostsToSkip = 0xff) override;
#else
  void ComputeRange(double range[2], int component) override;
  void ComputeFiniteRange(double range[2], int component) override;
#endif
  ///@}

  vtkDeviceOutputArray();
  ~vtkDeviceOutputArray() override;

  vtkObjectBase* NewInstanceInternal() const override
  {
    return vtkDataArray::CreateDataArray(this->DataType);
  }

private:
  vtkDeviceOutputArray(const vtkDeviceOutputArray&) = delete;
  void operator=(const vtkDeviceOutputArray&) = delete;

  T* BringToHost() const;
  /// Whether Host has the size of this array.
  bool IsLikeHost() const;
  /// Releases the output on the device.
  void Drop();
  /// Host with the values of this array; null if Host has another size.
  vtkDataArray* GetHost() const;
  /// Allocates new memory for a number of values. kept: number of values that are copied.
  bool SetSize(vtkIdType values, vtkIdType kept);

  int DataType;
  vtkSmartPointer<vtkDataArray> Host;        // has the memory of the values
  mutable std::mutex Mutex;                  // locked at the first access
  mutable std::atomic<T*> Values{ nullptr }; // null: not yet downloaded
  std::shared_ptr<deformvolume::DeviceOutput> Output;
};

#endif
