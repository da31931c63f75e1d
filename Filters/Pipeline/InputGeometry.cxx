// SPDX-License-Identifier: BSD-3-Clause
#include "InputGeometry.h"

#include "InputUpdate.h"
#include "PipelineGeometry.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"

#include <algorithm>

namespace deformvolume
{

const ImageGeometry& InputGeometry::Find(
  vtkAlgorithm* filter, int port, vtkInformation* output, const Ranks& ranks)
{
  vtkInformation* info = filter->GetInputInformation(port, 0);
  const ImageGeometry announced = GetGeometry(info);
  const std::pair<const void*, vtkMTimeType> stamp = GetInputStamp(filter, port);
  const bool hasOrigin = info->Has(vtkDataObject::ORIGIN()) != 0;
  const bool hasSpacing = info->Has(vtkDataObject::SPACING()) != 0;
  const bool hasDirection = info->Has(vtkDataObject::DIRECTION()) != 0;
  const bool hasAll = hasOrigin && hasSpacing && hasDirection;
  const bool isKnown = stamp == this->Stamp && announced.PointExtent == this->Geometry.PointExtent;
  if (hasAll || !isKnown)
  {
    this->Geometry = announced;
  }
  if (ranks.IsAny(!hasAll && !isKnown && GetNumberOfPoints(announced.PointExtent) > 0))
  {
    this->Stamp = {}; // in case of an exception
    Extent part = announced.PointExtent;
    if (CanProduceParts(filter, port))
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        part[2 * axis + 1] = std::min(part[2 * axis + 1], part[2 * axis] + 1);
      }
    }
    vtkImageData* image =
      vtkImageData::SafeDownCast(UpdateInputPart(filter, port, output, part, ranks));
    if (image && image->GetNumberOfPoints() > 0)
    {
      const ImageGeometry given = GetGeometry(image);
      this->Geometry.Origin = hasOrigin ? announced.Origin : given.Origin;
      this->Geometry.Spacing = hasSpacing ? announced.Spacing : given.Spacing;
      this->Geometry.Direction = hasDirection ? announced.Direction : given.Direction;
    }
  }
  this->Stamp = stamp;
  return this->Geometry;
}

} // namespace deformvolume
