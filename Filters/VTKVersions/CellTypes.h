// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellTypes_h
#define DeformVolumeCellTypes_h

#include "vtkDataArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace deformvolume
{

namespace detail
{
// Since VTK 9.6 the types may be in an array of any class, such as vtkConstantArray.
template <typename Grid>
auto GetCellTypes(Grid* grid, int) -> decltype(static_cast<vtkDataArray*>(grid->GetCellTypes()))
{
  return grid->GetCellTypes();
}

template <typename Grid>
vtkDataArray* GetCellTypes(Grid* grid, long)
{
  return grid->GetCellTypesArray();
}
} // namespace detail

/// The types of a grid's cells, one tuple for each cell; null if it has none.
inline vtkDataArray* GetCellTypes(vtkUnstructuredGrid* grid)
{
  return detail::GetCellTypes(grid, 0);
}

} // namespace deformvolume

#endif
