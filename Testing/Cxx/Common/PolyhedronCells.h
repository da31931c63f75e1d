// SPDX-License-Identifier: BSD-3-Clause
#ifndef PolyhedronCells_h
#define PolyhedronCells_h

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <vector>

/// The faces of a polyhedron as a grid stores them. The description may be invalid.
struct PolyhedronDescription
{
  /// The id of its first face, or -1 if the grid has no entry for the polyhedron.
  vtkIdType FirstFace;
  /// The number of faces that the grid states.
  vtkIdType NumberOfFaces;
  /// The faces that the grid has.
  std::vector<std::vector<vtkIdType>> Faces;
};

namespace detail
{
// Since VTK 9.5 the faces of polyhedra are stored in cell arrays.
template <typename Grid>
auto SetPolyhedron(Grid* grid, vtkUnsignedCharArray* types, vtkCellArray* cells,
  const PolyhedronDescription& polyhedron, int)
  -> decltype(grid->SetPolyhedralCells(types, cells, cells, cells))
{
  vtkNew<vtkCellArray> faces;
  for (const std::vector<vtkIdType>& face : polyhedron.Faces)
  {
    faces->InsertNextCell(static_cast<vtkIdType>(face.size()), face.data());
  }
  vtkNew<vtkCellArray> locations;
  if (polyhedron.FirstFace >= 0)
  {
    std::vector<vtkIdType> ids;
    for (vtkIdType i = 0; i < polyhedron.NumberOfFaces; ++i)
    {
      ids.push_back(polyhedron.FirstFace + i);
    }
    locations->InsertNextCell(polyhedron.NumberOfFaces, ids.data());
  }
  grid->SetPolyhedralCells(types, cells, locations, faces);
}

template <typename Grid>
void SetPolyhedron(Grid* grid, vtkUnsignedCharArray* types, vtkCellArray* cells,
  const PolyhedronDescription& polyhedron, long)
{
  vtkNew<vtkIdTypeArray> stream;
  stream->InsertNextValue(polyhedron.NumberOfFaces);
  for (const std::vector<vtkIdType>& face : polyhedron.Faces)
  {
    stream->InsertNextValue(static_cast<vtkIdType>(face.size()));
    for (const vtkIdType point : face)
    {
      stream->InsertNextValue(point);
    }
  }
  vtkNew<vtkIdTypeArray> locations;
  locations->InsertNextValue(polyhedron.FirstFace);
  grid->SetCells(types, cells, locations, stream);
}
} // namespace detail

/// Makes a polyhedron with these points the only cell of the grid.
inline void SetPolyhedron(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& points,
  const PolyhedronDescription& polyhedron)
{
  vtkNew<vtkUnsignedCharArray> types;
  types->InsertNextValue(VTK_POLYHEDRON);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(static_cast<vtkIdType>(points.size()), points.data());
  detail::SetPolyhedron(grid, types.Get(), cells.Get(), polyhedron, 0);
}

#endif
