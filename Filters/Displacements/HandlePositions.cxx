// SPDX-License-Identifier: BSD-3-Clause
#include "HandlePositions.h"

#include "Error.h"
#include "ShapedArray.h"
#include "VectorArray.h"

#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

std::vector<glm::dvec3> ReadPositions(vtkDataArray* array, const char* kind)
{
  std::vector<glm::dvec3> positions(static_cast<std::size_t>(array->GetNumberOfTuples()));
  const auto taker = [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType number)
  { std::copy_n(vectors, number, positions.begin() + first); };
  ReadVectors(array, taker, kind, "handles on input port 1");
  return positions;
}

} // namespace

HandlePositions ReadHandlePositions(vtkPointSet* handles, const std::string& body)
{
  HandlePositions positions;
  const vtkIdType count = handles ? handles->GetNumberOfPoints() : 0;
  if (count == 0)
  {
    return positions;
  }
  constexpr int components = 3;
  vtkDataArray* rest = FindShapedArray(handles->GetPointData(), "RestPosition", components, count,
    "point array", "the handles on input port 1");
  if (!rest)
  {
    throw Error(
      "The handles on input port 1 have no point array \"RestPosition\". Add one of three "
      "components: the place in the " +
      body + " at rest that each handle holds.");
  }
  positions.Rest = ReadPositions(rest, "Rest position");
  positions.Now = ReadPositions(handles->GetPoints()->GetData(), "Point");
  return positions;
}

} // namespace deformvolume
