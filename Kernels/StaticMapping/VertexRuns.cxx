// SPDX-License-Identifier: BSD-3-Clause
#include "VertexRuns.h"

#include "Error.h"
#include "KernelParameters.h"

#include <string>

namespace deformvolume
{
namespace
{

void CheckRecords(const VertexRuns& runs, std::size_t numberOfTetrahedra)
{
  for (std::size_t i = 0; i < runs.Tetrahedra.size(); ++i)
  {
    const std::int32_t id = runs.Tetrahedra[i].Tetrahedron;
    if (id < 0 || static_cast<std::size_t>(id) >= numberOfTetrahedra)
    {
      throw Error("Record " + std::to_string(i) + " of the runs is of the tetrahedron " +
        std::to_string(id) + ", but there are " + std::to_string(numberOfTetrahedra) + ".");
    }
  }
}

void CheckRow(const VertexRuns& runs, std::size_t row, std::int64_t size)
{
  const auto refuse = [row](const std::string& what)
  { throw Error("Row " + std::to_string(row) + " of voxels " + what); };
  const std::uint32_t begin = runs.RowBegins[row];
  const std::uint32_t end = runs.RowBegins[row + 1];
  if (begin >= end || end > runs.Runs.size())
  {
    refuse("has no runs, or more than there are.");
  }
  if (runs.Runs[begin].Begin != 0)
  {
    refuse("has a first run that does not begin at its first voxel.");
  }
  for (std::uint32_t i = begin; i < end; ++i)
  {
    const VertexRun& run = runs.Runs[i];
    if (run.Begin >= size || (i > begin && run.Begin <= runs.Runs[i - 1].Begin))
    {
      refuse("has runs that do not begin one after the other within the row.");
    }
    if (run.Tetrahedron < -1 ||
      run.Tetrahedron >= static_cast<std::int64_t>(runs.Tetrahedra.size()))
    {
      refuse("has a run with the record " + std::to_string(run.Tetrahedron) + ", but there are " +
        std::to_string(runs.Tetrahedra.size()) + ".");
    }
  }
}

} // namespace

std::uint64_t GetRunBytes(std::uint64_t runs, std::uint64_t rows, std::uint64_t records)
{
  return runs * sizeof(VertexRun) + 2 * rows * sizeof(std::uint32_t) +
    records * (sizeof(RestTetrahedron) + sizeof(TetrahedronRecord));
}

std::uint64_t GetBytes(const VertexRuns& runs)
{
  return runs.RowBegins.empty()
    ? 0
    : GetRunBytes(runs.Runs.size(), runs.RowBegins.size() - 1, runs.Tetrahedra.size());
}

void CheckRuns(const VertexRuns& runs, const VoxelGrid& voxelGrid, std::size_t numberOfTetrahedra)
{
  const Extent& extent = voxelGrid.VertexExtent;
  const auto rows = static_cast<std::size_t>(GetSize(extent, 1) * GetSize(extent, 2));
  for (int axis = 0; axis < 3; ++axis)
  {
    if (GetSize(extent, axis) > LargestRunSize)
    {
      throw Error("A volume of more than 16,777,216 voxels on an axis cannot be mapped by runs: "
                  "give a link for each voxel.");
    }
  }
  CheckRuns(runs, rows, GetSize(extent, 0), numberOfTetrahedra);
}

void CheckRuns(
  const VertexRuns& runs, std::size_t rows, std::int64_t rowSize, std::size_t numberOfTetrahedra)
{
  if (runs.RowBegins.size() != rows + 1 || runs.RowBegins.front() != 0 ||
    runs.RowBegins.back() != runs.Runs.size())
  {
    throw Error("The runs are not those of " + std::to_string(rows) + " rows of voxels.");
  }
  CheckRecords(runs, numberOfTetrahedra);
  for (std::size_t row = 0; row < rows; ++row)
  {
    CheckRow(runs, row, rowSize);
  }
}

} // namespace deformvolume
