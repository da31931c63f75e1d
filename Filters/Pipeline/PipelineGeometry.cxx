// SPDX-License-Identifier: BSD-3-Clause
#include "PipelineGeometry.h"

#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkMatrix3x3.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <algorithm>

namespace deformvolume
{

ImageGeometry GetGeometry(vtkImageData* image)
{
  ImageGeometry geometry;
  std::copy_n(image->GetExtent(), 6, geometry.PointExtent.begin());
  geometry.Origin = glm::make_vec3(image->GetOrigin());
  geometry.Spacing = glm::make_vec3(image->GetSpacing());
  geometry.Direction = MakeDirection(image->GetDirectionMatrix()->GetData());
  return geometry;
}

void SetTransform(vtkImageData* image, const ImageGeometry& geometry)
{
  const glm::dmat3 rows = glm::transpose(geometry.Direction);
  image->SetOrigin(glm::value_ptr(geometry.Origin));
  image->SetSpacing(glm::value_ptr(geometry.Spacing));
  image->SetDirectionMatrix(glm::value_ptr(rows));
}

ImageGeometry GetGeometry(vtkInformation* info)
{
  ImageGeometry geometry;
  if (info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), geometry.PointExtent.data());
  }
  if (info->Has(vtkDataObject::ORIGIN()))
  {
    geometry.Origin = glm::make_vec3(info->Get(vtkDataObject::ORIGIN()));
  }
  if (info->Has(vtkDataObject::SPACING()))
  {
    geometry.Spacing = glm::make_vec3(info->Get(vtkDataObject::SPACING()));
  }
  if (info->Has(vtkDataObject::DIRECTION()))
  {
    geometry.Direction = MakeDirection(info->Get(vtkDataObject::DIRECTION()));
  }
  return geometry;
}

} // namespace deformvolume
