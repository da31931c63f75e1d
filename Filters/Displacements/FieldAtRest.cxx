// SPDX-License-Identifier: BSD-3-Clause
#include "FieldAtRest.h"

#include "FieldGeometry.h"
#include "PipelineGeometry.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

namespace deformvolume
{

vtkSmartPointer<vtkImageData> MakeFieldAtRest(const ImageGeometry& volume)
{
  const ImageGeometry geometry = GetGridAtRest(volume);
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
