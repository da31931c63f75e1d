// SPDX-License-Identifier: BSD-3-Clause
#include "MeshGrids.h"

#include "DeformationSource.h"
#include "MaskArray.h"
#include "MeshStamp.h"

#include "vtkCellArray.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkExplicitStructuredGrid.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <functional>

namespace deformvolume
{

namespace
{

const char* GetName(vtkInformation* metaData)
{
  return metaData ? metaData->Get(vtkCompositeDataSet::NAME()) : nullptr;
}

// The name of the current block in a traversal of a composite dataset, or its flat index if it has
// no name.
std::string FindBlock(vtkCompositeDataSet* composite, vtkCompositeDataIterator* leaf)
{
  const char* name = leaf->HasCurrentMetaData() ? GetName(leaf->GetCurrentMetaData()) : nullptr;
  auto* collection = vtkPartitionedDataSetCollection::SafeDownCast(composite);
  for (unsigned int i = 0; collection && !name && i < collection->GetNumberOfPartitionedDataSets();
       ++i)
  {
    for (unsigned int k = 0; k < collection->GetNumberOfPartitions(i); ++k)
    {
      if (collection->GetPartitionAsDataObject(i, k) == leaf->GetCurrentDataObject())
      {
        name = collection->HasMetaData(i) ? GetName(collection->GetMetaData(i)) : nullptr;
      }
    }
  }
  return name ? std::string("block \"") + name + "\""
              : "the block with flat index " + std::to_string(leaf->GetCurrentFlatIndex());
}

bool IsGrid(vtkDataObject* object)
{
  return vtkUnstructuredGrid::SafeDownCast(object) || vtkStructuredGrid::SafeDownCast(object) ||
    vtkRectilinearGrid::SafeDownCast(object) || vtkExplicitStructuredGrid::SafeDownCast(object);
}

// Adds all cells of a grid, except those that are hidden or duplicate, or have a hidden point.
void MakeCells(vtkDataSet* source, vtkUnstructuredGrid* grid)
{
  const SkippedCells skipped(source, "deformation mesh");
  vtkNew<vtkUnsignedCharArray> types;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < source->GetNumberOfCells(); ++cell)
  {
    source->GetCellPoints(cell, ids);
    if (!skipped.Contain(cell) && !skipped.ContainPointOf(ids->begin(), ids->GetNumberOfIds()))
    {
      types->InsertNextValue(static_cast<unsigned char>(source->GetCellType(cell)));
      cells->InsertNextCell(ids);
    }
  }
  grid->SetCells(types, cells);
}

vtkSmartPointer<vtkPoints> MakePoints(vtkRectilinearGrid* source)
{
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(source->GetNumberOfPoints());
  for (vtkIdType id = 0; id < source->GetNumberOfPoints(); ++id)
  {
    double point[3];
    source->GetPoint(id, point);
    points->SetPoint(id, point);
  }
  return points;
}

// Subtracts vectors from points. Both arrays have the same number of tuples.
vtkSmartPointer<vtkPoints> Subtract(vtkDataArray* points, vtkDataArray* vectors)
{
  vtkNew<vtkDoubleArray> differences;
  differences->SetNumberOfComponents(3);
  differences->SetNumberOfTuples(points->GetNumberOfTuples());
  auto* const first = reinterpret_cast<glm::dvec3*>(differences->GetPointer(0));
  const vtkIdType count = points->GetNumberOfTuples();
  MakeVectorCopier(points)(0, count, first);
  std::vector<glm::dvec3> moves(static_cast<std::size_t>(count));
  MakeVectorCopier(vectors)(0, count, moves.data());
  std::transform(first, first + count, moves.begin(), first, std::minus<>());
  auto made = vtkSmartPointer<vtkPoints>::New();
  made->SetData(differences);
  return made;
}

} // namespace

vtkUnstructuredGrid* MeshGrids::UpdateRest(Conversion& conversion, vtkUnstructuredGrid* deformed,
  vtkDataArray* displacements, vtkMTimeType time)
{
  vtkDataArray* points = deformed->GetPoints() ? deformed->GetPoints()->GetData() : nullptr;
  // If the displacements are not usable and cells need them, a later check throws an Error.
  if (!points || !HaveVectors(deformed, displacements))
  {
    conversion.Rest = nullptr;
    return deformed;
  }
  Stamp stamp{ { nullptr, time } };
  AddArray(stamp, points);
  AddArray(stamp, displacements);
  vtkSmartPointer<vtkPoints> rest = conversion.Rest ? conversion.Rest->GetPoints() : nullptr;
  if (!rest || conversion.RestPoints != stamp)
  {
    rest = Subtract(points, displacements);
    conversion.RestPoints = stamp;
  }
  if (!conversion.Rest)
  {
    conversion.Rest = vtkSmartPointer<vtkUnstructuredGrid>::New();
  }
  conversion.Rest->ShallowCopy(deformed);
  conversion.Rest->SetPoints(rest);
  return conversion.Rest;
}

void MeshGrids::Update(Conversion& conversion, vtkDataSet* source, bool made)
{
  if (!conversion.Grid)
  {
    conversion.Grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  }
  vtkUnstructuredGrid* grid = conversion.Grid;
  auto* curved = vtkPointSet::SafeDownCast(source); // structured or explicit structured
  auto* straight = vtkRectilinearGrid::SafeDownCast(source);
  // If a grid that no filter has made is modified, its owner may have written to its arrays.
  const vtkMTimeType time = made ? 0 : source->vtkObject::GetMTime();
  Stamp cells{ { nullptr, time } };
  Stamp points{ { nullptr, time } };
  int dimensions[3] = { 0, 0, 0 };
  if (auto* structured = vtkStructuredGrid::SafeDownCast(source))
  {
    structured->GetDimensions(dimensions);
  }
  else if (straight)
  {
    straight->GetDimensions(dimensions);
  }
  else if (vtkCellArray* ids = vtkExplicitStructuredGrid::SafeDownCast(source)->GetCells())
  {
    cells.emplace_back(ids, ids->GetMTime());
  }
  for (const int size : dimensions)
  {
    cells.emplace_back(nullptr, static_cast<vtkMTimeType>(size));
  }
  for (vtkAbstractArray* mask : FindMasks(source))
  {
    AddArray(cells, mask);
  }
  if (straight)
  {
    AddArray(points, straight->GetXCoordinates());
    AddArray(points, straight->GetYCoordinates());
    AddArray(points, straight->GetZCoordinates());
  }
  if (conversion.Time != time)
  {
    conversion.Time = time;
    grid->Modified();
  }
  if (curved)
  {
    grid->SetPoints(curved->GetPoints());
  }
  else if (conversion.Points != points)
  {
    grid->SetPoints(MakePoints(straight));
  }
  conversion.Points = points;
  if (conversion.Cells != cells)
  {
    conversion.Cells.clear();
    MakeCells(source, grid);
    conversion.Cells = cells;
  }
  const Stamp pointData{ { source->GetPointData(), source->GetPointData()->GetMTime() } };
  if (conversion.PointData != pointData)
  {
    grid->GetPointData()->ShallowCopy(source->GetPointData());
    conversion.PointData = pointData;
  }
}

MeshParts MeshGrids::Find(vtkDataObject* object, bool made, const ArraySelector* displacements)
{
  std::vector<vtkDataSet*> grids;
  MeshParts parts;
  if (IsGrid(object))
  {
    grids.push_back(static_cast<vtkDataSet*>(object));
  }
  else if (const auto composite = vtkCompositeDataSet::SafeDownCast(object))
  {
    const auto leaves = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
    for (leaves->InitTraversal(); !leaves->IsDoneWithTraversal(); leaves->GoToNextItem())
    {
      if (IsGrid(leaves->GetCurrentDataObject()))
      {
        grids.push_back(static_cast<vtkDataSet*>(leaves->GetCurrentDataObject()));
        parts.Blocks.push_back(FindBlock(composite, leaves));
      }
      else if (const auto image = vtkImageData::SafeDownCast(leaves->GetCurrentDataObject());
               image && image->GetNumberOfCells() > 0)
      {
        parts.Ignored += (parts.Ignored.empty() ? "" : ", ") + FindBlock(composite, leaves);
      }
    }
  }
  this->Conversions.resize(grids.size());
  for (std::size_t i = 0; i < grids.size(); ++i)
  {
    Conversion& conversion = this->Conversions[i];
    auto* grid = vtkUnstructuredGrid::SafeDownCast(grids[i]);
    if (!grid)
    {
      Update(conversion, grids[i], made);
      grid = conversion.Grid;
    }
    if (displacements)
    {
      grid = UpdateRest(
        conversion, grid, (*displacements)(grid), made ? 0 : grid->vtkObject::GetMTime());
    }
    parts.push_back(grid);
  }
  return parts;
}

void DeformationGrids::Find(DeformationSource& source)
{
  source.ShapeParts = this->Shape.Find(
    source.Shape, source.ShapeIsMade, source.PointsAreDeformed ? &source.Selector : nullptr);
  source.RestParts = this->Rest.Find(source.Rest, source.RestIsMade);
}

} // namespace deformvolume
