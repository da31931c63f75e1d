// SPDX-License-Identifier: BSD-3-Clause
#include "SheetReading.h"

#include "Error.h"
#include "IndexBounds.h"
#include "MaskArray.h"

#include "vtkCellArray.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTriangleFilter.h"

namespace deformvolume
{
namespace
{

template <typename Function>
void ForEachCell(vtkCellArray* cells, Function&& function)
{
  vtkIdType size = 0;
  const vtkIdType* ids = nullptr;
  for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
  {
    function(size, ids);
  }
}

// Returns the cells of one kind that are not hidden. first: the number of its first cell in `data`.
vtkSmartPointer<vtkCellArray> FindShown(
  vtkCellArray* cells, vtkIdType first, const SkippedCells& skipped)
{
  auto shown = vtkSmartPointer<vtkCellArray>::New();
  ForEachCell(cells,
    [&](vtkIdType size, const vtkIdType* ids)
    {
      if (!skipped.Contain(first++) && !skipped.ContainPointOf(ids, size))
      {
        shown->InsertNextCell(size, ids);
      }
    });
  return shown;
}

// Returns the lines, polygons and strips that are not hidden.
vtkSmartPointer<vtkPolyData> FindShown(vtkPolyData* data, const std::string& name)
{
  const SkippedCells skipped(data, name);
  auto shown = vtkSmartPointer<vtkPolyData>::New();
  shown->SetPoints(data->GetPoints());
  vtkIdType first = data->GetNumberOfVerts();
  shown->SetLines(FindShown(data->GetLines(), first, skipped));
  first += data->GetNumberOfLines();
  shown->SetPolys(FindShown(data->GetPolys(), first, skipped));
  first += data->GetNumberOfPolys();
  shown->SetStrips(FindShown(data->GetStrips(), first, skipped));
  return shown;
}

void CheckPoints(vtkPolyData* data, const std::string& name)
{
  const vtkIdType points = data->GetNumberOfPoints();
  for (vtkCellArray* cells : { data->GetPolys(), data->GetStrips(), data->GetLines() })
  {
    ForEachCell(cells,
      [&](vtkIdType size, const vtkIdType* ids)
      {
        for (vtkIdType i = 0; i < size; ++i)
        {
          if (ids[i] < 0 || ids[i] >= points)
          {
            throw Error("A cell of the " + name + " has point " + std::to_string(ids[i]) +
              ", but there are " + std::to_string(points) + " points. Correct the cell.");
          }
        }
      });
  }
}

bool HasTrianglesOnly(vtkPolyData* data)
{
  bool all = data->GetNumberOfStrips() == 0;
  ForEachCell(data->GetPolys(), [&](vtkIdType size, const vtkIdType*) { all = all && size == 3; });
  return all;
}

void AddLines(vtkPolyData* data, const glm::dvec3& sweepVector, WorldSheet& sheet)
{
  // Add each point a second time, at the end of the sweep, so that the swept areas of neighboring
  // segments share their edges.
  const std::size_t count = sheet.Points.size();
  for (std::size_t i = 0; i < count; ++i)
  {
    sheet.Points.push_back(sheet.Points[i] + sweepVector);
  }
  const auto moved = static_cast<std::int64_t>(count);
  ForEachCell(data->GetLines(),
    [&](vtkIdType size, const vtkIdType* ids)
    {
      for (vtkIdType i = 1; i < size; ++i)
      {
        const std::int64_t a = ids[i - 1];
        const std::int64_t b = ids[i];
        sheet.Triangles.push_back({ { a, b, b + moved } });
        sheet.Triangles.push_back({ { a, b + moved, a + moved } });
      }
    });
}

} // namespace

WorldSheet ReadSheet(
  vtkPolyData* data, const std::optional<glm::dvec3>& sweepVector, const std::string& name)
{
  WorldSheet sheet;
  if (sweepVector && !IsFinite(*sweepVector))
  {
    throw Error("SweepVector is not finite. Set a finite vector.");
  }
  if (!data)
  {
    return sheet;
  }
  CheckPoints(data, name);
  const vtkSmartPointer<vtkPolyData> shown = FindShown(data, name);
  vtkSmartPointer<vtkPolyData> triangles = shown;
  if (!HasTrianglesOnly(shown))
  {
    vtkNew<vtkTriangleFilter> triangulation;
    triangulation->PassLinesOff();
    triangulation->SetInputData(shown);
    triangulation->Update();
    triangles = triangulation->GetOutput();
  }
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
  {
    glm::dvec3 point;
    data->GetPoint(i, &point.x);
    sheet.Points.push_back(point);
  }
  ForEachCell(triangles->GetPolys(),
    [&](vtkIdType, const vtkIdType* ids) {
      sheet.Triangles.push_back({ { ids[0], ids[1], ids[2] } });
    });
  if (shown->GetNumberOfLines() == 0)
  {
    return sheet;
  }
  if (sweepVector && *sweepVector != glm::dvec3(0.0))
  {
    AddLines(shown, *sweepVector, sheet);
  }
  else if (sheet.IsEmpty())
  {
    throw Error("The " + name + " has lines and no triangles. " +
      (sweepVector
          ? "Set SweepVector to the direction and the distance in which the lines are to cut."
          : "Connect a closed surface of triangles."));
  }
  return sheet;
}

} // namespace deformvolume
