// SPDX-License-Identifier: BSD-3-Clause
#include "RestPositions.h"

#include "Error.h"
#include "IndexBounds.h"
#include "KernelParameters.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace deformvolume
{
namespace
{

template <typename Entry>
cl::Buffer MakeBuffer(const OpenCLContext& context, std::vector<Entry> entries)
{
  return cl::Buffer(context.GetContext(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
    entries.size() * sizeof(Entry), entries.data());
}

/// Returns a RestVector for each index on x, then y, then z.
std::vector<RestVector> MakeRestVectors(const VoxelGrid& grid, const OutputTransform& transform)
{
  // Returns the contribution of an index to the position, in 2^-16 voxel. The rounding does not
  // depend on the part of the volume.
  const auto getPart = [&](int axis, int index)
  {
    glm::dvec3 part = transform.GetMatrix()[axis] * static_cast<double>(index);
    part += axis == 0 ? transform.GetShift() : glm::dvec3(0.0);
    return glm::i64vec3(glm::round(65536.0 * part));
  };
  const auto getWhole = [](std::int64_t part) { return (part - (part & 255)) / 256; };
  const Extent& extent = grid.VertexExtent;
  std::vector<RestVector> vectors;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int index = extent[2 * axis]; index <= extent[2 * axis + 1]; ++index)
    {
      RestVector vector;
      for (int row = 0; row < 3; ++row)
      {
        const std::int64_t part = getPart(axis, index)[row];
        std::int64_t whole = getWhole(part);
        if (axis == 0)
        {
          whole += getWhole(getPart(1, extent[2])[row]) + getWhole(getPart(2, extent[4])[row]);
        }
        else
        {
          whole -= getWhole(getPart(axis, extent[2 * axis])[row]);
        }
        vector.Whole[row] = static_cast<std::int32_t>(whole);
        vector.Fraction[row] = static_cast<float>(part & 255) / 256.0F;
      }
      vectors.push_back(vector);
    }
  }
  return vectors;
}

} // namespace

cl::Buffer MakeRestPositions(const OpenCLContext& context, const VoxelGrid& grid)
{
  const OutputTransform transform = GetOutputTransform(grid);
  const IndexBounds bounds = transform.ToOutput(GetBox(grid));
  for (int axis = 0; axis < 3; ++axis)
  {
    if (!(std::abs(bounds.Min[axis]) <= MaxOutputIndex &&
          std::abs(bounds.Max[axis]) <= MaxOutputIndex))
    {
      throw Error("The voxels at rest have output indices from " + FormatNumber(bounds.Min[axis]) +
        " to " + FormatNumber(bounds.Max[axis]) +
        " on an axis, but at most 2^21 is possible. Use a coarser output spacing, or a volume "
        "whose "
        "extent begins closer to 0.");
    }
  }
  if (!grid.ToOutput.IsDiagonal())
  {
    return MakeBuffer(context, MakeRestVectors(grid, transform));
  }
  std::vector<RestPosition> positions;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = 0; i < GetSize(grid.VertexExtent, axis); ++i)
    {
      const double position =
        256.0 * transform.GetMatrix()[axis][axis] * (grid.VertexExtent[2 * axis] + double(i)) +
        256.0 * transform.GetShift()[axis];
      const double whole = std::floor(position);
      positions.push_back(
        { static_cast<std::int32_t>(whole), static_cast<float>(position - whole) });
    }
  }
  return MakeBuffer(context, positions);
}

} // namespace deformvolume
