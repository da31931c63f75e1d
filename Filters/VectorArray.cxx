// SPDX-License-Identifier: BSD-3-Clause
#include "VectorArray.h"

#include "Error.h"
#include "ParallelFor.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSet.h"
#include "vtkPointData.h"

#include <atomic>
#include <cmath>
#include <limits>

namespace deformvolume
{

namespace
{

constexpr vtkIdType NONE = std::numeric_limits<vtkIdType>::max();

struct VectorReader
{
  template <typename ArrayT>
  void operator()(ArrayT* array, glm::dvec3* vectors)
  {
    const auto tuples = vtk::DataArrayTupleRange<3>(array);
    std::atomic<vtkIdType> bad{ NONE };
    ParallelFor(0, tuples.size(), 0,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          const auto tuple = tuples[i];
          const glm::dvec3 vector(static_cast<double>(tuple[0]), static_cast<double>(tuple[1]),
            static_cast<double>(tuple[2]));
          if (!std::isfinite(vector.x) || !std::isfinite(vector.y) || !std::isfinite(vector.z))
          {
            vtkIdType first = bad;
            while (i < first && !bad.compare_exchange_weak(first, i))
            {
            }
            return;
          }
          vectors[i] = vector;
        }
      });
    this->FirstBad = bad;
  }

  vtkIdType FirstBad = NONE;
};

} // namespace

void ReadVectors(
  vtkDataArray* array, glm::dvec3* vectors, const std::string& kind, const std::string& owner)
{
  using Dispatcher = vtkArrayDispatch::DispatchByValueType<vtkArrayDispatch::Reals>;
  VectorReader reader;
  if (!Dispatcher::Execute(array, reader, vectors))
  {
    reader(array, vectors);
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
