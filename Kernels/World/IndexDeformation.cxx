// SPDX-License-Identifier: BSD-3-Clause
#include "IndexDeformation.h"

#include "IndexBounds.h"
#include "ParallelFor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace deformvolume
{

MeshAtRest IndexDeformation::GetMeshAtRest() const
{
  static const std::vector<Tetrahedron> tetrahedra;
  static const std::vector<glm::dvec3> points;
  return { tetrahedra, points, this, 0, 0 };
}

std::optional<std::vector<TetrahedronChange>> IndexDeformation::GetConnectivityChanges(
  std::uint64_t) const
{
  return {};
}

DisplacementField IndexDeformation::GetField(const OutsideVoxels& outside) const
{
  DisplacementField field = this->GetFieldShape(outside);
  field.Vectors = this->OnDevice ? this->OnDevice->Read() : this->Vectors.data();
  return field;
}

DisplacementField IndexDeformation::GetFieldShape(const OutsideVoxels& outside) const
{
  DisplacementField field;
  field.Dimensions = this->FieldDimensions;
  field.IndexToField = this->IndexToField;
  if (this->OnDevice)
  {
    field.ToDisplacement = this->MatrixOnDevice;
  }
  field.Extrapolate = !outside.AreDiscarded();
  for (int axis = 0; axis < 3 && outside.AreKept(); ++axis)
  {
    // A FadeDistance of 0 would give an infinite value. With this limit the displacement fades
    // within 1e-6 of the distance between points.
    constexpr double most = 1e6;
    field.Fading[static_cast<std::size_t>(axis)] =
      std::min(this->FieldSpacing[axis] / outside.FadeDistance, most);
  }
  return field;
}

std::vector<unsigned char> IndexDeformation::FindUndefinedVoxels(const Extent& part,
  const OutsideVoxels& outside, const unsigned char* blanked, unsigned char blankedBits) const
{
  const DisplacementField field = this->GetFieldShape(outside);
  // Weights below this are rounding errors of positions.
  constexpr double tolerance = 1e-5;
  const auto width = static_cast<std::size_t>(GetSize(part, 0));
  const auto height = static_cast<std::size_t>(GetSize(part, 1));
  std::vector<unsigned char> undefined(static_cast<std::size_t>(GetNumberOfPoints(part)), 0);
  const auto& m = this->IndexToField;
  const auto isUndefined = [&](int x, int y, int z)
  {
    std::array<int, 3> low;
    std::array<int, 3> high;
    glm::dvec3 position;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int last = this->FieldDimensions[axis] - 1;
      double at = m[4 * axis] * x + m[4 * axis + 1] * y + m[4 * axis + 2] * z + m[4 * axis + 3];
      position[axis] = at;
      if (!field.Extrapolate && (at < -tolerance || at > last + tolerance))
      {
        return false; // the voxel is outside the field
      }
      at = std::min(std::max(at, 0.0), static_cast<double>(last));
      low[axis] = static_cast<int>(at + tolerance);
      high[axis] = std::min(last, at - low[axis] > tolerance ? low[axis] + 1 : low[axis]);
    }
    if (IsFading(field) && GetWeightBeyond(field, position, tolerance) == 0.0)
    {
      return false; // the voxel stays where it is
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      std::size_t point = 0;
      for (int axis = 2; axis >= 0; --axis)
      {
        point = point * static_cast<std::size_t>(this->FieldDimensions[axis]) +
          static_cast<std::size_t>((corner >> axis & 1) != 0 ? high[axis] : low[axis]);
      }
      if (this->UndefinedPoints[point])
      {
        return true;
      }
    }
    return false;
  };
  ParallelForItems(part[5] - part[4] + 1, 1,
    [&](int layer)
    {
      std::size_t voxel = static_cast<std::size_t>(layer) * width * height;
      for (int y = part[2]; y <= part[3]; ++y)
      {
        for (int x = part[0]; x <= part[1]; ++x)
        {
          const bool isBlanked = blanked && (blanked[voxel] & blankedBits) != 0;
          undefined[voxel++] = isBlanked || isUndefined(x, y, part[4] + layer) ? 1 : 0;
        }
      }
    });
  return undefined;
}

PointRanges IndexDeformation::GetChanges(std::uint64_t version) const
{
  PointRanges changes;
  const std::size_t count = this->Vectors.size() / 3;
  for (std::size_t block = 0; block < this->BlockVersions.size(); ++block)
  {
    if (this->BlockVersions[block] <= version)
    {
      continue;
    }
    const std::size_t begin = block * PointsPerBlock;
    if (changes.empty() || changes.back()[1] != begin)
    {
      changes.push_back({ { begin, begin } });
    }
    changes.back()[1] = std::min(begin + PointsPerBlock, count);
  }
  return changes;
}

void IndexDeformation::EraseUndefinedVectors()
{
  for (std::size_t i = 0; i < this->UndefinedPoints.size(); ++i)
  {
    if (this->UndefinedPoints[i] != 0)
    {
      std::fill_n(&this->Vectors[3 * i], 3, std::numeric_limits<float>::quiet_NaN());
    }
  }
}

void IndexDeformation::ResizeVectors(std::size_t count, std::size_t blocks)
{
  if (!this->VectorsAreWhole)
  {
    this->BlockVersions.clear();
  }
  if (this->Vectors.size() != 3 * count)
  {
    // A block with another number of points has changed.
    const std::size_t same = std::min(this->Vectors.size() / 3, count) / PointsPerBlock;
    this->BlockVersions.resize(std::min(this->BlockVersions.size(), same));
    this->Vectors.resize(3 * count);
  }
  this->BlockVersions.resize(blocks, this->VectorsVersion);
}

void IndexDeformation::UpdateDerived(
  const DerivedNodes& derived, std::size_t count, std::vector<std::atomic<bool>>& changed)
{
  std::atomic<bool> tooFar{ false };
  ParallelForItems(derived.GetCount(), PointsPerBlock,
    [&](std::size_t i)
    {
      const glm::vec3 sum(
        derived.Sum(i, [&](std::int32_t node) { return GetVector(this->Vectors.data(), node); }));
      float* last = this->Vectors.data() + 3 * (count + i);
      if (std::memcmp(last, &sum.x, 3 * sizeof(float)) != 0)
      {
        std::copy_n(&sum.x, 3, last);
        changed[(count + i) / PointsPerBlock].store(true, std::memory_order_relaxed);
      }
      for (int axis = 0; axis < 3; ++axis)
      {
        if (!(std::abs(sum[axis]) <= LargestDisplacement))
        {
          tooFar = true;
        }
      }
    });
  if (tooFar)
  {
    ThrowTooFar();
  }
}

void IndexDeformation::SetDisplacements(std::size_t count, const VectorSource& read,
  const glm::dmat3& toDisplacement, const DerivedNodes* derived)
{
  const std::uint64_t version = this->VectorsVersion;
  const std::size_t all = count + (derived ? derived->GetCount() : 0);
  const std::size_t blocks = (all + PointsPerBlock - 1) / PointsPerBlock;
  this->ResizeVectors(all, blocks);
  this->VectorsAreWhole = false;
  std::vector<std::atomic<bool>> changed(blocks);
  this->Faults.Resize(count);
  read(
    [&](std::int64_t first, const glm::dvec3* vectors, std::int64_t number)
    {
      this->Faults.Clear(first, number);
      std::array<float, 3 * PointsPerBlock> displacements;
      auto point = static_cast<std::size_t>(first);
      const std::size_t end = point + static_cast<std::size_t>(number);
      while (point < end)
      {
        const std::size_t block = point / PointsPerBlock;
        const std::size_t some = std::min(end, (block + 1) * PointsPerBlock) - point;
        const bool areNear = ConvertVectors(toDisplacement, vectors, some, displacements.data());
        for (std::size_t i = 0; i < some && !areNear; ++i)
        {
          if (!ConvertVectors(toDisplacement, vectors + i, 1, &displacements[3 * i]))
          {
            std::fill_n(&displacements[3 * i], 3, 0.0F);
            this->Faults.Mark(static_cast<std::int64_t>(point + i), NodeFaults::TooFar);
          }
        }
        float* last = this->Vectors.data() + 3 * point;
        if (std::memcmp(last, displacements.data(), 3 * some * sizeof(float)) != 0)
        {
          std::copy_n(displacements.begin(), 3 * some, last);
          changed[block].store(true, std::memory_order_relaxed);
        }
        vectors += some;
        point += some;
      }
    });
  if (all > count)
  {
    this->UpdateDerived(*derived, count, changed);
  }
  for (std::size_t block = 0; block < blocks; ++block)
  {
    if (changed[block])
    {
      this->BlockVersions[block] = version;
    }
  }
  this->VectorsAreWhole = true;
}

} // namespace deformvolume
