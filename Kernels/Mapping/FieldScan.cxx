// SPDX-License-Identifier: BSD-3-Clause
#include "FieldScan.h"

#include "ParallelFor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace deformvolume
{

namespace
{

constexpr double INFINITE = std::numeric_limits<double>::infinity();

// What numbers lie between. Not-a-number never does.
struct Range
{
  double Least = INFINITE;
  double Greatest = -INFINITE;
  void Add(double value)
  {
    this->Least = std::min(this->Least, value);
    this->Greatest = std::max(this->Greatest, value);
  }
};
using Ranges = std::array<Range, 3>;

// What the three components of some vectors lie between, and whether all are finite.
struct Components
{
  std::array<float, 3> Least;
  std::array<float, 3> Greatest;
  bool AreFinite;
};

Components FindComponents(const float* values, int count)
{
  // Twelve numbers at a time, of four vectors, side by side.
  constexpr int width = 12;
  alignas(16) std::array<float, width> least;
  alignas(16) std::array<float, width> greatest;
  alignas(16) std::array<float, width> rest{}; // nothing, where all numbers are finite
  least.fill(std::numeric_limits<float>::max());
  greatest.fill(-std::numeric_limits<float>::max());
  int i = 0;
#ifdef __SSE__
  // Compilers do not find these by themselves, and there are millions of points.
  __m128 lows[3];
  __m128 highs[3];
  __m128 rests[3];
  for (int k = 0; k < 3; ++k)
  {
    lows[k] = _mm_load_ps(&least[4 * k]);
    highs[k] = _mm_load_ps(&greatest[4 * k]);
    rests[k] = _mm_setzero_ps();
  }
  for (; i + width <= count; i += width)
  {
    for (int k = 0; k < 3; ++k)
    {
      const __m128 next = _mm_loadu_ps(values + i + 4 * k);
      lows[k] = _mm_min_ps(next, lows[k]);
      highs[k] = _mm_max_ps(next, highs[k]);
      rests[k] = _mm_add_ps(rests[k], _mm_sub_ps(next, next));
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    _mm_store_ps(&least[4 * k], lows[k]);
    _mm_store_ps(&greatest[4 * k], highs[k]);
    _mm_store_ps(&rest[4 * k], rests[k]);
  }
#endif
  for (; i < count; ++i)
  {
    const int k = i % width;
    least[k] = std::min(least[k], values[i]);
    greatest[k] = std::max(greatest[k], values[i]);
    rest[k] += values[i] - values[i];
  }
  Components found;
  found.AreFinite = std::all_of(rest.begin(), rest.end(), [](float r) { return r == 0.0F; });
  for (int axis = 0; axis < 3; ++axis)
  {
    found.Least[axis] =
      std::min({ least[axis], least[axis + 3], least[axis + 6], least[axis + 9] });
    found.Greatest[axis] =
      std::max({ greatest[axis], greatest[axis + 3], greatest[axis + 6], greatest[axis + 9] });
  }
  return found;
}

// Looks through rows of a field, and keeps what it has found.
class RowScanner
{
public:
  RowScanner(const VoxelGrid& voxelGrid, const DisplacementField& field)
    : Field(field)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const int offset = static_cast<int>(field.IndexToField[4 * axis + 3]);
      this->Begin[axis] = voxelGrid.VertexExtent[2 * axis] + offset;
      this->End[axis] = voxelGrid.VertexExtent[2 * axis + 1] + offset + 1;
      for (int i = 0; i < field.Dimensions[axis]; ++i)
      {
        this->Rest[axis].push_back(voxelGrid.Scale[axis] * (static_cast<double>(i) - offset));
      }
    }
  }

  // Some of the voxels, so that most others lie within what is known.
  void AddSome()
  {
    constexpr int step = 8;
    const auto next = [&](int i, int axis)
    { return i + 1 < this->End[axis] ? std::min(i + step, this->End[axis] - 1) : i + 1; };
    for (int z = this->Begin[2]; z < this->End[2]; z = next(z, 2))
    {
      for (int y = this->Begin[1]; y < this->End[1]; y = next(y, 1))
      {
        for (int x = this->Begin[0]; x < this->End[0]; x = next(x, 0))
        {
          this->AddPoint(x, y, z, true);
        }
      }
    }
  }

  // y, z: counted from the field's first point.
  void AddRow(int y, int z)
  {
    const bool inside =
      y >= this->Begin[1] && y < this->End[1] && z >= this->Begin[2] && z < this->End[2];
    const std::array<int, 4> ends{ { 0, inside ? this->Begin[0] : 0, inside ? this->End[0] : 0,
      this->Field.Dimensions[0] } };
    for (int part = 0; part < 3; ++part)
    {
      for (int x = ends[part]; x < ends[part + 1]; x += BLOCK)
      {
        this->AddBlock(x, std::min(x + BLOCK, ends[part + 1]), y, z, part == 1);
      }
    }
  }

  bool IsUsable = true;
  Ranges Positions; // of voxels

private:
  static constexpr int BLOCK = 64;

  std::int64_t GetPoint(int x, int y, int z) const
  {
    return (static_cast<std::int64_t>(z) * this->Field.Dimensions[1] + y) *
      this->Field.Dimensions[0] +
      x;
  }

  void AddPoint(int x, int y, int z, bool isVoxel)
  {
    const std::array<float, 3> displacement = GetDisplacement(this->Field, this->GetPoint(x, y, z));
    const std::array<int, 3> place{ { x, y, z } };
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto moved = static_cast<double>(displacement[axis]);
      this->IsUsable &= std::abs(moved) <= LargestDisplacement;
      if (isVoxel)
      {
        this->Positions[axis].Add(this->Rest[axis][place[axis]] + moved);
      }
    }
  }

  // Points of a row from x to end.
  void AddBlock(int x, int end, int y, int z, bool areVoxels)
  {
    const Components components =
      FindComponents(this->Field.Vectors + 3 * this->GetPoint(x, y, z), 3 * (end - x));
    if (!components.AreFinite)
    {
      this->IsUsable = false;
      return;
    }
    const std::array<int, 3> first{ { x, y, z } };
    const std::array<int, 3> last{ { end - 1, y, z } };
    bool known = true;
    for (int axis = 0; axis < 3; ++axis)
    {
      // Products and sums are rounded alike, so that no displacement leaves these bounds.
      double low = 0.0;
      double high = 0.0;
      for (int k = 0; k < 3; ++k)
      {
        const double factor = GetFactor(this->Field, 3 * axis + k);
        const double a = factor * static_cast<double>(components.Least[k]);
        const double b = factor * static_cast<double>(components.Greatest[k]);
        low += std::min(a, b);
        high += std::max(a, b);
      }
      known = known && low >= -LargestDisplacement && high <= LargestDisplacement;
      if (areVoxels && known)
      {
        const Range& range = this->Positions[axis];
        known = this->Rest[axis][first[axis]] + static_cast<double>(static_cast<float>(low)) >=
            range.Least &&
          this->Rest[axis][last[axis]] + static_cast<double>(static_cast<float>(high)) <=
            range.Greatest;
      }
    }
    for (int place = x; place < end && !known; ++place)
    {
      this->AddPoint(place, y, z, areVoxels);
    }
  }

  const DisplacementField& Field;
  // The voxels, counted from the field's first point.
  std::array<int, 3> Begin;
  std::array<int, 3> End;
  std::array<std::vector<double>, 3> Rest; // positions at each index of the field
};

} // namespace

bool AreVoxelsPoints(const VoxelGrid& voxelGrid, const DisplacementField& field)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const double* row = &field.IndexToField[4 * axis];
    for (int k = 0; k < 3; ++k)
    {
      if (row[k] != (axis == k ? 1.0 : 0.0))
      {
        return false;
      }
    }
    if (row[3] != std::round(row[3]) || voxelGrid.VertexExtent[2 * axis] + row[3] < 0.0 ||
      voxelGrid.VertexExtent[2 * axis + 1] + row[3] >= field.Dimensions[axis])
    {
      return false;
    }
  }
  return GetNumberOfPoints(voxelGrid.VertexExtent) > 0;
}

FieldScan ScanField(const VoxelGrid& voxelGrid, const DisplacementField& field)
{
  const std::int64_t rows = static_cast<std::int64_t>(field.Dimensions[1]) * field.Dimensions[2];
  const std::int64_t parts = std::min<std::int64_t>(rows, 64);
  std::vector<FieldScan> scans(static_cast<std::size_t>(parts));
  RowScanner some(voxelGrid, field);
  some.AddSome();
  ParallelFor(0, parts, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t part = begin; part < end; ++part)
      {
        RowScanner scanner = some;
        for (std::int64_t row = rows * part / parts; row < rows * (part + 1) / parts; ++row)
        {
          scanner.AddRow(static_cast<int>(row % field.Dimensions[1]),
            static_cast<int>(row / field.Dimensions[1]));
        }
        FieldScan& scan = scans[part];
        scan.IsUsable = scanner.IsUsable;
        const Ranges& found = scanner.Positions;
        if (found[0].Least <= found[0].Greatest)
        {
          scan.Bounds.Add(glm::dvec3(found[0].Least, found[1].Least, found[2].Least));
          scan.Bounds.Add(glm::dvec3(found[0].Greatest, found[1].Greatest, found[2].Greatest));
        }
      }
    });
  FieldScan all;
  all.IsUsable = true;
  for (const FieldScan& scan : scans)
  {
    all.IsUsable = all.IsUsable && scan.IsUsable;
    all.Bounds.Add(scan.Bounds);
  }
  return all;
}

} // namespace deformvolume
