// SPDX-License-Identifier: BSD-3-Clause
#include "MeshStamp.h"

#include "CellTypes.h"
#include "MaskArray.h"
#include "ParallelFor.h"
#include "PolyhedronFaces.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace deformvolume
{

namespace
{

constexpr vtkIdType BLOCK = 8192; // cells or points compared at a time

void AddArray(Stamp& stamp, vtkAbstractArray* array)
{
  stamp.emplace_back(array, array ? array->GetMTime() : 0);
  // What is inserted leaves no trace in the time.
  stamp.emplace_back(nullptr, array ? static_cast<vtkMTimeType>(array->GetNumberOfValues()) : 0);
}

vtkAbstractArray* GetGhosts(vtkUnstructuredGrid* grid)
{
  return grid->GetCellData()->GetAbstractArray(vtkDataSetAttributes::GhostArrayName());
}

// Whether body(begin, end) is true for all parts of a range; some are not looked at once it was
// not.
template <typename Body>
bool IsTrueForAll(vtkIdType count, Body&& body)
{
  std::atomic<bool> all{ true };
  ParallelFor(0, (count + BLOCK - 1) / BLOCK, 0,
    [&](vtkIdType first, vtkIdType last)
    {
      for (vtkIdType block = first; block < last && all.load(std::memory_order_relaxed); ++block)
      {
        if (!body(block * BLOCK, std::min((block + 1) * BLOCK, count)))
        {
          all = false;
        }
      }
    });
  return all;
}

// The cells of a part, in arrays of numbers of one size. Null: all have the type, or the number of
// nodes, of a tetrahedron.
template <typename Integer>
struct PartCells
{
  const unsigned char* Types;
  const Integer* Offsets;
  const Integer* Connectivity;

  // Whether some are these tetrahedra, whose nodes are counted from firstNode. Without branches,
  // which compilers make vectors of.
  bool Are(vtkIdType begin, vtkIdType end, const Tetrahedron* tetrahedra, Integer firstNode) const
  {
    Integer differences = 0;
    int otherTypes = 0;
    if (this->Types)
    {
      for (vtkIdType cell = begin; cell < end; ++cell)
      {
        otherTypes |= this->Types[cell] ^ VTK_TETRA;
      }
    }
    if (this->Offsets)
    {
      for (vtkIdType cell = begin; cell < end; ++cell)
      {
        differences |= this->Offsets[cell] ^ static_cast<Integer>(4 * cell);
      }
    }
    const std::int32_t* nodes = tetrahedra[begin].data();
    const Integer* points = this->Connectivity + 4 * begin;
    for (vtkIdType i = 0; i < 4 * (end - begin); ++i)
    {
      differences |= points[i] ^ (static_cast<Integer>(nodes[i]) - firstNode);
    }
    return differences == 0 && otherTypes == 0;
  }
};

template <typename Integer>
bool HasCells(vtkUnstructuredGrid* grid, const unsigned char* types, vtkDataArray* offsets,
  const Tetrahedron* tetrahedra, std::int32_t firstNode)
{
  PartCells<Integer> cells;
  cells.Types = types;
  cells.Offsets = offsets ? static_cast<const Integer*>(offsets->GetVoidPointer(0)) : nullptr;
  cells.Connectivity =
    static_cast<const Integer*>(grid->GetCells()->GetConnectivityArray()->GetVoidPointer(0));
  return IsTrueForAll(grid->GetNumberOfCells(),
    [&](vtkIdType begin, vtkIdType end)
    { return cells.Are(begin, end, tetrahedra, static_cast<Integer>(firstNode)); });
}

// Whether the cells of a grid, of which there are some, are these tetrahedra.
bool IsMadeOf(vtkUnstructuredGrid* grid, const Tetrahedron* tetrahedra, std::int32_t firstNode)
{
  const vtkIdType count = grid->GetNumberOfCells();
  vtkCellArray* cells = grid->GetCells();
  vtkDataArray* offsets = cells ? cells->GetOffsetsArray() : nullptr;
  vtkDataArray* connectivity = cells ? cells->GetConnectivityArray() : nullptr;
  if (GetGhosts(grid) || !offsets || !connectivity || !connectivity->HasStandardMemoryLayout() ||
    offsets->GetNumberOfValues() != count + 1 || connectivity->GetNumberOfValues() != 4 * count)
  {
    return false;
  }
  auto* types = vtkArrayDownCast<ByteArray>(GetCellTypes(grid));
  if (types ? types->GetNumberOfValues() < count : GetCommonCellType(grid) != VTK_TETRA)
  {
    return false;
  }
  if (!offsets->HasStandardMemoryLayout())
  {
    // Computed, as where all cells have the same number of nodes.
    if (cells->IsHomogeneous() != 4)
    {
      return false;
    }
    offsets = nullptr;
  }
  else if (offsets->GetDataTypeSize() != connectivity->GetDataTypeSize())
  {
    return false;
  }
  const unsigned char* type = types ? types->GetPointer(0) : nullptr;
  switch (connectivity->GetDataTypeSize())
  {
    case 4:
      return HasCells<std::int32_t>(grid, type, offsets, tetrahedra, firstNode);
    case 8:
      return HasCells<std::int64_t>(grid, type, offsets, tetrahedra, firstNode);
    default:
      return false;
  }
}

} // namespace

Stamp GetCellArraysStamp(const MeshParts& parts)
{
  Stamp stamp;
  for (vtkUnstructuredGrid* grid : parts)
  {
    // The node numbers of a part follow from the sizes of the parts before it.
    for (const vtkIdType count : { grid->GetNumberOfCells(), grid->GetNumberOfPoints() })
    {
      stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(count));
    }
    vtkCellArray* cells = grid->GetCells();
    stamp.emplace_back(cells, cells ? cells->GetMTime() : 0);
    AddArray(stamp, cells ? cells->GetConnectivityArray() : nullptr);
    AddArray(stamp, cells ? cells->GetOffsetsArray() : nullptr);
    AddArray(stamp, GetCellTypes(grid));
    AddArray(stamp, GetGhosts(grid));
    AddArray(stamp, grid->GetCellData()->GetHigherOrderDegrees());
    if (HasPolyhedronFaces(grid))
    {
      stamp.emplace_back(grid, grid->vtkObject::GetMTime()); // which knows of the faces
    }
  }
  return stamp;
}

void MeshStamp::Add(vtkUnstructuredGrid* grid, bool made)
{
  this->Grids.push_back({ grid, made ? 0 : grid->vtkObject::GetMTime() });
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
    vtkPoints* points = grid->GetPoints();
    stamp.Arrays.emplace_back(points, points ? points->vtkObject::GetMTime() : 0);
    AddArray(stamp.Arrays, points ? points->GetData() : nullptr);
  }
  return stamp;
}

bool MeshStamp::IsThatOf(const MeshStamp& last) const
{
  return this->Arrays == last.Arrays && !this->Grids.empty() &&
    std::equal(this->Grids.begin(), this->Grids.end(), last.Grids.begin(), last.Grids.end(),
      [](const Grid& now, const Grid& before)
      { return now.Object != before.Object || now.Modified == before.Modified; });
}

bool HasCells(const MeshParts& parts, const std::vector<Tetrahedron>& tetrahedra)
{
  std::size_t first = 0;
  std::int32_t firstNode = 0;
  for (vtkUnstructuredGrid* grid : parts)
  {
    const auto count = static_cast<std::size_t>(grid->GetNumberOfCells());
    if (count > tetrahedra.size() - first ||
      (count > 0 && !IsMadeOf(grid, tetrahedra.data() + first, firstNode)))
    {
      return false;
    }
    first += count;
    firstNode += static_cast<std::int32_t>(grid->GetNumberOfPoints());
  }
  return first == tetrahedra.size();
}

bool HasPoints(const MeshParts& parts, const glm::dmat4& transform,
  const std::vector<glm::dvec3>& points, const std::string& name)
{
  if (GetNumberOfNodes(parts) != points.size())
  {
    return false;
  }
  std::atomic<bool> same{ true };
  const glm::dvec3* next = points.data();
  for (vtkUnstructuredGrid* grid : parts)
  {
    if (grid->GetNumberOfPoints() > 0)
    {
      ReadVectors(
        grid->GetPoints()->GetData(),
        [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
        {
          for (vtkIdType i = 0; i < count && same.load(std::memory_order_relaxed); ++i)
          {
            if (glm::dvec3(transform * glm::dvec4(vectors[i], 1.0)) != next[first + i])
            {
              same = false;
            }
          }
        },
        "Point", name);
      next += grid->GetNumberOfPoints();
    }
  }
  return same;
}

} // namespace deformvolume
