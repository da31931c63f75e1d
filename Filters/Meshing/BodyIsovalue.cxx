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
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{
namespace
{

constexpr std::size_t NumberOfBins = 512;
// Hounsfield units. No tissue has less than the first. The isovalue of a body in air is less than
// the second, and that of metal in a body is greater than the third.
constexpr double LeastTissueInCT = -1024.0;
constexpr double LargestBodyIsovalue = -200.0;
constexpr double LeastMetalIsovalue = 1000.0;

struct Block
{
  double Sum = 0.0;
  vtkIdType Count = 0;
};

/// Sums the values in each block that are finite, not hidden and not equal to `padding`. A block
/// has `factor` voxels on each axis.
struct SumBlocks
{
  template <typename Array>
  void operator()(Array* array, const unsigned char* ghosts, const int size[3], const int factor[3],
    double padding, std::vector<Block>& blocks) const
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
          if (std::isfinite(value) && value != padding &&
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

struct Threshold
{
  double Value;
  double Share;     // of the means at or above the value
  double Explained; // part of the variance of the means that is between the two classes
};

// Otsu's threshold. Nothing if all means are equal.
std::optional<Threshold> FindThreshold(const std::vector<double>& means)
{
  const auto [low, high] = std::minmax_element(means.begin(), means.end());
  const double least = *low;
  const double range = *high - least;
  if (range == 0.0)
  {
    return {};
  }
  std::vector<double> counts(NumberOfBins, 0.0);
  for (const double mean : means)
  {
    const double bin = (mean - least) / range * NumberOfBins;
    counts[std::min(static_cast<std::size_t>(bin), NumberOfBins - 1)] += 1.0;
  }
  const double value = least + FindOtsuThreshold(counts) / NumberOfBins * range;
  double sums[2] = { 0.0, 0.0 }; // of the differences from the threshold: below, and above
  double numbers[2] = { 0.0, 0.0 };
  double squares = 0.0;
  for (const double mean : means)
  {
    const double difference = mean - value;
    sums[difference >= 0.0] += difference;
    numbers[difference >= 0.0] += 1.0;
    squares += difference * difference;
  }
  const auto count = static_cast<double>(means.size());
  const double sum = sums[0] + sums[1];
  const double distance = sums[1] / numbers[1] - sums[0] / numbers[0];
  return { { value, numbers[1] / count,
    numbers[0] * numbers[1] / count * distance * distance / (squares - sum * sum / count) } };
}

// Metal is a small part of a scan, but its values are so large that Otsu's threshold may separate
// it from all else. The isovalue is then the threshold with the largest means clipped, if these
// have two distinct peaks.
std::optional<double> FindBodyThreshold(std::vector<double> means)
{
  constexpr double largestMetal = 0.05; // shares of the means
  constexpr double leastBody = 0.1;
  constexpr double leastExplained = 0.8; // one peak that is flat has 0.75
  const auto whole = FindThreshold(means);
  if (!whole)
  {
    return {};
  }
  if (whole->Share < largestMetal && whole->Value > LeastMetalIsovalue)
  {
    const auto limit = means.end() - 1 - static_cast<std::ptrdiff_t>(largestMetal * means.size());
    std::nth_element(means.begin(), limit, means.end());
    std::fill(limit, means.end(), *limit);
    const auto clipped = FindThreshold(means);
    if (clipped && clipped->Share > leastBody && clipped->Explained > leastExplained)
    {
      return clipped->Value;
    }
  }
  return whole->Value;
}

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
  const PointGhosts ghosts = FindPointGhosts(volume, "volume");
  vtkIdType voxels = 0;
  const auto findMeans = [&](double padding)
  {
    std::vector<Block> blocks(count);
    if (!vtkArrayDispatch::Dispatch::Execute(
          array, SumBlocks{}, ghosts.Values, size, factor, padding, blocks))
    {
      SumBlocks{}(array, ghosts.Values, size, factor, padding, blocks);
    }
    std::vector<double> means;
    voxels = 0;
    for (const Block& block : blocks)
    {
      voxels += block.Count;
      if (block.Count > 0)
      {
        means.push_back(block.Sum / static_cast<double>(block.Count));
      }
    }
    return means;
  };
  const std::vector<double> means = findMeans(std::numeric_limits<double>::quiet_NaN());
  if (means.empty())
  {
    throw Error("No body: all values of the volume are hidden, infinite or NaN.");
  }
  const std::optional<double> isovalue = FindBodyThreshold(means);
  if (!isovalue)
  {
    const std::string name = array->GetName() ? array->GetName() : "";
    throw Error("The isovalue cannot be computed: all values of the volume are equal" +
      (array->GetNumberOfComponents() > 1
          ? " in the first component of the point array \"" + name + "\""
          : "") +
      ". Set an isovalue, or use a volume that shows a body.");
  }
  double limits[2];
  array->GetFiniteRange(limits, 0);
  if (limits[0] < LeastTissueInCT)
  {
    // Scanners pad CT outside of a circle with -2000, -2048 or -3024, for instance.
    constexpr double leastShare = 0.01;
    const auto all = static_cast<double>(voxels);
    const std::optional<double> unpadded = FindBodyThreshold(findMeans(limits[0]));
    if (unpadded && *unpadded > LeastTissueInCT && *unpadded < LargestBodyIsovalue &&
      static_cast<double>(voxels) < (1.0 - leastShare) * all)
    {
      return *unpadded;
    }
  }
  return *isovalue;
}

} // namespace deformvolume
