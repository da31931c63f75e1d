// SPDX-License-Identifier: BSD-3-Clause
#include "InputGeometry.h"

#include "Hash.h"
#include "InputUpdate.h"
#include "PipelineGeometry.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"

#include <algorithm>
#include <vector>

namespace deformvolume
{

const ImageGeometry& InputGeometry::Find(
  vtkAlgorithm* filter, int port, vtkInformation* output, const Ranks& ranks)
{
  vtkInformation* info = filter->GetInputInformation(port, 0);
  const ImageGeometry announced = GetGeometry(info);
  const std::pair<const void*, vtkMTimeType> stamp = GetInputStamp(filter, port);
  const bool hasAll = info->Has(vtkDataObject::ORIGIN()) && info->Has(vtkDataObject::SPACING()) &&
    info->Has(vtkDataObject::DIRECTION());
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
      this->Geometry.Origin = given.Origin;
      this->Geometry.Spacing = given.Spacing;
      this->Geometry.Direction = given.Direction;
    }
  }
  this->Stamp = stamp;
  return this->Geometry;
}

void InputGeometry::CheckRanks(const Ranks& ranks, const std::string& what) const
{
  const ImageGeometry& grid = this->Geometry;
  std::vector<double> numbers(grid.PointExtent.begin(), grid.PointExtent.end());
  for (int axis = 0; axis < 3; ++axis)
  {
    numbers.insert(numbers.end(), { grid.Origin[axis], grid.Spacing[axis] });
    for (int row = 0; row < 3; ++row)
    {
      numbers.push_back(grid.Direction[axis][row]);
    }
  }
  for (double& number : numbers)
  {
    number += 0.0; // -0.0 becomes 0.0, which equals it
  }
  std::uint64_t hash = HashOfNothing;
  AddToHash(hash, numbers);
  if (!ranks.AreEqual(hash))
  {
    throw Error(what +
      " has different grids on different ranks. Connect a source that announces the same whole "
      "extent, origin, spacing and direction on all ranks, such as a reader of one .pvti file.");
  }
}

} // namespace deformvolume
