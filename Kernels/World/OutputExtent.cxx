// SPDX-License-Identifier: BSD-3-Clause
#include "OutputExtent.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace deformvolume
{

namespace
{

double Snap(double index)
{
  return std::round(index * 256.0) / 256.0;
}

int ToIndex(double index)
{
  // Far below 2^31, so that padding and sizes of extents do not overflow.
  constexpr double most = 1 << 29;
  if (!(std::abs(index) <= most))
  {
    throw Error("The output would reach to the structured index " + FormatNumber(index) +
      ". Check the bounds, the output spacing, and that volume and deformation are in the same "
      "world units.");
  }
  return static_cast<int>(index);
}

} // namespace

Extent GetExtentInside(const IndexBounds& bounds)
{
  Extent extent;
  for (int axis = 0; axis < 3; ++axis)
  {
    extent[2 * axis] = ToIndex(std::ceil(Snap(bounds.Min[axis])));
    extent[2 * axis + 1] = ToIndex(std::floor(Snap(bounds.Max[axis])));
    if (extent[2 * axis] > extent[2 * axis + 1])
    {
      throw Error(std::string("The deformed volume lies between two layers of output voxels on "
                              "axis ") +
        "xyz"[axis] +
        " and covers none. Check the deformation and its units (are they meters in place of "
        "millimeters?), or set a smaller output spacing.");
    }
  }
  return extent;
}

Extent GetExtentAround(const IndexBounds& bounds)
{
  Extent extent;
  for (int axis = 0; axis < 3; ++axis)
  {
    extent[2 * axis] = ToIndex(std::floor(Snap(bounds.Min[axis])));
    extent[2 * axis + 1] = ToIndex(std::ceil(Snap(bounds.Max[axis])));
  }
  return extent;
}

IndexBounds GetVolumeBounds(const ImageGeometry& volume, const glm::dvec3& scale)
{
  const IndexBounds voxels = GetBox(volume.PointExtent);
  IndexBounds bounds;
  bounds.Add(scale * voxels.Min);
  bounds.Add(scale * voxels.Max);
  return bounds;
}

IndexBounds GetWorldBoxBounds(const double* box, const ImageGeometry& image)
{
  IndexBounds bounds;
  for (int axis = 0; axis < 3; ++axis)
  {
    const bool isBox = std::isfinite(box[2 * axis]) && std::isfinite(box[2 * axis + 1]) &&
      box[2 * axis] <= box[2 * axis + 1];
    if (!isBox)
    {
      throw Error(std::string("The bounds of the output are no box on axis ") + "xyz"[axis] + ": " +
        FormatNumber(box[2 * axis]) + " to " + FormatNumber(box[2 * axis + 1]) +
        ". Set a minimum no greater than the maximum.");
    }
    bounds.Min[axis] = box[2 * axis];
    bounds.Max[axis] = box[2 * axis + 1];
  }
  return TransformBox(image.GetWorldToIndex(), bounds);
}

Extent GetStableExtent(const Extent& last, const Extent& needed, int granularity)
{
  const bool isFirst = GetNumberOfPoints(last) == 0;
  const auto roundDown = [=](int index)
  { return static_cast<int>(std::floor(static_cast<double>(index) / granularity)) * granularity; };
  Extent kept;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int end = 0; end < 2; ++end)
    {
      // Upper ends are handled as the lower ends of the mirrored extents.
      const int sense = end == 0 ? 1 : -1;
      const int least = sense * needed[2 * axis + end];
      const int rounded = roundDown(least);
      const int before = sense * last[2 * axis + end];
      const bool serves = !isFirst && before <= least && rounded - before <= granularity;
      kept[2 * axis + end] = sense * (serves ? before : rounded);
    }
  }
  return GetPadded(kept, 0); // checks the size
}

Extent GetPadded(const Extent& extent, int padding)
{
  Extent padded;
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    padded[2 * axis] = extent[2 * axis] - padding;
    padded[2 * axis + 1] = extent[2 * axis + 1] + padding;
    voxels *= static_cast<double>(GetSize(padded, axis));
  }
  if (voxels > MostOutputVoxels)
  {
    throw Error(
      "The output would have more than 2^48 voxels: " + std::to_string(GetSize(padded, 0)) + " x " +
      std::to_string(GetSize(padded, 1)) + " x " + std::to_string(GetSize(padded, 2)) +
      ". Check the bounds, the output spacing, and that volume and deformation are in the same "
      "world units.");
  }
  return padded;
}

void CheckReferenceIndices(const VoxelGrid& voxelGrid, const ImageGeometry& reference)
{
  const IndexBounds bounds = GetOutputTransform(voxelGrid).ToOutput(GetBox(voxelGrid));
  for (int axis = 0; axis < 3; ++axis)
  {
    const double farthest = std::max(std::abs(bounds.Min[axis]), std::abs(bounds.Max[axis]));
    if (!(farthest <= MaxOutputIndex))
    {
      std::ostringstream text;
      text << "The volume at rest has the index " << farthest
           << " in the grid of the reference image on axis "
           << "xyz"[axis] << ", beyond 2^21. The reference image has "
           << DescribeTransform(reference)
           << ". Use a reference image near the volume, in the same world units, or with a greater "
              "spacing.";
      throw Error(text.str());
    }
  }
}

} // namespace deformvolume
