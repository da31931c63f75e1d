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
      throw Error("Record " + std::to_string(i) + " of the runs refers to tetrahedron " +
        std::to_string(id) + ", but the mesh has only " + std::to_string(numberOfTetrahedra) +
        " tetrahedra.");
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
    refuse("has the runs " + std::to_string(begin) + " to " + std::to_string(end) +
      " (exclusive), but the range must not be empty, and there are " +
      std::to_string(runs.Runs.size()) + " runs.");
  }
  if (runs.Runs[begin].Begin != 0)
  {
    refuse("has a first run that begins at voxel " + std::to_string(runs.Runs[begin].Begin) +
      ". It must begin at voxel 0.");
  }
  for (std::uint32_t i = begin; i < end; ++i)
  {
    const VertexRun& run = runs.Runs[i];
    if (run.Begin >= size || (i > begin && run.Begin <= runs.Runs[i - 1].Begin))
    {
      refuse("has a run that begins at voxel " + std::to_string(run.Begin) +
        ". Runs must begin in ascending order within the " + std::to_string(size) +
        " voxels of the row.");
    }
    if (run.Tetrahedron < -1 ||
      run.Tetrahedron >= static_cast<std::int64_t>(runs.Tetrahedra.size()))
    {
      refuse("has a run that refers to record " + std::to_string(run.Tetrahedron) +
        ", but there are only " + std::to_string(runs.Tetrahedra.size()) + " records.");
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
      throw Error("A volume with " + std::to_string(GetSize(extent, axis)) +
        " voxels on an axis cannot be mapped by runs: at most 16777216 are possible. Use links.");
    }
  }
  if (runs.RowBegins.size() != rows + 1 || runs.RowBegins.front() != 0 ||
    runs.RowBegins.back() != runs.Runs.size())
  {
    throw Error("The runs do not match a volume of " + std::to_string(rows) +
      " rows of voxels: RowBegins must have one entry more than there are rows, begin with 0 and "
      "end with the number of runs.");
  }
  CheckRecords(runs, numberOfTetrahedra);
  for (std::size_t row = 0; row < rows; ++row)
  {
    CheckRow(runs, row, GetSize(extent, 0));
  }
}

} // namespace deformvolume
