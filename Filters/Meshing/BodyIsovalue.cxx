// SPDX-License-Identifier: BSD-3-Clause
#include "BodyIsovalue.h"

#include "Error.h"
#include "MaskArray.h"
#include "OtsuThreshold.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace deformvolume
{
namespace
{

constexpr std::size_t NumberOfBins = 512;

struct Block
{
  double Sum = 0.0;
  vtkIdType Count = 0;

  double Mean() const { return this->Sum / static_cast<double>(this->Count); }
};

/// Sums the values in each block that are finite and not hidden. A block has `factor` voxels on
/// each axis.
struct SumBlocks
{
  template <typename Array>
  void operator()(Array* array, const unsigned char* ghosts, const int size[3], const int factor[3],
    std::vector<Block>& blocks) const
  {
    const auto values = vtk::DataArrayTupleRange(array);
    const vtkIdType columns = (size[0] + factor[0] - 1) / factor[0];
    const vtkIdType rows = (size[1] + factor[1] - 1) / factor[1];
    vtkIdType voxel = 0;
    for (int z = 0; z < size[2]; ++z)
    {
      for (int y = 0; y < size[1]; ++y)
      {
        Block* block = &blocks[(z / factor[2] * rows + y / factor[1]) * columns];
        for (int x = 0; x < size[0]; ++x, ++voxel)
        {
          const double value = static_cast<double>(values[voxel][0]);
          if (std::isfinite(value) &&
            !(ghosts && (ghosts[voxel] & vtkDataSetAttributes::HIDDENPOINT)))
          {
            block[x / factor[0]].Sum += value;
            ++block[x / factor[0]].Count;
          }
        }
      }
    }
  }
};

} // namespace

double FindIsovalue(vtkImageData* volume, vtkDataArray* array, double resolution)
{
  int size[3];
  int factor[3];
  volume->GetDimensions(size);
  std::size_t count = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double voxels = std::floor(resolution / std::abs(volume->GetSpacing()[axis]));
    factor[axis] = static_cast<int>(std::min(std::max(1.0, voxels), size[axis] / 2.0));
    count *= (size[axis] + factor[axis] - 1) / factor[axis];
  }
  std::vector<Block> blocks(count);
  const PointGhosts ghosts = FindPointGhosts(volume, "volume");
  if (!vtkArrayDispatch::Dispatch::Execute(array, SumBlocks{}, ghosts.Values, size, factor, blocks))
  {
    SumBlocks{}(array, ghosts.Values, size, factor, blocks);
  }
  blocks.erase(std::remove_if(
                 blocks.begin(), blocks.end(), [](const Block& block) { return block.Count == 0; }),
    blocks.end());
  if (blocks.empty())
  {
    throw Error("No body: all values of the volume are hidden, infinite or NaN.");
  }
  const auto [low, high] = std::minmax_element(blocks.begin(), blocks.end(),
    [](const Block& a, const Block& b) { return a.Mean() < b.Mean(); });
  const double least = low->Mean();
  const double range = high->Mean() - least;
  if (range == 0.0)
  {
    const std::string name = array->GetName() ? array->GetName() : "";
    throw Error("The isovalue cannot be computed: all values of the volume are equal" +
      (array->GetNumberOfComponents() > 1
          ? " in the first component of the point array \"" + name + "\""
          : "") +
      ". Set an isovalue, or use a volume that shows a body.");
  }
  std::vector<double> counts(NumberOfBins, 0.0);
  for (const Block& block : blocks)
  {
    const double bin = (block.Mean() - least) / range * NumberOfBins;
    counts[std::min(static_cast<std::size_t>(bin), NumberOfBins - 1)] += 1.0;
  }
  return least + FindOtsuThreshold(counts) / NumberOfBins * range;
}

} // namespace deformvolume
