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

#include <array>
#include <map>

namespace
{
/// The dimensions of cell types. Caches them, because they need an instance of vtkCell.
class CellDimensions
{
public:
  int Get(int type)
  {
    const auto found = this->Known.find(type);
    if (found != this->Known.end())
    {
      return found->second;
    }
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
    return this->Known[type] = cell ? cell->GetCellDimension() : 0;
  }

private:
  std::map<int, int> Known;
};

/// Whether a dataset is a grid with three-dimensional cells, which can deform a volume.
bool HasVolumeCells(vtkDataSet* data)
{
  const bool isGrid = vtkUnstructuredGrid::SafeDownCast(data) ||
    vtkStructuredGrid::SafeDownCast(data) || vtkRectilinearGrid::SafeDownCast(data);
  CellDimensions dimensions;
  for (vtkIdType cell = 0; isGrid && cell < data->GetNumberOfCells(); ++cell)
  {
    if (dimensions.Get(data->GetCellType(cell)) == 3)
    {
      return true;
    }
  }
  return false;
}

std::string DescribeCount(vtkIdType number, const char* one, const char* many)
{
  return std::to_string(number) + " " + (number == 1 ? one : many);
}

// For example "27 points, 12 triangles or other faces and 3 lines".
std::string DescribeCells(const std::vector<MeshPart>& parts)
{
  vtkIdType points = 0;
  std::array<vtkIdType, 4> cells{};
  CellDimensions dimensions;
  for (const MeshPart& part : parts)
  {
    points += part.Data->GetNumberOfPoints();
    for (vtkIdType cell = 0; cell < part.Data->GetNumberOfCells(); ++cell)
    {
      ++cells.at(static_cast<std::size_t>(dimensions.Get(part.Data->GetCellType(cell))));
    }
  }
  std::vector<std::string> words{ DescribeCount(points, "point", "points") };
  const std::array<std::array<const char*, 2>, 4> names{ { { { "vertex cell", "vertex cells" } },
    { { "line", "lines" } }, { { "triangle or other face", "triangles or other faces" } },
    { { "three-dimensional cell", "three-dimensional cells" } } } };
  for (std::size_t dimension = 4; dimension-- > 0;)
  {
    if (cells[dimension] > 0)
    {
      words.push_back(DescribeCount(cells[dimension], names[dimension][0], names[dimension][1]));
    }
  }
  if (words.size() == 1)
  {
    words.emplace_back("no cells");
  }
  std::string text = words.front();
  for (std::size_t i = 1; i < words.size(); ++i)
  {
    text += (i + 1 < words.size() ? ", " : " and ") + words[i];
  }
  return text;
}

std::string Describe(vtkDataObject* object)
{
  const std::vector<MeshPart> parts = FindParts(object);
  if (auto* image = vtkImageData::SafeDownCast(object))
  {
    return "an image of " + DescribeSize(image) + " points";
  }
  return parts.empty() ? "no points" : DescribeCells(parts);
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
                 : ". A mesh needs three-dimensional cells, such as tetrahedra and hexahedra"));
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
