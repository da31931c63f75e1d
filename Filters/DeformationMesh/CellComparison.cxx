// SPDX-License-Identifier: BSD-3-Clause
#include "CellComparison.h"

#include "CellTypes.h"
#include "MaskArray.h"
#include "MeshStamp.h"
#include "ParallelFor.h"
#include "WrittenTuples.h"

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace deformvolume
{

namespace
{

constexpr vtkIdType BLOCK = 8192;      // cells that are compared at a time
constexpr std::size_t MostChanges = 8; // list at most one change for this number of tetrahedra

// The tetrahedra of a part of the mesh, and the changes that were found.
struct ComparedPart
{
  const Tetrahedron* Tetrahedra;
  std::size_t First; // index of its first tetrahedron in the whole mesh
  std::int32_t FirstNode;
  std::size_t Most;                   // the largest number of changes for which a list pays
  std::vector<unsigned char> Written; // for each block whether it was written; empty: unknown
  std::vector<TetrahedronChange> Changes;
};

// The cells of a part, in arrays of integers of one size. Types or Offsets is null if it is known
// that all cells have the type, or the number of nodes, of a tetrahedron.
template <typename Integer>
struct PartCells
{
  const unsigned char* Types;
  const Integer* Offsets;
  const Integer* Connectivity;

  // Whether the cells from begin to end are tetrahedra. The loops have no branches, so that
  // compilers vectorize them.
  bool AreTetrahedra(vtkIdType begin, vtkIdType end) const
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
    return differences == 0 && otherTypes == 0;
  }

  // Whether the cells from begin to end have the nodes of the tetrahedra. firstNode: index of the
  // first node of the part.
  bool HaveNodes(
    vtkIdType begin, vtkIdType end, const Tetrahedron* tetrahedra, Integer firstNode) const
  {
    // Unsigned, since no index is negative: widening needs no sign extension.
    using Word = std::make_unsigned_t<Integer>;
    Word differences = 0;
    const std::int32_t* nodes = tetrahedra[begin].data();
    const Integer* points = this->Connectivity + 4 * begin;
    const auto first = static_cast<std::uint32_t>(firstNode);
    for (vtkIdType i = 0; i < 4 * (end - begin); ++i)
    {
      differences |= static_cast<Word>(points[i]) ^
        static_cast<Word>(static_cast<std::uint32_t>(nodes[i]) - first);
    }
    return differences == 0;
  }

  // Reads the nodes of a cell. Returns false if a node does not exist.
  bool Read(vtkIdType cell, vtkIdType numberOfPoints, std::int32_t firstNode,
    Tetrahedron& tetrahedron) const
  {
    for (int k = 0; k < 4; ++k)
    {
      const auto point = static_cast<vtkIdType>(this->Connectivity[4 * cell + k]);
      if (point < 0 || point >= numberOfPoints)
      {
        return false;
      }
      tetrahedron[k] = firstNode + static_cast<std::int32_t>(point);
    }
    return true;
  }

  // Lists the cells from begin to end whose nodes differ from those of their tetrahedra. Returns
  // false if a node does not exist.
  bool ListChanges(vtkIdType begin, vtkIdType end, vtkIdType numberOfPoints,
    const ComparedPart& part, std::vector<TetrahedronChange>& changes) const
  {
    for (vtkIdType cell = begin; cell < end; ++cell)
    {
      TetrahedronChange change;
      change.Before = part.Tetrahedra[cell];
      if (!this->Read(cell, numberOfPoints, part.FirstNode, change.After))
      {
        return false;
      }
      if (change.After != change.Before)
      {
        change.Number = static_cast<std::int32_t>(part.First) + static_cast<std::int32_t>(cell);
        changes.push_back(change);
      }
    }
    return true;
  }
};

// Returns false if not all cells are tetrahedra, or too many have changed.
template <typename Integer>
bool Compare(
  vtkUnstructuredGrid* grid, const unsigned char* types, vtkDataArray* offsets, ComparedPart& part)
{
  PartCells<Integer> cells;
  cells.Types = types;
  cells.Offsets = offsets ? static_cast<const Integer*>(offsets->GetVoidPointer(0)) : nullptr;
  cells.Connectivity =
    static_cast<const Integer*>(grid->GetCells()->GetConnectivityArray()->GetVoidPointer(0));
  const vtkIdType count = grid->GetNumberOfCells();
  const vtkIdType blocks = (count + BLOCK - 1) / BLOCK;
  std::vector<std::vector<TetrahedronChange>> changes(static_cast<std::size_t>(blocks));
  std::atomic<std::size_t> number{ 0 };
  std::atomic<bool> usable{ true };
  ParallelFor(0, blocks, 0,
    [&](vtkIdType first, vtkIdType last)
    {
      for (vtkIdType block = first; block < last && usable.load(std::memory_order_relaxed); ++block)
      {
        if (!part.Written.empty() && !part.Written[static_cast<std::size_t>(block)])
        {
          continue;
        }
        const vtkIdType begin = block * BLOCK;
        const vtkIdType end = std::min(begin + BLOCK, count);
        bool isUsable = cells.AreTetrahedra(begin, end);
        if (isUsable &&
          !cells.HaveNodes(begin, end, part.Tetrahedra, static_cast<Integer>(part.FirstNode)))
        {
          std::vector<TetrahedronChange>& found = changes[static_cast<std::size_t>(block)];
          isUsable = cells.ListChanges(begin, end, grid->GetNumberOfPoints(), part, found);
          number += found.size();
        }
        if (!isUsable || number > part.Most)
        {
          usable = false;
        }
      }
    });
  for (const std::vector<TetrahedronChange>& some : changes)
  {
    part.Changes.insert(part.Changes.end(), some.begin(), some.end());
  }
  return usable;
}

bool Compare(vtkUnstructuredGrid* grid, ComparedPart& part)
{
  const vtkIdType count = grid->GetNumberOfCells();
  vtkCellArray* cells = grid->GetCells();
  vtkDataArray* offsets = cells ? cells->GetOffsetsArray() : nullptr;
  vtkDataArray* connectivity = cells ? cells->GetConnectivityArray() : nullptr;
  const auto masks = FindMasks(grid);
  const bool hasMasks =
    std::any_of(masks.begin(), masks.end(), [](vtkAbstractArray* mask) { return mask != nullptr; });
  if (hasMasks || !offsets || !connectivity || !connectivity->HasStandardMemoryLayout() ||
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
    // VTK computes the offsets if all cells have the same number of nodes.
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
      return Compare<std::int32_t>(grid, type, offsets, part);
    case 8:
      return Compare<std::int64_t>(grid, type, offsets, part);
    default:
      return false;
  }
}

CellMemory GetCellMemory(vtkUnstructuredGrid* grid)
{
  vtkCellArray* cells = grid->GetCells();
  vtkDataArray* connectivity = cells ? cells->GetConnectivityArray() : nullptr;
  CellMemory memory;
  memory.Arrays = GetCellFormStamp(grid);
  memory.Connectivity = connectivity;
  memory.Time = connectivity ? connectivity->GetMTime() : 0;
  return memory;
}

// Returns for each block of cells of a part whether the block was written. Empty: unknown. count:
// number of tetrahedra of the part.
std::vector<unsigned char> FindWrittenBlocks(
  vtkUnstructuredGrid* grid, const CellMemory& last, std::size_t count)
{
  const CellMemory now = GetCellMemory(grid);
  std::vector<unsigned char> written;
  if (!now.Connectivity || now.Arrays != last.Arrays)
  {
    return written;
  }
  const auto values =
    FindWritten(grid->GetCells()->GetConnectivityArray(), last.Connectivity, last.Time);
  if (!values)
  {
    return written;
  }
  written.resize((count + BLOCK - 1) / BLOCK);
  MarkBlocks(*values, 4 * BLOCK, written);
  return written;
}

} // namespace

std::vector<CellMemory> GetCellMemories(const MeshParts& parts)
{
  std::vector<CellMemory> memories;
  for (vtkUnstructuredGrid* grid : parts)
  {
    memories.push_back(GetCellMemory(grid));
  }
  return memories;
}

std::optional<std::vector<TetrahedronChange>> FindDifferences(const MeshParts& parts,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<CellMemory>& memories)
{
  std::vector<TetrahedronChange> differences;
  const std::size_t most = tetrahedra.size() / MostChanges;
  std::size_t first = 0;
  std::int32_t firstNode = 0;
  // With several parts, node indices depend on the numbers of points of earlier parts, which may
  // have changed.
  const bool areKnown = memories.size() == 1 && parts.size() == 1;
  for (vtkUnstructuredGrid* grid : parts)
  {
    const auto count = static_cast<std::size_t>(grid->GetNumberOfCells());
    if (count > tetrahedra.size() - first)
    {
      return {};
    }
    if (count > 0)
    {
      ComparedPart part{ tetrahedra.data() + first, first, firstNode, most, {}, {} };
      if (areKnown)
      {
        part.Written = FindWrittenBlocks(grid, memories.front(), count);
      }
      if (!Compare(grid, part))
      {
        return {};
      }
      differences.insert(differences.end(), part.Changes.begin(), part.Changes.end());
    }
    first += count;
    firstNode += static_cast<std::int32_t>(grid->GetNumberOfPoints());
  }
  if (first != tetrahedra.size())
  {
    return {};
  }
  return differences;
}

} // namespace deformvolume
