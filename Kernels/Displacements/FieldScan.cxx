// SPDX-License-Identifier: BSD-3-Clause
#include "FieldScan.h"

#include "VectorComponents.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
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

// Checks blocks of a field and computes their bounds.
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
  }

  // Calls body(y, z) for the rows of a block.
  template <typename Body>
  void ForRows(std::size_t block, Body&& body) const
  {
    const auto blocks = static_cast<std::size_t>(CountBlocksOfPlane(this->Field));
    const int z = static_cast<int>(block / blocks);
    const int first = static_cast<int>(block % blocks) * RowsOfBlock;
    for (int y = first; y < std::min(first + RowsOfBlock, this->Field.Dimensions[1]); ++y)
    {
      body(y, z);
    }
  }

  // Returns a box that contains the deformed voxels of a block. usable: set to false if a vector is
  // not usable.
  IndexBounds Scan(std::size_t block, bool& usable) const
  {
    IndexBounds box;
    this->ForRows(block,
      [&](int y, int z)
      {
        const bool hasVoxels = this->HasVoxels(y, z);
        const std::array<int, 4> ends{ { 0, hasVoxels ? this->Begin[0] : 0,
          hasVoxels ? this->End[0] : 0, this->Field.Dimensions[0] } };
        for (int range = 0; range < 3; ++range)
        {
          for (int x = ends[range]; x < ends[range + 1]; x += Step)
          {
            const int end = std::min(x + Step, ends[range + 1]);
            usable = this->AddSome(x, end, y, z, range == 1, box) && usable;
          }
        }
      });
    return box;
  }

  // Returns the exact bounds of the deformed voxels of a block.
  IndexBounds FindBounds(std::size_t block) const
  {
    IndexBounds bounds;
    this->ForRows(block,
      [&](int y, int z)
      {
        for (int x = this->Begin[0]; this->HasVoxels(y, z) && x < this->End[0]; ++x)
        {
          bounds.Add(this->GetPosition(x, y, z) + GetVector(this->Field, this->GetPoint(x, y, z)));
        }
      });
    return bounds;
  }

private:
  static constexpr int Step = 64; // points of a row that are processed together

  std::int64_t GetPoint(int x, int y, int z) const
  {
    return (static_cast<std::int64_t>(z) * this->Field.Dimensions[1] + y) *
      this->Field.Dimensions[0] +
      x;
  }
  glm::dvec3 GetPosition(int x, int y, int z) const
  {
    return this->Rest[0][x] + this->Rest[1][y] + this->Rest[2][z];
  }
  // Whether a row of points contains voxels.
  bool HasVoxels(int y, int z) const
  {
    return y >= this->Begin[1] && y < this->End[1] && z >= this->Begin[2] && z < this->End[2];
  }

  // Checks the points x to end - 1 of a row. If they are voxels, adds their deformed positions to
  // the box. Returns whether all vectors are usable.
  bool AddSome(int x, int end, int y, int z, bool areVoxels, IndexBounds& box) const
  {
    const VectorComponents components = FindComponents(
      this->Field.Vectors + 3 * this->GetPoint(x, y, z), 3 * static_cast<std::size_t>(end - x));
    if (!components.AreFinite)
    {
      return false;
    }
    const DisplacementRange range = GetRange(this->Factors, components);
    bool near = true;
    for (int axis = 0; axis < 3; ++axis)
    {
      near = near && range.Least[axis] >= -LargestDisplacement &&
        range.Greatest[axis] <= LargestDisplacement;
    }
    for (int at = x; !near && at < end; ++at)
    {
      const glm::dvec3 moved = glm::abs(GetVector(this->Field, this->GetPoint(at, y, z)));
      if (!(std::max({ moved.x, moved.y, moved.z }) <= LargestDisplacement))
      {
        return false;
      }
    }
    if (areVoxels)
    {
      IndexBounds positions;
      positions.Add(this->GetPosition(x, y, z));
      positions.Add(this->GetPosition(end - 1, y, z));
      box.Add(positions.Min + glm::dvec3(range.Least[0], range.Least[1], range.Least[2]));
      box.Add(positions.Max + glm::dvec3(range.Greatest[0], range.Greatest[1], range.Greatest[2]));
    }
    return true;
  }

  const DisplacementField& Field;
  DisplacementFactors Factors;
  // The range of voxels, relative to the first point of the field.
  std::array<int, 3> Begin;
  std::array<int, 3> End;
  // The position of a voxel is the sum of one element for each axis, by the index of its point.
  std::array<std::vector<glm::dvec3>, 3> Rest;
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

std::vector<unsigned char> FieldScan::FindChanged(
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

FieldState FieldScan::Look(
  const VoxelGrid& voxelGrid, const DisplacementField& field, const PointRanges* changes)
{
  const std::vector<unsigned char> changed = this->FindChanged(field, changes);
  this->Bounds.Resize(changed.size());
  this->AreUsable.resize(changed.size());
  const BlockScanner scanner(voxelGrid, field);
  FieldState state;
  state.Bounds = this->Bounds.Compute(
    changed,
    [&](std::size_t block)
    {
      bool usable = true;
      const IndexBounds box = scanner.Scan(block, usable);
      this->AreUsable[block] = usable ? 1 : 0;
      return usable ? box : IndexBounds();
    },
    [&](std::size_t block) { return scanner.FindBounds(block); });
  state.IsUsable =
    std::find(this->AreUsable.begin(), this->AreUsable.end(), 0) == this->AreUsable.end();
  return state;
}

} // namespace deformvolume
