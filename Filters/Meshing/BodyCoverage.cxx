// SPDX-License-Identifier: BSD-3-Clause
#include "BodyCoverage.h"

#include "ParallelFor.h"
#include "TetrahedronRaster.h"

#include "vtkCellArray.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <atomic>
#include <memory>

namespace deformvolume
{
namespace
{

using Marks = std::unique_ptr<std::atomic<unsigned char>[]>;

std::vector<RasterPoint> GetRasterPoints(vtkUnstructuredGrid* mesh, const glm::dvec3& spacing)
{
  std::vector<RasterPoint> points(mesh->GetNumberOfPoints());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    glm::dvec3 point;
    mesh->GetPoint(static_cast<vtkIdType>(i), &point.x);
    point /= spacing;
    points[i] = { { RoundToRaster(point.x), RoundToRaster(point.y), RoundToRaster(point.z) } };
  }
  return points;
}

template <typename Integer>
void Mark(const std::array<RasterPoint, 4>& nodes, const VoxelBox& box,
  const std::array<int, 3>& size, Marks& marks)
{
  TetrahedronRaster<Integer> raster;
  if (!raster.SetTetrahedron(nodes, box))
  {
    return;
  }
  raster.ForEachRow(
    [&](std::int64_t y, std::int64_t z, std::int64_t first, std::int64_t last)
    {
      std::atomic<unsigned char>* row = marks.get() + (z * size[1] + y) * size[0];
      for (std::int64_t x = first; x <= last; ++x)
      {
        row[x].store(1, std::memory_order_relaxed);
      }
    });
}

void MarkTetrahedron(
  const std::array<RasterPoint, 4>& nodes, const std::array<int, 3>& size, Marks& marks)
{
  RasterPoint min = nodes[0];
  RasterPoint max = nodes[0];
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (const RasterPoint& node : nodes)
    {
      min[axis] = std::min(min[axis], node[axis]);
      max[axis] = std::max(max[axis], node[axis]);
    }
    // Round the minimum up and the maximum down. Right shifts of negative numbers round down.
    box.Min[axis] = std::max<std::int64_t>(0, (min[axis] + RasterUnit - 1) >> RasterBits);
    box.Max[axis] = std::min<std::int64_t>(size[axis] - 1, max[axis] >> RasterBits);
  }
  if (box.IsEmpty())
  {
    return;
  }
  if (FitsInt64(min, max))
  {
    Mark<std::int64_t>(nodes, box, size, marks);
  }
  else
  {
    Mark<WideInteger>(nodes, box, size, marks);
  }
}

} // namespace

UncoveredVoxels FindUncovered(vtkUnstructuredGrid* mesh, const BodyVoxels& body)
{
  const std::vector<RasterPoint> points = GetRasterPoints(mesh, body.Spacing);
  const vtkIdType voxels = body.NumberOfRows() * body.Size[0];
  Marks marks(new std::atomic<unsigned char>[voxels]());
  std::vector<std::array<vtkIdType, 4>> tetrahedra;
  tetrahedra.reserve(mesh->GetNumberOfCells());
  vtkCellArray* cells = mesh->GetCells();
  vtkIdType size;
  const vtkIdType* ids;
  for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
  {
    tetrahedra.push_back({ { ids[0], ids[1], ids[2], ids[3] } });
  }
  ParallelFor(0, static_cast<vtkIdType>(tetrahedra.size()), 256,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin; i < end; ++i)
      {
        const std::array<vtkIdType, 4>& nodes = tetrahedra[i];
        MarkTetrahedron(
          { { points[nodes[0]], points[nodes[1]], points[nodes[2]], points[nodes[3]] } }, body.Size,
          marks);
      }
    });

  UncoveredVoxels result;
  for (vtkIdType row = 0; row < body.NumberOfRows(); ++row)
  {
    const std::atomic<unsigned char>* rowMarks = marks.get() + row * body.Size[0];
    for (vtkIdType i = body.RowStarts[row]; i < body.RowStarts[row + 1]; ++i)
    {
      const VoxelRun& run = body.Runs[i];
      const PieceKind kind = body.Pieces[run.Piece];
      if (kind == PieceKind::Speck)
      {
        continue;
      }
      for (int x = run.Begin; x < run.End; ++x)
      {
        if (rowMarks[x].load(std::memory_order_relaxed) == 0)
        {
          ++result.OfBody;
          if (kind == PieceKind::Meshed)
          {
            result.OfMeshed.push_back(
              body.Spacing * glm::dvec3(x, row % body.Size[1], row / body.Size[1]));
          }
        }
      }
    }
  }
  return result;
}

} // namespace deformvolume
