// SPDX-License-Identifier: BSD-3-Clause
#include "BodyVoxels.h"

#include "DisjointSets.h"
#include "MaskArray.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace deformvolume
{
namespace
{

// Whether a value is one of the labels; if there are no labels, whether it is not 0.
template <typename T>
bool IsLabel(T value, const std::vector<vtkTypeInt64>& labels)
{
  if (!std::isfinite(static_cast<double>(value)))
  {
    return false;
  }
  if (labels.empty())
  {
    return value != T(0);
  }
  return std::any_of(labels.begin(), labels.end(),
    [value](vtkTypeInt64 label)
    {
      return std::is_integral<T>::value ? static_cast<vtkTypeInt64>(value) == label
                                        : static_cast<double>(value) == static_cast<double>(label);
    });
}

struct FindRuns
{
  template <typename Array>
  void operator()(Array* array, const unsigned char* ghosts, const BodyCriterion& criterion,
    BodyVoxels& body) const
  {
    const auto values = vtk::DataArrayTupleRange(array);
    const auto isBody = [&](vtkIdType voxel)
    {
      const vtk::GetAPIType<Array> value = values[voxel][0];
      const double number = static_cast<double>(value);
      return (criterion.ByLabels ? IsLabel(value, criterion.Labels)
                                 : number >= criterion.Isovalue && std::isfinite(number)) &&
        !(ghosts && (ghosts[voxel] & vtkDataSetAttributes::HIDDENPOINT));
    };
    vtkIdType voxel = 0;
    for (vtkIdType row = 0; row < body.NumberOfRows(); ++row)
    {
      bool isRun = false;
      for (int x = 0; x < body.Size[0]; ++x, ++voxel)
      {
        if (!isBody(voxel))
        {
          isRun = false;
        }
        else if (isRun)
        {
          ++body.Runs.back().End;
        }
        else
        {
          isRun = true;
          body.Runs.push_back({ x, x + 1, 0 });
        }
      }
      body.RowStarts[row + 1] = static_cast<vtkIdType>(body.Runs.size());
    }
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
  const PointGhosts ghosts = FindPointGhosts(volume, "volume");
  if (!vtkArrayDispatch::Dispatch::Execute(array, FindRuns{}, ghosts.Values, criterion, body))
  {
    FindRuns{}(array, ghosts.Values, criterion, body);
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
