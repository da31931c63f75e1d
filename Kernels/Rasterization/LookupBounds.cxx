// SPDX-License-Identifier: BSD-3-Clause
#include "LookupBounds.h"

#include "IndexBounds.h" // for FieldTransform and Interpolate
#include "ParallelFor.h"
#include "RasterParameters.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <vector>

namespace deformvolume
{

namespace
{

/// The number of cells of the field, on each axis, for which candidates are found together.
constexpr int BlockSize = 8;
/// A margin that is larger than any output, in steps between points of the field.
constexpr double Infinity = 1e9;
/// A bound of rounding errors, in voxels or in steps between points of the field.
constexpr double Rounding = 1e-6;
/// The number of voxels of a box up to which each voxel is tested, and the number of vectors that
/// are read for a larger box.
constexpr double MostInBox = 4096.0;

/// Returns the voxels in a box.
IndexBounds RoundToVoxels(const IndexBounds& box)
{
  return { glm::ceil(box.Min - Rounding), glm::floor(box.Max + Rounding) };
}

/// The lookup of output voxels in a volume through a field.
class Lookup
{
public:
  Lookup(const VoxelGrid& voxelGrid, const DisplacementField& field)
    : Field(field)
    , Transform(GetOutputTransform(voxelGrid))
    , Volume(GetBox(voxelGrid))
    , Grid(field)
  {
    // As in the kernel: half a step of positions, which are rounded to 1/256 output voxel.
    const glm::dvec3 tolerance = this->Transform.GetTolerance(1.0 / 256.0);
    this->Volume.Min -= tolerance;
    this->Volume.Max += tolerance;
  }

  glm::ivec3 GetNumberOfBlocks() const
  {
    return glm::max(glm::ivec3(1), (glm::ivec3(this->Grid.Last) + BlockSize - 1) / BlockSize);
  }

  /// Returns the output voxels in a block of the field that may be mapped into the volume. Returns
  /// an empty box if they are all in `known`.
  IndexBounds GetCandidates(const glm::ivec3& block, const IndexBounds& known) const
  {
    const glm::ivec3 first = block * BlockSize;
    const glm::ivec3 last = glm::min(first + BlockSize, glm::ivec3(this->Grid.Last));
    bool hasBorder = false;
    IndexBounds box = this->GetBlock(first, last, hasBorder);
    // Most blocks are skipped before their vectors are read.
    if (known.Contains(RoundToVoxels(box)))
    {
      return IndexBounds();
    }
    IndexBounds vectors;
    ForEachPoint({ { first.x, last.x, first.y, last.y, first.z, last.z } },
      [&](int x, int y, int z)
      {
        const glm::dvec3 vector = this->GetPoint(x, y, z);
        if (IsFinite(vector)) // otherwise the point is undefined
        {
          vectors.Add(vector);
        }
      });
    if (hasBorder && IsFading(this->Field))
    {
      vectors.Add(glm::dvec3(0.0));
    }
    return this->GetPart(box, vectors);
  }

  /// Returns the part of a box of output voxels that may be mapped into the volume.
  IndexBounds GetCandidates(const IndexBounds& voxels) const
  {
    IndexBounds positions; // in the field
    for (int corner = 0; corner < 8; ++corner)
    {
      positions.Add(this->Grid.ToField(glm::mix(voxels.Min, voxels.Max,
        glm::bvec3((corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0))));
    }
    positions.Min -= Rounding;
    positions.Max += Rounding;
    const glm::dvec3 first = glm::clamp(positions.Min, glm::dvec3(0.0), this->Grid.Last);
    const glm::dvec3 last = glm::clamp(positions.Max, glm::dvec3(0.0), this->Grid.Last);
    // A trilinear function on a part of a cell is between its values at the corners of that part.
    // IsCovered() may use the nearest point instead of a position.
    std::array<std::vector<double>, 3> planes;
    for (int axis = 0; axis < 3; ++axis)
    {
      std::vector<double>& here = planes[static_cast<std::size_t>(axis)];
      here = { first[axis], last[axis] };
      for (double point = std::ceil(std::max(first[axis] - DEFORMVOLUME_LOOKUP_TOLERANCE, 0.0));
           point <= std::min(last[axis] + DEFORMVOLUME_LOOKUP_TOLERANCE, this->Grid.Last[axis]);
           point += 1.0)
      {
        here.push_back(point);
      }
    }
    const glm::dvec3 size = voxels.Max - voxels.Min + 1.0;
    if (static_cast<double>(planes[0].size() * planes[1].size() * planes[2].size()) >
      std::min(MostInBox, size.x * size.y * size.z / 16.0))
    {
      return voxels; // to be split
    }
    IndexBounds corners;
    for (const double z : planes[2])
    {
      for (const double y : planes[1])
      {
        for (const double x : planes[0])
        {
          const glm::dvec3 vector = this->Interpolate({ x, y, z });
          if (IsFinite(vector))
          {
            corners.Add(vector);
          }
        }
      }
    }
    IndexBounds vectors;
    const auto isLower = glm::greaterThan(-positions.Min, positions.Max - this->Grid.Last);
    for (const glm::dvec3& position : { glm::clamp(first, positions.Min, positions.Max), // nearest
           glm::mix(positions.Max, positions.Min, isLower) })                            // farthest
    {
      const double weight = GetWeightBeyond(this->Field, position, DEFORMVOLUME_LOOKUP_TOLERANCE);
      if (weight == 0.0)
      {
        vectors.Add(glm::dvec3(0.0));
      }
      else if (!corners.IsEmpty())
      {
        vectors.Add({ weight * corners.Min, weight * corners.Max });
      }
    }
    return this->GetPart(voxels, vectors);
  }

  bool IsCovered(const glm::dvec3& voxel) const
  {
    const glm::dvec3 position = this->Grid.ToField(voxel);
    if (!this->Field.Extrapolate &&
      (glm::any(glm::lessThan(position, glm::dvec3(-DEFORMVOLUME_LOOKUP_TOLERANCE))) ||
        glm::any(glm::greaterThan(position, this->Grid.Last + DEFORMVOLUME_LOOKUP_TOLERANCE))))
    {
      return false;
    }
    const double weight = GetWeightBeyond(this->Field, position, DEFORMVOLUME_LOOKUP_TOLERANCE);
    glm::dvec3 vector = weight > 0.0 ? this->Interpolate(position) : glm::dvec3(0.0);
    if (!IsFinite(vector)) // use the nearest point, as the kernel does
    {
      const glm::dvec3 nearest = glm::round(position);
      const auto isNear =
        glm::lessThanEqual(glm::abs(position - nearest), glm::dvec3(DEFORMVOLUME_LOOKUP_TOLERANCE));
      vector = this->Interpolate(glm::mix(position, nearest, isNear));
    }
    const glm::dvec3 rest = this->Transform.ToIndex(voxel + weight * vector);
    return glm::all(glm::greaterThanEqual(rest, this->Volume.Min)) &&
      glm::all(glm::lessThanEqual(rest, this->Volume.Max));
  }

private:
  /// Returns the voxels of a box that vectors in a range may map into the volume.
  IndexBounds GetPart(const IndexBounds& box, const IndexBounds& vectors) const
  {
    const IndexBounds volume = this->Transform.ToOutput(this->Volume);
    return vectors.IsEmpty() ? IndexBounds()
                             : RoundToVoxels({ glm::max(box.Min, volume.Min - vectors.Max),
                                 glm::min(box.Max, volume.Max - vectors.Min) });
  }

  /// Returns the box of a block of the field, in indices of the output. first, last: points of the
  /// field. hasBorder: set to whether the block has a border of the field.
  IndexBounds GetBlock(const glm::ivec3& first, const glm::ivec3& last, bool& hasBorder) const
  {
    IndexBounds box;
    for (int corner = 0; corner < 8; ++corner)
    {
      glm::dvec3 point;
      for (int axis = 0; axis < 3; ++axis)
      {
        const bool upper = (corner >> axis & 1) != 0;
        const int gridPoint = upper ? last[axis] : first[axis];
        const bool isBorder = gridPoint == (upper ? static_cast<int>(this->Grid.Last[axis]) : 0);
        const double margin =
          isBorder ? (this->Field.Extrapolate ? Infinity : DEFORMVOLUME_LOOKUP_TOLERANCE) : 0.0;
        point[axis] = gridPoint + (upper ? margin : -margin);
        hasBorder = hasBorder || isBorder;
      }
      box.Add(this->Grid.ToIndex(point));
    }
    return box;
  }

  glm::dvec3 GetPoint(int x, int y, int z) const
  {
    const auto& size = this->Field.Dimensions;
    return GetVector(
      this->Field.Vectors, (static_cast<std::int64_t>(z) * size[1] + y) * size[0] + x);
  }

  glm::dvec3 Interpolate(const glm::dvec3& position) const
  {
    return deformvolume::Interpolate(this->Field,
      glm::clamp(position, glm::dvec3(0.0), this->Grid.Last),
      [this](std::int64_t point) { return GetVector(this->Field.Vectors, point); });
  }

  const DisplacementField& Field;
  OutputTransform Transform;
  IndexBounds Volume; // the range of rest positions, in indices of the volume
  FieldTransform Grid;
};

/// Whether a box has voxels that are not in `known`.
bool HasOthers(const IndexBounds& box, const IndexBounds& known)
{
  return glm::all(glm::lessThanEqual(box.Min, box.Max)) && !known.Contains(box);
}

/// Adds the covered voxels of a box to bounds. Tests only voxels that would extend the bounds.
void AddCovered(const Lookup& lookup, IndexBounds box, IndexBounds& bounds)
{
  const auto isLarge = [](const glm::dvec3& size) { return size.x * size.y * size.z > MostInBox; };
  if (HasOthers(box, bounds) && isLarge(box.Max - box.Min + 1.0))
  {
    // With a field in other units than the volume, one cell may hold billions of voxels.
    box = lookup.GetCandidates(box);
  }
  if (!HasOthers(box, bounds))
  {
    return;
  }
  const glm::dvec3 size = box.Max - box.Min + 1.0;
  if (isLarge(size))
  {
    for (const glm::dvec3& corner : { box.Min, box.Max })
    {
      if (lookup.IsCovered(corner))
      {
        bounds.Add(corner);
      }
    }
    const int axis = size.x >= box.GetLength() + 1.0 ? 0 : size.y >= size.z ? 1 : 2;
    IndexBounds lower = box;
    lower.Max[axis] = std::floor(0.5 * (box.Min[axis] + box.Max[axis]));
    box.Min[axis] = lower.Max[axis] + 1.0;
    AddCovered(lookup, lower, bounds);
    AddCovered(lookup, box, bounds);
    return;
  }
  for (double z = box.Min.z; z <= box.Max.z; z += 1.0)
  {
    for (double y = box.Min.y; y <= box.Max.y; y += 1.0)
    {
      const auto isKnown = [&](double x)
      {
        const glm::dvec3 voxel(x, y, z);
        return bounds.Contains({ voxel, voxel });
      };
      double low = box.Min.x;
      while (low <= box.Max.x && !isKnown(low) && !lookup.IsCovered({ low, y, z }))
      {
        low += 1.0;
      }
      if (low > box.Max.x)
      {
        continue;
      }
      double high = box.Max.x;
      while (high > low && !isKnown(high) && !lookup.IsCovered({ high, y, z }))
      {
        high -= 1.0;
      }
      bounds.Add({ low, y, z });
      bounds.Add({ high, y, z });
    }
  }
}

} // namespace

IndexBounds ComputeLookupBounds(const VoxelGrid& voxelGrid, const DisplacementField& field)
{
  const Lookup lookup(voxelGrid, field);
  const glm::ivec3 blocks = lookup.GetNumberOfBlocks();
  IndexBounds bounds;
  std::mutex mutex;
  ParallelForItems(static_cast<std::int64_t>(blocks.y) * blocks.z, 1,
    [&](std::int64_t row)
    {
      IndexBounds known;
      {
        const std::lock_guard<std::mutex> lock(mutex);
        known = bounds;
      }
      for (int x = 0; x < blocks.x; ++x)
      {
        const IndexBounds candidates = lookup.GetCandidates(
          { x, static_cast<int>(row % blocks.y), static_cast<int>(row / blocks.y) }, known);
        AddCovered(lookup, candidates, known);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      bounds.Add(known);
    });
  return bounds;
}

} // namespace deformvolume
