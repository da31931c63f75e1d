// SPDX-License-Identifier: BSD-3-Clause
#include "FieldAtRest.h"

#include "PipelineGeometry.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

namespace deformvolume
{

vtkSmartPointer<vtkImageData> MakeFieldAtRest(const ImageGeometry& volume)
{
  // A single cell, from one voxel before the first to one past the last: all voxels lie within it,
  // whatever is rounded.
  glm::dvec3 before;
  ImageGeometry geometry = volume;
  for (int axis = 0; axis < 3; ++axis)
  {
    before[axis] = volume.PointExtent[2 * axis] - 1.0;
    geometry.Spacing[axis] *= volume.PointExtent[2 * axis + 1] + 1.0 - before[axis];
  }
  geometry.Origin = glm::dvec3(volume.GetIndexToWorld() * glm::dvec4(before, 1.0));
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->SetDimensions(2, 2, 2);
  SetTransform(field, geometry);
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName("Displacement");
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(field->GetNumberOfPoints());
  vectors->Fill(0.0);
  field->GetPointData()->SetVectors(vectors);
  return field;
}

} // namespace deformvolume
