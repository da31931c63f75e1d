// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePolyhedronFaces_h
#define DeformVolumePolyhedronFaces_h

#include "vtkCellArray.h"
#include "vtkIdTypeArray.h"
#include "vtkUnstructuredGrid.h"

#include <vector>

namespace deformvolume
{

/// The faces of a polyhedron: the ids of the points of each face.
using PolyhedronFaces = std::vector<std::vector<vtkIdType>>;

namespace detail
{
// Since VTK 9.4: a cell array of the faces, and one with the faces of each cell.
template <typename Grid>
auto ReadPolyhedronFaces(Grid* grid, vtkIdType cell, PolyhedronFaces& faces, int)
  -> decltype(grid->GetPolyhedronFaces(), bool())
{
  vtkCellArray* allFaces = grid->GetPolyhedronFaces();
  vtkCellArray* locations = grid->GetPolyhedronFaceLocations();
  if (!allFaces || !locations || cell >= locations->GetNumberOfCells())
  {
    return false;
  }
  vtkIdType numberOfFaces = 0;
  const vtkIdType* ids = nullptr;
  locations->GetCellAtId(cell, numberOfFaces, ids);
  for (vtkIdType i = 0; i < numberOfFaces; ++i)
  {
    if (ids[i] < 0 || ids[i] >= allFaces->GetNumberOfCells())
    {
      return false;
    }
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    allFaces->GetCellAtId(ids[i], size, points);
    faces.emplace_back(points, points + size);
  }
  return true;
}

// Before VTK 9.4: one array of numbers, and the index in it at which each cell begins.
template <typename Grid>
bool ReadPolyhedronFaces(Grid* grid, vtkIdType cell, PolyhedronFaces& faces, long)
{
  vtkIdTypeArray* stream = grid->GetFaces();
  vtkIdTypeArray* locations = grid->GetFaceLocations();
  if (!stream || !locations || cell >= locations->GetNumberOfValues())
  {
    return false;
  }
  const vtkIdType length = stream->GetNumberOfValues();
  vtkIdType next = locations->GetValue(cell);
  if (next < 0 || next >= length)
  {
    return false;
  }
  for (vtkIdType left = stream->GetValue(next++); left > 0; --left)
  {
    if (next >= length || stream->GetValue(next) < 0 || stream->GetValue(next) >= length - next)
    {
      return false;
    }
    const vtkIdType size = stream->GetValue(next++);
    const vtkIdType* points = stream->GetPointer(next);
    faces.emplace_back(points, points + size);
    next += size;
  }
  return true;
}

template <typename Grid>
auto HasPolyhedronFaces(Grid* grid, int) -> decltype(grid->GetPolyhedronFaces(), bool())
{
  return grid->GetPolyhedronFaces() && grid->GetPolyhedronFaces()->GetNumberOfCells() > 0;
}

template <typename Grid>
bool HasPolyhedronFaces(Grid* grid, long)
{
  return grid->GetFaces() != nullptr;
}
} // namespace detail

/// Whether a grid has faces of polyhedra.
inline bool HasPolyhedronFaces(vtkUnstructuredGrid* grid)
{
  return detail::HasPolyhedronFaces(grid, 0);
}

/// Reads the faces of a polyhedron. Returns false if its arrays end before its faces do. The ids of
/// points are not checked.
inline bool ReadPolyhedronFaces(vtkUnstructuredGrid* grid, vtkIdType cell, PolyhedronFaces& faces)
{
  faces.clear();
  return detail::ReadPolyhedronFaces(grid, cell, faces, 0);
}

} // namespace deformvolume

#endif
