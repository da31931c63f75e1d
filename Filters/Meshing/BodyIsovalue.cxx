// SPDX-License-Identifier: BSD-3-Clause
#include "BodyIsovalue.h"

#include "Error.h"
#include "MaskArray.h"
#include "ParallelFor.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace deformvolume
{
namespace
{

using Index = std::array<vtkIdType, 3>;

// Mean of each block of voxels, NaN where a block has no voxel that counts.
struct BlockMeans
{
  template <typename Array>
  void operator()(Array* array, const unsigned char* ghosts, const Index& size, const Index& factor,
    const Index& blocks, std::vector<float>& means) const
  {
    const auto values = vtk::DataArrayTupleRange(array);
    // Some slabs of blocks at a time, and no thread allocates memory.
    constexpr vtkIdType together = 16;
    const vtkIdType plane = blocks[0] * blocks[1];
    std::vector<double> sums(plane * together);
    std::vector<vtkIdType> counts(plane * together);
    vtkIdType first = 0;
    auto slabs = [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType slab = begin; slab < end; ++slab)
      {
        const vtkIdType last = std::min((slab + 1) * factor[2], size[2]);
        for (vtkIdType z = slab * factor[2]; z < last; ++z)
        {
          for (vtkIdType y = 0; y < size[1]; ++y)
          {
            const vtkIdType row = (z * size[1] + y) * size[0];
            vtkIdType block = (slab - first) * plane + (y / factor[1]) * blocks[0];
            for (vtkIdType x = 0, left = factor[0]; x < size[0]; ++x, --left)
            {
              if (left == 0)
              {
                ++block;
                left = factor[0];
              }
              if (ghosts && (ghosts[row + x] & vtkDataSetAttributes::HIDDENPOINT))
              {
                continue;
              }
              const double value = static_cast<double>(values[row + x][0]);
              if (std::isfinite(value))
              {
                sums[block] += value;
                ++counts[block];
              }
            }
          }
        }
      }
    };
    for (; first < blocks[2]; first += together)
    {
      std::fill(sums.begin(), sums.end(), 0.0);
      std::fill(counts.begin(), counts.end(), 0);
      const vtkIdType last = std::min(first + together, blocks[2]);
      ParallelFor(first, last, 1, slabs);
      for (vtkIdType i = 0; i < (last - first) * plane; ++i)
      {
        means[first * plane + i] = counts[i]
          ? static_cast<float>(sums[i] / static_cast<double>(counts[i]))
          : std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
};

} // namespace

double OtsuThreshold(const std::vector<float>& values, double low, double high)
{
  constexpr int bins = 512;
  std::vector<double> histogram(bins, 0.0);
  for (float value : values)
  {
    if (std::isfinite(value))
    {
      const int bin = static_cast<int>((value - low) / (high - low) * bins);
      histogram[std::min(std::max(bin, 0), bins - 1)] += 1.0;
    }
  }
  const double total = std::accumulate(histogram.begin(), histogram.end(), 0.0);
  double moment = 0.0;
  for (int i = 0; i < bins; ++i)
  {
    moment += i * histogram[i];
  }
  double below = 0.0;
  double momentBelow = 0.0;
  double best = -1.0;
  double first = 0.0;
  double last = 0.0;
  for (int i = 0; i + 1 < bins; ++i)
  {
    below += histogram[i];
    momentBelow += i * histogram[i];
    const double above = total - below;
    if (below == 0.0 || above == 0.0)
    {
      continue;
    }
    const double difference = momentBelow / below - (moment - momentBelow) / above;
    const double between = below * above * difference * difference;
    if (between > best * (1.0 + 1e-12))
    {
      best = between;
      first = i;
    }
    if (between >= best * (1.0 - 1e-12))
    {
      last = i;
    }
  }
  return low + ((first + last) / 2.0 + 1.0) / bins * (high - low);
}

double FindIsovalue(vtkImageData* volume, vtkDataArray* array, double resolution)
{
  int dimensions[3];
  volume->GetDimensions(dimensions);
  Index size;
  Index factor;
  Index blocks;
  for (int axis = 0; axis < 3; ++axis)
  {
    size[axis] = dimensions[axis];
    const double spacing = std::abs(volume->GetSpacing()[axis]);
    factor[axis] = static_cast<vtkIdType>(
      std::min(std::max(1.0, std::floor(resolution / spacing)), dimensions[axis] / 2.0));
    blocks[axis] = (size[axis] + factor[axis] - 1) / factor[axis];
  }
  std::vector<float> means(blocks[0] * blocks[1] * blocks[2]);
  const unsigned char* ghosts = FindPointGhosts(volume);
  if (!vtkArrayDispatch::Dispatch::Execute(
        array, BlockMeans{}, ghosts, size, factor, blocks, means))
  {
    BlockMeans{}(array, ghosts, size, factor, blocks, means);
  }
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const float value : means)
  {
    if (std::isfinite(value))
    {
      low = std::min<double>(low, value);
      high = std::max<double>(high, value);
    }
  }
  if (low > high)
  {
    throw Error("No body: the volume has no finite value that is not hidden.");
  }
  if (low == high)
  {
    throw Error("The isovalue cannot be found: all values of the volume are equal. Switch "
                "AutomaticIsovalue off and set Isovalue.");
  }
  return OtsuThreshold(means, low, high);
}

std::array<double, 2> FindRange(vtkImageData* volume, vtkDataArray* array)
{
  const unsigned char* ghosts = FindPointGhosts(volume);
  const double infinity = std::numeric_limits<double>::infinity();
  std::array<double, 2> range{ { infinity, -infinity } };
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    const double value = array->GetComponent(i, 0);
    if (std::isfinite(value) && !(ghosts && (ghosts[i] & vtkDataSetAttributes::HIDDENPOINT)))
    {
      range = { { std::min(range[0], value), std::max(range[1], value) } };
    }
  }
  return range;
}

} // namespace deformvolume
