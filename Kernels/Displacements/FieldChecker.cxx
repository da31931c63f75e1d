// SPDX-License-Identifier: BSD-3-Clause
#include "FieldChecker.h"

#include "Lanes.h"
#include "ParallelFor.h"
#include "VectorComponents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace deformvolume
{

namespace
{

// Rows of one plane in a block.
constexpr int RowsOfBlock = 8;

int CountBlocksOfPlane(const DisplacementField& field)
{
  return (field.Dimensions[1] + RowsOfBlock - 1) / RowsOfBlock;
}

// Points of a row of a field. The position of a point at rest is the sum of Row, Plane, and for
// each axis its element of Along.
struct RowPoints
{
  const float* Vectors; // of the whole row
  std::array<const double*, 3> Along;
  glm::dvec3 Row;
  glm::dvec3 Plane;
  int Begin;
  int End;
};

// The bounds of deformed points, of each lane.
struct ScanResult
{
  Lanes Min[3] = { MakeLanes(Far), MakeLanes(Far), MakeLanes(Far) };
  Lanes Max[3] = { MakeLanes(-Far), MakeLanes(-Far), MakeLanes(-Far) };
  Lanes Faults = MakeLanes(0.0); // not 0 after a vector that is not usable

  static constexpr double Far = std::numeric_limits<double>::max();
};

// Adds the deformed positions of four points. numbers: their numbers in the row. The operations are
// those of GetDisplacement(), in the same order.
DEFORMVOLUME_ALWAYS_INLINE void AddPoints(const DisplacementFactors& factors, const RowPoints& row,
  const std::array<int, 4>& numbers, ScanResult& result)
{
  Lanes vectors[3];
  for (int lane = 0; lane < NumberOfLanes; ++lane)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      vectors[axis][lane] = static_cast<double>(row.Vectors[3 * numbers[lane] + axis]);
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const Lanes exact = factors[3 * axis] * vectors[0] + factors[3 * axis + 1] * vectors[1] +
      factors[3 * axis + 2] * vectors[2];
    const Lanes displacement =
      __builtin_convertvector(__builtin_convertvector(exact, FloatLanes), Lanes);
    Lanes position;
    for (int lane = 0; lane < NumberOfLanes; ++lane)
    {
      position[lane] = row.Along[axis][numbers[lane]];
    }
    position = position + row.Row[axis] + row.Plane[axis] + displacement;
    result.Min[axis] = position < result.Min[axis] ? position : result.Min[axis];
    result.Max[axis] = position > result.Max[axis] ? position : result.Max[axis];
    // Not-a-number is a fault, too.
    result.Faults = Absolute(displacement) <= LargestDisplacement ? result.Faults : MakeLanes(1.0);
  }
}

DEFORMVOLUME_ALWAYS_INLINE void AddRowInline(
  const DisplacementFactors& factors, const RowPoints& row, ScanResult& result)
{
  ScanResult all = result;
  int i = row.Begin;
  for (; i + NumberOfLanes <= row.End; i += NumberOfLanes)
  {
    AddPoints(factors, row, { { i, i + 1, i + 2, i + 3 } }, all);
  }
  if (i < row.End)
  {
    const int last = row.End - 1;
    AddPoints(factors, row, { { i, std::min(i + 1, last), std::min(i + 2, last), last } }, all);
  }
  result = all;
}

void AddRow(const DisplacementFactors& factors, const RowPoints& row, ScanResult& result)
{
  RunOnLanes([&]() __attribute__((always_inline)) { AddRowInline(factors, row, result); });
}

// Checks blocks of a field and computes the bounds of their deformed voxels.
class BlockScanner
{
public:
  BlockScanner(const VoxelGrid& voxelGrid, const DisplacementField& field)
    : Field(field)
    , Factors(GetFactors(field))
  {
    const OutputTransform transform = GetOutputTransform(voxelGrid);
    for (int axis = 0; axis < 3; ++axis)
    {
      const int offset = static_cast<int>(field.IndexToField[4 * axis + 3]);
      this->Begin[axis] = voxelGrid.VertexExtent[2 * axis] + offset;
      this->End[axis] = voxelGrid.VertexExtent[2 * axis + 1] + offset + 1;
      for (int i = 0; i < field.Dimensions[axis]; ++i)
      {
        this->Rest[axis].push_back(transform.GetMatrix()[axis] * (static_cast<double>(i) - offset) +
          (axis == 0 ? transform.GetShift() : glm::dvec3(0.0)));
      }
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      for (const glm::dvec3& place : this->Rest[0])
      {
        this->Along[axis].push_back(place[axis]);
      }
    }
  }

  // Returns the bounds of the deformed voxels of a block. usable: set to false if a vector of the
  // block is not usable.
  IndexBounds Scan(std::size_t block, bool& usable) const
  {
    ScanResult voxels;
    ScanResult others;
    const auto blocks = static_cast<std::size_t>(CountBlocksOfPlane(this->Field));
    const int z = static_cast<int>(block / blocks);
    const int first = static_cast<int>(block % blocks) * RowsOfBlock;
    for (int y = first; y < std::min(first + RowsOfBlock, this->Field.Dimensions[1]); ++y)
    {
      const std::int64_t point =
        (static_cast<std::int64_t>(z) * this->Field.Dimensions[1] + y) * this->Field.Dimensions[0];
      RowPoints row{ this->Field.Vectors + 3 * point,
        { { this->Along[0].data(), this->Along[1].data(), this->Along[2].data() } },
        this->Rest[1][y], this->Rest[2][z], 0, 0 };
      const bool hasVoxels = this->HasVoxels(y, z);
      const std::array<int, 4> ends{ { 0, hasVoxels ? this->Begin[0] : 0,
        hasVoxels ? this->End[0] : 0, this->Field.Dimensions[0] } };
      for (int range = 0; range < 3; ++range)
      {
        row.Begin = ends[range];
        row.End = ends[range + 1];
        AddRow(this->Factors, row, range == 1 ? voxels : others);
      }
    }
    usable = SumOfLanes(voxels.Faults + others.Faults) == 0.0;
    IndexBounds bounds;
    for (int lane = 0; lane < NumberOfLanes && usable; ++lane)
    {
      IndexBounds one;
      for (int axis = 0; axis < 3; ++axis)
      {
        one.Min[axis] = voxels.Min[axis][lane];
        one.Max[axis] = voxels.Max[axis][lane];
      }
      bounds.Add(one); // nothing if there are no voxels
    }
    return bounds;
  }

private:
  // Whether a row of points contains voxels.
  bool HasVoxels(int y, int z) const
  {
    return y >= this->Begin[1] && y < this->End[1] && z >= this->Begin[2] && z < this->End[2];
  }

  const DisplacementField& Field;
  DisplacementFactors Factors;
  // The range of voxels, relative to the first point of the field.
  std::array<int, 3> Begin;
  std::array<int, 3> End;
  // The position of a voxel is the sum of one element for each axis, by the index of its point.
  std::array<std::vector<glm::dvec3>, 3> Rest;
  std::array<std::vector<double>, 3> Along; // the components of Rest[0]
};

} // namespace

int GetFieldStride(const Extent& voxels, const std::array<double, 12>& indexToField,
  const std::array<int, 3>& dimensions)
{
  const double stride = indexToField[0];
  bool found = stride >= 1.0 && stride == std::floor(stride) && stride <= dimensions[0] &&
    GetNumberOfPoints(voxels) > 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double* row = &indexToField[4 * axis];
    for (int k = 0; k < 3; ++k)
    {
      found = found && row[k] == (axis == k ? stride : 0.0);
    }
    found = found && row[3] == std::floor(row[3]) && stride * voxels[2 * axis] + row[3] >= 0.0 &&
      stride * voxels[2 * axis + 1] + row[3] < dimensions[axis];
  }
  return found ? static_cast<int>(stride) : 0;
}

std::vector<unsigned char> FieldChecker::FindChanged(
  const DisplacementField& field, const PointRanges* changes) const
{
  const auto blocksOfPlane = static_cast<std::size_t>(CountBlocksOfPlane(field));
  const std::size_t blocks = blocksOfPlane * static_cast<std::size_t>(field.Dimensions[2]);
  if (!changes || this->AreUsable.size() != blocks)
  {
    return std::vector<unsigned char>(blocks, 1);
  }
  std::vector<unsigned char> changed(blocks, 0);
  const auto width = static_cast<std::size_t>(field.Dimensions[0]);
  const auto height = static_cast<std::size_t>(field.Dimensions[1]);
  const std::size_t rows = height * static_cast<std::size_t>(field.Dimensions[2]);
  for (const auto& range : *changes)
  {
    for (std::size_t row = range[0] / width; row < rows && row * width < range[1]; ++row)
    {
      changed[row / height * blocksOfPlane + row % height / RowsOfBlock] = 1;
    }
  }
  return changed;
}

FieldCheckResult FieldChecker::Check(
  const VoxelGrid& voxelGrid, const DisplacementField& field, const PointRanges* changes)
{
  const std::vector<unsigned char> changed = this->FindChanged(field, changes);
  this->Bounds.resize(changed.size());
  this->AreUsable.resize(changed.size());
  const BlockScanner scanner(voxelGrid, field);
  ParallelForItems(changed.size(), 16,
    [&](std::size_t block)
    {
      if (changed[block])
      {
        bool usable = true;
        this->Bounds[block] = scanner.Scan(block, usable);
        this->AreUsable[block] = usable ? 1 : 0;
      }
    });
  FieldCheckResult state;
  state.IsUsable =
    std::find(this->AreUsable.begin(), this->AreUsable.end(), 0) == this->AreUsable.end();
  for (const IndexBounds& bounds : this->Bounds)
  {
    state.Bounds.Add(bounds);
  }
  return state;
}

} // namespace deformvolume
