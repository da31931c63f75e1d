// SPDX-License-Identifier: BSD-3-Clause
#include "VectorArray.h"

#include "Error.h"
#include "ParallelFor.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSet.h"
#include "vtkPointData.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

namespace deformvolume
{

namespace
{

constexpr vtkIdType BLOCK = 512; // tuples at a time
constexpr vtkIdType NONE = std::numeric_limits<vtkIdType>::max();

struct VectorReader
{
  template <typename ArrayT>
  void operator()(ArrayT* array, const VectorTaker& take)
  {
    const auto tuples = vtk::DataArrayTupleRange<3>(array);
    std::atomic<vtkIdType> bad{ NONE };
    ParallelFor(0, tuples.size(), 0,
      [&](vtkIdType begin, vtkIdType end)
      {
        std::array<glm::dvec3, BLOCK> vectors;
        for (vtkIdType first = begin; first < end; first += BLOCK)
        {
          const vtkIdType count = std::min(BLOCK, end - first);
          for (vtkIdType i = 0; i < count; ++i)
          {
            const auto tuple = tuples[first + i];
            vectors[i] = glm::dvec3(static_cast<double>(tuple[0]), static_cast<double>(tuple[1]),
              static_cast<double>(tuple[2]));
            if (!std::isfinite(vectors[i].x) || !std::isfinite(vectors[i].y) ||
              !std::isfinite(vectors[i].z))
            {
              vtkIdType least = bad;
              while (first + i < least && !bad.compare_exchange_weak(least, first + i))
              {
              }
              return;
            }
          }
          take(first, vectors.data(), count);
        }
      });
    this->FirstBad = bad;
  }

  vtkIdType FirstBad = NONE;
};

} // namespace

void ReadVectors(
  vtkDataArray* array, const VectorTaker& take, const std::string& kind, const std::string& owner)
{
  using Dispatcher = vtkArrayDispatch::DispatchByValueType<vtkArrayDispatch::Reals>;
  VectorReader reader;
  if (!Dispatcher::Execute(array, reader, take))
  {
    reader(array, take);
  }
  if (reader.FirstBad != NONE)
  {
    throw Error(kind + " " + std::to_string(reader.FirstBad) + " of the " + owner +
      " is not finite. Remove NaN and infinity from it.");
  }
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
    if (array && array->GetNumberOfComponents() == 3)
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
