// SPDX-License-Identifier: BSD-3-Clause
#include "FieldReading.h"

#include "DeformationSource.h"
#include "Error.h"
#include "MaskArray.h"
#include "ParallelFor.h"
#include "PipelineGeometry.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDeviceVectorArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <atomic>
#include <limits>
#include <string>

namespace deformvolume
{

namespace
{

const char* const FIELD = "displacement field";

} // namespace

vtkDataArray* FindFieldVectors(vtkImageData* image, const DeformationSource& source)
{
  if (image->GetNumberOfPoints() == 0)
  {
    throw Error("The displacement field is empty. Connect a vtkImageData with a "
                "point array of three components.");
  }
  CheckTransform(GetGeometry(image), "the displacement field");
  return FindVectors(image, source.Selector, source.Wanted, std::string("the ") + FIELD);
}

std::vector<unsigned char> FindHiddenPoints(vtkImageData* image)
{
  const PointGhosts ghosts = FindPointGhosts(image, FIELD);
  std::vector<unsigned char> hidden;
  bool any = false;
  for (vtkIdType i = 0; ghosts.Values && i < image->GetNumberOfPoints(); ++i)
  {
    hidden.push_back((ghosts.Values[i] & vtkDataSetAttributes::HIDDENPOINT) != 0 ? 1 : 0);
    any = any || hidden.back() != 0;
  }
  return any ? hidden : std::vector<unsigned char>();
}

void ReadFieldVectors(
  vtkDataArray* array, const std::vector<unsigned char>& undefined, const VectorTaker& take)
{
  VectorTaker takeDefined = take;
  if (!undefined.empty())
  {
    takeDefined = [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
    {
      std::vector<glm::dvec3> defined(vectors, vectors + count);
      for (vtkIdType i = 0; i < count; ++i)
      {
        defined[i] *= undefined[first + i] ? 0.0 : 1.0;
      }
      take(first, defined.data(), count);
    };
  }
  constexpr vtkIdType none = std::numeric_limits<vtkIdType>::max();
  std::atomic<vtkIdType> fault{ none }; // the first one
  ReadVectors(array, takeDefined, "Vector", FIELD, nullptr,
    [&](vtkIdType point)
    {
      if (undefined.empty() || !undefined[point])
      {
        Lower(fault, point);
      }
    });
  if (fault != none)
  {
    throw Error("Vector " + std::to_string(fault) + " of the " + FIELD +
      " is not finite. Remove NaN and infinity from it, or mark its point as hidden in " +
      vtkDataSetAttributes::GhostArrayName() + ".");
  }
}

const float* FindFloats(vtkDataArray* array)
{
  if (auto* vectors = vtkDeviceVectorArray::SafeDownCast(array))
  {
    return vectors->IsOnDevice() ? nullptr : vectors->GetValues();
  }
  auto* floats = vtkAOSDataArrayTemplate<float>::FastDownCast(array);
  return floats ? floats->GetPointer(0) : nullptr;
}

} // namespace deformvolume
