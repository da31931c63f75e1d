// SPDX-License-Identifier: BSD-3-Clause
#include "MeshStamp.h"

#include "CellTypes.h"
#include "MaskArray.h"
#include "PolyhedronFaces.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>

namespace deformvolume
{

std::array<vtkAbstractArray*, 3> FindMasks(vtkDataSet* grid)
{
  const char* ghosts = vtkDataSetAttributes::GhostArrayName();
  return { { grid->GetCellData()->GetAbstractArray(ghosts),
    grid->GetPointData()->GetAbstractArray(ghosts),
    grid->GetPointData()->GetAbstractArray(ValidPointMaskName) } };
}

void AddMasks(Stamp& stamp, vtkDataSet* grid)
{
  for (vtkAbstractArray* mask : FindMasks(grid))
  {
    AddArray(stamp, mask);
  }
}

Stamp GetCellArraysStamp(const MeshParts& parts)
{
  Stamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    // The node indices of a part depend on the numbers of points of the parts before it.
    stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(grid->GetNumberOfPoints()));
    vtkCellArray* cells = grid->GetCells();
    stamp.emplace_back(cells, cells ? cells->GetMTime() : 0);
    AddArray(stamp, cells ? cells->GetConnectivityArray() : nullptr);
    stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(grid->GetNumberOfCells()));
    AddArray(stamp, cells ? cells->GetOffsetsArray() : nullptr);
    AddArray(stamp, GetCellTypes(grid));
    AddMasks(stamp, grid);
    AddArray(stamp, grid->GetCellData()->GetHigherOrderDegrees());
    if (HasPolyhedronFaces(grid))
    {
      stamp.emplace_back(grid, grid->vtkObject::GetMTime()); // changes with the faces
    }
  }
  return stamp;
}

void MeshStamp::Add(vtkUnstructuredGrid* grid, bool made)
{
  this->Times.push_back(made ? 0 : grid->vtkObject::GetMTime());
}

MeshStamp MeshStamp::OfCells(const MeshParts& parts, bool made)
{
  MeshStamp stamp;
  stamp.Arrays = GetCellArraysStamp(parts);
  for (vtkUnstructuredGrid* grid : parts)
  {
    stamp.Add(grid, made);
  }
  return stamp;
}

MeshStamp MeshStamp::OfPoints(const MeshParts& parts, bool made)
{
  MeshStamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    stamp.Add(grid, made);
    AddPoints(stamp.Arrays, grid->GetPoints());
  }
  return stamp;
}

bool MeshStamp::IsThatOf(const MeshStamp& last) const
{
  return this->Arrays == last.Arrays && this->Times == last.Times && !this->Times.empty();
}

} // namespace deformvolume
