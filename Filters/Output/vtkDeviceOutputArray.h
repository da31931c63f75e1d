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
#include <optional>
#include <vector>

namespace deformvolume
{

/// An array of the output of a filter whose values are on the device: it has the name and the
/// description of an ordinary array, and gets the values into the memory of that when somebody
/// reads or writes the first of them.
vtkSmartPointer<vtkDataArray> MakeDeviceOutputArray(
  vtkDataArray* host, const std::shared_ptr<DeviceOutput>& output);

} // namespace deformvolume

/// What MakeDeviceOutputArray() makes. It has the interfaces that all arrays have in common; who
/// needs one of VTK's common layout copies it, or the data set, by DeepCopy(). NewInstance() is
/// such an array. Several threads may read at once.
///
/// Where the values cannot be brought to the host that is an error of this object, and they are
/// the background.
template <typename T>
class vtkDeviceOutputArray : public vtkGenericDataArray<vtkDeviceOutputArray<T>, T>
{
  using Generic = vtkGenericDataArray<vtkDeviceOutputArray<T>, T>;

public:
  static vtkDeviceOutputArray* New();
  vtkAbstractTemplateTypeMacro(vtkDeviceOutputArray<T>, Generic);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// The values become those of an output, in the memory of an array of T that has its size. Before
  /// anybody else has this array.
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
  /// What vtkGenericDataArray asks of its subclasses.
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
  /// On the host the values lie tuple by tuple.
  bool HasStandardMemoryLayout() const override { return true; }
  void* GetVoidPointer(vtkIdType value) override { return this->GetValues() + value; }
  void* WriteVoidPointer(vtkIdType value, vtkIdType count) override;
  VTK_NEWINSTANCE vtkArrayIterator* NewIterator() override;
  ///@}

protected:
  ///@{
  /// Mappers ask for ranges of each new output. Those of components are found on the device, and
  /// the others by the ordinary array, whose numbers are not read as doubles.
#ifdef DEFORMVOLUME_RANGES_OF_GHOSTS
  // Those without ghosts come here.
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
  /// Null where the values are not on the device any more, or never were.
  std::shared_ptr<deformvolume::DeviceOutput> GetDeviceOutput() const;
  /// Whether the ordinary array has the size of this one.
  bool IsLikeHost() const;
  /// The range of a component as long as the values are on the device. Returns false where the host
  /// is to find it.
  bool FindRangeOnDevice(double range[2], int component, bool finite) const;
  /// Lets go of the values.
  void Drop();
  /// The ordinary array with the values of this one; null where that has another size by now.
  vtkDataArray* GetHost() const;
  /// Gives it memory of its own, for so many values; the first ones are kept, or none.
  bool SetSize(vtkIdType values, vtkIdType kept);

  int DataType;
  vtkSmartPointer<vtkDataArray> Host;        // whose memory it is
  mutable std::mutex Mutex;                  // of a first access
  mutable std::atomic<T*> Values{ nullptr }; // null: they have to be brought
  std::shared_ptr<deformvolume::DeviceOutput> Output;
  mutable std::mutex RangesMutex;
  mutable std::vector<std::optional<deformvolume::DeviceOutput::Range>> Ranges; // of components
};

#endif
