// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeFrame.h"

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <glm/matrix.hpp>

#include <cmath>

namespace deformvolume
{

VolumeFrame::VolumeFrame(vtkImageData* volume)
{
  int extent[6];
  volume->GetExtent(extent);
  for (int column = 0; column < 3; ++column)
  {
    const double spacing = volume->GetSpacing()[column];
    for (int row = 0; row < 3; ++row)
    {
      this->Axes[column][row] =
        volume->GetDirectionMatrix()->GetElement(row, column) * std::copysign(1.0, spacing);
    }
    this->Spacing[column] = std::abs(spacing);
    this->First[column] = extent[2 * column] * std::abs(spacing);
    this->Origin[column] = volume->GetOrigin()[column];
  }
}

glm::dvec3 VolumeFrame::ToWorld(const glm::dvec3& offset) const
{
  return this->Origin + this->Axes * (this->First + offset);
}

glm::dvec3 VolumeFrame::ToOffset(const glm::dvec3& world) const
{
  return glm::inverse(this->Axes) * (world - this->Origin) - this->First;
}

void VolumeFrame::MoveToWorld(vtkUnstructuredGrid* mesh) const
{
  vtkPoints* points = mesh->GetPoints();
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    double point[3];
    points->GetPoint(i, point);
    const glm::dvec3 world = this->ToWorld(glm::dvec3(point[0], point[1], point[2]));
    points->SetPoint(i, world.x, world.y, world.z);
  }
  points->Modified();
  if (glm::determinant(this->Axes) < 0.0)
  {
    vtkNew<vtkCellArray> mirrored;
    vtkCellArray* cells = mesh->GetCells();
    vtkIdType size;
    const vtkIdType* ids;
    for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
    {
      const vtkIdType nodes[4] = { ids[0], ids[1], ids[3], ids[2] };
      mirrored->InsertNextCell(4, nodes);
    }
    mesh->SetCells(VTK_TETRA, mirrored);
  }
}

} // namespace deformvolume
