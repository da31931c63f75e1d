// SPDX-License-Identifier: BSD-3-Clause
#include "VectorArray.h"

#include "Error.h"
#include "IndexBounds.h" // for IsFinite
#include "ParallelFor.h"
#include "WrittenTuples.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSet.h"
#include "vtkDeviceVectorArray.h"
#include "vtkPointData.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

namespace deformvolume
{

namespace
{

constexpr vtkIdType BLOCK = 512; // tuples that are read at a time
constexpr vtkIdType NONE = std::numeric_limits<vtkIdType>::max();

// The blocks of an array that were not written since the last reading, according to the log of the
// array (vtkArrayChanges).
class UnwrittenBlocks
{
public:
  UnwrittenBlocks(vtkDataArray* array, const VectorMemory* memory)
  {
    if (const auto ranges = memory ? FindWritten(array, memory->Array, memory->Time) : std::nullopt)
    {
      this->Known = memory->Count;
      this->Written.resize(
        (static_cast<std::size_t>(array->GetNumberOfTuples()) + BLOCK - 1) / BLOCK);
      MarkBlocks(*ranges, BLOCK, this->Written);
    }
  }

  bool Hold(vtkIdType first, vtkIdType count) const
  {
    return first + count <= this->Known && !this->Written[static_cast<std::size_t>(first / BLOCK)];
  }

private:
  vtkIdType Known = 0; // number of tuples at the last reading
  std::vector<unsigned char> Written;
};

// Independent sums without branches, which compilers vectorize: arrays have millions of values.
bool AreFinite(const double* values, vtkIdType count)
{
  constexpr vtkIdType lanes = 8;
  std::array<double, lanes> sums{};
  const vtkIdType whole = count / lanes * lanes;
  for (vtkIdType i = 0; i < whole; i += lanes)
  {
    for (vtkIdType lane = 0; lane < lanes; ++lane)
    {
      sums[lane] += 0.0 * values[i + lane]; // not-a-number where a value is not finite
    }
  }
  for (vtkIdType i = whole; i < count; ++i)
  {
    sums[i - whole] += 0.0 * values[i];
  }
  return std::all_of(sums.begin(), sums.end(), [](double sum) { return sum == 0.0; });
}

// Downloads the values of an array that are only on a device.
void BringToHost(vtkDeviceVectorArray* array)
{
  array->GetValues();
}
void BringToHost(vtkDataArray*) {}

// Copies tuples of an array. Contiguous memory is read through a pointer, which compilers
// vectorize.
template <typename T>
void CopyTuples(
  vtkAOSDataArrayTemplate<T>* array, vtkIdType first, vtkIdType count, glm::dvec3* vectors)
{
  const T* const values = array->GetPointer(3 * first);
  std::copy_n(values, 3 * count, &vectors->x);
}
template <typename ArrayT>
void CopyTuples(ArrayT* array, vtkIdType first, vtkIdType count, glm::dvec3* vectors)
{
  const auto values = vtk::DataArrayValueRange<3>(array);
  double* components = &vectors->x;
  for (vtkIdType i = 0; i < 3 * count; ++i)
  {
    components[i] = static_cast<double>(values[3 * first + i]);
  }
}

// Calls body(array) with the concrete class of an array of real numbers, or with vtkDataArray.
template <typename Body>
void VisitVectors(vtkDataArray* array, Body&& body)
{
  using Dispatcher = vtkArrayDispatch::DispatchByValueType<vtkArrayDispatch::Reals>;
  if (auto* const vectors = vtkDeviceVectorArray::SafeDownCast(array))
  {
    body(vectors);
  }
  else if (!Dispatcher::Execute(array, body))
  {
    body(array);
  }
}

struct VectorReader
{
  template <typename ArrayT>
  void operator()(
    ArrayT* array, const VectorTaker& take, const VectorMemory* memory, const FaultTaker& takeFault)
  {
    const vtkIdType tuples = array->GetNumberOfTuples();
    const UnwrittenBlocks unwritten(array, memory);
    BringToHost(array);
    std::atomic<vtkIdType> bad{ NONE };
    const auto read = [&](vtkIdType first, vtkIdType count)
    {
      std::array<glm::dvec3, BLOCK> vectors;
      CopyTuples(array, first, count, vectors.data());
      const bool areFinite = AreFinite(&vectors[0].x, 3 * count);
      if (!areFinite && !takeFault)
      {
        const auto found = std::find_if_not(vectors.begin(), vectors.begin() + count, IsFinite);
        Lower(bad, first + static_cast<vtkIdType>(found - vectors.begin()));
        return;
      }
      std::vector<vtkIdType> faults;
      for (vtkIdType i = 0; i < count && !areFinite; ++i)
      {
        if (!IsFinite(vectors[i]))
        {
          vectors[i] = glm::dvec3(0.0);
          faults.push_back(first + i);
        }
      }
      take(first, vectors.data(), count);
      std::for_each(faults.begin(), faults.end(), takeFault);
    };
    // Starting a thread for a few blocks costs more than it saves: the thread competes with those
    // of the device, which begin their work right afterwards.
    constexpr vtkIdType blocksOfPart = 8;
    ParallelFor(0, (tuples + BLOCK - 1) / BLOCK, blocksOfPart,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType first = begin * BLOCK; first < std::min(end * BLOCK, tuples); first += BLOCK)
        {
          const vtkIdType count = std::min(BLOCK, tuples - first);
          if (!unwritten.Hold(first, count))
          {
            read(first, count);
          }
        }
      });
    this->FirstBad = bad;
  }

  vtkIdType FirstBad = NONE;
};

} // namespace

void ReadVectors(vtkDataArray* array, const VectorTaker& take, const std::string& kind,
  const std::string& owner, VectorMemory* memory, const FaultTaker& takeFault)
{
  if (array->GetNumberOfComponents() != 3)
  {
    throw Error(kind + "s of the " + owner + " have " +
      std::to_string(array->GetNumberOfComponents()) + " components. Give each of them three.");
  }
  VectorReader reader;
  VisitVectors(array, [&](auto* typed) { reader(typed, take, memory, takeFault); });
  if (memory)
  {
    memory->Array = reader.FirstBad == NONE ? array : nullptr;
    memory->Time = array->GetMTime();
    memory->Count = array->GetNumberOfTuples();
  }
  if (reader.FirstBad != NONE)
  {
    throw Error(kind + " " + std::to_string(reader.FirstBad) + " of the " + owner +
      " is not finite. Remove NaN and infinity from it.");
  }
}

VectorCopier MakeVectorCopier(vtkDataArray* array)
{
  VectorCopier copier;
  VisitVectors(array,
    [&](auto* typed)
    {
      BringToHost(typed); // once, before several threads call the copier
      copier = [typed](vtkIdType first, vtkIdType count, glm::dvec3* vectors)
      { CopyTuples(typed, first, count, vectors); };
    });
  return copier;
}

vtkDataArray* FindVectors(vtkDataSet* dataSet)
{
  vtkPointData* pointData = dataSet->GetPointData();
  if (vtkDataArray* vectors = pointData->GetVectors())
  {
    return vectors;
  }
  vtkDataArray* found = nullptr;
  for (int i = 0; i < pointData->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = pointData->GetArray(i);
    // Colors and normals are not displacements.
    const bool isOther = array &&
      (array == pointData->GetNormals() || array->GetDataType() == VTK_UNSIGNED_CHAR ||
        (array->GetName() && std::string(array->GetName()) == "Normals"));
    if (array && array->GetNumberOfComponents() == 3 && !isOther)
    {
      if (found)
      {
        return nullptr;
      }
      found = array;
    }
  }
  return found;
}

} // namespace deformvolume
