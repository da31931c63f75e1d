// SPDX-License-Identifier: BSD-3-Clause
#include "BodyVoxels.h"

#include "DisjointSets.h"
#include "MaskArray.h"
#include "ParallelFor.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"

#include <glm/common.hpp>

#include <algorithm>

namespace deformvolume
{
namespace
{

// Calls run(begin, end) for the runs of one row.
template <typename IsBody, typename Run>
void ForEachRun(int length, IsBody&& isBody, Run&& run)
{
  int begin = -1;
  for (int x = 0; x < length; ++x)
  {
    if (isBody(x))
    {
      begin = begin < 0 ? x : begin;
    }
    else if (begin >= 0)
    {
      run(begin, x);
      begin = -1;
    }
  }
  if (begin >= 0)
  {
    run(begin, length);
  }
}

// Counts the runs first and then writes them, so that no thread allocates memory.
struct FindRuns
{
  template <typename Array>
  void operator()(Array* array, const unsigned char* ghosts, const BodyCriterion& criterion,
    BodyVoxels& body) const
  {
    const auto values = vtk::DataArrayTupleRange(array);
    using Value = vtk::GetAPIType<Array>;
    const vtkIdType length = body.Size[0];
    auto forEachRun = [&](vtkIdType row, auto&& run)
    {
      const vtkIdType start = row * length;
      auto isHidden = [&](int x)
      { return ghosts && (ghosts[start + x] & vtkDataSetAttributes::HIDDENPOINT); };
      if (criterion.ByLabels)
      {
        ForEachRun(
          body.Size[0],
          [&](int x)
          {
            const Value value = values[start + x][0];
            return IsLabel(value, criterion.Labels) && !isHidden(x);
          },
          run);
      }
      else
      {
        ForEachRun(
          body.Size[0],
          [&](int x)
          {
            const double value = static_cast<double>(values[start + x][0]);
            return value >= criterion.Isovalue && std::isfinite(value) && !isHidden(x);
          },
          run);
      }
    };
    const vtkIdType rows = body.NumberOfRows();
    ParallelFor(0, rows, 0,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType row = begin; row < end; ++row)
        {
          forEachRun(row, [&](int, int) { ++body.RowStarts[row + 1]; });
        }
      });
    std::partial_sum(body.RowStarts.begin(), body.RowStarts.end(), body.RowStarts.begin());
    body.Runs.resize(body.RowStarts.back());
    ParallelFor(0, rows, 0,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType row = begin; row < end; ++row)
        {
          VoxelRun* next = body.Runs.data() + body.RowStarts[row];
          forEachRun(row,
            [&](int first, int last)
            {
              next->Begin = first;
              next->End = last;
              ++next;
            });
        }
      });
  }
};

void JoinRows(const BodyVoxels& body, vtkIdType row, vtkIdType other, DisjointSets<vtkIdType>& sets)
{
  vtkIdType a = body.RowStarts[row];
  vtkIdType b = body.RowStarts[other];
  const vtkIdType lastA = body.RowStarts[row + 1];
  const vtkIdType lastB = body.RowStarts[other + 1];
  while (a < lastA && b < lastB)
  {
    const VoxelRun& runA = body.Runs[a];
    const VoxelRun& runB = body.Runs[b];
    if (runA.Begin <= runB.End && runB.Begin <= runA.End)
    {
      sets.Unite(a, b);
    }
    ++(runA.End < runB.End ? a : b);
  }
}

} // namespace

vtkIdType BodyVoxels::CountVoxels(PieceKind kind) const
{
  vtkIdType count = 0;
  for (const VoxelRun& run : this->Runs)
  {
    count += this->Pieces[run.Piece] == kind ? run.End - run.Begin : 0;
  }
  return count;
}

vtkIdType BodyVoxels::CountPieces(PieceKind kind) const
{
  return std::count(this->Pieces.begin(), this->Pieces.end(), kind);
}

BodyVoxels FindBodyVoxels(vtkImageData* volume, vtkDataArray* array, const BodyCriterion& criterion)
{
  BodyVoxels body;
  volume->GetDimensions(body.Size.data());
  volume->GetSpacing(&body.Spacing.x);
  body.Spacing = glm::abs(body.Spacing);
  body.RowStarts.assign(body.NumberOfRows() + 1, 0);
  const unsigned char* ghosts = FindPointGhosts(volume);
  if (!vtkArrayDispatch::Dispatch::Execute(array, FindRuns{}, ghosts, criterion, body))
  {
    FindRuns{}(array, ghosts, criterion, body);
  }
  return body;
}

void FindPieces(BodyVoxels& body, vtkIdType speckSize, bool largestOnly)
{
  DisjointSets<vtkIdType> sets(body.Runs.size());
  for (int z = 0; z < body.Size[2]; ++z)
  {
    for (int y = 0; y < body.Size[1]; ++y)
    {
      const vtkIdType row = vtkIdType(z) * body.Size[1] + y;
      if (y > 0)
      {
        JoinRows(body, row, row - 1, sets);
      }
      for (int j = std::max(y - 1, 0); z > 0 && j <= std::min(y + 1, body.Size[1] - 1); ++j)
      {
        JoinRows(body, row, vtkIdType(z - 1) * body.Size[1] + j, sets);
      }
    }
  }
  // The root of a piece is its first run.
  std::vector<vtkIdType> sizes;
  for (vtkIdType i = 0; i < static_cast<vtkIdType>(body.Runs.size()); ++i)
  {
    const vtkIdType root = sets.Find(i);
    if (root == i)
    {
      body.Runs[i].Piece = static_cast<vtkIdType>(sizes.size());
      sizes.push_back(0);
    }
    else
    {
      body.Runs[i].Piece = body.Runs[root].Piece;
    }
    sizes[body.Runs[i].Piece] += body.Runs[i].End - body.Runs[i].Begin;
  }
  const auto largest = std::max_element(sizes.begin(), sizes.end());
  body.Pieces.assign(sizes.size(), PieceKind::Meshed);
  for (std::size_t piece = 0; piece < sizes.size(); ++piece)
  {
    if (sizes[piece] <= speckSize && *largest > speckSize)
    {
      body.Pieces[piece] = PieceKind::Speck;
    }
    else if (largestOnly && sizes.begin() + piece != largest)
    {
      body.Pieces[piece] = PieceKind::LeftOut;
    }
  }
}

} // namespace deformvolume
