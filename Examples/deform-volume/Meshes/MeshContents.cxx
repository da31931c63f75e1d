// SPDX-License-Identifier: BSD-3-Clause
#include "MeshContents.h"

#include "Failure.h"
#include "ImageAxes.h"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUnstructuredGrid.h>
#include <vtkVersionMacros.h>
#include <vtkXMLFileReadTester.h>

#include <algorithm>
#include <set>

namespace
{
/// Whether a dataset is a grid with three-dimensional cells, which can deform a volume.
bool HasVolumeCells(vtkDataSet* data)
{
  if (!vtkUnstructuredGrid::SafeDownCast(data) && !vtkStructuredGrid::SafeDownCast(data) &&
    !vtkRectilinearGrid::SafeDownCast(data))
  {
    return false;
  }
  std::set<int> types;
  for (vtkIdType cell = 0; cell < data->GetNumberOfCells(); ++cell)
  {
    types.insert(data->GetCellType(cell));
  }
  return std::any_of(types.begin(), types.end(),
    [](int type)
    {
      const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
      return cell && cell->GetCellDimension() == 3;
    });
}

std::string DescribeCount(vtkIdType number, const char* one, const char* many)
{
  return std::to_string(number) + " " + (number == 1 ? one : many);
}

// For example "27 points and 12 cells".
std::string Describe(vtkDataObject* object)
{
  if (auto* image = vtkImageData::SafeDownCast(object))
  {
    return "an image of " + DescribeSize(image) + " points";
  }
  vtkIdType points = 0;
  vtkIdType cells = 0;
  for (const MeshPart& part : FindParts(object))
  {
    points += part.Data->GetNumberOfPoints();
    cells += part.Data->GetNumberOfCells();
  }
  return DescribeCount(points, "point", "points") + " and " + DescribeCount(cells, "cell", "cells");
}

std::string DescribeArrays(vtkPointData* arrays)
{
  std::string text;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    const char* const name = arrays->GetArrayName(i);
    // GetArray() returns null for arrays of strings.
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    text += std::string(text.empty() ? "" : ", ") + "\"" + (name ? name : "") + "\" (" +
      DescribeCount(array->GetNumberOfComponents(), "component", "components") + ")";
  }
  return text.empty() ? "there are no point arrays" : "there are " + text;
}

bool IsScalar(vtkPointData* arrays, const std::string& name)
{
  vtkDataArray* const array = arrays->GetArray(name.c_str());
  return array && array->GetNumberOfComponents() == 1;
}

// Returns how to join three arrays such as DISPX, DISPY and DISPZ to vectors; "" if there are none.
std::string GetAdvice(vtkPointData* arrays)
{
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    const std::string x = arrays->GetArrayName(i) ? arrays->GetArrayName(i) : "";
    for (std::size_t at = x.find_first_of("xX"); at != std::string::npos;
         at = x.find_first_of("xX", at + 1))
    {
      std::string y = x;
      std::string z = x;
      y[at] = static_cast<char>(x[at] + 1);
      z[at] = static_cast<char>(x[at] + 2);
      if (IsScalar(arrays, x) && IsScalar(arrays, y) && IsScalar(arrays, z))
      {
        return ". If \"" + x + "\", \"" + y + "\" and \"" + z +
          "\" are the displacements, join them to one array of three components, for example with "
          "ParaView's filter Merge Vector Components or with numpy.column_stack";
      }
    }
  }
  return "";
}

void CheckArray(const MeshPart& part, const std::string& name, const std::string& path)
{
  const std::string what =
    "cannot use " + path + ": " + (part.Block.empty() ? "" : "in its block " + part.Block + " ");
  vtkDataArray* array = part.Data->GetPointData()->GetArray(name.c_str());
  if (!array)
  {
    throw Failure(what + "there is no point array \"" + name + "\" of displacements; " +
      DescribeArrays(part.Data->GetPointData()) +
      (part.Data->GetCellData()->HasArray(name.c_str()) ? ", and a cell array \"" + name +
            "\", which ParaView's filter Cell Data to Point Data averages at points"
                                                        : "") +
      GetAdvice(part.Data->GetPointData()));
  }
  if (array->GetNumberOfComponents() != 3)
  {
    throw Failure(what + "the point array \"" + name + "\" has " +
      DescribeCount(array->GetNumberOfComponents(), "component", "components") +
      ", but displacements have 3; " + DescribeArrays(part.Data->GetPointData()) +
      GetAdvice(part.Data->GetPointData()));
  }
}

// Throws a Failure if polyhedra have no faces: earlier readers ignore those that VTK 9.4 and later
// write.
void CheckPolyhedra(vtkUnstructuredGrid* grid, const std::string& path)
{
  vtkNew<vtkIdList> faces;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    if (grid->GetCellType(cell) != VTK_POLYHEDRON)
    {
      continue;
    }
    grid->GetFaceStream(cell, faces);
    if (faces->GetNumberOfIds() > 0)
    {
      continue;
    }
    vtkNew<vtkXMLFileReadTester> tester;
    tester->SetFileName(path.c_str());
    const char* const version = tester->TestReadFile() ? tester->GetFileVersion() : nullptr;
    throw Failure("cannot read " + path + ": cell " + std::to_string(cell) +
      " is a polyhedron whose faces cannot be read. VTK 9.4 and later write polyhedra in version "
      "2.3 of the file format" +
      (version ? std::string(" (this file is of version ") + version + ")" : "") +
      ", and this program has VTK " VTK_VERSION
      ". Write the file with ParaView 5.13 or older, or turn the polyhedra into tetrahedra first "
      "(ParaView: Filters > Tetrahedralize)");
  }
}
}

std::vector<MeshPart> FindParts(vtkDataObject* object)
{
  std::vector<MeshPart> parts;
  if (auto* composite = vtkCompositeDataSet::SafeDownCast(object))
  {
    const auto leaf = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
    for (leaf->InitTraversal(); !leaf->IsDoneWithTraversal(); leaf->GoToNextItem())
    {
      if (auto* data = vtkDataSet::SafeDownCast(leaf->GetCurrentDataObject()))
      {
        const char* name = leaf->HasCurrentMetaData()
          ? leaf->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME())
          : nullptr;
        parts.push_back({ data,
          "\"" + (name ? std::string(name) : std::to_string(leaf->GetCurrentFlatIndex())) + "\"" });
      }
    }
  }
  else if (auto* data = vtkDataSet::SafeDownCast(object))
  {
    parts.push_back({ data, "" });
  }
  return parts;
}

void CheckMesh(vtkDataObject* mesh, const std::string& displacement, const std::string& path)
{
  bool deforms = false;
  bool hasImages = false;
  for (const MeshPart& part : FindParts(mesh))
  {
    hasImages = hasImages || vtkImageData::SafeDownCast(part.Data);
    const bool isField = part.Data == vtkImageData::SafeDownCast(mesh);
    if (HasVolumeCells(part.Data) || (isField && part.Data->GetNumberOfPoints() > 0))
    {
      deforms = true;
      if (auto* grid = vtkUnstructuredGrid::SafeDownCast(part.Data))
      {
        CheckPolyhedra(grid, path);
      }
      if (!displacement.empty())
      {
        CheckArray(part, displacement, path);
      }
    }
  }
  if (!deforms)
  {
    throw Failure("cannot use " + path + " as a mesh: it holds " + Describe(mesh) +
      (hasImages ? ", including blocks of image data. Such blocks are ignored. Give an image as a "
                   "displacement field (--field), in a file of its own"
                 : ", but no three-dimensional cells, such as tetrahedra and hexahedra"));
  }
}

void CheckField(vtkImageData* field, const std::string& displacement, const std::string& path)
{
  if (!displacement.empty())
  {
    CheckArray({ field, "" }, displacement, path);
    return;
  }
  vtkPointData* arrays = field->GetPointData();
  int vectors = 0;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = arrays->GetArray(i);
    vectors += array && array->GetNumberOfComponents() == 3 ? 1 : 0;
  }
  if (!arrays->GetVectors() && vectors != 1)
  {
    throw Failure("cannot use " + path + ": " +
      (vectors == 0 ? "it has no point array with 3 components for the displacements"
                    : "name the array of displacements with --displacement") +
      "; " + DescribeArrays(arrays) + (vectors == 0 ? GetAdvice(arrays) : ""));
  }
}

void CheckSheet(vtkDataObject* sheet, const std::string& path)
{
  auto* surface = vtkPolyData::SafeDownCast(sheet);
  if (!surface || surface->GetNumberOfPolys() + surface->GetNumberOfStrips() == 0)
  {
    throw Failure("cannot use " + path + " as a sheet: it holds " + Describe(sheet) +
      ". A sheet is a surface of triangles or other polygons");
  }
}
