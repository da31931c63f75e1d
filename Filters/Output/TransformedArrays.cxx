// SPDX-License-Identifier: BSD-3-Clause
#include "TransformedArrays.h"

#include "Error.h"

#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <set>
#include <string>

namespace deformvolume
{

namespace
{

glm::dvec3 TransformNormal(const glm::dmat3& gradient, const glm::dvec3& normal)
{
  // The inverse transpose times the determinant, which exists for singular gradients as well.
  const glm::dmat3 cofactors(glm::cross(gradient[1], gradient[2]),
    glm::cross(gradient[2], gradient[0]), glm::cross(gradient[0], gradient[1]));
  const glm::dvec3 turned = cofactors * normal;
  const double length = glm::length(turned);
  const double sign = glm::determinant(gradient) < 0.0 ? -1.0 : 1.0;
  return length > 0.0 ? sign / length * turned : turned;
}

} // namespace

void TransformedArray::Transform(vtkIdType first, const std::vector<PointMap::Image>& images) const
{
  std::vector<glm::dvec3> vectors(images.size());
  this->CopySource(first, static_cast<vtkIdType>(images.size()), vectors.data());
  for (std::size_t i = 0; i < images.size(); ++i)
  {
    const glm::dmat3& gradient = images[i].Gradient;
    // Normals keep their length if nothing is deformed.
    const bool isNormal =
      this->Attribute == vtkDataSetAttributes::NORMALS && gradient != glm::dmat3(1.0);
    const glm::dvec3 turned =
      isNormal ? TransformNormal(gradient, vectors[i]) : gradient * vectors[i];
    this->Output->SetTuple(first + static_cast<vtkIdType>(i), &turned.x);
  }
}

std::vector<TransformedArray> FindTransformed(vtkPointSet* points, bool allVectors)
{
  using Attributes = vtkDataSetAttributes;
  vtkPointData* pointData = points->GetPointData();
  std::vector<TransformedArray> found;
  std::set<vtkDataArray*> others{ nullptr, pointData->GetTCoords() };
  const auto add = [&](vtkDataArray* array, int attribute)
  {
    if (!others.insert(array).second)
    {
      return;
    }
    const vtkIdType count = points->GetNumberOfPoints();
    if (array->GetNumberOfTuples() != count)
    {
      throw Error("The point array \"" + std::string(array->GetName() ? array->GetName() : "") +
        "\" on input port 0 has " + std::to_string(array->GetNumberOfTuples()) +
        " tuples, but there are " + std::to_string(count) + " points. Give each point a tuple.");
    }
    found.push_back({ MakeVectorCopier(array), attribute, MakeVectors(array, count) });
  };
  add(pointData->GetNormals(), Attributes::NORMALS);
  add(pointData->GetVectors(), Attributes::VECTORS);
  for (int i = 0; allVectors && i < pointData->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = pointData->GetArray(i);
    if (array && array->GetNumberOfComponents() == 3 && array->GetName() &&
      (array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE))
    {
      add(array, -1);
    }
  }
  return found;
}

vtkSmartPointer<vtkDataArray> MakeVectors(vtkDataArray* like, vtkIdType count)
{
  const int type = like->GetDataType() == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE;
  const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  array->SetName(like->GetName());
  array->SetNumberOfComponents(3);
  array->CopyComponentNames(like);
  array->SetNumberOfTuples(count);
  return array;
}

} // namespace deformvolume
